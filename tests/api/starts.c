/* Starts that are too dense: moved to rest density before their first step, so that no step throws
 * them, and only they. */
#include "support.h"

#include <math.h>

enum { LAYERS = 10, WIDE = 6 };

static const double spacing = 0.05, gravity = 9.81;

/* A box that is WIDE and three times as high as LAYERS. */
static pbf_params box_params(uint32_t dimension) {
  pbf_params params = test_params();
  params.time_step = 0.0025;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = spacing * WIDE;
  params.domain_max[1] = spacing * 3 * LAYERS;
  if (dimension == 2) params.domain_max[0] *= 2;
  return params;
}

static uint32_t count_in(uint32_t dimension) {
  return dimension == 3 ? LAYERS * WIDE * WIDE : LAYERS * 2 * WIDE;
}

/* As many positions as `dense` times as many layers have places, anywhere in LAYERS / dense. */
static void *anywhere(uint32_t dimension, uint32_t precision, const pbf_params *params,
                      double dense) {
  uint32_t count = count_in(dimension), seed = 7;
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint64_t i = 0; i < (uint64_t)count * dimension; ++i) {
    seed = seed * 1664525u + 1013904223u;
    double side = i % dimension == 1 ? spacing * LAYERS / dense : params->domain_max[i % dimension];
    test_put(x, i, precision, side * (0.001 + 0.998 * seed / 4294967296.0));
  }
  return x;
}

static void *lattice(uint32_t dimension, uint32_t precision) {
  uint32_t count = count_in(dimension), wide = dimension == 3 ? WIDE : 2 * WIDE;
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % wide, i / wide % LAYERS, i / wide / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, spacing * (at[k] + 0.5));
  }
  return x;
}

static pbf_solver *solver_with(uint32_t dimension, uint32_t precision, const pbf_params *params,
                               const void *x, const void *v) {
  pbf_desc desc = test_desc(dimension, precision, 2 * count_in(dimension));
  pbf_solver *s = test_create(&desc, params);
  assert_ok(pbf_add_particles(s, count_in(dimension), x, v, NULL));
  return s;
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

/* Kinetic energy a particle, over g d. */
static double kinetic(pbf_solver *s) { return stats_of(s).kinetic_energy / (gravity * spacing); }

/* The most of it in the next steps. */
static double most_kinetic(pbf_solver *s, int steps) {
  double most = 0;
  for (int k = 0; k < steps; ++k) {
    assert_ok(pbf_step(s, 1));
    most = fmax(most, kinetic(s));
  }
  return most;
}

/* Its particles have next to nowhere to fall: what is not thrown moves by less than two spacings.
 */
static void expect_calm(const char *what, uint32_t dimension, pbf_solver *s) {
  double most = most_kinetic(s, 40);
  if (!(most < 2)) fail_msg("%s, %uD: thrown at %g g d", what, dimension, most);
}

static void check_random(uint32_t dimension, uint32_t precision) {
  const double dense[] = {1, 1.5, 2.5, 1.5};
  for (int k = 0; k < 4; ++k) {
    pbf_params params = box_params(dimension);
    if (k == 3) params.time_step = 0.0002; /* in which a step undoes a share of an error only */
    void *x = anywhere(dimension, precision, &params, dense[k]);
    pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
    expect_calm("a start at random", dimension, s);
    assert_true(stats_of(s).density_error_mean < params.prestabilization);
    free(x);
    pbf_destroy(s);
  }
}

static void random_starts_are_calm(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_random);
}

static void check_unasked(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = anywhere(dimension, precision, &params, 1.5);
  for (int jacobi = 0; jacobi < 2; ++jacobi) {
    params.prestabilization = jacobi ? 0.02 : 0;
    params.solver = jacobi ? PBF_SOLVER_JACOBI : PBF_SOLVER_CHEBYSHEV;
    pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
    assert_true(most_kinetic(s, 10) > 10);
    pbf_destroy(s);
  }
  free(x);
}

static void nothing_is_done_unasked(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_unasked);
}

/* Thrown along x without gravity, a start keeps its velocity to the rest that its steps undo, its
 * momentum as steps do, and its centre flies on from where it was. */
static void check_velocities(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  uint32_t count = count_in(dimension);
  void *x = anywhere(dimension, precision, &params, 1.5), *v = calloc(count * 3, precision);
  assert_non_null(v);
  for (uint32_t i = 0; i < count; ++i) test_put(v, (uint64_t)i * dimension, precision, 4);
  params.gravity[1] = 0;
  for (int k = 0; k < 3; ++k) { /* no wall near */
    params.domain_min[k] = -4;
    params.domain_max[k] += 4;
  }
  pbf_solver *s = solver_with(dimension, precision, &params, x, v);
  pbf_stats before = stats_of(s);
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_step(s, 1));
  pbf_stats after = stats_of(s);
  assert_ok(pbf_get_info(s, &info));
  assert_int_equal(info.step, 1);
  assert_true(info.time == params.time_step);
  assert_true(fabs(after.momentum[0] - 4) < 1e-4 && fabs(after.momentum[1]) < 1e-4);
  assert_true(fabs(after.kinetic_energy - 8) < 0.1);
  assert_true(fabs(after.center_of_mass[0] - before.center_of_mass[0] - 4 * params.time_step) <
              1e-4 * spacing);
  assert_true(after.density_error_mean < 0.01 && before.density_error_mean > 0.3);
  pbf_destroy(s);
  free(x);
  free(v);
}

static void velocities_and_time_stay(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_velocities);
}

static void check_lattice(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = lattice(dimension, precision);
  pbf_solver *a = solver_with(dimension, precision, &params, x, NULL);
  params.prestabilization = 0;
  pbf_solver *b = solver_with(dimension, precision, &params, x, NULL);
  assert_ok(pbf_step(a, 3));
  assert_ok(pbf_step(b, 3));
  assert_int_equal(test_hash(a), test_hash(b));
  free(x);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void good_starts_are_left_alone(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_lattice);
}

static void check_changes(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = lattice(dimension, precision);
  pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
  assert_ok(pbf_step(s, 40));
  params.particle_volume = pow(spacing, dimension) * 1.3;
  assert_ok(pbf_set_params(s, &params));
  expect_calm("a third more volume", dimension, s);
  params.particle_volume = 0;
  params.smoothing_radius = 2.3 * spacing;
  params.spacing = spacing * 1.1;
  assert_ok(pbf_set_params(s, &params));
  expect_calm("another spacing", dimension, s);
  free(x);
  x = anywhere(dimension, precision, &params, 1);
  assert_ok(pbf_set_positions(s, 0, count_in(dimension), x));
  expect_calm("other places", dimension, s);
  free(x);
  pbf_destroy(s);
}

static void changes_make_starts(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_changes);
}

/* The largest way of a particle in a step that is not its velocity times the step, in spacings. */
static double way_without_velocity(pbf_solver *s, uint32_t dimension, uint32_t precision,
                                   double time_step) {
  uint32_t count;
  double most = 0;
  assert_ok(pbf_get_count(s, &count));
  uint64_t values = (uint64_t)count * dimension;
  void *x = calloc(values, precision), *y = calloc(values, precision),
       *v = calloc(values, precision);
  assert_true(x && y && v);
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_positions(s, 0, count, y));
  assert_ok(pbf_get_velocities(s, 0, count, v));
  for (uint64_t i = 0; i < values; ++i) {
    double way = test_value(y, i, precision) - test_value(x, i, precision);
    most = fmax(most, fabs(way - test_value(v, i, precision) * time_step));
  }
  free(x);
  free(y);
  free(v);
  return most / spacing;
}

/* The kinetic energy after a step, of a tank whose wall has been set `in` farther in. */
static double squeezed(uint32_t dimension, uint32_t precision, pbf_params params, double in,
                       uint64_t *hash) {
  const double prestabilization = params.prestabilization;
  void *x = lattice(dimension, precision);
  params.prestabilization = 0.02;
  pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
  assert_ok(pbf_step(s, 40));
  params.domain_max[0] -= in;
  if (dimension == 2) params.domain_max[2] /= 2; /* which is ignored */
  params.prestabilization = prestabilization;
  assert_ok(pbf_set_params(s, &params));
  double most = most_kinetic(s, 1);
  *hash = test_hash(s);
  double hidden = way_without_velocity(s, dimension, precision, params.time_step);
  if (!(hidden < 1e-4)) fail_msg("%uD: %g spacings without a velocity", dimension, hidden);
  pbf_destroy(s);
  free(x);
  return most;
}

/* A box made half as wide at once, whether or not its walls lend density to whom they have passed.
 * Of a wall set not quite half an h farther in, steps take care. */
static void check_walls(uint32_t dimension, uint32_t precision) {
  pbf_params on = box_params(dimension), off = on;
  const double half = on.domain_max[0] / 2, little = 0.9 * spacing;
  uint64_t hash[2];
  off.prestabilization = 0;
  for (int k = 0; k < 2; ++k, on.wall_density = off.wall_density = 0) {
    double thrown = squeezed(dimension, precision, off, half, &hash[0]);
    double moved = squeezed(dimension, precision, on, half, &hash[1]);
    if (!(thrown > 100 && moved < 4))
      fail_msg("a narrower box, %uD: thrown at %g g d, and %g", dimension, thrown, moved);
    squeezed(dimension, precision, off, little, &hash[0]);
    squeezed(dimension, precision, on, little, &hash[1]);
    assert_int_equal(hash[0], hash[1]);
  }
}

static void walls_that_jump_throw_nobody(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_walls);
}

/* A tank at rest, and into it a quarter of its particles where others are: at once, one by one, and
 * a state saved between. */
static pbf_solver *tank_with_newcomers(uint32_t dimension, uint32_t precision, const void *x,
                                       uint32_t at_once) {
  pbf_params params = box_params(dimension);
  void *start = lattice(dimension, precision);
  pbf_solver *s = solver_with(dimension, precision, &params, start, NULL);
  assert_ok(pbf_step(s, 20));
  for (uint32_t i = 0; i < count_in(dimension) / 4; i += at_once) {
    const char *from = (const char *)x + (size_t)i * dimension * precision;
    assert_ok(pbf_add_particles(s, at_once, from, NULL, NULL));
  }
  free(start);
  return s;
}

static void check_newcomers(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = anywhere(dimension, precision, &params, 1);
  pbf_solver *s = tank_with_newcomers(dimension, precision, x, count_in(dimension) / 4);
  pbf_solver *one_by_one = tank_with_newcomers(dimension, precision, x, 1);
  pbf_solver *saved = test_solver(dimension, precision, 2 * count_in(dimension));
  uint64_t size;
  void *state = test_save(one_by_one, &size);
  assert_ok(pbf_load(saved, state, size));
  expect_calm("newcomers", dimension, s);
  expect_calm("newcomers, one by one", dimension, one_by_one);
  expect_calm("newcomers, saved", dimension, saved);
  assert_int_equal(test_hash(s), test_hash(one_by_one));
  assert_int_equal(test_hash(s), test_hash(saved));
  free(state);
  free(x);
  pbf_destroy(s);
  pbf_destroy(one_by_one);
  pbf_destroy(saved);
}

static void newcomers_are_calm(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_newcomers);
}

/* A tank that runs, and into it a quarter of its particles where others are, at once or one by one:
 * what moves does so by its velocity. */
static void check_velocities_of_newcomers(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *start = lattice(dimension, precision), *x = anywhere(dimension, precision, &params, 1);
  for (uint32_t at_once = 1; at_once < count_in(dimension); at_once *= count_in(dimension) / 4) {
    pbf_solver *s = solver_with(dimension, precision, &params, start, NULL);
    assert_ok(pbf_step(s, 20));
    for (uint32_t i = 0; i < count_in(dimension) / 4; i += at_once) {
      const char *from = (const char *)x + (size_t)i * dimension * precision;
      assert_ok(pbf_add_particles(s, at_once, from, NULL, NULL));
    }
    double hidden = way_without_velocity(s, dimension, precision, params.time_step);
    if (!(hidden < 1e-4)) fail_msg("%uD: %g spacings without a velocity", dimension, hidden);
    pbf_destroy(s);
  }
  free(start);
  free(x);
}

static void newcomers_move_by_their_velocities(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_velocities_of_newcomers);
}

/* What comes to no fluid is a start, though others were there before. */
static void check_refilled(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = anywhere(dimension, precision, &params, 1.5);
  uint32_t count = count_in(dimension), *ids = calloc(count, sizeof *ids);
  assert_non_null(ids);
  pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
  assert_ok(pbf_step(s, 2));
  for (uint32_t i = 0; i < count; ++i) ids[i] = i;
  assert_ok(pbf_remove_particles(s, count, ids));
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  expect_calm("a tank that is filled again", dimension, s);
  free(ids);
  free(x);
  pbf_destroy(s);
}

static void what_is_filled_again_is_a_start(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_refilled);
}

/* Domain, particles and a collider are shifted by whole lengths, which rounds nothing. Physics does
 * not know where the origin is: all move on as without, to rounding, and so they do when a state is
 * saved half-way, or some particles change their places meanwhile. */
static void shift_world(pbf_solver **s, uint32_t dimension, uint32_t precision, double by,
                        int saves) {
  pbf_collider ball = {.struct_size = sizeof ball};
  pbf_params params = {.struct_size = sizeof params};
  uint64_t values = (uint64_t)count_in(dimension) * dimension, size;
  void *x = calloc(values, precision);
  assert_non_null(x);
  assert_ok(pbf_get_params(*s, &params));
  params.domain_max[0] += by;
  if (!saves) params.domain_min[0] += by;
  assert_ok(pbf_set_params(*s, &params));
  assert_ok(pbf_get_positions(*s, 0, count_in(dimension), x));
  for (uint64_t i = 0; i < values; i += dimension)
    test_put(x, i, precision, test_value(x, i, precision) + by);
  assert_ok(pbf_set_positions(*s, 0, count_in(dimension), x));
  free(x);
  if (saves) { /* and the lower wall comes after */
    void *saved = test_save(*s, &size);
    pbf_destroy(*s);
    *s = test_solver(dimension, precision, 2 * count_in(dimension));
    assert_ok(pbf_load(*s, saved, size));
    free(saved);
    params.domain_min[0] += by;
    assert_ok(pbf_set_params(*s, &params));
  }
  assert_ok(pbf_get_collider(*s, 0, &ball));
  ball.position[0] += by;
  assert_ok(pbf_set_colliders(*s, 1, &ball));
}

static void check_origin(uint32_t dimension, uint32_t precision) {
  const double by = 2, rounding = precision == PBF_FLOAT32 ? 1e-3 : 1e-9;
  pbf_params params = box_params(dimension);
  pbf_collider ball;
  params.domain_max[0] *= 2; /* the dam breaks, around a ball */
  params.time_step = 1.0 / 120;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 3 * spacing;
  ball.velocity[1] = 0.1;
  for (uint32_t k = 0; k < dimension; ++k) ball.position[k] = 3 * spacing;
  uint32_t count = count_in(dimension);
  void *x = lattice(dimension, precision), *y = calloc((size_t)count * dimension, precision);
  assert_non_null(y);
  for (int saves = 0; saves < 2; ++saves) {
    params.prestabilization = saves ? 0.02 : 0;
    pbf_solver *stays = solver_with(dimension, precision, &params, x, NULL);
    pbf_solver *shifted = solver_with(dimension, precision, &params, x, NULL);
    for (int k = 0; k < 2; ++k) assert_ok(pbf_set_colliders(k ? stays : shifted, 1, &ball));
    assert_ok(pbf_step(stays, 20));
    assert_ok(pbf_step(shifted, 20));
    shift_world(&shifted, dimension, precision, by, saves);
    assert_ok(pbf_step(stays, 1));
    assert_ok(pbf_step(shifted, 1));
    void *z = calloc((size_t)count * dimension, precision);
    assert_non_null(z);
    assert_ok(pbf_get_positions(stays, 0, count, y));
    assert_ok(pbf_get_positions(shifted, 0, count, z));
    double most = 0;
    for (uint64_t i = 0; i < (uint64_t)count * dimension; ++i) {
      double right = test_value(y, i, precision) + (i % dimension == 0 ? by : 0);
      most = fmax(most, fabs(test_value(z, i, precision) - right) / spacing);
    }
    if (!(most < rounding)) fail_msg("%uD: %g spacings off", dimension, most);
    free(z);
    pbf_destroy(stays);
    pbf_destroy(shifted);
  }
  free(x);
  free(y);
}

static void the_origin_may_move(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_origin);
}

/* All are set where they are, but for a tenth of them, which come where others are. */
static void check_some_set(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  uint32_t count = count_in(dimension);
  void *x = lattice(dimension, precision);
  pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
  assert_ok(pbf_step(s, 20));
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t i = 0; i < count; i += 10)
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, spacing * (2 + 0.01 * (i % 64 + k)));
  assert_ok(pbf_set_positions(s, 0, count, x));
  double hidden = way_without_velocity(s, dimension, precision, params.time_step);
  if (!(hidden < 1e-4)) fail_msg("%uD: %g spacings without a velocity", dimension, hidden);
  free(x);
  pbf_destroy(s);
}

static void some_that_are_set_are_no_start(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_some_set);
}

/* Some in one place of a tank, which its mean error does not tell. */
static void check_some(uint32_t dimension, uint32_t precision) {
  enum { SOME = 6 };
  pbf_params params = box_params(dimension);
  params.prestabilization = 0.07;
  void *x = lattice(dimension, precision), *v = calloc(SOME * 3, precision);
  assert_non_null(v);
  pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
  for (uint32_t i = 0; i < SOME * dimension; ++i)
    test_put(v, i, precision, spacing * (3.5 + 0.01 * i));
  assert_ok(pbf_add_particles(s, SOME, v, NULL, NULL));
  pbf_stats before = stats_of(s);
  assert_true(before.density_error_mean < params.prestabilization);
  assert_true(before.density_error_max > 25 * params.prestabilization);
  double most = most_kinetic(s, 10);
  if (!(most < 2)) fail_msg("some in one place, %uD: thrown at %g g d", dimension, most);
  free(x);
  free(v);
  pbf_destroy(s);
}

static void some_in_one_place_are_calm(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  check_some(3, PBF_FLOAT32);
  if (test_has_kind(3, PBF_FLOAT64)) check_some(3, PBF_FLOAT64);
}

/* Fewer than a hundredth, step by step: what flows must not stop for them. */
static void check_few(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = lattice(dimension, precision);
  uint64_t hash[2];
  for (int k = 0; k < 2; ++k) {
    params.prestabilization = 0.02;
    pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
    assert_ok(pbf_step(s, 2));
    params.prestabilization = k ? 0.02 : 0;
    assert_ok(pbf_set_params(s, &params));
    for (int step = 0; step < 4; ++step) {
      assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
      assert_ok(pbf_step(s, 1));
      assert_ok(pbf_set_positions(s, 1, 1, x));
      assert_ok(pbf_step(s, 1));
    }
    hash[k] = test_hash(s);
    pbf_destroy(s);
  }
  assert_int_equal(hash[0], hash[1]);
  free(x);
}

static void few_are_no_start(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_few);
}

static void check_saved(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  void *x = anywhere(dimension, precision, &params, 1.5);
  pbf_solver *a = solver_with(dimension, precision, &params, x, NULL);
  pbf_solver *b = test_solver(dimension, precision, 2 * count_in(dimension));
  for (int k = 0; k < 2; ++k) { /* before the first step, and in what follows */
    uint64_t size;
    void *saved = test_save(a, &size);
    assert_ok(pbf_load(b, saved, size));
    assert_ok(pbf_step(a, 4));
    assert_ok(pbf_step(b, 4));
    assert_int_equal(test_hash(a), test_hash(b));
    free(saved);
  }
  free(x);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void saved_starts_are_starts(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_saved);
}

/* Fluid that fills the places of a ball, and a wall that moves. */
static void check_obstacles(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  pbf_collider ball;
  params.wall_velocity[PBF_WALL_X_MIN] = 0.5;
  void *x = anywhere(dimension, precision, &params, 1);
  pbf_solver *s = solver_with(dimension, precision, &params, x, NULL);
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 2 * spacing;
  for (uint32_t k = 0; k < dimension; ++k) ball.position[k] = 4 * spacing;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_positions(s, 0, count_in(dimension), x));
  for (uint32_t i = 0; i < count_in(dimension); ++i) {
    double r2 = 0;
    for (uint32_t k = 0; k < dimension; ++k)
      r2 += pow(test_value(x, (uint64_t)i * dimension + k, precision) - ball.position[k], 2);
    assert_true(sqrt(r2) > ball.radius * (1 - 1e-5));
    assert_true(test_value(x, (uint64_t)i * dimension, precision) > 0.5 * params.time_step - 1e-6);
  }
  expect_calm("a start around a ball", dimension, s);
  free(x);
  pbf_destroy(s);
}

static void starts_keep_out_of_obstacles(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_obstacles);
}

static void count_sentences(void *user, int32_t level, const char *message) {
  if (level == PBF_LOG_WARNING && strstr(message, "too little room")) ++*(int *)user;
}

static uint64_t generation_of(pbf_solver *s) {
  pbf_view view = {.struct_size = sizeof view};
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_ok(pbf_unmap(s, PBF_FIELD_POSITION));
  return view.generation;
}

/* Twice the fluid that the box has room for: that is found out soon, which the count of changes
 * tells, and said once; the step goes on with it. */
static void check_overfull(uint32_t dimension, uint32_t precision) {
  pbf_params params = box_params(dimension);
  pbf_desc desc = test_desc(dimension, precision, count_in(dimension));
  int sentences = 0;
  desc.log = count_sentences;
  desc.log_user = &sentences;
  params.domain_max[1] = spacing * LAYERS / 2;
  void *x = anywhere(dimension, precision, &params, 2);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, count_in(dimension), x, NULL, NULL));
  uint64_t before = generation_of(s);
  assert_ok(pbf_step(s, 1));
  assert_true(generation_of(s) - before < 150);
  assert_ok(pbf_step(s, 1));
  assert_int_equal(sentences, 1);
  assert_true(stats_of(s).density_error_mean > 0.5);
  free(x);
  pbf_destroy(s);
}

static void too_much_fluid_is_said(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_overfull);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_starts_are_calm),
      cmocka_unit_test(nothing_is_done_unasked),
      cmocka_unit_test(velocities_and_time_stay),
      cmocka_unit_test(good_starts_are_left_alone),
      cmocka_unit_test(changes_make_starts),
      cmocka_unit_test(newcomers_are_calm),
      cmocka_unit_test(newcomers_move_by_their_velocities),
      cmocka_unit_test(what_is_filled_again_is_a_start),
      cmocka_unit_test(the_origin_may_move),
      cmocka_unit_test(some_that_are_set_are_no_start),
      cmocka_unit_test(some_in_one_place_are_calm),
      cmocka_unit_test(walls_that_jump_throw_nobody),
      cmocka_unit_test(few_are_no_start),
      cmocka_unit_test(saved_starts_are_starts),
      cmocka_unit_test(starts_keep_out_of_obstacles),
      cmocka_unit_test(too_much_fluid_is_said),
  };
  return TEST_RUN(tests);
}
