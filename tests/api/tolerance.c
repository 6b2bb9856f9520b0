/* The density solve ends when its error is small enough, and not before. */
#include "support.h"

enum { MOST = 16, COLUMNS = 10, LAYERS = 10 };

static pbf_params box_params(double tolerance) {
  pbf_params params = test_params();
  params.iterations = MOST;
  params.tolerance = tolerance;
  params.domain_max[0] = 0.05 * COLUMNS;
  params.domain_max[1] = 0.05 * (LAYERS + 4);
  params.domain_max[2] = 0.05 * 4;
  return params;
}

/* A tank of fluid on its lattice, scaled by `squeeze` from the floor's corner on. */
static pbf_solver *tank(const pbf_desc *desc, const pbf_params *params, double squeeze) {
  uint32_t deep = desc->dimension == 3 ? 4 : 1, count = COLUMNS * LAYERS * deep;
  pbf_solver *s = test_create(desc, params);
  void *x = calloc((size_t)count * desc->dimension, desc->precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % COLUMNS, i / COLUMNS % LAYERS, i / COLUMNS / LAYERS};
    for (uint32_t k = 0; k < desc->dimension; ++k)
      test_put(x, (uint64_t)i * desc->dimension + k, desc->precision,
               squeeze * 0.05 * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

static pbf_solver *tank_of(uint32_t dimension, uint32_t precision, double tolerance,
                           double squeeze) {
  pbf_desc desc = test_desc(dimension, precision, COLUMNS * LAYERS * 4);
  pbf_params params = box_params(tolerance);
  return tank(&desc, &params, squeeze);
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

/* What is left of the error after a step that ended early: the iteration that found it small enough
 * made it smaller still, or hardly larger. */
static void check_rest(uint32_t dimension, uint32_t precision) {
  const double tolerance = 1e-3;
  uint32_t fewest = MOST;
  pbf_solver *s = tank_of(dimension, precision, tolerance, 1);
  for (int k = 0; k < 40; ++k) {
    assert_ok(pbf_step(s, 1));
    pbf_stats stats = stats_of(s);
    assert_in_range(stats.iterations, 1, MOST);
    if (stats.iterations < fewest) fewest = stats.iterations;
    if (stats.iterations < MOST && !(stats.density_error_mean < 1.5 * tolerance))
      fail_msg("%uD: %u iterations leave %g", dimension, stats.iterations,
               stats.density_error_mean);
  }
  if (fewest == MOST) fail_msg("%uD: never fewer than %u iterations", dimension, fewest);
  pbf_destroy(s);
}

static void a_fluid_at_rest_ends_early(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_rest);
}

/* On a device a watched solve takes another path, whose sums are in another order. */
static int bits_stay(void) { return strcmp(test_backend(), "cuda") != 0; }

/* A quarter of its volume gone: no number of iterations will do. */
static void check_squeezed(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank_of(dimension, precision, 1e-6, 0.9);
  pbf_solver *fixed = tank_of(dimension, precision, 0, 0.9);
  for (int k = 0; k < 3; ++k) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_step(fixed, 1));
    assert_int_equal(stats_of(s).iterations, MOST);
    assert_int_equal(stats_of(fixed).iterations, MOST);
  }
  if (bits_stay()) assert_true(test_hash(s) == test_hash(fixed));
  pbf_destroy(s);
  pbf_destroy(fixed);
}

static void a_squeezed_one_takes_all(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_squeezed);
}

/* An error that any fluid has within the tolerance: one iteration a step, as if there were no more,
 * but for the weights of Chebyshev, of which the first is 1. */
static void check_one(uint32_t dimension, uint32_t precision, uint32_t solver, uint32_t most) {
  pbf_desc desc = test_desc(dimension, precision, COLUMNS * LAYERS * 4);
  pbf_params params = box_params(100);
  params.solver = solver;
  params.iterations = most;
  params.collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_AFTER_SOLVE;
  pbf_solver *s = tank(&desc, &params, 0.95);
  params.tolerance = 0;
  params.iterations = 1;
  pbf_solver *one = tank(&desc, &params, 0.95);
  assert_ok(pbf_step(s, 4));
  assert_ok(pbf_step(one, 4));
  assert_int_equal(stats_of(s).iterations, 1);
  if (solver == PBF_SOLVER_JACOBI && bits_stay()) assert_true(test_hash(s) == test_hash(one));
  pbf_destroy(s);
  pbf_destroy(one);
}

static void check_ones(uint32_t dimension, uint32_t precision) {
  for (uint32_t most = 1; most <= 4; ++most) {
    check_one(dimension, precision, PBF_SOLVER_JACOBI, most);
    check_one(dimension, precision, PBF_SOLVER_CHEBYSHEV, most);
  }
}

static void an_easy_tolerance_takes_one(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_ones);
}

/* The same iterations and bits whatever the number of threads, and in every run. */
static void threads_agree(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  uint64_t hash = 0;
  uint32_t iterations = 0;
  for (uint32_t threads = 1; threads <= 3; ++threads) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, COLUMNS * LAYERS * 4);
    pbf_params params = box_params(2e-3);
    desc.threads = threads;
    pbf_solver *s = tank(&desc, &params, 0.99);
    uint32_t sum = 0;
    for (int k = 0; k < 20; ++k) {
      assert_ok(pbf_step(s, 1 + k % 3));
      sum += stats_of(s).iterations;
    }
    if (threads == 1) hash = test_hash(s), iterations = sum;
    assert_true(test_hash(s) == hash);
    assert_int_equal(sum, iterations);
    assert_true(sum < 20 * MOST);
    pbf_destroy(s);
  }
}

/* Both ends of one step give the pressure and density of where the fluid is. */
static void switched_on_and_off(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_solver *s = tank_of(3, PBF_FLOAT32, 0, 1), *plain = tank_of(3, PBF_FLOAT32, 0, 1);
  pbf_params on = box_params(1e-3), off = box_params(0);
  assert_ok(pbf_set_params(s, &on));
  assert_ok(pbf_set_params(s, &off));
  assert_ok(pbf_step(s, 5));
  assert_ok(pbf_step(plain, 5));
  assert_true(test_hash(s) == test_hash(plain));
  assert_ok(pbf_set_params(s, &on));
  assert_ok(pbf_step(s, 5));
  assert_true(stats_of(s).iterations < MOST);
  assert_ok(pbf_set_params(s, &off));
  assert_ok(pbf_step(s, 1));
  assert_int_equal(stats_of(s).iterations, MOST);
  pbf_destroy(s);
  pbf_destroy(plain);
}

/* Stages that were left empty did not run. */
static void only_what_ran_is_counted(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  if (!bits_stay()) test_skip("a device times launches, empty ones as well");
  pbf_solver *s = tank_of(3, PBF_FLOAT32, 2e-3, 0.99);
  pbf_timings timings = {.struct_size = sizeof timings};
  assert_ok(pbf_step(s, 3));
  pbf_status status = pbf_set_timing(s, 1);
  if (status == PBF_ERROR_UNSUPPORTED) test_skip(pbf_last_error());
  assert_ok(status);
  uint32_t iterations = 0;
  for (int k = 0; k < 10; ++k) {
    assert_ok(pbf_step(s, 1));
    iterations += stats_of(s).iterations;
  }
  assert_true(iterations < 10 * MOST);
  assert_ok(pbf_get_timings(s, &timings));
  uint32_t found = 0;
  for (uint32_t k = 0; k < timings.stage_count; ++k) {
    const pbf_stage_time *stage = &timings.stages[k];
    if (strcmp(stage->name, "lambda") != 0 && strcmp(stage->name, "move") != 0) continue;
    assert_int_equal(stage->runs, iterations);
    ++found;
  }
  assert_int_equal(found, 2);
  pbf_destroy(s);
}

static pbf_solver *reference_tank(double tolerance, double squeeze) {
  pbf_desc desc = test_desc(2, PBF_FLOAT64, COLUMNS * LAYERS * 4);
  pbf_params params = box_params(tolerance);
  desc.backend = "reference";
  pbf_solver *s = NULL;
  pbf_backend_info info = {.struct_size = sizeof info};
  for (uint32_t i = 0; pbf_get_backend_info(&desc, i, &info) == PBF_OK; ++i)
    if (strcmp(info.name, "reference") == 0 && info.available) s = tank(&desc, &params, squeeze);
  return s;
}

/* As long as rounding has not grown. */
static void as_many_as_reference(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_solver *expected = reference_tank(5e-4, 0.98);
  if (!expected) test_skip("there is no reference to ask");
  pbf_solver *s = tank_of(2, PBF_FLOAT64, 5e-4, 0.98);
  for (int k = 0; k < 4; ++k) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_step(expected, 1));
    assert_int_equal(stats_of(s).iterations, stats_of(expected).iterations);
  }
  pbf_destroy(s);
  pbf_destroy(expected);
}

int main(void) {
  const struct CMUnitTest tolerance[] = {
      cmocka_unit_test(a_fluid_at_rest_ends_early),  cmocka_unit_test(a_squeezed_one_takes_all),
      cmocka_unit_test(an_easy_tolerance_takes_one), cmocka_unit_test(threads_agree),
      cmocka_unit_test(switched_on_and_off),         cmocka_unit_test(as_many_as_reference),
      cmocka_unit_test(only_what_ran_is_counted),
  };
  return TEST_RUN(tolerance);
}
