/* The pressure grid: deep water stands with few iterations, and what falls freely is left alone. */
#include "deep_column.h"

/* Largest distance of the pressure from that of water at rest, over that on the floor, where the
 * surface is two cells away. */
static double pressure_error(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  uint32_t count = 0;
  double worst = 0, deep = gravity * spacing * LAYERS;
  assert_ok(pbf_get_count(s, &count));
  void *x = calloc((size_t)count * dimension, precision), *p = calloc(count, precision);
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_get_pressures(s, 0, count, p));
  for (uint32_t i = 0; i < count; ++i) {
    double y = test_value(x, (uint64_t)i * dimension + 1, precision);
    double rest = gravity * (spacing * LAYERS - y);
    if (y < spacing * (LAYERS - 8)) worst = fmax(worst, fabs(test_value(p, i, precision) - rest));
  }
  free(x);
  free(p);
  return worst / deep;
}

static void check_column(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = column(dimension, precision, 2, 1), *plain = column(dimension, precision, 0, 1);
  assert_ok(pbf_step(s, 200));
  assert_ok(pbf_step(plain, 200));
  double speed = sqrt(2 * stats_of(s).kinetic_energy / (gravity * spacing));
  double lost = lost_height(s), error = pressure_error(s, dimension, precision);
  if (!(fabs(lost) < 0.01)) fail_msg("%uD: %g of the height lost", dimension, lost);
  if (!(speed < 0.1)) fail_msg("%uD: moves at %g sqrt(g d)", dimension, speed);
  if (!(error < 0.05)) fail_msg("%uD: the pressure is %g off", dimension, error);
  double without = sqrt(2 * stats_of(plain).kinetic_energy / (gravity * spacing));
  if (!(without > 0.2)) fail_msg("%uD: without a grid it moves at %g", dimension, without);
  pbf_destroy(s);
  pbf_destroy(plain);
}

static void a_column_stands(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_column);
}

/* Forces know nothing of an error that is there: one of all layers together takes the iterations
 * hundreds of steps, in which it throws the column up. */
static void check_squeezed(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = column(dimension, precision, 2, 0.99);
  assert_ok(pbf_step(s, 120));
  double lost = lost_height(s);
  if (!(fabs(lost) < 0.01)) fail_msg("%uD: %g of the height lost", dimension, lost);
  pbf_destroy(s);
}

static void what_is_squeezed_comes_back(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_squeezed);
}

/* Nothing presses on fluid that falls: not even its own surface, which fills cells in part. */
static void check_fall(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 10 * 10 * 3);
  pbf_params params = column_params(2);
  params.domain_max[0] = 1;
  params.domain_max[2] = 3;
  pbf_solver *s = block(&desc, &params, 10, 10, 0.23, 2.51, 1);
  assert_ok(pbf_step(s, 30));
  pbf_stats stats = stats_of(s);
  double t = 30 * params.time_step, expected = gravity * t;
  if (!(fabs(stats.momentum[1] + expected) < 1e-4 * expected && fabs(stats.momentum[0]) < 1e-4 &&
        fabs(2 * stats.kinetic_energy - expected * expected) < 1e-3 * expected * expected))
    fail_msg("%uD: falls at %g, %g, %g; %g is free", dimension, stats.momentum[0],
             stats.momentum[1], stats.momentum[2], -expected);
  pbf_destroy(s);
}

static void what_falls_is_left_alone(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_fall);
}

static uint64_t hash_of_threads(uint32_t dimension, uint32_t columns, uint32_t layers, double grid,
                                uint32_t threads) {
  pbf_desc desc = test_desc(dimension, PBF_FLOAT32, columns * layers * (dimension == 3 ? 3 : 1));
  pbf_params params = column_params(grid);
  desc.threads = threads;
  params.domain_max[0] = spacing * columns * 2;
  params.domain_max[1] = spacing * layers * 1.2;
  pbf_solver *s = block(&desc, &params, columns, layers, 0, 0, 1);
  assert_ok(pbf_step(s, 4));
  assert_ok(pbf_step(s, 5));
  uint64_t hash = test_hash(s);
  pbf_destroy(s);
  return hash;
}

static void threads_agree(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  uint64_t hash = hash_of_threads(3, COLUMNS, LAYERS, 1.5, 1);
  for (uint32_t threads = 2; threads <= 3; ++threads)
    assert_true(hash_of_threads(3, COLUMNS, LAYERS, 1.5, threads) == hash);
}

/* So many nodes that threads share the solve, between them and with none to help. */
static void threads_agree_on_a_large_grid(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  const char *backend = getenv("PBF_TEST_BACKEND");
  if (backend && strcmp(backend, "reference") == 0) test_skip("it has one thread, and takes long");
  uint64_t hash = hash_of_threads(2, 200, 100, 1, 1);
  for (uint32_t threads = 2; threads <= 5; threads += 3)
    assert_true(hash_of_threads(2, 200, 100, 1, threads) == hash);
}

/* What it held goes, and a saved state needs nothing of it. */
static void switched_on_and_off(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_solver *s = column(2, PBF_FLOAT64, 0, 1), *plain = column(2, PBF_FLOAT64, 0, 1);
  pbf_params on = column_params(2), off = column_params(0);
  assert_ok(pbf_set_params(s, &on));
  assert_ok(pbf_set_params(s, &off));
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_step(plain, 3));
  assert_true(test_hash(s) == test_hash(plain));
  assert_ok(pbf_set_params(s, &on));
  assert_ok(pbf_set_params(plain, &on));
  assert_ok(pbf_step(s, 4));
  assert_ok(pbf_step(plain, 2));
  assert_ok(pbf_set_params(plain, &off));
  assert_ok(pbf_set_params(plain, &on));
  assert_ok(pbf_step(plain, 2));
  assert_true(test_hash(s) == test_hash(plain));
  pbf_destroy(s);
  pbf_destroy(plain);
}

/* A pressure is that of the last step, whatever becomes of the grid since. */
static double *pressures_of(pbf_solver *s, uint32_t precision) {
  uint32_t count = 0;
  assert_ok(pbf_get_count(s, &count));
  void *raw = calloc(count, precision);
  double *p = calloc(count, sizeof *p);
  assert_true(raw && p);
  assert_ok(pbf_get_pressures(s, 0, count, raw));
  for (uint32_t i = 0; i < count; ++i) p[i] = test_value(raw, i, precision);
  free(raw);
  return p;
}

static void expect_pressures(pbf_solver *s, uint32_t precision, const double *p, uint32_t count,
                             const char *when) {
  double *now = pressures_of(s, precision);
  for (uint32_t i = 0; i < count; ++i)
    if (!(fabs(now[i] - p[i]) < 1e-5 * gravity * spacing * LAYERS))
      fail_msg("%s pressure %u is %g, it was %g", when, i, now[i], p[i]);
  free(now);
}

static void check_outlived(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = column(dimension, precision, 2, 1), *unread = column(dimension, precision, 2, 1);
  const pbf_params on = column_params(2), off = column_params(0);
  uint32_t count = 0, last[1];
  assert_ok(pbf_get_count(s, &count));
  void *x = calloc(1, (size_t)dimension * precision);
  assert_ok(pbf_step(s, 10));
  assert_ok(pbf_get_ids(s, count - 1, 1, last));
  assert_ok(pbf_remove_particles(s, 1, last));
  double *p = pressures_of(s, precision);
  assert_true(p[0] > 0.5 * gravity * spacing * LAYERS);
  assert_ok(pbf_step(unread, 10));
  assert_ok(pbf_remove_particles(unread, 1, last));
  assert_ok(pbf_set_params(unread, &off));
  expect_pressures(unread, precision, p, count - 1, "read late");
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, 0.1);
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  expect_pressures(s, precision, p, count - 1, "after adding");
  double *after = pressures_of(s, precision);
  if (!(after[count - 1] == 0)) fail_msg("before its first step it has %g", after[count - 1]);
  assert_ok(pbf_get_positions(s, 0, 1, x));
  assert_ok(pbf_set_positions(s, 0, 1, x));
  expect_pressures(s, precision, p, count - 1, "put where it is");
  assert_ok(pbf_set_params(s, &off));
  expect_pressures(s, precision, p, count - 1, "without a grid");
  assert_ok(pbf_set_params(s, &on));
  expect_pressures(s, precision, p, count - 1, "with the next grid");
  free(x), free(p), free(after);
  pbf_destroy(s);
  pbf_destroy(unread);
}

static void pressures_outlive_the_grid(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_outlived);
}

/* However a deep column starts: as it would fall at random, and not on a lattice. */
/* Every coordinate by up to a quarter of a spacing. */
static void shake(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  uint32_t count = 0;
  assert_ok(pbf_get_count(s, &count));
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint64_t k = 0; k < (uint64_t)count * dimension; ++k) {
    double shift = (double)((k * 2654435761u) % 1024) / 1024 - 0.5; /* of half a spacing */
    test_put(x, k, precision, test_value(x, k, precision) + 0.5 * shift * spacing);
  }
  assert_ok(pbf_set_positions(s, 0, count, x));
  free(x);
}

static void check_disorder(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = column(dimension, precision, -1, 1);
  shake(s, dimension, precision);
  double highest = 0;
  for (int k = 0; k < 8; ++k) {
    assert_ok(pbf_step(s, 30));
    highest = fmax(highest, -lost_height(s));
  }
  double speed = sqrt(2 * stats_of(s).kinetic_energy / (gravity * spacing));
  if (!(highest < 0.1)) fail_msg("%uD: thrown up by %g of its height", dimension, highest);
  if (!(fabs(lost_height(s)) < 0.02)) fail_msg("%uD: %g lost", dimension, lost_height(s));
  if (!(speed < 0.2)) fail_msg("%uD: moves at %g sqrt(g d)", dimension, speed);
  pbf_destroy(s);
}

static void disorder_settles(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_disorder);
}

/* What the grid carries stirs the more, the more it is: 150 layers in steps of 1/44 s stood 1.2 to
 * 2 % too high while all but 0.7 % of density error was carried. */
static void check_long_steps(uint32_t dimension, uint32_t precision) {
  enum { DEEP = 150, WIDE = 12, STEPS = 110 };
  if (dimension == 3) return; /* the same, and takes long */
  pbf_desc desc = test_desc(dimension, precision, DEEP * WIDE);
  pbf_params params = column_params(-1);
  params.time_step = 1.0 / 44;
  params.domain_max[0] = spacing * WIDE;
  params.domain_max[1] = 1.5 * spacing * DEEP;
  pbf_solver *s = block(&desc, &params, WIDE, DEEP, 0, 0, 1);
  shake(s, dimension, precision);
  for (int k = 0; k < 2; ++k) {
    assert_ok(pbf_step(s, STEPS));
    double rise = stats_of(s).center_of_mass[1] / (0.5 * spacing * DEEP) - 1;
    if (!(fabs(rise) < 0.005)) fail_msg("after %d steps it is %g too high", (k + 1) * STEPS, rise);
  }
  pbf_destroy(s);
}

static void long_steps_do_not_stir(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_long_steps);
}

/* Takes away who is nearer to a point than that. */
static void dig(pbf_solver *s, const pbf_desc *desc, double x, double y, double radius) {
  uint32_t count = 0, dug = 0;
  assert_ok(pbf_get_count(s, &count));
  void *places = calloc((size_t)count * desc->dimension, desc->precision);
  uint32_t *ids = calloc(count, sizeof *ids);
  assert_ok(pbf_get_positions(s, 0, count, places));
  for (uint32_t i = 0; i < count; ++i) {
    uint64_t at = (uint64_t)i * desc->dimension;
    double dx = test_value(places, at, desc->precision) - x;
    double dy = test_value(places, at + 1, desc->precision) - y;
    if (dx * dx + dy * dy < radius * radius) ids[dug++] = i;
  }
  assert_ok(pbf_remove_particles(s, dug, ids));
  free(places);
  free(ids);
}

/* A ball under water is room that the water does not have, and stays dry. */
static void check_ball(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 30 * 20 * 3);
  pbf_params params = column_params(2);
  params.domain_max[0] = 1.5;
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[0] = 0.75;
  ball.position[1] = 0.3;
  ball.position[2] = 0.075;
  ball.radius = 0.2;
  pbf_solver *s = block(&desc, &params, 30, 20, 0, 0, 1);
  dig(s, &desc, 0.75, 0.3, 0.22);
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, 120));
  double speed = sqrt(2 * stats_of(s).kinetic_energy / (gravity * spacing));
  if (!(speed < 0.1)) fail_msg("%uD: moves at %g sqrt(g d)", dimension, speed);
  pbf_destroy(s);
}

/* Lowered into water at rest, it stirs the water, which comes to rest again. */
static void check_lowered_ball(uint32_t dimension, uint32_t precision) {
  enum { SIDE = 20, DEPTH = 12 };
  const uint32_t deep = dimension == 3 ? 3 : 1; /* as block() */
  pbf_desc desc = test_desc(dimension, precision, SIDE * DEPTH * deep);
  pbf_params params = test_params();
  params.domain_max[0] = SIDE * spacing;
  params.domain_max[1] = 2;
  params.domain_max[2] = deep * spacing;
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  const double start = 1, end = 0.3, speed = 0.4;
  ball.position[0] = 0.5;
  ball.position[1] = start;
  ball.position[2] = 0.5 * params.domain_max[2];
  ball.velocity[1] = -speed;
  ball.radius = 0.2;
  pbf_solver *s = block(&desc, &params, SIDE, DEPTH, 0, 0, 1);
  assert_ok(pbf_step(s, 240));
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, (uint32_t)((start - end) / speed / params.time_step)));
  ball.position[1] = end;
  ball.velocity[1] = 0;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, 960));
  const double left = sqrt(2 * stats_of(s).kinetic_energy / (gravity * spacing));
  if (!(left < 0.04)) fail_msg("%uD: moves at %g sqrt(g d)", dimension, left);
  pbf_destroy(s);
}

static void water_rests_around_a_lowered_ball(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_lowered_ball);
}

static void water_rests_around_a_ball(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_ball);
}

/* Steps that are short for gravity undo errors little by little, but not less of them than they
 * add: two thirds of a free fall's time of water 160 layers deep, which the iterations carry alone.
 */
static void check_short_steps(uint32_t precision) {
  enum { TALL = 160, WIDE = 6, STEPS = 800 };
  pbf_desc desc = test_desc(2, precision, TALL * WIDE);
  pbf_params params = column_params(0);
  params.smoothing_radius = 3 * spacing;
  params.spacing = spacing;
  params.particle_volume = 0;
  params.time_step = 0.0014;
  params.domain_max[1] = spacing * (TALL + 12);
  pbf_solver *s = block(&desc, &params, WIDE, TALL, 0, 0, 1);
  assert_ok(pbf_step(s, STEPS));
  double height = stats_of(s).center_of_mass[1] / (0.5 * spacing * TALL);
  if (!(height > 0.97)) fail_msg("the column is %g times as high", height);
  pbf_destroy(s);
}

static void short_steps_hold_deep_water(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  check_short_steps(PBF_FLOAT32);
  check_short_steps(PBF_FLOAT64);
}

/* Four boxes hold the water in a wide domain: without a grid iterations leave it soft, but it never
 * has more energy than it began with. */
static void check_pool(uint32_t precision) {
  enum { WIDE = 6, DEEP = 72, COUNT = WIDE * WIDE * DEEP, STEPS = 20 };
  const double half = 0.5 * spacing * WIDE, tall = 0.75 * spacing * DEEP, thick = 0.5;
  pbf_desc desc = test_desc(3, precision, COUNT);
  pbf_params params = column_params(0);
  pbf_collider boxes[4];
  void *x = calloc(COUNT, 3 * precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < COUNT; ++i) {
    uint32_t at[3] = {i % WIDE, i / WIDE / WIDE, i / WIDE % WIDE};
    for (uint32_t k = 0; k < 3; ++k)
      test_put(x, (uint64_t)i * 3 + k, precision, spacing * (at[k] + 0.5));
  }
  for (int k = 0; k < 3; ++k) {
    params.domain_min[k] = k == 1 ? 0 : -20;
    params.domain_max[k] = 20;
  }
  for (int b = 0; b < 4; ++b) {
    int across = b < 2 ? 0 : 2;
    assert_ok(pbf_collider_init(&boxes[b], sizeof *boxes, PBF_COLLIDER_BOX));
    boxes[b].position[0] = boxes[b].position[2] = half;
    boxes[b].half_extents[0] = boxes[b].half_extents[2] = half + 2 * thick;
    boxes[b].position[across] += (b % 2 ? 1 : -1) * (half + thick);
    boxes[b].half_extents[across] = thick;
    boxes[b].position[1] = boxes[b].half_extents[1] = tall;
  }
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, 4, boxes));
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  free(x);
  const double start = 0.5 * gravity * spacing * DEEP;
  for (int k = 0; k < 5; ++k) {
    assert_ok(pbf_step(s, STEPS));
    pbf_stats stats = stats_of(s);
    double energy = stats.kinetic_energy + gravity * stats.center_of_mass[1];
    if (!(energy <= 1.01 * start))
      fail_msg("%g of the energy after %d steps", energy / start, (k + 1) * STEPS);
  }
  pbf_destroy(s);
}

static void pools_of_boxes_gain_no_energy(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  check_pool(PBF_FLOAT32);
  check_pool(PBF_FLOAT64);
}

/* Where a ball leaves no room, the grid has nothing to say, not even of a crowd. With a correction
 * of shear stress neither smooths its pressure. */
static pbf_stats in_a_ball(uint32_t dimension, uint32_t precision, double grid) {
  pbf_desc desc = test_desc(dimension, precision, 6 * 6 * 3);
  pbf_params params = column_params(grid);
  pbf_collider ball;
  params.domain_max[0] = params.domain_max[1] = params.domain_max[2] = 1;
  params.shear_stress_correction = 0.75;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 3;
  pbf_solver *s = block(&desc, &params, 6, 6, 0, 0, 0.01);
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, 3));
  pbf_stats stats = stats_of(s);
  pbf_destroy(s);
  return stats;
}

static void check_no_room(uint32_t dimension, uint32_t precision) {
  pbf_stats with = in_a_ball(dimension, precision, 2.5);
  pbf_stats without = in_a_ball(dimension, precision, 0);
  /* A device may run a step with a grid in other kernels than one without, which sum elsewhere. */
  const double rounding = strcmp(test_backend(), "cuda") != 0 ? 0
                          : precision == PBF_FLOAT32          ? 1e-5
                                                              : 1e-13;
  for (uint32_t k = 0; k < dimension; ++k)
    assert_true(fabs(with.center_of_mass[k] - without.center_of_mass[k]) <= rounding);
  assert_true(with.speed_max <= 2 * without.speed_max);
}

static void where_there_is_no_room(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_no_room);
}

/* Who sleeps carries the grid's pressure on. */
static void it_sleeps(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_desc desc = test_desc(3, PBF_FLOAT32, MOST);
  pbf_params params = column_params(2);
  params.sleep_speed = 0.1 * sqrt(gravity * spacing);
  params.sleep_time = 0.25;
  pbf_solver *s = block(&desc, &params, COLUMNS, LAYERS, 0, 0, 1);
  for (int k = 0; k < 20 && stats_of(s).asleep < stats_of(s).count; ++k) assert_ok(pbf_step(s, 30));
  assert_int_equal(stats_of(s).asleep, stats_of(s).count);
  assert_true(fabs(lost_height(s)) < 0.01);
  /* What the iterations carry of it, a quarter, is that of single steps. */
  double error = pressure_error(s, 3, PBF_FLOAT32);
  if (!(error < 0.15)) fail_msg("asleep the pressure is %g off", error);
  static float before[MOST][3], after[MOST][3], pressures[2][MOST];
  assert_ok(pbf_get_positions(s, 0, MOST, before));
  assert_ok(pbf_get_pressures(s, 0, MOST, pressures[0]));
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_get_positions(s, 0, MOST, after));
  assert_ok(pbf_get_pressures(s, 0, MOST, pressures[1]));
  assert_memory_equal(before, after, sizeof before);
  assert_memory_equal(pressures[0], pressures[1], sizeof pressures[0]);
  pbf_destroy(s);
}

/* A column that breaks in a room three times as wide. */
static pbf_solver *breaking_column(const char *backend, int in_a_bottle) {
  pbf_desc desc = test_desc(2, PBF_FLOAT64, MOST);
  pbf_params params = column_params(2), wide;
  if (backend) desc.backend = backend;
  params.domain_max[0] *= 3;
  pbf_collider box = bottle(&params, &wide);
  box.angular_velocity[2] = 0.1;
  pbf_solver *s = block(&desc, in_a_bottle ? &wide : &params, COLUMNS, LAYERS, spacing, spacing, 1);
  if (in_a_bottle) assert_ok(pbf_set_colliders(s, 1, &box));
  return s;
}

/* As long as rounding has not grown. */
static void compare_with_reference(int in_a_bottle) {
  pbf_solver *expected = breaking_column("reference", in_a_bottle);
  pbf_solver *s = breaking_column(NULL, in_a_bottle);
  assert_ok(pbf_step(s, 10));
  assert_ok(pbf_step(expected, 10));
  enum { COUNT = LAYERS * COLUMNS };
  double x[COUNT][2], y[COUNT][2], p[COUNT], q[COUNT];
  assert_ok(pbf_get_positions(s, 0, COUNT, x));
  assert_ok(pbf_get_positions(expected, 0, COUNT, y));
  assert_ok(pbf_get_pressures(s, 0, COUNT, p));
  assert_ok(pbf_get_pressures(expected, 0, COUNT, q));
  for (int i = 0; i < COUNT; ++i) {
    for (int k = 0; k < 2; ++k)
      if (!(fabs(x[i][k] - y[i][k]) < 1e-6))
        fail_msg("particle %d is %g off the reference", i, fabs(x[i][k] - y[i][k]));
    if (!(fabs(p[i] - q[i]) < 1e-3)) fail_msg("pressure %d: %g, %g", i, p[i], q[i]);
  }
  pbf_destroy(s);
  pbf_destroy(expected);
}

static void as_the_reference(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  if (!test_has_reference(2, PBF_FLOAT64)) test_skip("there is no reference to ask");
  compare_with_reference(0);
  compare_with_reference(1);
}

int main(void) {
  const struct CMUnitTest deep[] = {
      cmocka_unit_test(a_column_stands),
      cmocka_unit_test(what_is_squeezed_comes_back),
      cmocka_unit_test(what_falls_is_left_alone),
      cmocka_unit_test(threads_agree),
      cmocka_unit_test(threads_agree_on_a_large_grid),
      cmocka_unit_test(switched_on_and_off),
      cmocka_unit_test(water_rests_around_a_ball),
      cmocka_unit_test(water_rests_around_a_lowered_ball),
      cmocka_unit_test(short_steps_hold_deep_water),
      cmocka_unit_test(pools_of_boxes_gain_no_energy),
      cmocka_unit_test(where_there_is_no_room),
      cmocka_unit_test(it_sleeps),
      cmocka_unit_test(as_the_reference),
      cmocka_unit_test(disorder_settles),
      cmocka_unit_test(long_steps_do_not_stir),
      cmocka_unit_test(pressures_outlive_the_grid),
  };
  return TEST_RUN(deep);
}
