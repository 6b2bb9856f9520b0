/* The pressure grid's equations, of which each node has one, and their solve: grid.h says what
 * they are. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_NODES_H
#define PBF_PHYSICS_PRESSURE_GRID_NODES_H

#include "physics/pressure_grid/surface.h"

/* ---- Nodes --------------------------------------------------------------------------------- */

/* The integral of grad N_a · grad N_b over a unit cell, an element's stiffness, is OWN in these
 * units for a = b; for corners that differ in one axis 0 in three dimensions and -1 in two, in more
 * axes -1 and -2. */
#define PBF_PRESSURE_GRID_STIFFNESS (PBF_DIM == 3 ? 1.0 / 12 : 1.0 / 6)
#define PBF_PRESSURE_GRID_STIFFNESS_OWN 4

/* What a node's cells have and do. */
typedef struct pbf_pressure_grid_node_sum {
  double free_volume, weight, sum;
} pbf_pressure_grid_node_sum;

/* The cell of which the node, the i-th along each axis, is corner `a`. A crowd counts as an error
 * of its cell's whole free volume: it is for the iterations. */
PBF_FN void pbf_pressure_grid_add_cell(const pbf_pressure_grid *c,
                                       const pbf_pressure_grid_source_scale *source_scale,
                                       const int64_t *sums, const double *free_volumes,
                                       const double *weights, int64_t node, const int i[PBF_DIM],
                                       int a, pbf_pressure_grid_node_sum *all) {
  int64_t cell = node - (int64_t)c->corner[a];
  double divergence = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    int right_of = a >> k & 1;
    divergence += (right_of ? 1 : -1) * (c->push[k] + c->pull[k] * (i[k] - right_of));
  }
  all->free_volume += free_volumes[cell];
  all->weight += weights[cell];
  all->sum += source_scale->share / PBF_CORNERS *
                  pbf_lesser(pbf_pressure_grid_error(c, sums[cell]), free_volumes[cell]) +
              free_volumes[cell] * divergence * 2 / PBF_CORNERS;
}

/* The system's right side and the inverse of its diagonal: 0 for a node in the open or with next to
 * no free volume, and where nothing is to be done. `weights` are free volumes over parts. One cell
 * by one, here and below, so that the compiler can do several nodes at once. */
PBF_FN void pbf_pressure_grid_equation_at(const pbf_pressure_grid *c,
                                          const pbf_pressure_grid_source_scale *source_scale,
                                          const int64_t *sums, const double *free_volumes,
                                          const double *weights, double depth, int64_t node,
                                          const int i[PBF_DIM], double *right, double *inverse) {
  pbf_pressure_grid_node_sum all = {0, 0, 0};
  pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i, 0, &all);
  pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i, 1, &all);
  pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i, 2, &all);
  pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i, 3, &all);
  if (PBF_DIM == 3) {
    pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i,
                               PBF_CORNERS - 4, &all);
    pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i,
                               PBF_CORNERS - 3, &all);
    pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i,
                               PBF_CORNERS - 2, &all);
    pbf_pressure_grid_add_cell(c, source_scale, sums, free_volumes, weights, node, i,
                               PBF_CORNERS - 1, &all);
  }
  int has = all.free_volume >= 0.1 && source_scale->part > 0;
  int solved = has && !pbf_pressure_grid_is_open(depth);
  *right = has ? -source_scale->part * all.sum : 0;
  *inverse = solved ? 1 / (PBF_PRESSURE_GRID_STIFFNESS * PBF_PRESSURE_GRID_STIFFNESS_OWN *
                           pbf_greater(all.weight, 0.1))
                    : 0;
}

/* That of any node; 0 for those outside. */
PBF_FN void pbf_pressure_grid_equation(const pbf_pressure_grid *c,
                                       const pbf_pressure_grid_source_scale *source_scale,
                                       const int64_t *sums, const double *free_volumes,
                                       const double *weights, double depth, uint32_t node,
                                       double *right, double *inverse) {
  int i[PBF_DIM];
  *right = *inverse = 0;
  pbf_pressure_grid_place(c, node, i);
  for (int k = 0; k < PBF_DIM; ++k)
    if (i[k] == 0) return;
  pbf_pressure_grid_equation_at(c, source_scale, sums, free_volumes, weights, depth, node, i, right,
                                inverse);
}

/* The weights of the cells around a node: of the one of which it is corner a. */
PBF_FN void pbf_pressure_grid_around(const pbf_pressure_grid *c, const double *weights,
                                     uint32_t node, double around[PBF_CORNERS]) {
  for (int a = 0; a < PBF_CORNERS; ++a) around[a] = weights[(int64_t)node - (int64_t)c->corner[a]];
}

/* The part of a node's left side from the cell of which it is corner `a`. */
PBF_FN double pbf_pressure_grid_stiffness(const pbf_pressure_grid *c,
                                          const double around[PBF_CORNERS], const double *lambda,
                                          uint32_t node, int a) {
  int64_t x = 1 - 2 * (a & 1), y = (1 - 2 * (a >> 1 & 1)) * (int64_t)c->corner[2];
  const double *at = lambda + node;
  int64_t z = (1 - 2 * (a >> 2)) * (int64_t)c->corner[PBF_CORNERS / 2];
  double others = PBF_DIM == 2 ? at[x] + at[y] + 2 * at[x + y]
                               : at[x + y] + at[x + z] + (at[y + z] + at[x + y + z]);
  return around[a] * (PBF_PRESSURE_GRID_STIFFNESS_OWN * at[0] - others);
}

/* What is missing on the left side. */
PBF_FN double pbf_pressure_grid_residual(const pbf_pressure_grid *c,
                                         const double around[PBF_CORNERS], const double *lambda,
                                         double right, uint32_t node) {
  double left = pbf_pressure_grid_stiffness(c, around, lambda, node, 0) +
                pbf_pressure_grid_stiffness(c, around, lambda, node, 1) +
                (pbf_pressure_grid_stiffness(c, around, lambda, node, 2) +
                 pbf_pressure_grid_stiffness(c, around, lambda, node, 3));
  if (PBF_DIM == 3)
    left += pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 4) +
            pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 3) +
            (pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 2) +
             pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 1));
  return right - PBF_PRESSURE_GRID_STIFFNESS * left;
}

/* ---- The solve: Chebyshev's semi-iteration, as in the iterations over particles -------------- */

/* No element's largest eigenvalue is above 1.5 times its diagonal, so no grid's is; the smallest is
 * that of a wave four times as long as the water, of so many nodes. */
#define PBF_PRESSURE_GRID_HIGHEST 1.5

typedef struct pbf_pressure_grid_solve {
  double ratio2, step; /* of the interval */
  int most;            /* iterations */
  double enough;       /* what may be missing at a node */
  double weight;       /* of the iteration */
} pbf_pressure_grid_solve;

/* `largest` is the largest right side; 0: there is nothing to do. So many iterations leave 4 % of
 * the longest wave, which fluid in motion takes all of them for. */
PBF_FN pbf_pressure_grid_solve pbf_pressure_grid_solve_begin(int longest, double largest) {
  pbf_pressure_grid_solve s;
  double wave = 0.5 * PBF_PI / (longest + 1), low = 0.375 * wave * wave;
  double ratio = (PBF_PRESSURE_GRID_HIGHEST - low) / (PBF_PRESSURE_GRID_HIGHEST + low);
  s.ratio2 = ratio * ratio;
  s.step = 2 / (PBF_PRESSURE_GRID_HIGHEST + low);
  s.most = largest > 0 ? 8 + 2 * longest : 0;
  s.enough = 0.05 / longest * largest;
  s.weight = 1;
  return s;
}

/* Once iteration k is over. */
PBF_FN void pbf_pressure_grid_solve_go_on(pbf_pressure_grid_solve *s, int k) {
  s->weight = k == 0 ? 2 / (2 - s->ratio2) : 4 / (4 - s->ratio2 * s->weight);
}

/* lambda of a node that is not in the open, after an iteration. */
PBF_FN double pbf_pressure_grid_next(const pbf_pressure_grid_solve *s, double residual,
                                     double inverse, double now, double before) {
  return pbf_lesser(s->weight * (now + s->step * residual * inverse - before) + before, 0);
}

/* Whether an iteration looks if it may be the last. */
PBF_FN int pbf_pressure_grid_asks(int k) { return k % 4 == 3; }

/* How far its equation is from holding, where lambda may go on. */
PBF_FN double pbf_pressure_grid_miss(double residual, double lambda) {
  return lambda < 0 || residual < 0 ? fabs(residual) : 0;
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

/* Cells between a node and the surface above it. */
PBF_FN double pbf_pressure_grid_above(const pbf_pressure_grid *c, const double *free_volumes,
                                      const double *weights, int64_t node) {
  double free_volume = 0, weight = 0;
  int below = pbf_pressure_grid_down(c) > 0;
  for (int a = 0; a < PBF_CORNERS; ++a) {
    if ((a >> c->axis & 1) != below) continue;
    free_volume += free_volumes[node - (int64_t)c->corner[a]];
    weight += weights[node - (int64_t)c->corner[a]];
  }
  return weight > 0 ? free_volume / weight : 1;
}

/* What carries a part of the weight of so many cells, one above the other. */
PBF_FN double pbf_pressure_grid_weight(const pbf_pressure_grid *c, double part, double cells) {
  return -part * fabs(c->push[c->axis]) * cells;
}

/* The part of the weight of what stands above, in the run of nodes of a column that stands on the
 * domain's wall; 0 elsewhere. */
PBF_FN void pbf_pressure_grid_guess(const pbf_pressure_grid *c, double part, const double *inverse,
                                    const double *free_volumes, const double *weights,
                                    uint32_t column, double *lambda) {
  const pbf_pressure_grid_column at = pbf_pressure_grid_column_at(c, column);
  uint32_t top = 1 + (uint32_t)c->n[c->axis], stands = 0;
  lambda[at.outside] = 0;
  for (uint32_t i = 0; i < top; ++i) lambda[at.floor + i * at.up] = 0;
  if (pbf_pressure_grid_down(c) == 0) return;
  while (stands < top && inverse[at.floor + stands * at.up] > 0) ++stands;
  if (!stands) return;
  double above = pbf_pressure_grid_above(c, free_volumes, weights, at.floor + (stands - 1) * at.up);
  for (uint32_t i = 0; i < stands; ++i)
    lambda[at.floor + i * at.up] = pbf_pressure_grid_weight(c, part, stands - 1 - i + above);
}

#endif
