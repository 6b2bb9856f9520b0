/* Deep water: what the weight of the fluid presses together is undone on a coarse grid, once a step
 * and before the iterations, which carry a pressure by about a layer each.
 *
 * The grid has a value lambda at each of its nodes and multilinear elements between them. With K
 * the stiffness of an element, N a node's function and w the moves that the forces alone make in
 * the step,
 *
 *   sum over the cells e at a node of  room_e (K lambda)_node
 *       = - sum over them of  room_e w_e · grad N_node + PBF_COARSE_SHARE error_e N_node
 *
 * and particles move by grad lambda. What the fluid brings along is left to the iterations: it is
 * free of divergence as far as these have made it so, and taking from it what a grid can't tell
 * from compression takes energy from every wave. Errors of density would stay; a share of them goes
 * along. It is the room of a cell that counts, the part that is free of walls and colliders, and
 * not what fills it: so nothing presses on fluid that falls, whose surface fills cells in part.
 *
 * lambda is 0 at nodes in the open and nowhere positive; beyond walls there is nothing to move,
 * which is what an element's edge does of itself. */
#ifndef PBF_PHYSICS_COARSE_H
#define PBF_PHYSICS_COARSE_H

#include "physics/collide.h"
#include "physics/derive.h"

#define PBF_COARSE_SHARE 0.1 /* of the density errors that a step undoes */

/* Nodes among cells that are filled to less than the first part are in the open, from the second on
 * they are not. */
#define PBF_COARSE_OPEN 0.6
#define PBF_COARSE_FULL 0.8

PBF_FN double pbf_lesser(double a, double b) { return a < b ? a : b; }
PBF_FN double pbf_greater(double a, double b) { return a > b ? a : b; }

enum { PBF_CORNERS = 1 << PBF_DIM };

/* In units of the cells' width: lambda of its square, moves of itself. A cell has the index of its
 * corner 0, and one row of cells and nodes lies before the walls on each side, so that no loop asks
 * where it ends. */
typedef struct pbf_coarse {
  double lower[PBF_DIM], width; /* of the first cells inside */
  double last[PBF_DIM];         /* part of the last ones that is before the upper walls */
  double unit;                  /* what a particle fills of a cell */
  double push[PBF_DIM];         /* move by the forces in cells 0 … */
  double pull[PBF_DIM];         /* … and its change from cell to cell along that axis */
  int n[PBF_DIM];               /* cells inside */
  uint32_t size[PBF_DIM];       /* indices along an axis */
  uint32_t corner[PBF_CORNERS]; /* index of a cell's corners from its own */
  uint32_t nodes;               /* and cells: indices */
} pbf_coarse;

/* Indices that there is room for, with those behind the last node that its cells' corners have. */
static inline uint64_t pbf_coarse_limit(uint32_t capacity) {
  return 4096 + (uint64_t)capacity / (PBF_DIM == 3 ? 8 : 2);
}

static inline int pbf_coarse_cells(const pbf_walls *walls, int axis, double width) {
  double length = (double)walls->upper.c[axis] - (double)walls->lower.c[axis];
  return (int)fmin(fmax(ceil(length / width - 1e-6), 1), 1e6);
}

/* Indices that a grid takes, with those behind its last node. */
static inline double pbf_coarse_taken(const pbf_walls *walls, double width) {
  double nodes = 1, rows = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    rows = nodes;
    nodes *= pbf_coarse_cells(walls, k, width) + 2;
  }
  return nodes + 2 * rows + 2;
}

/* The grid between walls, in a limited number of indices; `value_scale` is pbf_constants'. */
static inline pbf_coarse pbf_coarse_between(const pbf_params *params, pbf_real value_scale,
                                            const pbf_walls *walls, uint64_t limit) {
  pbf_coarse c;
  double dt2 = params->time_step * params->time_step;
  double width = params->pressure_grid * params->smoothing_radius;
  while (pbf_coarse_taken(walls, width) > (double)limit) width *= 1.1;
  c.width = width;
  c.unit = (double)value_scale / pbf_norm_value(params->kernel, PBF_DIM, params->smoothing_radius);
  c.nodes = 1;
  for (int a = 0; a < PBF_CORNERS; ++a) c.corner[a] = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    double length = (double)walls->upper.c[k] - (double)walls->lower.c[k];
    c.lower[k] = (double)walls->lower.c[k];
    c.n[k] = pbf_coarse_cells(walls, k, width);
    c.last[k] = fmin(1, length / width - (c.n[k] - 1));
    c.unit /= width;
    c.push[k] = dt2 / width *
                (params->gravity[k] -
                 params->attraction * (c.lower[k] - 0.5 * width - params->attraction_center[k]));
    c.pull[k] = -dt2 * params->attraction;
    for (int a = 0; a < PBF_CORNERS; ++a) c.corner[a] += (uint32_t)(a >> k & 1) * c.nodes;
    c.size[k] = (uint32_t)c.n[k] + 2;
    c.nodes *= c.size[k];
  }
  return c;
}

/* Where along each axis an index is; 0 and n + 1 are cells outside, 0 is a node outside. */
PBF_FN void pbf_coarse_place(const pbf_coarse *c, uint32_t index, int at[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    at[k] = (int)(index % c->size[k]);
    index /= c->size[k];
  }
}

/* ---- Particles ----------------------------------------------------------------------------- */

/* The cell that holds x, and where x is in it. */
PBF_FN uint32_t pbf_coarse_cell(const pbf_coarse *c, pbf_vec x, double at[PBF_DIM]) {
  uint32_t cell = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k) {
    double place = pbf_greater(((double)x.c[k] - c->lower[k]) / c->width, 0);
    int last = c->n[k] - 1, i = place < last ? (int)place : last;
    at[k] = pbf_lesser(place - i, 1);
    cell = cell * c->size[k] + (uint32_t)(i + 1);
  }
  return cell;
}

/* What a particle adds to its cell's sum: one to the count in the upper 24 bits, its density error
 * to what is below. The sum of integers is the same in any order. Room counts where it is a
 * ripple, not where fluid ends. */
PBF_FN int64_t pbf_coarse_entry(pbf_real density) {
  double error = pbf_lesser((double)density - 1, 1);
  if (error < 0) error *= pbf_greater(0, 1 + 10 * error);
  return ((int64_t)1 << 40) + (int64_t)(error * (1 << 20));
}

/* u at the place `at` in a cell. */
PBF_FN pbf_vec pbf_coarse_move(const pbf_coarse *c, const double *lambda, uint32_t cell,
                               const double at[PBF_DIM]) {
  pbf_vec u;
  for (int k = 0; k < PBF_DIM; ++k) {
    double sum = 0;
    for (int a = 0; a < PBF_CORNERS; ++a) {
      double slope = a >> k & 1 ? 1 : -1;
      for (int l = 0; l < PBF_DIM; ++l)
        if (l != k) slope *= a >> l & 1 ? at[l] : 1 - at[l];
      sum += slope * lambda[cell + c->corner[a]];
    }
    u.c[k] = (pbf_real)(c->width * sum);
  }
  return u;
}

/* lambda there. */
PBF_FN double pbf_coarse_lambda(const pbf_coarse *c, const double *lambda, uint32_t cell,
                                const double at[PBF_DIM]) {
  double sum = 0;
  for (int a = 0; a < PBF_CORNERS; ++a) {
    double value = lambda[cell + c->corner[a]];
    for (int k = 0; k < PBF_DIM; ++k) value *= a >> k & 1 ? at[k] : 1 - at[k];
    sum += value;
  }
  return c->width * c->width * sum;
}

/* ---- Cells --------------------------------------------------------------------------------- */

PBF_FN int64_t pbf_coarse_count(int64_t sum) { return (sum + ((int64_t)1 << 39)) >> 40; }

PBF_FN double pbf_coarse_fill(const pbf_coarse *c, int64_t sum) {
  return c->unit * (double)pbf_coarse_count(sum);
}

PBF_FN double pbf_coarse_error(const pbf_coarse *c, int64_t sum) {
  return c->unit * (double)(sum - pbf_coarse_count(sum) * ((int64_t)1 << 40)) / (1 << 20);
}

/* The part of a cell that is free of walls and colliders. */
PBF_FN double pbf_coarse_room(const pbf_coarse *c, int count, const pbf_solid *solids,
                              uint32_t cell) {
  double room = 1;
  int i[PBF_DIM];
  pbf_vec middle;
  pbf_coarse_place(c, cell, i);
  for (int k = 0; k < PBF_DIM; ++k) {
    if (i[k] == 0 || i[k] > c->n[k]) return 0;
    if (i[k] == c->n[k]) room *= c->last[k];
    middle.c[k] = (pbf_real)(c->lower[k] + (i[k] - 0.5) * c->width);
  }
  for (int s = 0; s < count; ++s) {
    pbf_vec normal;
    double distance = (double)pbf_solid_distance(&solids[s], middle, &normal);
    room *= pbf_lesser(pbf_greater(0.5 + distance / c->width, 0), 1);
  }
  return room;
}

/* ---- Nodes --------------------------------------------------------------------------------- */

/* Integral over a unit cell of grad N_a · grad N_b, for corners that differ along the axes of these
 * bits. */
PBF_FN double pbf_coarse_stiffness(int differs) {
  int axes = (differs & 1) + (differs >> 1 & 1) + (differs >> 2);
  if (PBF_DIM == 3) return axes == 0 ? 1.0 / 3 : axes == 1 ? 0 : -1.0 / 12;
  return axes == 0 ? 2.0 / 3 : axes == 1 ? -1.0 / 6 : -1.0 / 3;
}

/* The system's right side and the inverse of its diagonal: 0 for a node in the open, outside, or
 * with next to no room. A crowd counts as an error of its cell's whole room: it is for the
 * iterations. */
PBF_FN void pbf_coarse_equation(const pbf_coarse *c, const int64_t *sums, const double *rooms,
                                uint32_t node, double *right, double *inverse) {
  int i[PBF_DIM];
  double filled = 0, room = 0, sum = 0;
  *right = *inverse = 0;
  pbf_coarse_place(c, node, i);
  for (int k = 0; k < PBF_DIM; ++k)
    if (i[k] == 0) return;
  for (int a = 0; a < PBF_CORNERS; ++a) {
    uint32_t cell = node - c->corner[a];
    double divergence = 0;
    filled += pbf_coarse_fill(c, sums[cell]);
    room += rooms[cell];
    for (int k = 0; k < PBF_DIM; ++k) {
      int right_of = a >> k & 1;
      divergence += (right_of ? 1 : -1) * (c->push[k] + c->pull[k] * (i[k] - right_of));
    }
    sum +=
        PBF_COARSE_SHARE / PBF_CORNERS * pbf_lesser(pbf_coarse_error(c, sums[cell]), rooms[cell]) +
        rooms[cell] * divergence / (PBF_CORNERS / 2);
  }
  if (room < 0.1) return;
  double part = (filled / room - PBF_COARSE_OPEN) / (PBF_COARSE_FULL - PBF_COARSE_OPEN);
  *right = -sum;
  if (part > 0) *inverse = pbf_lesser(part, 1) / (pbf_coarse_stiffness(0) * room);
}

/* The part of a node's left side from the cell of which it is corner `a`. */
PBF_FN double pbf_coarse_part(const pbf_coarse *c, const double *rooms, const double *lambda,
                              uint32_t node, int a) {
  double sum = 0;
  for (int b = 0; b < PBF_CORNERS; ++b) {
    int64_t away = (b & 1) - (a & 1);
    for (int k = 1; k < PBF_DIM; ++k)
      away += ((b >> k & 1) - (a >> k & 1)) * (int64_t)c->corner[1u << k];
    if (pbf_coarse_stiffness(a ^ b) != 0)
      sum += pbf_coarse_stiffness(a ^ b) * lambda[(int64_t)node + away];
  }
  return rooms[node - c->corner[a]] * sum;
}

/* What is missing on the left side; one by one, so that every stiffness is a constant. */
PBF_FN double pbf_coarse_residual(const pbf_coarse *c, const double *rooms, const double *lambda,
                                  double right, uint32_t node) {
  right -= pbf_coarse_part(c, rooms, lambda, node, 0) + pbf_coarse_part(c, rooms, lambda, node, 1);
  right -= pbf_coarse_part(c, rooms, lambda, node, 2) + pbf_coarse_part(c, rooms, lambda, node, 3);
  if (PBF_DIM == 2) return right;
  right -= pbf_coarse_part(c, rooms, lambda, node, 4) + pbf_coarse_part(c, rooms, lambda, node, 5);
  return right -
         (pbf_coarse_part(c, rooms, lambda, node, 6) + pbf_coarse_part(c, rooms, lambda, node, 7));
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

/* `largest` is the largest right side. */
PBF_FN pbf_coarse_solve pbf_coarse_begin(int longest, double largest) {
  pbf_coarse_solve s;
  double wave = 0.5 * PBF_PI / (longest + 1), low = 0.375 * wave * wave;
  double ratio = (PBF_COARSE_HIGHEST - low) / (PBF_COARSE_HIGHEST + low);
  s.ratio2 = ratio * ratio;
  s.step = 2 / (PBF_COARSE_HIGHEST + low);
  s.most = 8 + 4 * longest;
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

/* The weight of what stands above, in the run of nodes of a column along that axis that stands on
 * the domain's wall; 0 elsewhere. */
PBF_FN void pbf_coarse_guess(const pbf_coarse *c, const double *inverse, int axis, int down,
                             uint32_t column, double *lambda) {
  uint32_t stride = c->corner[1u << axis], top = 1 + (uint32_t)c->n[axis];
  uint32_t first = column % stride + column / stride * stride * c->size[axis];
  uint32_t floor = down < 0 ? first + stride : first + top * stride;
  int64_t up = down < 0 ? (int64_t)stride : -(int64_t)stride;
  uint32_t stands = 0;
  for (uint32_t i = 0; i <= top; ++i) lambda[first + i * stride] = 0;
  while (down != 0 && stands < top && inverse[floor + stands * up] > 0) ++stands;
  for (uint32_t i = 0; i < stands; ++i)
    lambda[floor + i * up] = -fabs(c->push[axis]) * (stands - i);
}

#endif
