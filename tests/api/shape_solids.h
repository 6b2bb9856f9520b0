/* Solids in closed form, and shapes that have their distances. */
#ifndef PBF_TESTS_SHAPE_SOLIDS_H
#define PBF_TESTS_SHAPE_SOLIDS_H

#include <math.h>
#include <string.h>

#include <pbf/shapes.h>

#include "meshes.h"
#include "support.h"

static const double d = 0.05;

/* ---- Solids in closed form ------------------------------------------------------------------ */

typedef double (*solid)(const double p[3], uint32_t dimension);

static inline double length_of(const double *v, uint32_t dimension) {
  double sum = 0;
  for (uint32_t k = 0; k < dimension; ++k) sum += v[k] * v[k];
  return sqrt(sum);
}

static const double ball_radius = 0.2;

static inline double ball(const double p[3], uint32_t dimension) {
  return length_of(p, dimension) - ball_radius;
}

static inline double box_of(const double p[3], uint32_t dimension, const double half[3]) {
  double inside = -INFINITY, out[3] = {0, 0, 0};
  for (uint32_t k = 0; k < dimension; ++k) {
    const double beyond = fabs(p[k]) - half[k];
    inside = fmax(inside, beyond);
    out[k] = fmax(beyond, 0);
  }
  return inside > 0 ? length_of(out, dimension) : inside;
}

static const double box_half[3] = {0.2, 0.3, 0.2};

static inline double box(const double p[3], uint32_t dimension) {
  return box_of(p, dimension, box_half);
}

/* A cup, open at the top: its room is `cup_radius` wide to each side and begins at y = 0. */
static const double cup_radius = 0.25, cup_height = 0.6, cup_wall = 0.08;

static inline double cup_room(const double p[3], uint32_t dimension) {
  const double across = dimension == 3 ? hypot(p[0], p[2]) : fabs(p[0]);
  return fmax(across - cup_radius, -p[1]);
}

/* ---- Their shapes --------------------------------------------------------------------------- */

/* Nodes around -reach … reach, no node at a place that the solid is symmetric about. */
static inline pbf_grid_desc grid_of(uint32_t dimension, solid of, const double reach[3],
                                    double cell) {
  pbf_grid_desc grid = {.struct_size = sizeof grid, .dimension = dimension, .cell = cell};
  size_t nodes = 1;
  for (uint32_t k = 0; k < dimension; ++k) {
    grid.origin[k] = -reach[k] - 3.3 * cell - 0.01 * cell * k;
    grid.nodes[k] = (uint32_t)(2 * reach[k] / cell) + 8;
    nodes *= grid.nodes[k];
  }
  if (dimension == 2) grid.nodes[2] = 1;
  float *values = malloc(nodes * sizeof *values);
  assert_non_null(values);
  for (size_t n = 0; n < nodes; ++n) {
    const size_t at[3] = {n % grid.nodes[0], n / grid.nodes[0] % grid.nodes[1],
                          n / grid.nodes[0] / grid.nodes[1]};
    double p[3];
    for (int k = 0; k < 3; ++k) p[k] = grid.origin[k] + cell * (double)at[k];
    values[n] = (float)of(p, dimension);
  }
  grid.values = values;
  return grid;
}

static inline pbf_shape *shape_of(uint32_t dimension, solid of, const double reach[3],
                                  double cell) {
  const pbf_grid_desc grid = grid_of(dimension, of, reach, cell);
  pbf_shape *shape = NULL;
  assert_ok(pbf_shape_from_grid(&grid, &shape));
  assert_non_null(shape);
  free((void *)grid.values);
  return shape;
}

static inline pbf_shape *small_ball(uint32_t dimension) {
  const double reach[3] = {ball_radius, ball_radius, ball_radius};
  return shape_of(dimension, ball, reach, 0.25 * d);
}

static inline pbf_collider collider_of(pbf_shape *shape) {
  pbf_collider collider;
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_SHAPE));
  collider.geometry = shape;
  return collider;
}

static inline uint32_t references_to(pbf_shape *shape) {
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  return info.references;
}

static inline void skip_without_fluid(void) {
  if (test_is_stub()) test_skip("the stub has no fluid");
}

#endif
