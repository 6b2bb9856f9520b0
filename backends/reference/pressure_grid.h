/* Part of solve.h: deep water (physics/pressure_grid/grid.h): particle by particle, node by node.
 */
#ifndef PBF_REFERENCE_PRESSURE_GRID_H
#define PBF_REFERENCE_PRESSURE_GRID_H

#include "common/pressure_grid.h"

static inline pbf_fluid_bounds bounds_of(const pbf_vec *x, uint32_t count) {
  pbf_fluid_bounds around;
  for (int k = 0; k < PBF_DIM; ++k) {
    around.lower.c[k] = (pbf_real)INFINITY;
    around.upper.c[k] = (pbf_real)-INFINITY;
    for (uint32_t i = 0; i < count; ++i) {
      around.lower.c[k] = pbf_real_min(around.lower.c[k], x[i].c[k]);
      around.upper.c[k] = pbf_real_max(around.upper.c[k], x[i].c[k]);
    }
  }
  return around;
}

static inline void pressure_grid_add(pbf_pressure_grid_storage *storage, pbf_vec x, pbf_real target,
                                     pbf_real density, pbf_real overlap) {
  double at[PBF_DIM];
  uint32_t cell = pbf_pressure_grid_find(storage, x, at);
  if (cell == PBF_NO_INDEX) return;
  storage->sums[cell] += pbf_pressure_grid_entry(target, density, overlap);
  storage->places[cell] += pbf_pressure_grid_place_entry(at);
}

static inline void pressure_grid_add_move(pbf_pressure_grid_storage *storage, pbf_vec x, pbf_vec v,
                                          pbf_vec acceleration) {
  double at[PBF_DIM];
  uint32_t cell = pbf_pressure_grid_find(storage, x, at);
  if (cell == PBF_NO_INDEX) return;
  for (uint64_t k = 0; k < PBF_DIM; ++k)
    storage->cell_moves[PBF_DIM * cell + k] +=
        pbf_cell_move_entry(&storage->grid, v.c[k], acceleration.c[k]);
}

static inline pbf_vec pressure_grid_move(const pbf_pressure_grid_storage *storage, pbf_vec x) {
  double at[PBF_DIM];
  uint32_t cell = pbf_pressure_grid_find(storage, x, at);
  if (cell == PBF_NO_INDEX) return (pbf_vec){{0}};
  return pbf_pressure_grid_correction(&storage->grid, &storage->topology, storage->lambda, cell,
                                      at);
}

/* Returns the largest right side of a node that is not in the open. */
static inline double pressure_grid_equations(pbf_pressure_grid_storage *storage,
                                             const pbf_pressure_grid_source_scale *source_scale) {
  double largest = pbf_pressure_grid_torn_equations(storage, source_scale);
  for (uint32_t node = 0; node < storage->grid.nodes; ++node) {
    double *right = &storage->right[node], *inverse = &storage->inverse[node];
    pbf_pressure_grid_equation(&storage->grid, &storage->topology, source_scale, storage->sums,
                               storage->places, storage->free_volumes, storage->depths, node, right,
                               inverse);
    if (storage->topology.is_active && storage->topology.torn[node]) *inverse = 0;
    if (*inverse > 0) *right += pbf_pressure_grid_moves_at(storage, source_scale, node);
    if (*inverse > 0) largest = pbf_max(largest, fabs(*right));
  }
  return largest;
}

/* One iteration; returns how far the one before has come. */
static inline double pressure_grid_iterate(pbf_pressure_grid_storage *storage,
                                           const pbf_pressure_grid_solve *solve) {
  double miss = 0;
  for (uint32_t torn = 0; torn < pbf_pressure_grid_torn_count(&storage->topology); ++torn)
    miss =
        pbf_max(miss, pbf_pressure_grid_relax_torn(&storage->grid, &storage->topology, solve,
                                                   storage->free_volumes, storage->lambda, torn));
  for (uint32_t node = 0; node < storage->grid.nodes; ++node) {
    double now = storage->lambda[node], *before = &storage->before[node];
    if (!(storage->inverse[node] > 0)) continue;
    double around[PBF_CORNERS];
    pbf_pressure_grid_around(&storage->grid, storage->free_volumes, node, around);
    const double surface = pbf_pressure_grid_surface_of(around, storage->inverse[node]);
    double residual = pbf_pressure_grid_residual(&storage->grid, around, storage->lambda,
                                                 storage->right[node], surface, node);
    miss = pbf_max(miss, pbf_pressure_grid_miss(residual, now));
    *before = pbf_pressure_grid_next(solve, residual, storage->inverse[node], now, *before);
  }
  pbf_pressure_grid_swap(storage);
  return miss;
}

/* Once all have added. */
static inline void pressure_grid_solve(pbf_pressure_grid_storage *storage, const pbf_obstacles *o) {
  pbf_pressure_grid_box all;
  for (int k = 0; k < PBF_DIM; ++k) {
    all.first[k] = 0;
    all.last[k] = storage->grid.n[k] + 1;
  }
  pbf_pressure_grid_source_scale source_scale =
      pbf_pressure_grid_find_free_volumes(storage, o, &all);
  pbf_pressure_grid_find_surface(storage, &all);
  pbf_pressure_grid_solve solve = pbf_pressure_grid_solve_begin(
      source_scale.longest, pressure_grid_equations(storage, &source_scale));
  pbf_pressure_grid_guess_all(storage, &source_scale);
  for (int k = 0; k < solve.max_iterations; ++k) {
    double miss = pressure_grid_iterate(storage, &solve);
    if (pbf_pressure_grid_asks(k) && miss <= solve.enough) break;
    pbf_pressure_grid_solve_go_on(&solve, k);
  }
  for (int k = 0; k < PBF_DIM; ++k) all.first[k] = 1;
  pbf_pressure_grid_extrapolate(storage, &all);
}

/* Once all have been moved. */
static inline void pressure_grid_find_datum(pbf_pressure_grid_storage *storage) {
  pbf_pressure_grid_box inside;
  for (int k = 0; k < PBF_DIM; ++k) {
    inside.first[k] = 1;
    inside.last[k] = storage->grid.n[k];
  }
  pbf_pressure_grid_find_datum(storage, &inside);
}

#endif
