/* The coarse grid's memory on a host, and its solve, by one thread. */
#ifndef PBF_COMMON_DEEP_H
#define PBF_COMMON_DEEP_H

#include "common/memory.h"
#include "physics/coarse.h"
#include "physics/constants.h"

typedef struct pbf_deep {
  pbf_coarse grid; /* of this step */
  int64_t *sums;   /* of cells, see pbf_coarse_entry; the first of all arrays */
  double *rooms;   /* of cells */
  double *right, *inverse, *lambda, *before; /* of nodes */
  uint32_t *inside;                          /* the nodes that are not in the open, … */
  uint32_t count;                            /* so many */
} pbf_deep;

/* Takes the memory or releases it. 0 when there is none. */
static inline int pbf_deep_keep(pbf_memory *memory, pbf_deep *deep, int wanted, uint32_t capacity) {
  enum { ARRAYS = 7 };
  uint64_t limit = pbf_coarse_limit(capacity);
  if (!wanted) {
    pbf_memory_free(memory, deep->sums);
    deep->sums = NULL;
    return 1;
  }
  if (deep->sums) return 1;
  deep->sums = pbf_memory_take(memory, "pressure grid", ARRAYS * limit, sizeof(double));
  if (!deep->sums) return 0;
  /* What lies behind the last node is read, and counts for nothing unless it is no number. */
  memset(deep->sums, 0, ARRAYS * limit * sizeof(double));
  double *next = (double *)deep->sums;
  double **const arrays[] = {&deep->rooms, &deep->right, &deep->inverse, &deep->lambda,
                             &deep->before};
  for (unsigned k = 0; k < sizeof arrays / sizeof arrays[0]; ++k) *arrays[k] = next += limit;
  deep->inside = (uint32_t *)(next + limit);
  return 1;
}

/* Before particles add to the sums. */
static inline void pbf_deep_begin(pbf_deep *deep, const pbf_params *params,
                                  const pbf_constants *constants, uint32_t capacity,
                                  const pbf_walls *walls) {
  deep->grid =
      pbf_coarse_between(params, constants->value_scale, walls, pbf_coarse_limit(capacity));
  memset(deep->sums, 0, deep->grid.nodes * sizeof *deep->sums);
}

/* One particle, from any thread. */
static inline void pbf_deep_add(pbf_deep *deep, pbf_vec x, pbf_real density) {
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&deep->grid, x, at);
  __atomic_fetch_add(&deep->sums[cell], pbf_coarse_entry(density), __ATOMIC_RELAXED);
}

/* The nodes that are not in the open, and the solve's bounds. */
static inline pbf_coarse_solve pbf_deep_equations(pbf_deep *deep) {
  const pbf_coarse *c = &deep->grid;
  int low[PBF_DIM], high[PBF_DIM], longest = 1;
  double largest = 0;
  deep->count = 0;
  for (int k = 0; k < PBF_DIM; ++k) low[k] = c->n[k] + 1, high[k] = 0;
  for (uint32_t node = 0; node < c->nodes; ++node) {
    int i[PBF_DIM];
    double *right = &deep->right[node], *inverse = &deep->inverse[node];
    pbf_coarse_equation(c, deep->sums, deep->rooms, node, right, inverse);
    if (!(*inverse > 0)) continue;
    pbf_coarse_place(c, node, i);
    for (int k = 0; k < PBF_DIM; ++k) {
      low[k] = low[k] < i[k] ? low[k] : i[k];
      high[k] = high[k] > i[k] ? high[k] : i[k];
      if (high[k] - low[k] >= longest) longest = high[k] - low[k] + 1;
    }
    largest = fmax(largest, fabs(*right));
    deep->inside[deep->count++] = node;
  }
  return pbf_coarse_begin(longest, largest);
}

static inline pbf_coarse_solve pbf_deep_prepare(pbf_deep *deep, const pbf_obstacles *o) {
  const pbf_coarse *c = &deep->grid;
  int axis, down = pbf_coarse_down(c, &axis);
  for (uint32_t cell = 0; cell < c->nodes; ++cell)
    deep->rooms[cell] = pbf_coarse_room(c, pbf_solid_count(o), o->solids, cell);
  pbf_coarse_solve solve = pbf_deep_equations(deep);
  for (uint32_t column = 0; column < pbf_coarse_columns(c, axis); ++column)
    pbf_coarse_guess(c, deep->inverse, axis, down, column, deep->lambda);
  memcpy(deep->before, deep->lambda, c->nodes * sizeof *deep->lambda);
  return solve;
}

/* One iteration; returns how far the one before has come. */
static inline double pbf_deep_iterate(pbf_deep *deep, const pbf_coarse_solve *solve) {
  double miss = 0, *now = deep->lambda;
  for (uint32_t k = 0; k < deep->count; ++k) {
    uint32_t node = deep->inside[k];
    double *before = &deep->before[node];
    double residual = pbf_coarse_residual(&deep->grid, deep->rooms, now, deep->right[node], node);
    miss = fmax(miss, pbf_coarse_miss(residual, now[node]));
    *before = pbf_coarse_next(solve, residual, deep->inverse[node], now[node], *before);
  }
  deep->lambda = deep->before;
  deep->before = now;
  return miss;
}

/* Once all have added. */
static inline void pbf_deep_solve(pbf_deep *deep, const pbf_obstacles *o) {
  pbf_coarse_solve solve = pbf_deep_prepare(deep, o);
  for (int k = 0; k < solve.most; ++k) {
    double miss = pbf_deep_iterate(deep, &solve);
    if (pbf_coarse_asks(k) && miss <= solve.enough) break;
    pbf_coarse_go_on(&solve, k);
  }
}

/* What the grid adds to a particle's move. */
static inline pbf_vec pbf_deep_move(const pbf_deep *deep, pbf_vec x) {
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&deep->grid, x, at);
  return pbf_coarse_move(&deep->grid, deep->lambda, cell, at);
}

/* The lambda over particles that has the grid's pressure at x. */
static inline pbf_real pbf_deep_lambda(const pbf_deep *deep, const pbf_constants *c,
                                       pbf_real inv_time_step, pbf_vec x) {
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&deep->grid, x, at);
  double lambda = pbf_coarse_lambda(&deep->grid, deep->lambda, cell, at);
  return (pbf_real)(lambda * (double)inv_time_step * (double)inv_time_step / (double)c->pressure);
}

#endif
