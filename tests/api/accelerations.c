/* Accelerations that the caller gives to particles: one that all have is gravity, a central field
 * keeps a particle on its way around, and each stays with its particle. */
#include <pbf/phases.h>

#include "support.h"

#include <math.h>

static void put_rows(void *rows, uint32_t dimension, uint32_t precision, uint32_t row,
                     const double value[3]) {
  for (uint32_t k = 0; k < dimension; ++k)
    test_put(rows, (uint64_t)row * dimension + k, precision, value[k]);
}

/* Nothing but gravity and collisions. */
static pbf_params still_params(void) {
  pbf_params params = test_params();
  params.time_step = 0.01;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = -8;
    params.domain_max[k] = 8;
  }
  return params;
}

/* Particles out of each other's reach, at rest. */
static pbf_solver *apart(uint32_t dimension, uint32_t precision, uint32_t count) {
  const pbf_params params = still_params();
  const pbf_desc desc = test_desc(dimension, precision, count + 1);
  pbf_solver *solver = test_create(&desc, &params);
  char *x = calloc((size_t)count * dimension, precision);
  for (uint32_t i = 0; i < count; ++i)
    put_rows(x, dimension, precision, i, (const double[]){2 * (double)i - 3, 0, 0});
  assert_ok(pbf_add_particles(solver, count, x, NULL, NULL));
  free(x);
  return solver;
}

static double speed_along_y(pbf_solver *solver, uint32_t dimension, uint32_t precision,
                            uint32_t row) {
  double v[3];
  assert_ok(pbf_get_velocities(solver, row, 1, v));
  (void)dimension;
  return test_value(v, 1, precision);
}

/* ---- All alike ------------------------------------------------------------------------------ */

typedef struct fallen {
  uint64_t hash;
  double center[3];
} fallen;

/* A block that falls on the floor, by gravity or by an acceleration that all have. The longest
 * steps are divided as they are by gravity, and each part has its part of the acceleration. */
static fallen fall(uint32_t dimension, uint32_t precision, int by_gravity, uint32_t substeps,
                   uint32_t steps) {
  enum { SIDE = 6, MOST = SIDE * SIDE * SIDE };
  pbf_params params = test_params();
  const double g[3] = {0.5, -9.75, 0};
  const uint32_t count = dimension == 3 ? MOST : SIDE * SIDE;
  char *x = calloc((size_t)count * dimension, precision), *a = calloc((size_t)count * dimension, 8);
  params.solver = PBF_SOLVER_JACOBI;
  params.cohesion = params.pressure_grid = 0;
  params.max_depenetration_speed = 1;
  if (substeps > 0) params.time_step = 0.1;
  params.max_substeps = substeps;
  for (int k = 0; k < 3; ++k) params.gravity[k] = by_gravity ? g[k] : 0;
  for (uint32_t i = 0; i < count; ++i) {
    const double d = params.smoothing_radius / 2,
                 at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
    double place[3];
    for (int k = 0; k < 3; ++k) place[k] = params.domain_min[k] + d * (at[k] + 1);
    put_rows(x, dimension, precision, i, place);
    put_rows(a, dimension, precision, i, g);
  }
  const pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *solver = test_create(&desc, &params);
  assert_ok(pbf_add_particles(solver, count, x, NULL, NULL));
  /* A GPU has another way for few particles without accelerations, which rounds otherwise. */
  if (by_gravity) memset(a, 0, (size_t)count * dimension * precision);
  if (!by_gravity || strcmp(test_backend(), "cuda") == 0)
    assert_ok(pbf_set_accelerations(solver, 0, count, a));
  assert_ok(pbf_step(solver, steps));
  fallen end = {test_hash(solver), {0}};
  assert_ok(pbf_get_positions(solver, 0, count, x));
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < dimension; ++k)
      end.center[k] += test_value(x, (uint64_t)i * dimension + k, precision) / count;
  pbf_destroy(solver);
  free(x);
  free(a);
  return end;
}

static void check_same_fall(uint32_t dimension, uint32_t precision, uint32_t substeps) {
  const fallen by_gravity = fall(dimension, precision, 1, substeps, 40);
  const fallen by_all = fall(dimension, precision, 0, substeps, 40);
  for (uint32_t k = 0; k < dimension; ++k)
    if (!(fabs(by_gravity.center[k] - by_all.center[k]) < 1e-5))
      fail_msg("%uD, float%u, substeps %u: center[%u] is %.9g by gravity and %.9g by accelerations",
               dimension, 8 * precision, substeps, k, by_gravity.center[k], by_all.center[k]);
  assert_true(by_gravity.hash == by_all.hash);
}

static void check_gravity(uint32_t dimension, uint32_t precision) {
  check_same_fall(dimension, precision, 0);
  check_same_fall(dimension, precision, 8);
}

static void one_of_all_is_gravity(void **state) {
  (void)state;
  test_for_each_kind(check_gravity);
}

/* ---- A field of the caller's ---------------------------------------------------------------- */

/* Towards an axis, w² r: the particle goes around it, by the scheme's own recurrence. */
static void check_vortex(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 200 };
  const double w2 = 9, dt = still_params().time_step;
  double x[3] = {1, 0, 0.5}, v[3] = {0, 3, 0};
  char values[3 * sizeof(double)], a[3 * sizeof(double)];
  pbf_solver *solver = apart(dimension, precision, 1);
  put_rows(values, dimension, precision, 0, x);
  assert_ok(pbf_set_positions(solver, 0, 1, values));
  put_rows(values, dimension, precision, 0, v);
  assert_ok(pbf_set_velocities(solver, 0, 1, values));
  for (int step = 0; step < STEPS; ++step) {
    double pull[3] = {0, 0, 0};
    assert_ok(pbf_get_positions(solver, 0, 1, values));
    for (int k = 0; k < 2; ++k) pull[k] = -w2 * test_value(values, k, precision);
    put_rows(a, dimension, precision, 0, pull);
    assert_ok(pbf_set_accelerations(solver, 0, 1, a));
    assert_ok(pbf_step(solver, 1));
    for (int k = 0; k < 2; ++k) v[k] -= dt * w2 * x[k];
    for (int k = 0; k < 2; ++k) x[k] += dt * v[k];
  }
  assert_ok(pbf_get_positions(solver, 0, 1, values));
  const double accuracy = precision == PBF_FLOAT32 ? 2e-4 : 1e-11;
  for (uint32_t k = 0; k < dimension; ++k)
    if (!(fabs(test_value(values, k, precision) - x[k]) < accuracy))
      fail_msg("axis %u: %.9g, it must be %.9g", k, test_value(values, k, precision), x[k]);
  assert_true(fabs(hypot(x[0], x[1]) - 1) < 0.05);
  pbf_destroy(solver);
}

static void a_central_field_turns_a_particle(void **state) {
  (void)state;
  test_for_each_kind(check_vortex);
}

/* ---- Rows of particles that come and go ----------------------------------------------------- */

static double step_limit(pbf_solver *solver) {
  double limit;
  assert_ok(pbf_get_step_limit(solver, &limit));
  return limit;
}

static void check_rows(uint32_t dimension, uint32_t precision) {
  char a[4 * 3 * sizeof(double)] = {0};
  pbf_solver *solver = apart(dimension, precision, 4);
  for (uint32_t i = 0; i < 4; ++i)
    put_rows(a, dimension, precision, i, (const double[]){0, (double)i, 0});
  assert_ok(pbf_set_accelerations(solver, 1, 3, a + dimension * precision)); /* not row 0 */
  assert_ok(pbf_step(solver, 10));
  for (uint32_t i = 0; i < 4; ++i) {
    assert_true(fabs(speed_along_y(solver, dimension, precision, i) - 0.1 * i) < 1e-6);
  }
  const uint32_t removed[] = {1, 3};
  const double before = step_limit(solver);
  assert_ok(pbf_remove_particles(solver, 2, removed));
  assert_true(fabs(step_limit(solver) / before - sqrt(1.5)) <
              1e-6); /* by the largest, a dt² = d/2 */
  put_rows(a, dimension, precision, 0, (const double[]){-5, 0, 0});
  assert_ok(pbf_add_particles(solver, 1, a, NULL, NULL));
  assert_ok(pbf_step(solver, 10));
  const double right[3] = {0, 0.4, 0}; /* of ids 0, 2 and 4 */
  for (uint32_t i = 0; i < 3; ++i)
    assert_true(fabs(speed_along_y(solver, dimension, precision, i) - right[i]) < 1e-6);
  assert_ok(pbf_set_accelerations(solver, 0, 0, NULL));
  assert_ok(pbf_step(solver, 10));
  assert_true(fabs(speed_along_y(solver, dimension, precision, 1) - 0.4) < 1e-6);
  pbf_destroy(solver);
}

static void each_stays_with_its_particle(void **state) {
  (void)state;
  test_for_each_kind(check_rows);
}

/* ---- Bad input, memory, saved states -------------------------------------------------------- */

/* The library's, or the backend's. */
static int has_array(pbf_solver *solver) {
  pbf_plan plan = {.struct_size = sizeof plan};
  int has = 0;
  assert_ok(pbf_get_plan(solver, &plan));
  for (uint32_t k = 0; k < plan.array_count; ++k)
    has |= strstr(plan.arrays[k].name, "acceleration") != NULL;
  return has;
}

static void check_input(uint32_t dimension, uint32_t precision) {
  char a[2 * 3 * sizeof(double)] = {0};
  pbf_solver *solver = apart(dimension, precision, 2);
  uint64_t bytes;
  void *saved = test_save(solver, &bytes);
  assert_int_equal(has_array(solver), 0);
  assert_fails(pbf_set_accelerations(solver, 1, 2, a), PBF_ERROR_INVALID_ARGUMENT, "first is 1");
  assert_fails(pbf_set_accelerations(solver, 0, 2, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "null with 0 and 0 takes all");
  put_rows(a, dimension, precision, 1, (const double[]){0, NAN, 0});
  assert_fails(pbf_set_accelerations(solver, 0, 2, a), PBF_ERROR_INVALID_ARGUMENT, "accelerations");
  assert_int_equal(has_array(solver), 0);
  put_rows(a, dimension, precision, 1, (const double[]){0, 1, 0});
  assert_ok(pbf_set_accelerations(solver, 0, 2, a));
  assert_int_equal(has_array(solver), 1);
  assert_ok(pbf_load(solver, saved, bytes));
  assert_int_equal(has_array(solver), 0);
  assert_ok(pbf_step(solver, 1));
  assert_true(speed_along_y(solver, dimension, precision, 1) == 0);
  free(saved);
  pbf_destroy(solver);
}

/* With another fluid, for which a backend wants memory once it has the state's particles. */
static void *saved_with_phases(pbf_solver *solver, uint64_t *bytes) {
  pbf_phase phases[2];
  for (int k = 0; k < 2; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = 0.5;
  assert_ok(pbf_set_phases(solver, 2, phases));
  void *saved = test_save(solver, bytes);
  assert_ok(pbf_set_phases(solver, 0, NULL));
  return saved;
}

/* Rows that were given none, and gaps in ids, too: with the state another solver goes on with the
 * same bits, whatever accelerations it had. */
static void check_saved(uint32_t dimension, uint32_t precision) {
  enum { COUNT = 30 };
  char a[COUNT * 3 * sizeof(double)] = {0};
  uint64_t bytes;
  for (uint32_t i = 0; i < COUNT; ++i)
    put_rows(a, dimension, precision, i, (const double[]){0.1 * i, 1, -0.05 * i});
  pbf_solver *solver = test_filled(dimension, precision, COUNT, COUNT);
  assert_ok(pbf_set_accelerations(solver, 0, COUNT - 3, a));
  assert_ok(pbf_remove_particles(solver, 2, (const uint32_t[]){4, 20}));
  assert_ok(pbf_step(solver, 2));
  void *saved = test_save(solver, &bytes);
  for (int had = 0; had < 2; ++had) {
    pbf_solver *other = test_filled(dimension, precision, COUNT, COUNT);
    if (had) assert_ok(pbf_set_accelerations(other, 0, COUNT, a));
    assert_ok(pbf_load(other, saved, bytes));
    assert_int_equal(has_array(other), 1);
    uint64_t again;
    void *resaved = test_save(other, &again);
    assert_int_equal(again, bytes);
    assert_memory_equal(resaved, saved, bytes);
    free(resaved);
    assert_ok(pbf_remove_particles(other, 1, (const uint32_t[]){7}));
    assert_ok(pbf_step(other, 5));
    pbf_solver *right = test_filled(dimension, precision, COUNT, COUNT);
    assert_ok(pbf_load(right, saved, bytes));
    assert_ok(pbf_remove_particles(right, 1, (const uint32_t[]){7}));
    assert_ok(pbf_step(right, 5));
    assert_true(test_hash(other) == test_hash(right));
    pbf_destroy(right);
    pbf_destroy(other);
  }
  pbf_solver *gone_on = test_filled(dimension, precision, COUNT, COUNT);
  assert_ok(pbf_load(gone_on, saved, bytes));
  assert_ok(pbf_step(gone_on, 5));
  assert_ok(pbf_step(solver, 5));
  assert_true(test_hash(gone_on) == test_hash(solver));
  pbf_destroy(gone_on);
  pbf_destroy(solver);
  free(saved);
}

static void saved_states_have_them(void **state) {
  (void)state;
  test_for_each_kind(check_saved);
}

/* Of each byte that a forger may write, and seal. */
static void forged_states(void **state) {
  (void)state;
  const uint32_t dimension = test_has_kind(2, PBF_FLOAT64) ? 2 : 3;
  const uint32_t precision = test_has_kind(2, PBF_FLOAT64) ? PBF_FLOAT64 : PBF_FLOAT32;
  char a[2 * 3 * sizeof(double)] = {0};
  pbf_solver *solver = apart(dimension, precision, 2);
  assert_ok(pbf_set_accelerations(solver, 0, 2, a));
  uint64_t size;
  unsigned char *saved = test_save(solver, &size);
  for (uint64_t i = 0; i + 8 < size; ++i) {
    pbf_solver *other = apart(dimension, precision, 2);
    const uint64_t before = test_hash(other);
    const unsigned char kept = saved[i];
    saved[i] = 0xff;
    test_seal(saved, size);
    if (pbf_load(other, saved, size) == PBF_OK)
      assert_ok(pbf_save(other, NULL, &(uint64_t){0}));
    else
      assert_true(test_hash(other) == before);
    saved[i] = kept;
    pbf_destroy(other);
  }
  /* The header, of the size that stands at 12, ends with whether there are some, how many rows, and
   * the size of it all. */
  uint32_t header;
  memcpy(&header, saved + 12, sizeof header);
  memset(saved + header - 16, 0, 4);
  test_seal(saved, size);
  assert_fails(pbf_load(solver, saved, size), PBF_ERROR_DATA, "the saved state");
  free(saved);
  pbf_destroy(solver);
}

/* A load for which memory runs out leaves them. */
static void check_failing_load(uint32_t dimension, uint32_t precision) {
  char a[2 * 3 * sizeof(double)] = {0};
  uint64_t bytes;
  put_rows(a, dimension, precision, 1, (const double[]){0, 1, 0});
  for (uint64_t n = 1, failed = 1; failed; ++n) {
    pbf_solver *solver = apart(dimension, precision, 2);
    void *saved = saved_with_phases(solver, &bytes);
    assert_ok(pbf_set_accelerations(solver, 0, 2, a));
    test_count.failing_call = test_count.calls + n;
    failed = pbf_load(solver, saved, bytes) != PBF_OK;
    test_count.failing_call = 0;
    assert_ok(pbf_step(solver, 10));
    const double right = failed ? 0.1 : 0;
    assert_true(fabs(speed_along_y(solver, dimension, precision, 1) - right) < 1e-6);
    assert_true(n > 1 || failed);
    free(saved);
    pbf_destroy(solver);
  }
}

static void a_load_that_fails_leaves_them(void **state) {
  (void)state;
  test_for_each_kind(check_failing_load);
}

/* ---- Sleep ---------------------------------------------------------------------------------- */

/* What one presses to the floor falls asleep. Another one that lifts it wakes it, and so does what
 * lifts it once that is taken away. */
static void check_sleep(uint32_t dimension, uint32_t precision) {
  for (int taken = 0; taken < 2; ++taken) {
    char a[2 * 3 * sizeof(double)] = {0};
    pbf_params params = still_params();
    pbf_stats stats = {.struct_size = sizeof stats};
    params.domain_min[1] = 0;
    params.gravity[1] = 1;
    params.sleep_speed = 0.005;
    params.sleep_time = 0.1;
    pbf_solver *solver = apart(dimension, precision, 1);
    assert_ok(pbf_set_params(solver, &params));
    put_rows(a, dimension, precision, 0, (const double[]){0, -2, 0});
    assert_ok(pbf_set_accelerations(solver, 0, 1, a));
    assert_ok(pbf_step(solver, 100));
    assert_ok(pbf_get_stats(solver, &stats));
    assert_int_equal(stats.asleep, 1);
    put_rows(a, dimension, precision, 0, (const double[]){0, 0, 0});
    assert_ok(taken ? pbf_set_accelerations(solver, 0, 0, NULL)
                    : pbf_set_accelerations(solver, 0, 1, a));
    assert_ok(pbf_step(solver, 10));
    const double speed = speed_along_y(solver, dimension, precision, 0);
    assert_true(speed > 0.085 && speed < 0.101); /* less what the wall takes as it leaves */
    pbf_destroy(solver);
  }
}

static void they_wake(void **state) {
  (void)state;
  test_for_each_kind(check_sleep);
}

static void bad_input_changes_nothing(void **state) {
  (void)state;
  test_for_each_kind(check_input);
}

int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_of_all_is_gravity),
      cmocka_unit_test(a_central_field_turns_a_particle),
      cmocka_unit_test(each_stays_with_its_particle),
      cmocka_unit_test(bad_input_changes_nothing),
      cmocka_unit_test(saved_states_have_them),
      cmocka_unit_test(forged_states),
      cmocka_unit_test(a_load_that_fails_leaves_them),
      cmocka_unit_test(they_wake),
  };
  return TEST_RUN(tests);
}
