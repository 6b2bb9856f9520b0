/* Small clouds of particles and brute-force sums over them. */
#ifndef PBF_TEST_PHYSICS_SUPPORT_H
#define PBF_TEST_PHYSICS_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

extern "C" {
#include <cmocka.h>
}

#include "physics/boundary.h"
#include "physics/passes/confinement.h"
#include "physics/passes/curl.h"
#include "physics/passes/density.h"
#include "physics/passes/lambda.h"
#include "physics/passes/move.h"
#include "physics/passes/predict.h"
#include "physics/passes/velocity.h"
#include "physics/passes/viscosity.h"

enum { CLOUD = 40 };

/* Walls and colliders, wherever they are. */
typedef struct test_obstacles {
  pbf_domain domain;
  int count;
  const pbf_surface *surfaces;
} test_obstacles;

static inline test_obstacles between(const pbf_domain &domain, int count = 0,
                                     const pbf_surface *surfaces = NULL) {
  return {domain, count, surfaces};
}

static inline void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.17g is not within %g of %.17g", value, tolerance, expected);
}

/* Uniform in [0, 1), the same in every run. */
static inline double next_random(uint32_t *state) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 8) * (1.0 / 16777216.0);
}

static inline void fill_cloud(pbf_vec *x, double side) {
  uint32_t state = 12345;
  for (int i = 0; i < CLOUD; ++i)
    for (int k = 0; k < PBF_DIM; ++k) x[i].c[k] = side * next_random(&state);
}

static inline pbf_params test_params(uint32_t kernel) {
  pbf_params p;
  memset(&p, 0, sizeof p);
  p.struct_size = sizeof p;
  p.kernel = kernel;
  p.smoothing_radius = 0.7;
  p.spacing = 0.31;
  p.time_step = 0.01;
  p.iterations = 1;
  p.scorr_k = 0.1;
  p.scorr_dq = 0.25;
  p.scorr_n = 4;
  p.over_relaxation = 1;
  p.cfm = 0.3;
  p.cohesion = 1;
  return p;
}

/* V times the kernel sum at particle i, itself included. */
static inline double brute_density(int features, const pbf_constants *c, const pbf_vec *x, int i) {
  double sum = c->value_scale;
  for (int j = 0; j < CLOUD; ++j) {
    pbf_vec d = pbf_sub(x[i], x[j]);
    if (j != i) sum += kernel_value<pbf_real>(features, c, pbf_dot(d, d));
  }
  return sum;
}

#endif
