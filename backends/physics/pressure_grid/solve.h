/* The solve of the pressure grid's equations, and where it starts. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_SOLVE_H
#define PBF_PHYSICS_PRESSURE_GRID_SOLVE_H

#include "physics/pressure_grid/nodes.h"

/* ---- The solve: Chebyshev's semi-iteration, as in the iterations over particles -------------- */

/* No element's largest eigenvalue is above 1.5 times its diagonal, so no grid's is; the smallest is
 * that of a wave four times as long as the water, of so many nodes. */
#define PBF_PRESSURE_GRID_HIGHEST 1.5

typedef struct pbf_pressure_grid_solve {
  double ratio2, step; /* of the interval */
  int max_iterations;  /* iterations */
  double enough;       /* what may be missing at a node */
  double weight;       /* of the iteration */
} pbf_pressure_grid_solve;

/* Iterations for eigenvalues from `low` to `high`, of the matrix over its diagonal. */
PBF_FN pbf_pressure_grid_solve pbf_pressure_grid_within(double low, double high) {
  const double ratio = (high - low) / (high + low);
  return (pbf_pressure_grid_solve){ratio * ratio, 2 / (high + low), 0, 0, 1};
}

/* `largest` is the largest right side; 0: there is nothing to do. So many iterations leave 4 % of
 * the longest wave, which fluid in motion takes all of them for. */
PBF_FN pbf_pressure_grid_solve pbf_pressure_grid_solve_begin(int longest, double largest) {
  const double wave = 0.5 * PBF_PI / (longest + 1);
  pbf_pressure_grid_solve s =
      pbf_pressure_grid_within(0.375 * wave * wave, PBF_PRESSURE_GRID_HIGHEST);
  s.max_iterations = largest > 0 ? 8 + 4 * longest : 0;
  s.enough = 0.005 / longest * largest;
  return s;
}

/* Once iteration k is over. */
PBF_FN void pbf_pressure_grid_solve_go_on(pbf_pressure_grid_solve *s, int k) {
  s->weight = k == 0 ? 2 / (2 - s->ratio2) : 4 / (4 - s->ratio2 * s->weight);
}

/* lambda of a node that is not in the open, after an iteration. */
PBF_FN double pbf_pressure_grid_next(const pbf_pressure_grid_solve *s, double residual,
                                     double inverse, double now, double before) {
  return pbf_min(s->weight * (now + s->step * residual * inverse - before) + before, 0);
}

/* Whether an iteration looks if it may be the last. */
PBF_FN int pbf_pressure_grid_asks(int k) { return k % 4 == 3; }

/* How far its equation is from holding, where lambda may go on. */
PBF_FN double pbf_pressure_grid_miss(double residual, double lambda) {
  return lambda < 0 || residual < 0 ? fabs(residual) : 0;
}

/* ---- Torn nodes ----------------------------------------------------------------------------- */

/* An iteration of one, into `next`; returns how far its equation is from holding. */
PBF_FN double pbf_pressure_grid_relax_torn(const pbf_pressure_grid *c,
                                           const pbf_pressure_grid_topology *t,
                                           const pbf_pressure_grid_solve *solve,
                                           const double *free_volumes, const double *lambda,
                                           uint32_t torn) {
  const double now = lambda[t->torn_at[torn]];
  if (!(t->inverse[torn] > 0)) {
    t->next[torn] = 0;
    return 0;
  }
  const double residual = pbf_pressure_grid_torn_residual(c, t, free_volumes, lambda, torn);
  t->next[torn] = pbf_pressure_grid_next(solve, residual, t->inverse[torn], now, t->before[torn]);
  return pbf_pressure_grid_miss(residual, now);
}

/* Once all of an iteration are known, which go where the next one reads them. */
PBF_FN void pbf_pressure_grid_end_torn(const pbf_pressure_grid_topology *t, const double *lambda,
                                       double *next_lambda, uint32_t torn) {
  const uint32_t node = t->torn_at[torn];
  t->before[torn] = lambda[node];
  next_lambda[node] = t->next[torn];
}

/* ---- Where it starts ----------------------------------------------------------------------- */

/* To which side the forces push along the grid's axis: -1 or 1; 0: there are none. */
PBF_FN int pbf_pressure_grid_down(const pbf_pressure_grid *c) {
  return c->push[c->axis] < 0 ? -1 : c->push[c->axis] > 0;
}

PBF_FN uint32_t pbf_pressure_grid_columns(const pbf_pressure_grid *c) {
  return c->nodes / c->size[c->axis];
}

/* A column of nodes along the grid's axis, from the domain's wall that it stands on. */
typedef struct pbf_pressure_grid_column {
  uint32_t outside, floor; /* nodes: the one outside, the one on the wall that fluid stands on */
  int64_t up;
} pbf_pressure_grid_column;

PBF_FN pbf_pressure_grid_column pbf_pressure_grid_column_at(const pbf_pressure_grid *c,
                                                            uint32_t column) {
  uint32_t stride = c->corner[1u << c->axis], top = 1 + (uint32_t)c->n[c->axis];
  uint32_t first = column % stride + column / stride * stride * c->size[c->axis];
  int falls = pbf_pressure_grid_down(c) < 0;
  return (pbf_pressure_grid_column){first, falls ? first + stride : first + top * stride,
                                    falls ? (int64_t)stride : -(int64_t)stride};
}

/* Cells between a node inside and the surface, on the way to the next one, which is not. */
PBF_FN double pbf_pressure_grid_above(const double *depths, int64_t node, int64_t next) {
  return depths[node] / pbf_max(depths[node] - depths[next], depths[node]);
}

/* And above the last of so many nodes inside of a column of `top`. */
PBF_FN double pbf_pressure_grid_column_above(const double *depths, pbf_pressure_grid_column at,
                                             uint32_t stands, uint32_t top) {
  const int64_t last = at.floor + (stands - 1) * at.up;
  return stands < top ? pbf_pressure_grid_above(depths, last, last + at.up) : 1;
}

/* What carries a part of the weight of so many cells, one above the other. */
PBF_FN double pbf_pressure_grid_weight(const pbf_pressure_grid *c, double part, double cells) {
  return -part * fabs(c->push[c->axis]) * cells;
}

/* ---- … on solids, and between thin ones -------------------------------------------------------
 */

/* Whether a node is not in the open. */
PBF_FN int pbf_pressure_grid_is_solved(const pbf_pressure_grid_topology *t, const double *inverse,
                                       uint32_t node) {
  const uint32_t torn = t->torn[node];
  return torn ? t->inverse[torn - 1] > 0 : inverse[node] > 0;
}

/* Whether there is room between a node that is not torn and the next one to that side of the axis.
 */
PBF_FN int pbf_pressure_grid_has_free_volume(const pbf_pressure_grid *c, const double *free_volumes,
                                             uint32_t node, int upwards) {
  double volume = 0;
  for (int a = 0; a < PBF_CORNERS; ++a)
    if ((a >> c->axis & 1) != upwards) volume += free_volumes[node - c->corner[a]];
  return volume >= 0.1;
}

/* The node next to one along the grid's axis; PBF_NO_INDEX where a solid or a wall is. */
PBF_FN uint32_t pbf_pressure_grid_beside(const pbf_pressure_grid *c,
                                         const pbf_pressure_grid_topology *t,
                                         const double *free_volumes, uint32_t node, int upwards) {
  const uint32_t stride = c->corner[1u << c->axis];
  if (t->torn[node]) return pbf_node_beside_torn(c, t, t->torn[node] - 1, c->axis, upwards);
  if (!pbf_pressure_grid_has_free_volume(c, free_volumes, node, upwards)) return PBF_NO_INDEX;
  return upwards ? node + stride : node - stride;
}

/* What a torn node starts with: the part of the weight of what stands above it, where that stands
 * on something. */
PBF_FN double pbf_pressure_grid_torn_guess(const pbf_pressure_grid *c,
                                           const pbf_pressure_grid_topology *t, double part,
                                           const double *inverse, const double *free_volumes,
                                           const double *depths, uint32_t torn) {
  const int upwards = pbf_pressure_grid_down(c) < 0;
  uint32_t node = t->torn_at[torn], next, cells = 0;
  if (pbf_pressure_grid_down(c) == 0 || !pbf_pressure_grid_is_solved(t, inverse, node)) return 0;
  while ((next = pbf_pressure_grid_beside(c, t, free_volumes, node, !upwards)) != PBF_NO_INDEX) {
    if (!pbf_pressure_grid_is_solved(t, inverse, next)) return 0;
    node = next;
  }
  node = t->torn_at[torn];
  while ((next = pbf_pressure_grid_beside(c, t, free_volumes, node, upwards)) != PBF_NO_INDEX &&
         pbf_pressure_grid_is_solved(t, inverse, next)) {
    node = next;
    ++cells;
  }
  const double above = next == PBF_NO_INDEX ? 1 : pbf_pressure_grid_above(depths, node, next);
  return pbf_pressure_grid_weight(c, part, cells + above);
}

PBF_FN bool pbf_node_is_torn(const pbf_pressure_grid_topology *t, int64_t node) {
  return t->is_active && t->torn[node];
}

/* The part of the weight of what stands above, once the torn nodes have theirs: in runs of nodes of
 * a column that are not torn, on whatever they stand, below whatever torn node or surface they end;
 * 0 elsewhere. */
PBF_FN void pbf_pressure_grid_guess(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                                    double part, const double *inverse, const double *free_volumes,
                                    const double *depths, uint32_t column, double *lambda) {
  const pbf_pressure_grid_column at = pbf_pressure_grid_column_at(c, column);
  const uint32_t top = 1 + (uint32_t)c->n[c->axis];
  const int upwards = pbf_pressure_grid_down(c) < 0;
  lambda[at.outside] = 0;
  for (uint32_t i = 0; i < top; ++i)
    if (!pbf_node_is_torn(t, at.floor + i * at.up)) lambda[at.floor + i * at.up] = 0;
  if (pbf_pressure_grid_down(c) == 0) return;
  for (uint32_t i = 0; i < top;) {
    const uint32_t first = i;
    const int64_t floor = at.floor + first * at.up;
    while (i < top && inverse[at.floor + i * at.up] > 0) ++i;
    if (i == first) {
      ++i;
      continue;
    }
    const int64_t last = at.floor + (i - 1) * at.up;
    const int on_torn =
        first > 0 && pbf_node_is_torn(t, floor - at.up) && lambda[floor - at.up] < 0;
    if (first > 0 && !on_torn &&
        pbf_pressure_grid_has_free_volume(c, free_volumes, (uint32_t)floor, !upwards))
      continue;
    const double above = i < top && pbf_node_is_torn(t, last + at.up) && lambda[last + at.up] < 0
                             ? 1 + lambda[last + at.up] / pbf_pressure_grid_weight(c, part, 1)
                             : pbf_pressure_grid_column_above(depths, at, i, top);
    for (uint32_t k = first; k < i; ++k)
      lambda[at.floor + k * at.up] = pbf_pressure_grid_weight(c, part, i - 1 - k + above);
  }
}

#endif
