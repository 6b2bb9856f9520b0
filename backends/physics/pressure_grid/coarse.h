/* Coarser levels of the pressure grid, by which its solve sees waves that are much longer than a
 * cell: a multigrid method, the iterations of which do not grow in number with the grid.
 *
 * A level's cells are twice as wide as those of the one before, and its nodes are every second one.
 * With P the multilinear interpolation to the finer level, its equations are those of the best
 * correction P e there, in energy: P' A P e = P' r, of the residual r. So a correction brings
 * lambda closer whatever cells solids and the surface cut. Nodes in the open have none, nor have
 * those where lambda is held at 0 when the levels are made, which the iterations of the grid itself
 * see to (truncated monotone multigrid: Kornhuber 1994, https://doi.org/10.1007/BF03325426).
 *
 * Corrections need few digits: levels are in float, in units of the largest right side. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_COARSE_H
#define PBF_PHYSICS_PRESSURE_GRID_COARSE_H

#include "physics/pressure_grid/solve.h"

enum {
  PBF_STENCIL = PBF_DIM == 3 ? 14 : 5, /* a node and half of its neighbours: the rest have it */
  PBF_AROUND = PBF_DIM == 3 ? 27 : 9,  /* a node and all of its neighbours */
  PBF_COARSE_ARRAYS = PBF_STENCIL + 4, /* of a level */
  PBF_COARSE_LEVELS = 12               /* at most */
};

/* Nodes have the index of a grid's: one row of them lies before the first. */
typedef struct pbf_coarse_level {
  int n[PBF_DIM];           /* cells */
  uint32_t stride[PBF_DIM]; /* between nodes */
  uint32_t nodes;           /* indices */
  uint32_t length;          /* with those behind the last node that its neighbours have */
  float *stencil;           /* PBF_STENCIL arrays: A between a node and those from itself on */
  float *inverse;           /* of the sum of all magnitudes in a row of A; 0: no equation */
  float *right;             /* side */
  float *now, *before;      /* the correction, and before the last iteration */
} pbf_coarse_level;

/* Along the axis that has most. */
PBF_FN int pbf_most_cells(const int n[PBF_DIM]) {
  int most = n[0];
  for (int k = 1; k < PBF_DIM; ++k)
    if (n[k] > most) most = n[k];
  return most;
}

/* ---- Places -------------------------------------------------------------------------------- */

static inline pbf_coarse_level pbf_coarse_level_of(const int n[PBF_DIM]) {
  pbf_coarse_level level;
  memset(&level, 0, sizeof level);
  level.nodes = 1;
  level.length = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    level.n[k] = (n[k] + 1) / 2;
    level.stride[k] = level.nodes;
    level.length += level.nodes;
    level.nodes *= (uint32_t)level.n[k] + 2;
  }
  level.length += level.nodes;
  return level;
}

/* Neighbour `k` of PBF_AROUND is so far from a node along an axis. */
PBF_FN int pbf_around_offset(int k, int axis) {
  return (axis == 0 ? k : axis == 1 ? k / 3 : k / 9) % 3 - 1;
}

/* Between the indices of neighbour k and of a node: as a level has less than 2^31. */
PBF_FN int pbf_coarse_offset(const pbf_coarse_level *l, int k) {
  int offset = 0;
  for (int axis = 0; axis < PBF_DIM; ++axis)
    offset += pbf_around_offset(k, axis) * (int)l->stride[axis];
  return offset;
}

/* Where along each axis an index is; whether it is a node. */
PBF_FN int pbf_coarse_place(const pbf_coarse_level *l, uint32_t index, int at[PBF_DIM]) {
  int inside = index < l->nodes;
  for (int k = 0; k < PBF_DIM; ++k) {
    at[k] = (int)(index % ((uint32_t)l->n[k] + 2));
    index /= (uint32_t)l->n[k] + 2;
    inside = inside && at[k] > 0;
  }
  return inside;
}

/* ---- Equations ----------------------------------------------------------------------------- */

/* A between a node of a level and its neighbour k. */
PBF_FN float pbf_coarse_between(const pbf_coarse_level *l, uint32_t node, int k) {
  const int half = PBF_AROUND / 2, away = k < half ? half - k : k - half;
  const float *of_those_away = l->stencil + (uint64_t)away * l->length;
  return of_those_away[k < half ? (int)node + pbf_coarse_offset(l, k) : (int)node];
}

/* A between a node and all around it. */
typedef struct pbf_coarse_row {
  float of[PBF_AROUND];
} pbf_coarse_row;

PBF_FN pbf_coarse_row pbf_row_of_level(const pbf_coarse_level *l, uint32_t node) {
  pbf_coarse_row row;
  PBF_UNROLLED
  for (int k = 0; k < PBF_AROUND; ++k) row.of[k] = pbf_coarse_between(l, node, k);
  return row;
}

/* Of the grid itself, between nodes that corrections move, which `moves` says. */
PBF_FN pbf_coarse_row pbf_row_of_grid(const pbf_pressure_grid *c, const double *free_volumes,
                                      const double *inverse, const uint8_t *moves, uint32_t node) {
  pbf_coarse_row row;
  double around[PBF_CORNERS];
  pbf_pressure_grid_around(c, free_volumes, node, around);
  PBF_UNROLLED
  for (int k = 0; k < PBF_AROUND; ++k) {
    double volume = 0;
    int apart = 0; /* as corners of a cell */
    int64_t other = node;
    for (int axis = 0; axis < PBF_DIM; ++axis) {
      const int offset = pbf_around_offset(k, axis);
      apart |= (offset != 0) << axis;
      other += offset * (int64_t)c->corner[1u << axis];
    }
    PBF_UNROLLED
    for (int a = 0; a < PBF_CORNERS; ++a) {
      int has_both = 1;
      for (int axis = 0; axis < PBF_DIM; ++axis) {
        const int offset = pbf_around_offset(k, axis);
        has_both = has_both && (offset == 0 || (a >> axis & 1) == (offset < 0));
      }
      if (has_both) volume += around[a];
    }
    row.of[k] = (float)(-PBF_PRESSURE_GRID_STIFFNESS * volume *
                        pbf_pressure_grid_between_corners(0, apart));
    if (k != PBF_AROUND / 2 && !moves[other]) row.of[k] = 0;
  }
  row.of[PBF_AROUND / 2] = (float)(1 / inverse[node]);
  return row;
}

/* ---- From level to level -------------------------------------------------------------------- */

/* What a coarse node counts at a finer one that is so many nodes away along an axis. */
PBF_FN float pbf_interpolation(int away) {
  return away == 0 ? 1.0f : away * away == 1 ? 0.5f : 0.0f;
}

/* The finer node `from` of PBF_AROUND that are around the coarse one, the I-th along each axis, of
 * a level with n cells. */
typedef struct pbf_finer_node {
  int at[PBF_DIM];
  float weight; /* of the coarse node there; 0: there is none between the walls */
} pbf_finer_node;

PBF_FN pbf_finer_node pbf_finer_node_of(const int I[PBF_DIM], int from, const int n[PBF_DIM]) {
  pbf_finer_node finer;
  finer.weight = 1;
  for (int axis = 0; axis < PBF_DIM; ++axis) {
    const int away = pbf_around_offset(from, axis), at = 2 * I[axis] - 1 + away;
    finer.at[axis] = at;
    finer.weight *= at >= 1 && at <= n[axis] + 1 ? pbf_interpolation(away) : 0;
  }
  return finer;
}

/* What a finer node, its row times P, adds to P' A P between the coarse node, the I-th, and those
 * around it: axis by axis. */
PBF_FN pbf_coarse_row pbf_galerkin_part(const int I[PBF_DIM], const pbf_finer_node *finer,
                                        const int n[PBF_DIM], pbf_coarse_row row) {
  PBF_UNROLLED
  for (int axis = PBF_DIM - 1, stride = PBF_AROUND / 3; axis >= 0; --axis, stride /= 3) {
    float weights[3][3]; /* of a coarse node around, at a finer one around */
    const int away = finer->at[axis] - (2 * I[axis] - 1);
    PBF_UNROLLED
    for (int q = 0; q < 9; ++q) {
      const int step = q / 3 - 1, K = q % 3 - 1, at = finer->at[axis] + step;
      weights[q / 3][q % 3] =
          at >= 1 && at <= n[axis] + 1 ? pbf_interpolation(away + step - 2 * K) : 0;
    }
    PBF_UNROLLED
    for (int k = 0; k < PBF_AROUND; ++k) {
      if (k / stride % 3) continue;
      const float low = row.of[k], middle = row.of[k + stride], high = row.of[k + 2 * stride];
      PBF_UNROLLED
      for (int K = 0; K < 3; ++K)
        row.of[k + K * stride] =
            low * weights[0][K] + middle * weights[1][K] + high * weights[2][K];
    }
  }
  PBF_UNROLLED
  for (int k = 0; k < PBF_AROUND; ++k) row.of[k] *= finer->weight;
  return row;
}

/* The sum over the finer nodes around a coarse one, the I-th, of what they have, index 0 nothing:
 * P'. */
template <class Value>
PBF_FN float pbf_restricted(const int I[PBF_DIM], const int n[PBF_DIM],
                            const uint32_t stride[PBF_DIM], Value value) {
  float sum = 0;
  PBF_UNROLLED
  for (int from = 0; from < PBF_AROUND; ++from) {
    const pbf_finer_node finer = pbf_finer_node_of(I, from, n);
    uint32_t node = 0;
    for (int axis = 0; axis < PBF_DIM; ++axis) node += (uint32_t)finer.at[axis] * stride[axis];
    /* Without a branch, so that all values are on their way at once. */
    sum += finer.weight * value(finer.weight > 0 ? node : 0);
  }
  return sum;
}

/* A coarse level's correction at a node, the i-th, of the finer one: P. */
PBF_FN float pbf_interpolated(const pbf_coarse_level *l, const int i[PBF_DIM],
                              const float *values) {
  float sum = 0;
  PBF_UNROLLED
  for (int corner = 0; corner < PBF_CORNERS; ++corner) {
    uint32_t node = 0;
    float weight = 1;
    for (int axis = 0; axis < PBF_DIM; ++axis) {
      const int upper = corner >> axis & 1, between = i[axis] % 2 == 0;
      node += (uint32_t)((i[axis] + 1) / 2 + (between ? upper : 0)) * l->stride[axis];
      weight *= between ? 0.5f : upper ? 0.0f : 1.0f;
    }
    sum += weight * values[node];
  }
  return sum;
}

/* ---- Iterations of a level ------------------------------------------------------------------ */

PBF_FN float pbf_coarse_inverse(const pbf_coarse_level *l, uint32_t node) {
  float sum = 0;
  PBF_UNROLLED
  for (int k = 0; k < PBF_AROUND; ++k) sum += fabsf(pbf_coarse_between(l, node, k));
  return sum > 0 ? 1 / sum : 0;
}

typedef struct pbf_coarse_equation {
  pbf_coarse_row row;
  float inverse, right;
} pbf_coarse_equation;

PBF_FN pbf_coarse_equation pbf_coarse_equation_of(const pbf_coarse_level *l, uint32_t node) {
  return (pbf_coarse_equation){pbf_row_of_level(l, node), l->inverse[node], l->right[node]};
}

/* The correction at a node after an iteration. */
PBF_FN float pbf_coarse_next(const pbf_coarse_level *l, const pbf_coarse_equation *e, float step,
                             float weight, const float *now, const float *before, uint32_t node) {
  float left = 0;
  PBF_UNROLLED
  for (int k = 0; k < PBF_AROUND; ++k)
    left += e->row.of[k] * now[(int)node + pbf_coarse_offset(l, k)];
  return weight * (now[node] + step * e->inverse * (e->right - left) - before[node]) + before[node];
}

/* How a level is smoothed: of waves that are shorter than four of its cells hardly any is left. The
 * sum of magnitudes in a row is no less than the largest eigenvalue. */
enum { PBF_SMOOTHINGS = 4 };

static inline pbf_pressure_grid_solve pbf_coarse_smoothing() {
  return pbf_pressure_grid_within(0.12, 1);
}

/* The coarsest one is solved, more or less, by so many iterations. */
enum { PBF_COARSEST_CELLS = 4, PBF_COARSEST_ITERATIONS = 12 };

static inline pbf_pressure_grid_solve pbf_coarsest_solve() {
  const double wave = 0.5 * PBF_PI / (PBF_COARSEST_CELLS + 2);
  return pbf_pressure_grid_within(0.25 * wave * wave, 1);
}

/* And the grid itself, before and after a correction. */
static inline pbf_pressure_grid_solve pbf_finest_smoothing() {
  return pbf_pressure_grid_within(0.35, PBF_PRESSURE_GRID_HIGHEST);
}

/* The weights of the first iterations, which take a division each to find. */
static inline void pbf_find_weights(pbf_pressure_grid_solve s, int iterations, double *weights) {
  for (int k = 0; k < iterations; ++k) {
    weights[k] = s.weight;
    pbf_pressure_grid_solve_go_on(&s, k);
  }
}

/* Each leaves a tenth of what is missing, or less; after three it is less than what iterations of
 * the grid alone leave. What is enough for these is so small for the sake of the longest wave,
 * which is corrected here: so many times as much will do. */
enum { PBF_MAX_CORRECTIONS = 3, PBF_CORRECTED_ENOUGH = 8 };

#endif
