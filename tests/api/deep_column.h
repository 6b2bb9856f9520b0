/* Columns of deep water, for the tests of the pressure grid. */
#ifndef PBF_TESTS_API_DEEP_COLUMN_H
#define PBF_TESTS_API_DEEP_COLUMN_H

#include <math.h>

#include "support.h"

enum { LAYERS = 60, COLUMNS = 6, MOST = LAYERS * COLUMNS * 3 };

static const double spacing = 0.05, gravity = 9.81;

static inline pbf_params column_params(double grid) {
  pbf_params params = test_params();
  params.iterations = 4;
  params.pressure_grid = grid;
  params.domain_max[0] = spacing * COLUMNS;
  params.domain_max[1] = spacing * (LAYERS + 12);
  params.domain_max[2] = spacing * 3;
  return params;
}

/* Fluid on its lattice above a point, squeezed towards the floor. */
static inline pbf_solver *block(const pbf_desc *desc, const pbf_params *params, uint32_t columns,
                                uint32_t layers, double left, double low, double squeeze) {
  uint32_t thick = desc->dimension == 3 ? 3 : 1, count = columns * layers * thick;
  pbf_solver *s = test_create(desc, params);
  void *x = calloc((size_t)count * desc->dimension, desc->precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % columns, i / columns % layers, i / columns / layers};
    const double from[3] = {left, low, 0};
    for (uint32_t k = 0; k < desc->dimension; ++k)
      test_put(x, (uint64_t)i * desc->dimension + k, desc->precision,
               from[k] + (k == 1 ? squeeze : 1) * spacing * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

static inline pbf_solver *column(uint32_t dimension, uint32_t precision, double grid,
                                 double squeeze) {
  pbf_desc desc = test_desc(dimension, precision, MOST);
  pbf_params params = column_params(grid);
  return block(&desc, &params, COLUMNS, LAYERS, 0, 0, squeeze);
}

static inline pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

/* The column's room as the inside of a box in a domain a hundred times as wide. */
static inline pbf_collider bottle(const pbf_params *column, pbf_params *params) {
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  box.inverted = 1;
  *params = *column;
  for (int k = 0; k < 3; ++k) {
    box.position[k] = box.half_extents[k] = 0.5 * column->domain_max[k];
    params->domain_min[k] = -50 * spacing * COLUMNS;
    params->domain_max[k] = 50 * spacing * COLUMNS;
  }
  return box;
}

/* Of the mean height, at first half the column's. */
static inline double lost_height(pbf_solver *s) {
  return 1 - stats_of(s).center_of_mass[1] / (0.5 * spacing * LAYERS);
}

#endif
