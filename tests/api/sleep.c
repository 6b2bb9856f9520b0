/* Fluid that comes to rest sleeps, and wakes on touch. Skipped where a backend lets nothing sleep.
 */
#include "support.h"

enum { SIDE = 6, HIGH = 4 };

static pbf_params sleepy(void) {
  pbf_params params = test_params();
  params.sleep_speed = 0.08;
  params.sleep_time = 0.2;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 0.3;
  params.domain_max[1] = 1;
  return params;
}

static uint32_t particles_in(uint32_t dimension) {
  return dimension == 3 ? SIDE * SIDE * HIGH : SIDE * HIGH;
}

static pbf_solver *solver_with(uint32_t dimension, uint32_t precision, const pbf_params *params) {
  pbf_desc desc = test_desc(dimension, precision, particles_in(dimension) + 8);
  pbf_solver *s = NULL;
  desc.threads = 2;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_status status = pbf_create(&desc, params, &s);
  if (status == PBF_ERROR_UNSUPPORTED && params->sleep_speed > 0) {
    assert_non_null(strstr(pbf_last_error(), "sleep"));
    test_skip(pbf_last_error());
  }
  assert_ok(status);
  return s;
}

/* A pool as high as it is at rest, in a box that it fills from wall to wall. */
static void fill(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  uint32_t count = particles_in(dimension);
  void *x = calloc((size_t)count * dimension, precision);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t column = i / HIGH, place[3] = {column % SIDE, i % HIGH, column / SIDE};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, 0.025 + 0.05 * place[k]);
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
}

static pbf_solver *pool(uint32_t dimension, uint32_t precision) {
  pbf_params params = sleepy();
  pbf_solver *s = solver_with(dimension, precision, &params);
  fill(s, dimension, precision);
  return s;
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

static uint32_t asleep_in(pbf_solver *s) { return stats_of(s).asleep; }

/* Steps until all sleep; how many that took. */
static uint32_t until_asleep(pbf_solver *s, uint32_t count) {
  enum { STEP_LIMIT = 1500 };
  uint32_t steps = 0;
  while (asleep_in(s) < count) {
    assert_ok(pbf_step(s, 30));
    if ((steps += 30) >= STEP_LIMIT)
      fail_msg("%u of %u asleep after %u steps", asleep_in(s), count, steps);
  }
  return steps;
}

static void check_rest(uint32_t dimension, uint32_t precision) {
  uint32_t count = particles_in(dimension);
  pbf_solver *s = pool(dimension, precision);
  assert_int_equal(asleep_in(s), 0);
  uint32_t steps = until_asleep(s, count);
  assert_true(steps >= 24); /* sleep_time */
  pbf_stats before = stats_of(s);
  pbf_info then = {.struct_size = sizeof then}, now = {.struct_size = sizeof now};
  assert_ok(pbf_get_info(s, &then));
  assert_true(before.speed_max == 0);
  assert_ok(pbf_step(s, 100000));
  assert_ok(pbf_get_info(s, &now));
  pbf_stats after = stats_of(s);
  assert_memory_equal(&before, &after, sizeof before);
  assert_int_equal(now.step, then.step + 100000);
  assert_true(now.time > then.time + 800);
  pbf_destroy(s);
}

static void fluid_at_rest_sleeps(void **state) {
  (void)state;
  test_for_each_kind(check_rest);
}

/* A pool without weight that rises as one, at a part of the speed at which fluid falls asleep. */
static uint32_t asleep_of_a_flow(uint32_t dimension, uint32_t precision, double part) {
  uint32_t count = particles_in(dimension);
  pbf_params params = sleepy();
  memset(params.gravity, 0, sizeof params.gravity);
  pbf_solver *s = solver_with(dimension, precision, &params);
  fill(s, dimension, precision);
  void *v = calloc((size_t)count * dimension, precision);
  for (uint32_t i = 0; i < count; ++i)
    test_put(v, (uint64_t)i * dimension + 1, precision, part * params.sleep_speed);
  assert_ok(pbf_set_velocities(s, 0, count, v));
  free(v);
  assert_ok(pbf_step(s, 200)); /* more than eight times sleep_time */
  uint32_t asleep = asleep_in(s);
  pbf_destroy(s);
  return asleep;
}

/* Between once and three times that speed no neighbour wakes a particle: its activity must tell. */
static void check_flow(uint32_t dimension, uint32_t precision) {
  assert_int_equal(asleep_of_a_flow(dimension, precision, 2), 0);
  assert_int_equal(asleep_of_a_flow(dimension, precision, 0.5), particles_in(dimension));
}

static void what_flows_stays_awake(void **state) {
  (void)state;
  test_for_each_kind(check_flow);
}

/* With solves that end early, too, fluid at rest sleeps, and wakes of what falls in. */
static void rest_within_a_tolerance(void **state) {
  (void)state;
  uint32_t count = particles_in(3), id, asleep = 0, fewest = 12, woken = 0;
  pbf_params params = sleepy();
  params.iterations = fewest;
  params.tolerance = 2e-3;
  pbf_solver *s = solver_with(3, PBF_FLOAT32, &params);
  fill(s, 3, PBF_FLOAT32);
  for (int step = 0; step < 300 && asleep < count / 2; ++step) {
    assert_ok(pbf_step(s, 1));
    pbf_stats stats = stats_of(s);
    assert_in_range(stats.iterations, 1, params.iterations);
    if (asleep == 0 && stats.iterations < fewest) fewest = stats.iterations;
    asleep = stats.asleep;
  }
  assert_true(asleep >= count / 2);
  assert_true(fewest < params.iterations);
  const float drop[3] = {0.15f, 0.3f, 0.15f}, down[3] = {0, -2, 0};
  assert_ok(pbf_add_particles(s, 1, drop, down, &id));
  for (int step = 0; step < 30; ++step) {
    assert_ok(pbf_step(s, 1));
    uint32_t awake = count - asleep_in(s);
    woken = awake > woken ? awake : woken;
  }
  assert_true(woken > count / 4);
  pbf_destroy(s);
}

static void without_a_speed_nothing_sleeps(void **state) {
  (void)state;
  pbf_params params = sleepy();
  params.sleep_speed = 0;
  pbf_solver *s = solver_with(3, PBF_FLOAT32, &params);
  fill(s, 3, PBF_FLOAT32);
  assert_ok(pbf_step(s, 600));
  assert_int_equal(asleep_in(s), 0);
  assert_true(stats_of(s).speed_max > 0);
  pbf_destroy(s);
}

static void changed_parameters_wake(void **state) {
  (void)state;
  uint32_t count = particles_in(3);
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, count);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(s, &params));
  assert_ok(pbf_set_params(s, &params));
  assert_int_equal(asleep_in(s), count); /* they are what they were */
  params.sleep_speed = 0;
  assert_ok(pbf_set_params(s, &params));
  assert_int_equal(asleep_in(s), 0);
  params.sleep_speed = sleepy().sleep_speed;
  assert_ok(pbf_set_params(s, &params));
  until_asleep(s, count);
  params.gravity[0] = 3;
  assert_ok(pbf_set_params(s, &params));
  assert_int_equal(asleep_in(s), 0);
  double x = stats_of(s).center_of_mass[0];
  assert_ok(pbf_step(s, 30));
  assert_true(stats_of(s).center_of_mass[0] > x + 1e-3);
  params.sleep_speed = 0;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 1));
  assert_int_equal(asleep_in(s), 0);
  pbf_destroy(s);
}

/* Waking is no push: what a sleeper's place lacks does not become speed. */
static void waking_is_no_push(void **state) {
  (void)state;
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, particles_in(3));
  pbf_params params = sleepy();
  params.gravity[0] = 1e-6;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 1));
  assert_true(stats_of(s).speed_max < 1e-6);
  assert_ok(pbf_step(s, 1));
  assert_true(stats_of(s).speed_max < 0.3);
  pbf_destroy(s);
}

/* Something falls in: as it comes near, and not before, those around it wake, and then more. */
static void an_impact_wakes(void **state) {
  (void)state;
  uint32_t count = particles_in(3), id, woken = 0;
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, count);
  float drop[3] = {0.15f, 0.8f, 0.15f};
  assert_ok(pbf_add_particles(s, 1, drop, NULL, &id));
  assert_int_equal(asleep_in(s), count);
  for (int step = 0; step < 60; ++step) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_positions(s, id, 1, drop));
    uint32_t awake = count - asleep_in(s);
    if (drop[1] > 0.4) assert_int_equal(awake, 0);
    woken = awake > woken ? awake : woken;
  }
  assert_true(drop[1] < 0.3f);
  assert_true(woken > 8);
  until_asleep(s, count + 1);
  pbf_destroy(s);
}

/* Drops that fall onto a wide pool, of which most sleeps on: what sleeps has no neighbours listed,
 * and where particles have been placed is asked of all others. */
static void rain_falls_on_sleepers(void **state) {
  (void)state;
  enum { WIDE = 24, POOL = WIDE * WIDE * HIGH, DROPS = 40, ROUNDS = 3 }; /* fewer than a layer */
  float x[3 * POOL];
  pbf_params params = sleepy();
  pbf_destroy(solver_with(3, PBF_FLOAT32, &params)); /* skips where nothing sleeps */
  pbf_desc desc = test_desc(3, PBF_FLOAT32, POOL + DROPS * ROUNDS);
  params.domain_max[0] = params.domain_max[2] = 0.05 * WIDE;
  pbf_solver *s = test_create(&desc, &params);
  for (uint32_t i = 0; i < POOL; ++i) {
    const uint32_t column = i / HIGH, place[3] = {column % WIDE, i % HIGH, column / WIDE};
    for (int k = 0; k < 3; ++k) x[3 * i + k] = 0.025f + 0.05f * (float)place[k];
  }
  assert_ok(pbf_add_particles(s, POOL, x, NULL, NULL));
  until_asleep(s, POOL);
  for (uint32_t round = 0; round < ROUNDS; ++round) {
    const float above[3] = {0.3f * (float)(round + 1), 0.3f, 0.5f};
    for (uint32_t i = 0; i < DROPS; ++i) /* close to each other, each on three planes of its own */
      for (uint32_t k = 0; k < 3; ++k)
        x[3 * i + k] = above[k] + 0.05f * (float)(i * (7 + 6 * k) % DROPS) / DROPS;
    assert_ok(pbf_add_particles(s, DROPS, x, NULL, NULL));
    assert_ok(pbf_step(s, 1));
    assert_in_range(asleep_in(s), POOL / 2, POOL);
  }
  pbf_destroy(s);
}

static void removing_and_setting_wake(void **state) {
  (void)state;
  uint32_t count = particles_in(3);
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, count);
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){17}));
  assert_int_equal(asleep_in(s), 0);
  until_asleep(s, count - 1);
  float x[3], v[3] = {0, 0, 0};
  assert_ok(pbf_get_positions(s, 3, 1, x));
  assert_ok(pbf_set_positions(s, 3, 1, x));
  assert_int_equal(asleep_in(s), 0);
  until_asleep(s, count - 1);
  assert_ok(pbf_set_velocities(s, 3, 1, v));
  assert_int_equal(asleep_in(s), 0);
  pbf_destroy(s);
}

/* A ball sinks from the ceiling: no particle wakes before it is within h, and then they do. */
static void a_moving_collider_wakes(void **state) {
  (void)state;
  uint32_t count = particles_in(3), asleep = count;
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, count);
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.05;
  ball.position[0] = ball.position[2] = 0.15;
  ball.position[1] = 0.8;
  ball.velocity[1] = -0.5;
  double surface = stats_of(s).position_max[1];
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_int_equal(asleep_in(s), count);
  while (asleep == count && ball.position[1] > 0) {
    assert_ok(pbf_step(s, 1));
    asleep = asleep_in(s);
    assert_ok(pbf_get_collider(s, 0, &ball));
  }
  assert_true(asleep < count);
  assert_true(ball.position[1] < surface + 0.05 + 0.1 + 0.01); /* radius, h, and two steps */
  assert_true(ball.position[1] > surface + 0.05);
  pbf_destroy(s);
}

static void a_moving_wall_wakes(void **state) {
  (void)state;
  uint32_t count = particles_in(3);
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, count);
  const double speed = 0.1;
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  pbf_params params = sleepy();
  params.wall_velocity[PBF_WALL_Y_MAX] = -speed;
  params.domain_max[1] += speed * info.time;
  assert_ok(pbf_set_params(s, &params));
  until_asleep(s, count);
  for (uint32_t asleep = count; asleep == count; asleep = asleep_in(s)) assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_info(s, &info));
  double wall = params.domain_max[1] - speed * info.time, surface = stats_of(s).position_max[1];
  assert_true(wall > surface + 0.05 && wall < surface + 0.11);
  pbf_destroy(s);
}

/* A collider that leaves where it stood wakes all, if any sleeps there; one that comes wakes those
 * around it. */
static void a_changed_collider_wakes(void **state) {
  (void)state;
  uint32_t count = particles_in(3);
  pbf_solver *s = pool(3, PBF_FLOAT32);
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.02;
  assert_ok(pbf_set_colliders(s, 1, &ball)); /* in a corner */
  until_asleep(s, count);
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_int_equal(asleep_in(s), count);
  ball.position[0] = ball.position[1] = ball.position[2] = 0.9;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_int_equal(asleep_in(s), 0);
  until_asleep(s, count);
  ball.position[0] = ball.position[1] = ball.position[2] = 0.1;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  uint32_t asleep = asleep_in(s);
  assert_true(asleep < count && asleep > count / 2);
  ball.position[1] = 0.12;
  assert_ok(pbf_set_colliders(s, 1, &ball)); /* none sleeps there any more */
  asleep = asleep_in(s);
  assert_true(asleep < count && asleep > count / 2);
  until_asleep(s, count);
  assert_ok(pbf_set_colliders(s, 0, NULL));
  assert_int_equal(asleep_in(s), 0);
  pbf_destroy(s);
}

/* ---- A gate and a stick -------------------------------------------------------------------- */

enum { DAM_LONG = 12, DAM_HIGH = 16, DAM_WIDE = 4 };

typedef enum gate { REMOVED, LIFTED, SET_ELSEWHERE } gate;

static pbf_collider closed_gate(void) {
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  box.position[0] = 0.05 * DAM_LONG + 0.05;
  box.position[1] = 1;
  box.half_extents[0] = 0.05;
  box.half_extents[1] = box.half_extents[2] = 1.1;
  return box;
}

static void open_gate(pbf_solver *s, gate how) {
  pbf_collider box = closed_gate();
  if (how == LIFTED) box.velocity[1] = 5;
  if (how == SET_ELSEWHERE) box.position[1] = 4;
  assert_ok(pbf_set_colliders(s, how == REMOVED ? 0 : 1, &box));
}

/* How far the water of a dam, asleep at first or not, has gone 0.5 s after its gate has. */
static double gone(uint32_t dimension, double sleep_speed, gate how) {
  const uint32_t count = DAM_LONG * DAM_HIGH * (dimension == 3 ? DAM_WIDE : 1);
  pbf_params params = sleepy();
  params.sleep_speed = sleep_speed;
  params.domain_max[0] = 2.5;
  params.domain_max[1] = 3;
  params.domain_max[2] = 0.05 * DAM_WIDE;
  pbf_desc desc = test_desc(dimension, PBF_FLOAT32, count);
  pbf_solver *s = NULL;
  float x[DAM_LONG * DAM_HIGH * DAM_WIDE * 3];
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t place[3] = {i / DAM_HIGH % DAM_LONG, i % DAM_HIGH, i / DAM_HIGH / DAM_LONG};
    for (uint32_t k = 0; k < dimension; ++k)
      x[i * dimension + k] = 0.025f + 0.05f * (float)place[k];
  }
  const pbf_collider box = closed_gate();
  assert_ok(pbf_create(&desc, &params, &s));
  assert_ok(pbf_set_colliders(s, 1, &box));
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  assert_ok(pbf_step(s, 240));
  if (sleep_speed > 0) until_asleep(s, count);
  const double at = stats_of(s).center_of_mass[0];
  open_gate(s, how);
  assert_ok(pbf_step(s, (uint32_t)(0.5 / params.time_step + 0.5)));
  const double moved = stats_of(s).center_of_mass[0] - at;
  pbf_destroy(s);
  return moved;
}

/* What held the water is gone for all of it at once, not only for what is next to the gate. */
static void check_dam(uint32_t dimension, gate how) {
  const double asleep = gone(dimension, 0.08, how), awake = gone(dimension, 0, how);
  print_message("%u dimensions, gate %d: %g m, awake %g m\n", dimension, (int)how, asleep, awake);
  assert_true(awake > 0.1);
  assert_true(fabs(asleep / awake - 1) < 0.15);
}

static void a_dam_that_slept_breaks(void **state) {
  (void)state;
  pbf_params params = sleepy();
  pbf_destroy(solver_with(3, PBF_FLOAT32, &params)); /* skips where nothing sleeps */
  check_dam(3, REMOVED);
  for (int how = REMOVED; how <= SET_ELSEWHERE && test_has_kind(2, PBF_FLOAT32); ++how)
    check_dam(2, (gate)how);
}

/* A stick goes to and fro at one end of a long pool, with a velocity or by being set elsewhere in
 * each step: the other end falls asleep all the same. */
static void check_stick(uint32_t dimension, int with_velocity) {
  enum { LONG = 60, WIDE = 2 };
  const uint32_t count = LONG * HIGH * (dimension == 3 ? WIDE : 1);
  pbf_params params = sleepy();
  params.domain_max[0] = 0.05 * LONG;
  params.domain_max[2] = 0.05 * WIDE;
  pbf_desc desc = test_desc(dimension, PBF_FLOAT32, count);
  pbf_solver *s = NULL;
  float x[LONG * HIGH * WIDE * 3];
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t place[3] = {i / HIGH % LONG, i % HIGH, i / HIGH / LONG};
    for (uint32_t k = 0; k < dimension; ++k)
      x[i * dimension + k] = 0.025f + 0.05f * (float)place[k];
  }
  pbf_collider stick;
  assert_ok(pbf_collider_init(&stick, sizeof stick, PBF_COLLIDER_SPHERE));
  stick.radius = 0.05;
  stick.position[0] = 0.2;
  stick.position[1] = 0.15;
  stick.position[2] = 0.05;
  assert_ok(pbf_create(&desc, &params, &s));
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  assert_ok(pbf_set_colliders(s, 1, &stick));
  until_asleep(s, count);
  uint32_t asleep = 0;
  for (int step = 0; step < 480; ++step) {
    const double speed = 0.3 * cos(0.1 * step);
    stick.velocity[0] = with_velocity ? speed : 0;
    assert_ok(pbf_set_colliders(s, 1, &stick));
    if (step == 1) assert_int_equal(asleep_in(s), 0); /* it has moved by now */
    assert_ok(pbf_step(s, 1));
    stick.position[0] += speed * params.time_step;
    asleep = asleep_in(s);
  }
  print_message("%u of %u asleep\n", asleep, count);
  assert_true(asleep > count / 4);
  pbf_destroy(s);
}

static void stirred_at_one_end_the_other_sleeps(void **state) {
  (void)state;
  pbf_params params = sleepy();
  pbf_destroy(solver_with(3, PBF_FLOAT32, &params)); /* skips where nothing sleeps */
  const uint32_t dimension = test_has_kind(2, PBF_FLOAT32) ? 2 : 3;
  check_stick(dimension, 1);
  check_stick(dimension, 0);
}

/* Two arms, 6 spacings wide, joined below a wall of one: what is laid upon the water in the one row
 * by row, slower than `sleep_speed`, stands in both in the end. */
enum { ARM = 6, ARMS = 2 * ARM + 1, ROWS = 8, DEEP_ARMS = 4 };

static uint32_t put_row(pbf_solver *s, uint32_t dimension, double y, uint32_t from, uint32_t to) {
  float x[ARMS * DEEP_ARMS * 3];
  uint32_t count = 0;
  for (uint32_t k = 0; k < (dimension == 3 ? DEEP_ARMS : 1); ++k)
    for (uint32_t i = from; i < to; ++i, ++count) {
      float *at = x + count * dimension;
      at[0] = 0.05f * ((float)i + 0.5f);
      at[1] = 0.05f * (float)y;
      if (dimension == 3) at[2] = 0.05f * ((float)k + 0.5f);
    }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  return count;
}

static void check_arms(uint32_t dimension) {
  enum { BELOW = 2, HIGH_ARMS = 6, STEPS_A_ROW = 60 };
  pbf_params params = sleepy();
  params.domain_max[0] = 0.05 * ARMS;
  params.domain_max[2] = 0.05 * DEEP_ARMS;
  const pbf_desc desc = test_desc(dimension, PBF_FLOAT32, 1000);
  pbf_solver *s = NULL;
  pbf_collider wall;
  static float x[1000 * 3];
  uint32_t count = 0, right = 0;
  assert_ok(pbf_create(&desc, &params, &s));
  assert_ok(pbf_collider_init(&wall, sizeof wall, PBF_COLLIDER_BOX));
  wall.position[0] = 0.05 * ARMS / 2;
  wall.position[1] = 1 + 0.05 * BELOW;
  wall.half_extents[0] = 0.025;
  assert_ok(pbf_set_colliders(s, 1, &wall));
  for (uint32_t row = 0; row < HIGH_ARMS; ++row) {
    count += put_row(s, dimension, row + 0.5, 0, row < BELOW ? ARMS : ARM);
    if (row >= BELOW) count += put_row(s, dimension, row + 0.5, ARM + 1, ARMS);
  }
  until_asleep(s, count);
  for (uint32_t row = 0; row < ROWS; ++row) {
    assert_ok(pbf_get_positions(s, 0, count, x));
    double level = 0;
    for (uint32_t i = 0; i < count; ++i)
      if (x[i * dimension] < 0.05f * ARM) level = fmax(level, (double)x[i * dimension + 1] / 0.05);
    count += put_row(s, dimension, level + 1, 0, ARM);
    assert_ok(pbf_step(s, STEPS_A_ROW));
  }
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t i = 0; i < count; ++i) right += x[i * dimension] > 0.05f * ARMS / 2;
  const double of = (double)right / (count - right);
  if (!(of > 0.7)) fail_msg("%uD: the other arm has %g of what this one has", dimension, of);
  pbf_destroy(s);
}

static void a_level_that_rises_wakes_what_is_far(void **state) {
  (void)state;
  pbf_params params = sleepy();
  pbf_destroy(solver_with(3, PBF_FLOAT32, &params)); /* skips where nothing sleeps */
  if (test_has_kind(2, PBF_FLOAT32)) check_arms(2);
  check_arms(3);
}

/* max(rho/rho0 - 1, 0) of all, and the mean of their pressures. */
typedef struct excess {
  double mean, most, pressure;
} excess;

/* A pool of particles out of place, once it has come to rest. */
static excess excess_at_rest(const pbf_params *params) {
  enum { WIDE = 10, COUNT = WIDE * WIDE * HIGH, STEPS = 300 };
  static float x[COUNT][3], densities[COUNT], pressures[COUNT];
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  pbf_solver *s = NULL;
  excess e = {0, 0, 0};
  uint32_t state = 1;
  assert_ok(pbf_create(&desc, params, &s));
  for (uint32_t i = 0; i < COUNT; ++i)
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t place[3] = {i / HIGH % WIDE, i % HIGH, i / HIGH / WIDE};
      state = state * 1664525 + 1013904223;
      x[i][k] = 0.05f * ((float)place[k] + 0.25f + (float)(state >> 8) / (1 << 25));
    }
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  assert_ok(pbf_step(s, STEPS));
  assert_int_equal(asleep_in(s) > COUNT / 2, params->sleep_speed > 0);
  assert_ok(pbf_get_densities(s, 0, COUNT, densities));
  assert_ok(pbf_get_pressures(s, 0, COUNT, pressures));
  for (uint32_t i = 0; i < COUNT; ++i) {
    double more = fmax((double)densities[i] - 1, 0);
    e.mean += more / COUNT;
    e.most = fmax(e.most, more);
    e.pressure += (double)pressures[i] / COUNT;
  }
  pbf_destroy(s);
  return e;
}

/* A particle that falls asleep later than those around it does not come to rest too near to them.
 */
static void check_excess(double tolerance) {
  pbf_params params = sleepy();
  params.iterations = 8;
  params.tolerance = tolerance;
  params.domain_max[0] = params.domain_max[2] = 0.5;
  pbf_destroy(solver_with(3, PBF_FLOAT32, &params)); /* skips where nothing sleeps */
  excess asleep = excess_at_rest(&params);
  params.sleep_speed = 0;
  excess awake = excess_at_rest(&params);
  print_message("density error of %g %% on average and %g %% at most, awake %g and %g\n",
                100 * asleep.mean, 100 * asleep.most, 100 * awake.mean, 100 * awake.most);
  print_message("mean pressure %g, awake %g\n", asleep.pressure, awake.pressure);
  assert_true(asleep.most < 8 * awake.most);
  /* Where solves end early, the awake's means change from step to step. */
  assert_true(asleep.mean < (tolerance > 0 ? tolerance : 8 * awake.mean));
  if (tolerance == 0) assert_true(fabs(asleep.pressure / awake.pressure - 1) < 0.15);
}

static void sleep_is_not_denser(void **state) {
  (void)state;
  check_excess(0);
}

static void nor_within_a_tolerance(void **state) {
  (void)state;
  check_excess(2e-3);
}

/* Saved while some sleep, and while all do: the same bits. */
static void check_saved(uint32_t dimension, uint32_t precision) {
  pbf_params awake = sleepy();
  awake.sleep_speed = 0;
  pbf_solver *a = pool(dimension, precision), *b = solver_with(dimension, precision, &awake);
  for (uint32_t asleep = 0; asleep == 0; asleep = asleep_in(a)) assert_ok(pbf_step(a, 5));
  for (int round = 0; round < 2; ++round) {
    uint64_t size;
    void *state = test_save(a, &size);
    assert_ok(pbf_load(b, state, size));
    assert_int_equal(asleep_in(a), asleep_in(b));
    for (int i = 0; i < 4; ++i) {
      assert_ok(pbf_step(a, 10));
      assert_ok(pbf_step(b, 10));
      assert_int_equal(test_hash(a), test_hash(b));
      assert_int_equal(asleep_in(a), asleep_in(b));
    }
    free(state);
    until_asleep(a, particles_in(dimension));
  }
  pbf_destroy(a);
  pbf_destroy(b);
}

static void sleep_is_saved(void **state) {
  (void)state;
  test_for_each_kind(check_saved);
}

/* A state in which particles sleep, with parameters by which none does. */
static void a_forged_state(void **state) {
  (void)state;
  enum { AT_KEPT = 44 };
  uint32_t kept;
  const uint32_t none = 0, two = 2;
  uint64_t size;
  pbf_solver *s = pool(3, PBF_FLOAT32);
  until_asleep(s, particles_in(3));
  char *saved = test_save(s, &size);
  memcpy(&kept, saved + AT_KEPT, sizeof kept);
  memcpy(saved + AT_KEPT, &two, sizeof two);
  test_seal(saved, size);
  assert_fails(pbf_load(s, saved, size), PBF_ERROR_DATA, "sizes");
  memcpy(saved + AT_KEPT, &none, sizeof none);
  test_seal(saved, size);
  assert_fails(pbf_load(s, saved, size), PBF_ERROR_DATA, "sizes");
  const float nan = NAN;
  memcpy(saved + AT_KEPT, &kept, sizeof kept);
  memcpy(saved + size - 8 - sizeof nan, &nan, sizeof nan);
  test_seal(saved, size);
  assert_fails(pbf_load(s, saved, size), PBF_ERROR_DATA, "must be finite");
  assert_int_equal(asleep_in(s), particles_in(3));
  free(saved);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest sleep[] = {
      cmocka_unit_test(fluid_at_rest_sleeps),
      cmocka_unit_test(without_a_speed_nothing_sleeps),
      cmocka_unit_test(changed_parameters_wake),
      cmocka_unit_test(waking_is_no_push),
      cmocka_unit_test(an_impact_wakes),
      cmocka_unit_test(rain_falls_on_sleepers),
      cmocka_unit_test(removing_and_setting_wake),
      cmocka_unit_test(a_moving_collider_wakes),
      cmocka_unit_test(a_moving_wall_wakes),
      cmocka_unit_test(a_changed_collider_wakes),
      cmocka_unit_test(sleep_is_saved),
      cmocka_unit_test(a_forged_state),
      cmocka_unit_test(rest_within_a_tolerance),
      cmocka_unit_test(what_flows_stays_awake),
      cmocka_unit_test(sleep_is_not_denser),
      cmocka_unit_test(nor_within_a_tolerance),
      cmocka_unit_test(a_dam_that_slept_breaks),
      cmocka_unit_test(stirred_at_one_end_the_other_sleeps),
      cmocka_unit_test(a_level_that_rises_wakes_what_is_far),
  };
  return TEST_RUN(sleep);
}
