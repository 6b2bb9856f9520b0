/* The pressure grid's equations, of which each node has one, and their solve: coarse.h says what
 * they are. */
#ifndef PBF_PHYSICS_COARSE_NODES_H
#define PBF_PHYSICS_COARSE_NODES_H

#include "physics/coarse.h"

/* ---- Nodes --------------------------------------------------------------------------------- */

/* The integral of grad N_a · grad N_b over a unit cell, an element's stiffness, is OWN in these
 * units for a = b; for corners that differ in one axis 0 in three dimensions and -1 in two, in more
 * axes -1 and -2. */
#define PBF_COARSE_UNIT (PBF_DIM == 3 ? 1.0 / 12 : 1.0 / 6)
#define PBF_COARSE_OWN 4

/* What a node's cells have and do. */
typedef struct pbf_coarse_total {
  double filled, room, sum;
} pbf_coarse_total;

/* The cell of which the node, the i-th along each axis, is corner `a`. A crowd counts as an error
 * of its cell's whole room: it is for the iterations. */
PBF_FN void pbf_coarse_add_cell(const pbf_coarse *c, const pbf_coarse_dose *dose,
                                const int64_t *sums, const double *rooms, int64_t node,
                                const int i[PBF_DIM], int a, pbf_coarse_total *all) {
  int64_t cell = node - (int64_t)c->corner[a];
  double divergence = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    int right_of = a >> k & 1;
    divergence += (right_of ? 1 : -1) * (c->push[k] + c->pull[k] * (i[k] - right_of));
  }
  all->filled += pbf_coarse_fill(c, sums[cell]);
  all->room += rooms[cell];
  all->sum += dose->share / PBF_CORNERS * pbf_lesser(pbf_coarse_error(c, sums[cell]), rooms[cell]) +
              rooms[cell] * divergence / (PBF_CORNERS / 2);
}

/* The system's right side and the inverse of its diagonal: 0 for a node in the open or with next to
 * no room, and where nothing is to be done. One cell by one, here and below, so that the compiler
 * can do several nodes at once. */
PBF_FN void pbf_coarse_equation_at(const pbf_coarse *c, const pbf_coarse_dose *dose,
                                   const int64_t *sums, const double *rooms, int64_t node,
                                   const int i[PBF_DIM], double *right, double *inverse) {
  pbf_coarse_total all = {0, 0, 0};
  pbf_coarse_add_cell(c, dose, sums, rooms, node, i, 0, &all);
  pbf_coarse_add_cell(c, dose, sums, rooms, node, i, 1, &all);
  pbf_coarse_add_cell(c, dose, sums, rooms, node, i, 2, &all);
  pbf_coarse_add_cell(c, dose, sums, rooms, node, i, 3, &all);
  if (PBF_DIM == 3) {
    pbf_coarse_add_cell(c, dose, sums, rooms, node, i, PBF_CORNERS - 4, &all);
    pbf_coarse_add_cell(c, dose, sums, rooms, node, i, PBF_CORNERS - 3, &all);
    pbf_coarse_add_cell(c, dose, sums, rooms, node, i, PBF_CORNERS - 2, &all);
    pbf_coarse_add_cell(c, dose, sums, rooms, node, i, PBF_CORNERS - 1, &all);
  }
  double room = pbf_greater(all.room, 0.1);
  double part = (all.filled / room - PBF_COARSE_OPEN) / (PBF_COARSE_FULL - PBF_COARSE_OPEN);
  double of_room = pbf_lesser(pbf_greater(part, 0), 1) / (PBF_COARSE_UNIT * PBF_COARSE_OWN * room);
  int has = all.room >= 0.1 && dose->part > 0;
  *right = has ? -dose->part * all.sum : 0;
  *inverse = has ? of_room : 0;
}

/* That of any node; 0 for those outside. */
PBF_FN void pbf_coarse_equation(const pbf_coarse *c, const pbf_coarse_dose *dose,
                                const int64_t *sums, const double *rooms, uint32_t node,
                                double *right, double *inverse) {
  int i[PBF_DIM];
  *right = *inverse = 0;
  pbf_coarse_place(c, node, i);
  for (int k = 0; k < PBF_DIM; ++k)
    if (i[k] == 0) return;
  pbf_coarse_equation_at(c, dose, sums, rooms, node, i, right, inverse);
}

/* The room of the cells around a node: of the one of which it is corner a. */
PBF_FN void pbf_coarse_around(const pbf_coarse *c, const double *rooms, uint32_t node,
                              double around[PBF_CORNERS]) {
  for (int a = 0; a < PBF_CORNERS; ++a) around[a] = rooms[(int64_t)node - (int64_t)c->corner[a]];
}

/* The part of a node's left side from the cell of which it is corner `a`. */
PBF_FN double pbf_coarse_part(const pbf_coarse *c, const double around[PBF_CORNERS],
                              const double *lambda, uint32_t node, int a) {
  int64_t x = 1 - 2 * (a & 1), y = (1 - 2 * (a >> 1 & 1)) * (int64_t)c->corner[2];
  const double *at = lambda + node;
  double others = at[x] + at[y] + 2 * at[x + y];
  if (PBF_DIM == 3) {
    int64_t z = (1 - 2 * (a >> 2)) * (int64_t)c->corner[PBF_CORNERS / 2];
    others = at[x + y] + at[x + z] + (at[y + z] + at[x + y + z]);
  }
  return around[a] * (PBF_COARSE_OWN * at[0] - others);
}

/* What is missing on the left side. */
PBF_FN double pbf_coarse_residual(const pbf_coarse *c, const double around[PBF_CORNERS],
                                  const double *lambda, double right, uint32_t node) {
  double left =
      pbf_coarse_part(c, around, lambda, node, 0) + pbf_coarse_part(c, around, lambda, node, 1) +
      (pbf_coarse_part(c, around, lambda, node, 2) + pbf_coarse_part(c, around, lambda, node, 3));
  if (PBF_DIM == 3)
    left += pbf_coarse_part(c, around, lambda, node, PBF_CORNERS - 4) +
            pbf_coarse_part(c, around, lambda, node, PBF_CORNERS - 3) +
            (pbf_coarse_part(c, around, lambda, node, PBF_CORNERS - 2) +
             pbf_coarse_part(c, around, lambda, node, PBF_CORNERS - 1));
  return right - PBF_COARSE_UNIT * left;
}

/* ---- The solve: Chebyshev's semi-iteration, as in the iterations over particles -------------- */

/* No element's largest eigenvalue is above 1.5 times its diagonal, so no grid's is; the smallest is
 * that of a wave four times as long as the water, of so many nodes. */
#define PBF_COARSE_HIGHEST 1.5

typedef struct pbf_coarse_solve {
  double ratio2, step; /* of the interval */
  int most;            /* iterations */
  double enough;       /* what may be missing at a node */
  double weight;       /* of the iteration */
} pbf_coarse_solve;

/* `largest` is the largest right side; 0: there is nothing to do. So many iterations leave 4 % of
 * the longest wave, which fluid in motion takes all of them for. */
PBF_FN pbf_coarse_solve pbf_coarse_begin(int longest, double largest) {
  pbf_coarse_solve s;
  double wave = 0.5 * PBF_PI / (longest + 1), low = 0.375 * wave * wave;
  double ratio = (PBF_COARSE_HIGHEST - low) / (PBF_COARSE_HIGHEST + low);
  s.ratio2 = ratio * ratio;
  s.step = 2 / (PBF_COARSE_HIGHEST + low);
  s.most = largest > 0 ? 8 + 2 * longest : 0;
  s.enough = 0.05 / longest * largest;
  s.weight = 1;
  return s;
}

/* Once iteration k is over. */
PBF_FN void pbf_coarse_go_on(pbf_coarse_solve *s, int k) {
  s->weight = k == 0 ? 2 / (2 - s->ratio2) : 4 / (4 - s->ratio2 * s->weight);
}

/* lambda of a node that is not in the open, after an iteration. */
PBF_FN double pbf_coarse_next(const pbf_coarse_solve *s, double residual, double inverse,
                              double now, double before) {
  return pbf_lesser(s->weight * (now + s->step * residual * inverse - before) + before, 0);
}

/* Whether an iteration looks if it may be the last. */
PBF_FN int pbf_coarse_asks(int k) { return k % 4 == 3; }

/* How far its equation is from holding, where lambda may go on. */
PBF_FN double pbf_coarse_miss(double residual, double lambda) {
  return lambda < 0 || residual < 0 ? fabs(residual) : 0;
}

/* ---- Where it starts ----------------------------------------------------------------------- */

/* The axis along which the forces push most, and to which side: -1 or 1; 0: there are none. */
PBF_FN int pbf_coarse_down(const pbf_coarse *c, int *axis) {
  *axis = 0;
  for (int k = 1; k < PBF_DIM; ++k)
    if (fabs(c->push[k]) > fabs(c->push[*axis])) *axis = k;
  return c->push[*axis] < 0 ? -1 : c->push[*axis] > 0;
}

PBF_FN uint32_t pbf_coarse_columns(const pbf_coarse *c, int axis) {
  return c->nodes / c->size[axis];
}

/* What carries a part of the weight of so many nodes, one above the other. */
PBF_FN double pbf_coarse_weight(const pbf_coarse *c, double part, int axis, uint32_t nodes) {
  return -part * fabs(c->push[axis]) * nodes;
}

/* The part of the weight of what stands above, in the run of nodes of a column along that axis that
 * stands on the domain's wall; 0 elsewhere. */
PBF_FN void pbf_coarse_guess(const pbf_coarse *c, double part, const double *inverse, int axis,
                             int down, uint32_t column, double *lambda) {
  uint32_t stride = c->corner[1u << axis], top = 1 + (uint32_t)c->n[axis];
  uint32_t first = column % stride + column / stride * stride * c->size[axis];
  uint32_t floor = down < 0 ? first + stride : first + top * stride;
  int64_t up = down < 0 ? (int64_t)stride : -(int64_t)stride;
  uint32_t stands = 0;
  for (uint32_t i = 0; i <= top; ++i) lambda[first + i * stride] = 0;
  while (down != 0 && stands < top && inverse[floor + stands * up] > 0) ++stands;
  for (uint32_t i = 0; i < stands; ++i)
    lambda[floor + i * up] = pbf_coarse_weight(c, part, axis, stands - i);
}

#endif
