/* A deep tank that leans: what pushes all of its fluid aside as a gravity of `tilt` along the first
 * axis would, leaves its surface with that slope. */
#ifndef PBF_TESTS_LEANING_TANK_H
#define PBF_TESTS_LEANING_TANK_H

#include "support.h"

#include <math.h>

enum { WIDE = 40, DEEP = 24 };
static const double d = 0.05, pull = 9.81, tilt = 0.12;

static inline pbf_params leaning_params(uint32_t dimension) {
  const double size[3] = {WIDE * d, 2 * DEEP * d, 4 * d};
  pbf_params params;
  assert_ok(pbf_params_init(&params, sizeof params));
  params.spacing = d;
  params.smoothing_radius = 2 * d;
  params.time_step = 1.0 / 60;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = k < dimension ? size[k] : 1;
  return params;
}

/* Filled level, moving at `speed` along the first axis. */
static inline pbf_solver *leaning_tank(const char *backend, uint32_t dimension, uint32_t precision,
                                       const pbf_params *params, double speed) {
  const uint32_t count = WIDE * DEEP * (dimension == 3 ? 4 : 1);
  pbf_desc desc = test_desc(dimension, precision, count);
  if (backend) desc.backend = backend;
  pbf_solver *solver = test_create(&desc, params);
  char x[3 * sizeof(double)], v[3 * sizeof(double)];
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % WIDE, i / WIDE % DEEP, i / WIDE / DEEP};
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, k, precision, d * (at[k] + 0.5));
      test_put(v, k, precision, k == 0 ? speed : 0);
    }
    assert_ok(pbf_add_particles(solver, 1, x, v, NULL));
  }
  return solver;
}

/* The mean over two seconds, ten later, of where the centre of mass is, beside what it is in a tank
 * with that slope: off the middle of a tank that moves at `speed`, and above its floor. */
static inline void check_leaning(pbf_solver *solver, uint32_t dimension, double speed) {
  enum { LOOKS = 20, EACH = 6 };
  const double width = WIDE * d, depth = DEEP * d, right = tilt * width * width / (12 * depth);
  const double height = depth / 2 + tilt * right / 2;
  double centre[2] = {0, 0};
  assert_ok(pbf_step(solver, 600));
  for (int look = 1; look <= LOOKS; ++look) {
    pbf_stats stats = {.struct_size = sizeof stats};
    assert_ok(pbf_step(solver, EACH));
    assert_ok(pbf_get_stats(solver, &stats));
    const double middle = WIDE * d / 2 + speed * (600 + look * EACH) / 60.0;
    centre[0] += (stats.center_of_mass[0] - middle) / LOOKS;
    centre[1] += stats.center_of_mass[1] / LOOKS;
  }
  if (!(fabs(centre[0] / right - 1) < 0.04))
    fail_msg("%uD, tank at %g: %g of the right slope", dimension, speed, centre[0] / right);
  if (!(fabs(centre[1] / height - 1) < 0.005))
    fail_msg("%uD, tank at %g: %g of the right height", dimension, speed, centre[1] / height);
}

/* A wall that stands in its middle and parts it. */
static inline pbf_collider wall_in_the_middle(void) {
  pbf_collider wall;
  assert_ok(pbf_collider_init(&wall, sizeof wall, PBF_COLLIDER_BOX));
  wall.position[0] = WIDE / 2 * d;
  wall.half_extents[0] = 0.1 * d;
  wall.half_extents[1] = 3 * DEEP * d;
  return wall;
}

/* Particles of a tank in 2D and float32, whole and parted by that wall, are where those of the
 * reference are. */
static inline void check_as_reference(pbf_solver *(*tank)(const char *backend, int parts)) {
  static float x[WIDE * DEEP][2], y[WIDE * DEEP][2];
  if (!test_has_reference(2, PBF_FLOAT32)) test_skip("there is no reference to ask");
  for (int parts = 0; parts < 2; ++parts) {
    pbf_solver *solver = tank(NULL, parts), *reference = tank("reference", parts);
    assert_ok(pbf_get_positions(solver, 0, WIDE * DEEP, x));
    assert_ok(pbf_get_positions(reference, 0, WIDE * DEEP, y));
    for (int i = 0; i < WIDE * DEEP; ++i)
      for (int k = 0; k < 2; ++k)
        if (!(fabsf(x[i][k] - y[i][k]) < 1e-4f))
          fail_msg("particle %d is %g off the reference", i, fabs((double)(x[i][k] - y[i][k])));
    pbf_destroy(solver);
    pbf_destroy(reference);
  }
}

#endif
