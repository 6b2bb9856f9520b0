/* Part of step.h: deep water (physics/coarse.h): particle by particle, node by node. */
#ifndef PBF_REFERENCE_PRESSURE_GRID_H
#define PBF_REFERENCE_PRESSURE_GRID_H

#include "common/deep.h"

static inline void deep_add(pbf_deep *deep, pbf_vec x, pbf_real target, pbf_real density) {
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&deep->grid, x, at);
  deep->sums[cell] += pbf_coarse_entry(target, density);
  deep->places[cell] += pbf_coarse_place_entry(at);
}

static inline pbf_vec deep_move(const pbf_deep *deep, pbf_vec x) {
  double at[PBF_DIM];
  uint32_t cell = pbf_coarse_cell(&deep->grid, x, at);
  return pbf_coarse_move(&deep->grid, deep->lambda, deep->parts, cell, at);
}

/* Returns the largest right side of a node that is not in the open. */
static inline double deep_equations(pbf_deep *deep,
                                    const pbf_pressure_grid_source_scale *source_scale) {
  double largest = 0;
  for (uint32_t node = 0; node < deep->grid.nodes; ++node) {
    double *right = &deep->right[node], *inverse = &deep->inverse[node];
    pbf_coarse_equation(&deep->grid, source_scale, deep->sums, deep->rooms, deep->weights,
                        deep->depths[node], node, right, inverse);
    if (*inverse > 0) largest = pbf_greater(largest, fabs(*right));
  }
  return largest;
}

/* One iteration; returns how far the one before has come. */
static inline double deep_iterate(pbf_deep *deep, const pbf_coarse_solve *solve) {
  double miss = 0;
  for (uint32_t node = 0; node < deep->grid.nodes; ++node) {
    double now = deep->lambda[node], *before = &deep->before[node];
    if (!(deep->inverse[node] > 0)) continue;
    double around[PBF_CORNERS];
    pbf_coarse_around(&deep->grid, deep->weights, node, around);
    double residual =
        pbf_coarse_residual(&deep->grid, around, deep->lambda, deep->right[node], node);
    miss = pbf_greater(miss, pbf_coarse_miss(residual, now));
    *before = pbf_coarse_next(solve, residual, deep->inverse[node], now, *before);
  }
  pbf_deep_swap(deep);
  return miss;
}

/* Once all have added. */
static inline void deep_solve(pbf_deep *deep, const pbf_obstacles *o) {
  pbf_deep_box all;
  for (int k = 0; k < PBF_DIM; ++k) {
    all.first[k] = 0;
    all.last[k] = deep->grid.n[k] + 1;
  }
  pbf_pressure_grid_source_scale source_scale = pbf_grid_pressure_source_scale(deep, o, &all);
  pbf_deep_cut(deep, &all);
  pbf_coarse_solve solve =
      pbf_coarse_begin(source_scale.longest, deep_equations(deep, &source_scale));
  pbf_deep_guess(deep, &source_scale);
  for (int k = 0; k < solve.most; ++k) {
    double miss = deep_iterate(deep, &solve);
    if (pbf_coarse_asks(k) && miss <= solve.enough) break;
    pbf_coarse_go_on(&solve, k);
  }
}

#endif
