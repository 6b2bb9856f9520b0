/* Steps that are too long: what for, that it is said, and that the library divides them. */
#include "support.h"

#include <math.h>

static const double gravity = 9.81;

/* Of the domain: the fluid's lattice, with three times its height above. */
static pbf_params params_of(double spacing, const uint32_t n[3]) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = spacing * n[k] * (k == 1 ? 4 : 1);
  return params;
}

static void count_sentences(void *user, int32_t level, const char *message) {
  static const char *const names[] = {"", "gravity", "attraction", "particle", "wall", "collider"};
  uint32_t *said = user;
  if (level != PBF_LOG_WARNING) return;
  for (int k = PBF_LIMIT_GRAVITY; k <= PBF_LIMIT_COLLIDERS; ++k)
    said[k] += strstr(message, names[k]) != NULL;
}

static pbf_solver *tank(uint32_t dimension, uint32_t precision, const pbf_params *params,
                        const uint32_t n[3], uint32_t *said) {
  uint32_t count = n[0] * n[1] * (dimension == 3 ? n[2] : 1);
  pbf_desc desc = test_desc(dimension, precision, count);
  desc.log = said ? count_sentences : NULL;
  desc.log_user = said;
  pbf_solver *s = test_create(&desc, params);
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, params->spacing * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

static double limit_of(pbf_solver *s) {
  double limit = 0;
  assert_ok(pbf_get_step_limit(s, &limit));
  return limit;
}

static void expect_limit(pbf_solver *s, uint32_t cause, double right) {
  double limit = limit_of(s);
  pbf_stats stats = stats_of(s);
  if (!(fabs(limit - right) <= 1e-6 * right || limit == right) || stats.step_limit != limit ||
      stats.limited_by != cause)
    fail_msg("limit %g of %g by %u, it must be %g by %u", limit, stats.step_limit, stats.limited_by,
             right, cause);
}

/* g dt² = d / 2, v dt = d; a long box's corners go around it with half of its section's diagonal.
 */
static void check_limits(uint32_t dimension, uint32_t precision) {
  const double d = 0.05;
  const uint32_t n[3] = {4, 4, 4};
  pbf_params params = params_of(d, n);
  params.gravity[1] = 0;
  pbf_solver *s = tank(dimension, precision, &params, n, NULL);
  expect_limit(s, PBF_LIMIT_NONE, INFINITY);
  params.gravity[0] = 3, params.gravity[1] = -4;
  params.gravity[2] = dimension == 2 ? 1000 : 0;
  assert_ok(pbf_set_params(s, &params));
  expect_limit(s, PBF_LIMIT_GRAVITY, sqrt(0.5 * d / 5));
  params.wall_velocity[PBF_WALL_X_MIN] = -1;
  params.wall_amplitude[PBF_WALL_Y_MAX] = 0.1;
  params.wall_frequency[PBF_WALL_Y_MAX] = 20;
  assert_ok(pbf_set_params(s, &params));
  expect_limit(s, PBF_LIMIT_WALLS, d / 2);
  pbf_collider body;
  assert_ok(pbf_collider_init(&body, sizeof body, PBF_COLLIDER_BOX));
  for (int k = 0; k < 3; ++k) body.half_extents[k] = k < 2 ? 0.3 + 0.1 * k : 20;
  body.position[1] = 10;
  body.velocity[0] = -2;
  body.angular_velocity[2] = 2;
  assert_ok(pbf_set_colliders(s, 1, &body));
  expect_limit(s, PBF_LIMIT_COLLIDERS, d / 3);
  if (dimension == 3) { /* the same, and the long axis turned about y by 60 degrees */
    body.orientation[1] = 0.5, body.orientation[3] = sqrt(0.75);
    body.angular_velocity[0] = sqrt(3), body.angular_velocity[2] = 1;
    assert_ok(pbf_set_colliders(s, 1, &body));
    expect_limit(s, PBF_LIMIT_COLLIDERS, d / 3);
  }
  body.shape = PBF_COLLIDER_SPHERE; /* whose turn moves nothing */
  assert_ok(pbf_set_colliders(s, 1, &body));
  assert_true(fabs(limit_of(s) - d / 2) < 1e-6 * d);
  body.radius_rate = 1; /* what it grows by adds to its way, for as long as it does */
  body.duration = 0.4;
  body.position[1] = 100;
  assert_ok(pbf_set_colliders(s, 1, &body));
  expect_limit(s, PBF_LIMIT_COLLIDERS, d / 3);
  for (int k = 0; k < 2; ++k) {
    params.time_step = 0.2;
    params.wall_velocity[PBF_WALL_X_MIN] = params.wall_amplitude[PBF_WALL_Y_MAX] = 0;
    params.gravity[0] = params.gravity[1] = params.gravity[2] = 0;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 1));
    assert_int_equal(stats_of(s).limited_by == PBF_LIMIT_COLLIDERS, k == 0);
  }
  double velocity[3] = {0, -4, dimension == 3 ? 3 : 0};
  char v[sizeof velocity];
  for (uint32_t k = 0; k < dimension; ++k) test_put(v, k, precision, velocity[k]);
  assert_ok(pbf_set_velocities(s, 5, 1, v));
  expect_limit(s, PBF_LIMIT_PARTICLES, dimension == 3 ? d / 5 : d / 4);
  assert_fails(pbf_get_step_limit(s, NULL), PBF_ERROR_INVALID_ARGUMENT, "limit is null");
  pbf_destroy(s);
}

static void limits_are_closed_forms(void **state) {
  (void)state;
  test_for_each_kind(check_limits);
}

/* A ball of n³ particles pressed together by k r at its surface; repelled from the middle they are
 * in a corner. */
static void what_attracts_limits_steps(void **state) {
  (void)state;
  const double d = 0.05, k = 30;
  const uint32_t n[3] = {8, 8, 8};
  pbf_params params = params_of(d, n);
  params.gravity[1] = 0;
  params.attraction = k;
  for (int a = 0; a < 3; ++a) {
    params.domain_min[a] = -2;
    params.domain_max[a] = 2;
  }
  pbf_solver *s = tank(3, PBF_FLOAT32, &params, n, NULL);
  double radius = d * cbrt(3 * 512 / (4 * acos(-1)));
  expect_limit(s, PBF_LIMIT_ATTRACTION, sqrt(0.5 * d / (k * radius)));
  params.attraction = -k;
  assert_ok(pbf_set_params(s, &params));
  expect_limit(s, PBF_LIMIT_ATTRACTION, sqrt(0.5 * d / (k * sqrt(12))));
  pbf_destroy(s);
}

/* Once for each cause, however many steps there are, and anew after it has ended. */
static void long_steps_are_said_once(void **state) {
  (void)state;
  const double d = 0.05;
  const uint32_t n[3] = {4, 4, 4};
  uint32_t said[PBF_LIMIT_COLLIDERS + 1] = {0};
  pbf_params params = params_of(d, n);
  pbf_collider ball;
  pbf_solver *s = tank(3, PBF_FLOAT32, &params, n, said);
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[1] = 40;
  for (uint32_t times = 1; times <= 2; ++times) {
    params.time_step = 0.1;
    params.wall_velocity[PBF_WALL_X_MAX] = 0.6;
    ball.velocity[1] = 0.7;
    assert_ok(pbf_set_colliders(s, 1, &ball));
    for (int k = 0; k < 3; ++k) {
      assert_ok(pbf_set_params(s, &params));
      assert_ok(pbf_step(s, 2));
      stats_of(s);
    }
    for (uint32_t k = PBF_LIMIT_GRAVITY; k <= PBF_LIMIT_COLLIDERS; ++k)
      if (said[k] != (k == PBF_LIMIT_ATTRACTION ? 0 : times))
        fail_msg("cause %u: said %u times, it must be %u", k, said[k], times);
    params.time_step = 0.001;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 1));
    stats_of(s);
  }
  params.time_step = 0.1;
  params.max_substeps = 30;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 2));
  assert_int_equal(said[PBF_LIMIT_GRAVITY] + said[PBF_LIMIT_WALLS] + said[PBF_LIMIT_COLLIDERS], 6);
  pbf_destroy(s);
}

/* Water of millimetres in steps of a sixtieth, 2.7 spacings of fall in each. Hydrostatics: it
 * stands, and is at rest. */
static void check_still(uint32_t dimension, uint32_t precision) {
  const double d = 0.001;
  const uint32_t n[3] = {8, 10, 6};
  pbf_params params = params_of(d, n);
  params.time_step = 1.0 / 60;
  for (params.max_substeps = 1; params.max_substeps <= 8; params.max_substeps += 7) {
    pbf_solver *s = tank(dimension, precision, &params, n, NULL);
    assert_ok(pbf_step(s, 40));
    pbf_stats stats = stats_of(s);
    double height = 2 * stats.center_of_mass[1] / (d * n[1]);
    double speed = sqrt(2 * stats.kinetic_energy / (gravity * d));
    int stands = fabs(height - 1) < 0.1 && speed < 0.2;
    if (stands != (params.max_substeps > 1) || stats.substeps != (stands ? 3 : 1))
      fail_msg("%uD, up to %u parts: %g of the height, at %g sqrt(g d), in %u parts", dimension,
               params.max_substeps, height, speed, stats.substeps);
    pbf_destroy(s);
  }
}

static void divided_steps_let_water_stand(void **state) {
  (void)state;
  test_for_long_kinds(check_still);
}

/* A wall that goes in by three spacings a step, until the tank is half as long; there is room
 * above. */
static double squeezed(uint32_t max_substeps) {
  enum { LONG = 24 };
  const double d = 0.05, rate = 3;
  const uint32_t n[3] = {LONG, 8, 6};
  pbf_params params = params_of(d, n);
  double most = 0;
  params.max_substeps = max_substeps;
  params.wall_velocity[PBF_WALL_X_MIN] = rate * d / params.time_step;
  pbf_solver *s = tank(3, PBF_FLOAT32, &params, n, NULL);
  for (int k = 0; k < LONG / 2 / rate; ++k) {
    assert_ok(pbf_step(s, 1));
    most = fmax(most, stats_of(s).density_error_mean);
  }
  pbf_destroy(s);
  return most;
}

static void divided_steps_follow_pistons(void **state) {
  (void)state;
  double whole = squeezed(0), divided = squeezed(8);
  if (!(divided < 0.15 && whole > 0.3))
    fail_msg("squeezed by %g, by %g in whole steps", divided, whole);
}

/* Into one call or many, saved and loaded between; the caller's steps are what counts. A step that
 * is short enough is not divided, and keeps its bits. */
static uint64_t hash_after(uint32_t dimension, uint32_t precision, double time_step,
                           uint32_t max_substeps, uint32_t slice, int saves) {
  enum { STEPS = 24 };
  const uint32_t n[3] = {8, 10, 4};
  pbf_params params = params_of(0.05, n);
  params.max_substeps = max_substeps;
  params.time_step = time_step;
  params.domain_max[0] *= 2;
  params.wall_amplitude[PBF_WALL_X_MAX] = 0.05;
  params.wall_frequency[PBF_WALL_X_MAX] = 11;
  pbf_solver *s = tank(dimension, precision, &params, n, NULL);
  for (uint32_t done = 0; done < STEPS; done += slice) {
    if (saves && done == STEPS / 2) {
      uint64_t size;
      void *saved = test_save(s, &size);
      pbf_destroy(s);
      s = test_solver(dimension, precision, 1000);
      assert_ok(pbf_load(s, saved, size));
      free(saved);
    }
    assert_ok(pbf_step(s, slice));
  }
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  assert_int_equal(info.step, STEPS);
  assert_true(info.time == STEPS * time_step);
  uint64_t hash = test_hash(s);
  pbf_destroy(s);
  return hash;
}

static void check_bits(uint32_t dimension, uint32_t precision) {
  uint64_t right = hash_after(dimension, precision, 0.03, 4, 24, 0);
  assert_int_equal(hash_after(dimension, precision, 0.03, 4, 1, 0), right);
  assert_int_equal(hash_after(dimension, precision, 0.03, 4, 6, 1), right);
  assert_int_not_equal(hash_after(dimension, precision, 0.03, 1, 24, 0), right);
  assert_int_equal(hash_after(dimension, precision, 0.002, 4, 24, 0),
                   hash_after(dimension, precision, 0.002, 0, 24, 0));
}

static void divided_steps_replay(void **state) {
  (void)state;
  test_for_each_kind(check_bits);
}

/* Constants that are brought up to date for another time_step are those of a new solver. */
static void check_time_steps(uint32_t dimension, uint32_t precision) {
  const uint32_t n[3] = {8, 10, 4};
  uint64_t hash[2];
  for (int later = 0; later < 2; ++later) {
    pbf_params params = params_of(0.05, n);
    params.cohesion = params.damping_compensation = params.angular_momentum_correction = 1;
    params.scorr_k = 0.001;
    params.vorticity = params.viscosity = 0.05;
    params.domain_max[0] *= 2;
    params.time_step = later ? 0.02 : 0.0008;
    pbf_solver *s = tank(dimension, precision, &params, n, NULL);
    params.time_step = 0.0008;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 12));
    hash[later] = test_hash(s);
    pbf_destroy(s);
  }
  assert_int_equal(hash[0], hash[1]);
}

static void another_time_step_is_as_from_the_start(void **state) {
  (void)state;
  test_for_each_kind(check_time_steps);
}

/* The stub has neither gravity's pressure nor walls. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(limits_are_closed_forms),
      cmocka_unit_test(what_attracts_limits_steps),
      cmocka_unit_test(long_steps_are_said_once),
      cmocka_unit_test(divided_steps_let_water_stand),
      cmocka_unit_test(divided_steps_follow_pistons),
      cmocka_unit_test(divided_steps_replay),
      cmocka_unit_test(another_time_step_is_as_from_the_start),
  };
  return TEST_RUN(tests);
}
