/* Drag in closed form: a free particle's velocity, and the slope of a tank in the wind. */
#include "leaning_tank.h"

#include <string.h>

enum { STEPS = 24 };
static const double rate = 3, time = 0.4, wind[3] = {0.5, -0.25, 1}, start[3] = {-1, 2, 0.125};

static pbf_params params_of(uint32_t steps, double gravity) {
  pbf_params params = test_params();
  params.drag = rate;
  params.time_step = time / steps;
  params.attraction = 0;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = k == 1 ? gravity : 0;
    params.drag_velocity[k] = wind[k];
    params.domain_min[k] = -4;
    params.domain_max[k] = 4;
  }
  return params;
}

/* Its velocity after these steps, with one particle more out of reach. */
static void velocity_after(uint32_t dimension, uint32_t precision, const pbf_params *params,
                           uint32_t steps, double v[3]) {
  const pbf_desc desc = test_desc(dimension, precision, 2);
  pbf_solver *solver = test_create(&desc, params);
  double x[6] = {0}, velocities[6] = {0};
  char positions[sizeof x], values[sizeof velocities];
  for (uint32_t k = 0; k < 2 * dimension; ++k) {
    test_put(positions, k, precision, k < dimension ? 0 : 2);
    test_put(values, k, precision, start[k % dimension]);
  }
  assert_ok(pbf_add_particles(solver, 2, positions, values, NULL));
  assert_ok(pbf_step(solver, steps));
  assert_ok(pbf_get_velocities(solver, 0, 1, values));
  for (uint32_t k = 0; k < dimension; ++k) v[k] = test_value(values, k, precision);
  pbf_destroy(solver);
}

/* v(t) = u + (v(0) - u) exp(-rate t), however many steps t has. */
static void check_decay(uint32_t dimension, uint32_t precision) {
  const double accuracy = precision == PBF_FLOAT32 ? 2e-5 : 1e-11;
  for (uint32_t steps = 1; steps <= STEPS; steps *= 4) {
    const pbf_params params = params_of(steps, 0);
    double v[3];
    velocity_after(dimension, precision, &params, steps, v);
    for (uint32_t k = 0; k < dimension; ++k) {
      const double right = wind[k] + (start[k] - wind[k]) * exp(-rate * time);
      if (!(fabs(v[k] - right) < accuracy))
        fail_msg("%uD, %u steps: velocity %g, it must be %g", dimension, steps, v[k], right);
    }
  }
}

static void velocities_decay(void **state) {
  (void)state;
  test_for_each_kind(check_decay);
}

/* What falls ends where a step's gravity is what its drag takes: v = u + g dt q / (1 - q) with
 * q = exp(-rate dt), which is u + g / rate in short steps. */
static void check_fall(uint32_t dimension, uint32_t precision) {
  const double gravity = -2, dt = time / STEPS, q = exp(-rate * dt);
  const double right = wind[1] + gravity * dt * q / (1 - q);
  const pbf_params params = params_of(STEPS, gravity);
  double v[3];
  velocity_after(dimension, precision, &params, 10 * STEPS, v);
  if (!(fabs(v[1] - right) < 1e-4)) fail_msg("%uD: %g, it must be %g", dimension, v[1], right);
  assert_true(fabs(right - (wind[1] + gravity / rate)) < rate * dt * fabs(gravity / rate));
}

static void what_falls_ends_at_a_speed(void **state) {
  (void)state;
  test_for_each_kind(check_fall);
}

/* ---- A deep tank in the wind --------------------------------------------------------------- */

/* With walls that move along at `speed`, as its fluid does, in a wind that is as much faster as
 * makes the tilt. */
static pbf_solver *windy_tank(const char *backend, uint32_t dimension, uint32_t precision,
                              double speed) {
  pbf_params params = leaning_params(dimension);
  params.drag = 1;
  params.drag_velocity[0] = speed + tilt * pull / params.drag;
  params.wall_velocity[0] = params.wall_velocity[1] = speed;
  return leaning_tank(backend, dimension, precision, &params, speed);
}

/* Drag by what the wind is faster than the tank and its fluid is a gravity aside. */
static void check_tank(uint32_t dimension, uint32_t precision) {
  for (int moves = 0; moves < 2; ++moves) {
    const double speed = moves ? 0.5 : 0;
    pbf_solver *solver = windy_tank(NULL, dimension, precision, speed);
    check_leaning(solver, dimension, speed);
    pbf_destroy(solver);
  }
}

static void a_deep_tank_leans_in_the_wind(void **state) {
  (void)state;
  test_skip_if_watched();
  check_tank(2, PBF_FLOAT32);
  if (strcmp(test_backend(), "reference") != 0) check_tank(3, PBF_FLOAT32); /* takes it long */
}

/* Far from rest, as long as rounding has not grown: whole, and parted by a thin wall. */
static pbf_solver *parted_tank(const char *backend, int parts) {
  const pbf_collider wall = wall_in_the_middle();
  pbf_solver *solver = windy_tank(backend, 2, PBF_FLOAT32, 0.5);
  static float v[WIDE * DEEP][2];
  for (int i = 0; i < WIDE * DEEP; ++i) {
    v[i][0] = 0.01f * (float)(i / WIDE);
    v[i][1] = 0.005f * (float)(i % WIDE) - 0.1f;
  }
  assert_ok(pbf_set_velocities(solver, 0, WIDE * DEEP, v));
  if (parts) assert_ok(pbf_set_colliders(solver, 1, &wall));
  assert_ok(pbf_step(solver, 6));
  return solver;
}

static void as_the_reference(void **state) {
  (void)state;
  check_as_reference(parted_tank);
}

/* The stub has no drag. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(velocities_decay),
      cmocka_unit_test(what_falls_ends_at_a_speed),
      cmocka_unit_test(as_the_reference),
      cmocka_unit_test(a_deep_tank_leans_in_the_wind),
  };
  return TEST_RUN(tests);
}
