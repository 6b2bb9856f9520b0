/* A block of two fluids, its places told apart by a function. */
#ifndef PBF_TESTS_PHASE_SCENE_H
#define PBF_TESTS_PHASE_SCENE_H

#include "support.h"

#include <math.h>

#include <pbf/phases.h>

static const double spacing = 0.05, gravity = 9.81;

typedef struct fluid {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
  uint32_t size[3]; /* particles along each axis */
  double density[2];
  uint32_t *phase;
  double *x, *v; /* read back */
} fluid;

/* In place of the backend that is tested. */
static const char *other_backend;

/* Of a place in the block, 0 or 1. */
typedef uint32_t (*phase_of)(const fluid *f, const double x[3]);

static inline pbf_params params_of(const uint32_t size[3], double height) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = 1.0 / 120;
  params.gravity[0] = params.gravity[2] = 0;
  params.gravity[1] = -gravity;
  for (int k = 0; k < 3; ++k) {
    params.domain_min[k] = 0;
    params.domain_max[k] = spacing * size[k];
  }
  params.domain_max[1] = height;
  return params;
}

static inline void set_phases(pbf_solver *solver, double lower, double upper, double viscosity) {
  pbf_phase phases[2];
  for (int k = 0; k < 2; ++k) {
    assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
    phases[k].rest_density = k ? upper : lower;
    phases[k].viscosity = viscosity;
  }
  assert_ok(pbf_set_phases(solver, 2, phases));
}

/* The places of a lattice that fills the block from the origin, shaken by so many spacings. */
static inline fluid fluid_of(uint32_t dimension, uint32_t precision, const pbf_params *params,
                             const uint32_t size[3], double shaken, const double density[2],
                             phase_of which) {
  fluid f = {.dimension = dimension, .precision = precision, .density = {density[0], density[1]}};
  memcpy(f.size, size, sizeof f.size);
  f.count = size[0] * size[1] * (dimension == 3 ? size[2] : 1);
  pbf_desc desc = test_desc(dimension, precision, f.count + 8);
  if (other_backend) desc.backend = other_backend;
  f.solver = test_create(&desc, params);
  f.phase = calloc(f.count, sizeof *f.phase);
  f.x = calloc((size_t)f.count * dimension, sizeof *f.x);
  f.v = calloc((size_t)f.count * dimension, sizeof *f.v);
  char *values = calloc((size_t)f.count * dimension, precision);
  assert_true(f.phase && f.x && f.v && values);
  uint32_t random = 1;
  for (uint32_t i = 0; i < f.count; ++i) {
    const uint32_t at[3] = {i % size[0], i / size[0] % size[1], i / size[0] / size[1]};
    double x[3] = {0};
    for (uint32_t k = 0; k < dimension; ++k) x[k] = spacing * (at[k] + 0.5);
    f.phase[i] = which(&f, x);
    for (uint32_t k = 0; k < dimension; ++k) {
      random = 1664525 * random + 1013904223;
      x[k] += shaken * spacing * (random / 4294967296.0 - 0.5);
      test_put(values, (uint64_t)i * dimension + k, precision, x[k]);
    }
  }
  assert_ok(pbf_add_particles(f.solver, f.count, values, NULL, NULL));
  free(values);
  set_phases(f.solver, density[0], density[1], 1);
  assert_ok(pbf_set_particle_phases(f.solver, 0, f.count, f.phase));
  return f;
}

static inline void look(fluid *f) {
  test_read(f->solver, f->dimension, f->precision, f->count, f->x, f->v);
}

static inline void destroy(fluid *f) {
  pbf_destroy(f->solver);
  free(f->phase);
  free(f->x);
  free(f->v);
}

static inline uint32_t mixed(const fluid *f, const double x[3]) {
  (void)f;
  return sin(29 * x[0] + 13 * x[1] - 41 * x[2] + 7 * sin(50 * x[1])) > 0;
}

#endif
