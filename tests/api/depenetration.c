/* What is found inside a collider, since that has been set there, leaves it at a bounded speed. */
#include "support.h"

#include <math.h>

static pbf_params params_of(double time_step, double speed) {
  pbf_params params = test_params();
  params.time_step = time_step;
  params.max_depenetration_speed = speed;
  params.wall_density = 0; /* of a lone particle that is all the density it has */
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = -2;
    params.domain_max[k] = 2;
  }
  return params;
}

/* A particle at rest `depth` under the surface of a collider is out of it after depth / speed, no
 * sooner, and never faster, however long a step is: x = depth - speed t. */
static void check_way_out(uint32_t dimension, uint32_t precision, uint32_t shape, uint32_t steps,
                          double speed) {
  const double depth = 0.2, size = 0.5, time = depth / speed;
  const pbf_desc desc = test_desc(dimension, precision, 1);
  const pbf_params params = params_of(time / steps, speed);
  pbf_solver *solver = test_create(&desc, &params);
  pbf_collider c;
  char x[3 * 8], v[3 * 8];
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  c.radius = c.half_extents[0] = c.half_extents[1] = c.half_extents[2] = size;
  c.position[0] = shape == PBF_COLLIDER_PLANE ? size : 0;
  c.axis[0] = shape == PBF_COLLIDER_PLANE ? 1 : 0;
  c.axis[1] = 1 - c.axis[0];
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, k == 0 ? size - depth : 0);
  assert_ok(pbf_add_particles(solver, 1, x, NULL, NULL));
  assert_ok(pbf_set_colliders(solver, 1, &c));
  for (uint32_t step = 1; step <= steps; ++step) {
    assert_ok(pbf_step(solver, 1));
    assert_ok(pbf_get_positions(solver, 0, 1, x));
    assert_ok(pbf_get_velocities(solver, 0, 1, v));
    const double out = test_value(x, 0, precision), fast = test_value(v, 0, precision);
    const double right = size - depth + depth * step / steps;
    if (!(fabs(out - right) < 1e-5 && fabs(fast - speed) < 1e-3 * speed))
      fail_msg("shape %u: after %u of %u steps it is at %g, not %g, with %g", shape, step, steps,
               out, right, fast);
  }
  pbf_destroy(solver);
}

static void check_ways_out(uint32_t dimension, uint32_t precision) {
  for (uint32_t shape = PBF_COLLIDER_PLANE; shape <= PBF_COLLIDER_BOX; ++shape)
    for (uint32_t steps = 5; steps <= 20; steps *= 4) {
      check_way_out(dimension, precision, shape, steps, 0.5);
      check_way_out(dimension, precision, shape, steps, 4);
    }
}

static void particles_leave_at_the_speed_that_is_told(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub collides with nothing");
  test_for_each_kind(check_ways_out);
}

/* A ball that is set into a tank at rest, and then grows: what fills its place is no faster than a
 * fall by the depth makes it, and shorter steps make nothing faster. */
static double fastest_around_ball(double time_step) {
  enum { WIDE = 12, LAYERS = 10, COUNT = WIDE * WIDE * LAYERS };
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  pbf_params params = test_params();
  params.time_step = time_step;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = k == 1 ? 2 : 0.05 * WIDE;
  pbf_solver *solver = test_create(&desc, &params);
  float *x = calloc(3 * COUNT, sizeof *x);
  for (int i = 0; i < COUNT; ++i) {
    const int at[3] = {i % WIDE, i / WIDE % LAYERS, i / WIDE / LAYERS};
    for (int k = 0; k < 3; ++k) x[3 * i + k] = 0.05f * ((float)at[k] + 0.5f);
  }
  assert_ok(pbf_add_particles(solver, COUNT, x, NULL, NULL));
  free(x);
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[0] = ball.position[2] = 0.3;
  ball.position[1] = 0.25;
  double fastest = 0;
  assert_ok(pbf_step(solver, (uint32_t)(0.25 / time_step)));
  for (int grown = 0; grown < 2; ++grown) {
    ball.radius = grown ? 0.18 : 0.12;
    assert_ok(pbf_set_colliders(solver, 1, &ball));
    for (int step = 0; step < 0.1 / time_step; ++step) {
      pbf_stats stats = {.struct_size = sizeof stats};
      assert_ok(pbf_step(solver, 1));
      assert_ok(pbf_get_stats(solver, &stats));
      fastest = fmax(fastest, stats.speed_max);
    }
  }
  pbf_destroy(solver);
  return fastest;
}

static void what_a_ball_finds_is_not_thrown(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub collides with nothing");
  const double bound = sqrt(2 * 9.81 * 0.5);
  const double at_step = fastest_around_ball(1.0 / 120),
               at_quarter = fastest_around_ball(1.0 / 480);
  if (!(at_step < bound && at_quarter < bound))
    fail_msg("%g m/s, in steps of a quarter %g; a fall has %g", at_step, at_quarter, bound);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_leave_at_the_speed_that_is_told),
      cmocka_unit_test(what_a_ball_finds_is_not_thrown),
  };
  return TEST_RUN(tests);
}
