/* A pool for questions: a lattice, its lowest layer half a spacing above the floor, y = 0. */
#ifndef PBF_TESTS_QUERY_SCENE_H
#define PBF_TESTS_QUERY_SCENE_H

#include <pbf/query.h>

#include "support.h"

enum { POINTS = 200 };

static const double d = 0.05; /* the spacing */

enum { SIDE = 14, LAYERS = 12, MOST = SIDE * SIDE * LAYERS };

/* v = flow + slope x, by components. */
static const double flow[3] = {0.3, -0.2, 0.5};
static const double slope[3][3] = {{1, 0.5, -0.3}, {-0.7, 0.2, 0.9}, {0.4, -1.1, -0.6}};
static const double still[3][3] = {{0}};

static inline double linear(uint32_t k, const double *x, uint32_t dimension, const double s[3][3]) {
  double v = flow[k];
  for (uint32_t l = 0; l < dimension; ++l) v += s[k][l] * x[l];
  return v;
}

typedef struct pool {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
} pool;

static inline pool pool_of(uint32_t dimension, uint32_t precision, const double s[3][3],
                           uint32_t order) {
  const uint32_t across = dimension == 3 ? SIDE * SIDE : SIDE, count = across * LAYERS;
  const pbf_desc desc = test_desc(dimension, precision, MOST + 8);
  pbf_params params = test_params();
  params.domain_max[0] = params.domain_max[2] = SIDE * d;
  params.domain_max[1] = 1000;
  pool p = {test_create(&desc, &params), dimension, precision, count};
  double *x = calloc((size_t)count * dimension, sizeof *x),
         *v = calloc((size_t)count * dimension, sizeof *v);
  assert_true(x && v);
  for (uint32_t row = 0; row < count; ++row) {
    const uint32_t i = (uint32_t)((uint64_t)row * order % count); /* of another order of adding */
    const uint32_t at[3] = {i % SIDE, i / across, i / SIDE % SIDE};
    const double place[3] = {d * (at[0] + 0.5), d * (at[1] + 0.5), d * (at[2] + 0.5)};
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)row * dimension + k, precision, place[k]);
      test_put(v, (uint64_t)row * dimension + k, precision, linear(k, place, dimension, s));
    }
  }
  assert_ok(pbf_add_particles(p.solver, count, x, v, NULL));
  free(x);
  free(v);
  return p;
}

static const double level = LAYERS * d;

static inline double random_in(uint32_t *state, double lower, double upper) {
  *state = *state * 1664525u + 1013904223u;
  return lower + (upper - lower) * (*state >> 8) / (1 << 24);
}

static inline pbf_volume volume_of(uint32_t shape) {
  pbf_volume volume;
  assert_ok(pbf_volume_init(&volume, sizeof volume, shape));
  volume.position[0] = volume.position[2] = 0.5 * SIDE * d;
  volume.position[1] = level;
  return volume;
}

static inline pbf_volume_flow measure(const pool *p, const pbf_volume *volume) {
  pbf_volume_flow found = {.struct_size = sizeof found};
  assert_ok(pbf_measure_volumes(p->solver, 1, volume, &found));
  return found;
}

static inline void assert_near(double found, double right, double most, const char *what) {
  if (!(fabs(found - right) <= most)) fail_msg("%s is %.9g, not %.9g", what, found, right);
}

#endif
