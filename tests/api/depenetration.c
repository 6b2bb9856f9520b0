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

/* ---- In water ------------------------------------------------------------------------------- */

enum { WIDE = 12, LAYERS = 10 };

static const double spacing = 0.05;

static uint32_t count_of(uint32_t dimension) {
  return dimension == 3 ? WIDE * WIDE * LAYERS : WIDE * LAYERS;
}

/* At rest, after a quarter of a second. */
static pbf_solver *tank(uint32_t dimension, uint32_t precision, double time_step) {
  const uint32_t count = count_of(dimension);
  const pbf_desc desc = test_desc(dimension, precision, count);
  pbf_params params = test_params();
  params.time_step = time_step;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = k == 1 ? 2 : spacing * WIDE;
  pbf_solver *solver = test_create(&desc, &params);
  char *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % WIDE, i / WIDE % LAYERS, i / WIDE / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, spacing * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(solver, count, x, NULL, NULL));
  free(x);
  assert_ok(pbf_step(solver, (uint32_t)(0.25 / time_step)));
  return solver;
}

static pbf_collider ball_of(double x, double y, double radius) {
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[0] = x;
  ball.position[1] = y;
  ball.position[2] = 0.3;
  ball.radius = radius;
  return ball;
}

static double fastest_during(pbf_solver *solver, double time, double time_step) {
  double fastest = 0;
  for (int step = 0; step < time / time_step; ++step) {
    pbf_stats stats = {.struct_size = sizeof stats};
    assert_ok(pbf_step(solver, 1));
    assert_ok(pbf_get_stats(solver, &stats));
    fastest = fmax(fastest, stats.speed_max);
  }
  return fastest;
}

static uint32_t count_inside(pbf_solver *solver, uint32_t dimension, uint32_t precision,
                             const pbf_collider *ball) {
  const uint32_t count = count_of(dimension);
  uint32_t inside = 0;
  char *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  assert_ok(pbf_get_positions(solver, 0, count, x));
  for (uint32_t i = 0; i < count; ++i) {
    double square = 0;
    for (uint32_t k = 0; k < dimension; ++k)
      square += pow(test_value(x, (uint64_t)i * dimension + k, precision) - ball->position[k], 2);
    inside += sqrt(square) < ball->radius - 1e-3;
  }
  free(x);
  return inside;
}

/* What fills its place is no faster than a fall by the depth makes it, and shorter steps make
 * nothing faster. */
static const double fall = 3.132; /* sqrt(2 g LAYERS spacing) */

/* A ball that is set into the water, and then grows. */
static double fastest_around_ball(double time_step) {
  pbf_solver *solver = tank(3, PBF_FLOAT32, time_step);
  double fastest = 0;
  for (int grown = 0; grown < 2; ++grown) {
    const pbf_collider ball = ball_of(0.3, 0.25, grown ? 0.18 : 0.12);
    assert_ok(pbf_set_colliders(solver, 1, &ball));
    fastest = fmax(fastest, fastest_during(solver, 0.1, time_step));
  }
  pbf_destroy(solver);
  return fastest;
}

static void what_a_ball_finds_is_not_thrown(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub collides with nothing");
  const double at_step = fastest_around_ball(1.0 / 120),
               at_quarter = fastest_around_ball(1.0 / 480);
  if (!(at_step < fall && at_quarter < fall))
    fail_msg("%g m/s, in steps of a quarter %g; a fall has %g", at_step, at_quarter, fall);
}

/* A ball that reaches through a wall or the floor: of what it finds, some is pushed against that,
 * and comes out between the two. After that it is water again, as dense as it was. */
static void check_ball_through_wall(uint32_t dimension, uint32_t precision, double x, double y,
                                    double radius) {
  const double time_step = 1.0 / 480;
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_solver *solver = tank(dimension, precision, time_step);
  const pbf_collider ball = ball_of(x, y, radius);
  assert_ok(pbf_set_colliders(solver, 1, &ball));
  const double fastest = fastest_during(solver, 0.2, time_step);
  assert_ok(pbf_step(solver, (uint32_t)(0.3 / time_step)));
  const uint32_t inside = count_inside(solver, dimension, precision, &ball);
  if (!(fastest < 1.5 * fall && inside == 0))
    fail_msg("%uD, ball at %g, %g: %g m/s, a fall has %g; then %u are inside", dimension, x, y,
             fastest, fall, inside);
  assert_ok(pbf_step(solver, (uint32_t)(1.5 / time_step)));
  assert_ok(pbf_get_stats(solver, &stats));
  if (!(stats.density_error_mean < 0.1))
    fail_msg("%uD, ball at %g, %g: 2 s later denser than at rest by %g", dimension, x, y,
             stats.density_error_mean);
  pbf_destroy(solver);
}

static void check_balls_through_walls(uint32_t dimension, uint32_t precision) {
  check_ball_through_wall(dimension, precision, 0.15, 0.25, 0.2);
  check_ball_through_wall(dimension, precision, 0.31, 0.15, 0.2);
}

static void nothing_is_thrown_between_ball_and_wall(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub collides with nothing");
  test_for_each_kind(check_balls_through_walls);
}

/* A balloon that is set a little larger for each step: water is denser around it by no more than
 * elsewhere, for it gives way. */
static void check_balloon(uint32_t dimension, uint32_t precision) {
  const double time_step = 1.0 / 120, rate = 0.3;
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_solver *solver = tank(dimension, precision, time_step);
  for (int step = 0; step < 48; ++step) {
    const pbf_collider balloon = ball_of(0.3, 0.25, 0.05 + rate * time_step * step);
    assert_ok(pbf_set_colliders(solver, 1, &balloon));
    assert_ok(pbf_step(solver, 1));
  }
  assert_ok(pbf_get_stats(solver, &stats));
  if (!(stats.density_error_mean < 0.04))
    fail_msg("%uD: denser than at rest by %g", dimension, stats.density_error_mean);
  pbf_destroy(solver);
}

static void what_grows_a_little_each_step_presses_nothing(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub collides with nothing");
  test_for_each_kind(check_balloon);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_leave_at_the_speed_that_is_told),
      cmocka_unit_test(what_a_ball_finds_is_not_thrown),
      cmocka_unit_test(nothing_is_thrown_between_ball_and_wall),
      cmocka_unit_test(what_grows_a_little_each_step_presses_nothing),
  };
  return TEST_RUN(tests);
}
