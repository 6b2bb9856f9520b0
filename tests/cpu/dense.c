/* Far too many neighbours: lists that grow, memory that ends, and the state of a step that failed.
 */
#include "cpu_support.h"

#include <stdio.h>

/* At length more than 2^31 pairs in a cell: too many for an instrumented build. */
static uint32_t dense_count(void) {
  if (TEST_INSTRUMENTED) return 1000;
  return test_is_long() ? 46500 : 3000;
}

static double *crowd(uint32_t count, double size) {
  double *x = calloc((size_t)count * 3, sizeof *x);
  uint64_t seed = 9;
  assert_non_null(x);
  for (uint32_t i = 0; i < 3 * count; ++i) x[i] = 0.5 + size * (cpu_random(&seed) - 0.5);
  return x;
}

/* One cell with all: the memory grows as the square, an eighth of a byte a pair and a little. */
static void all_in_one_cell(void **state) {
  (void)state;
  const uint32_t count = dense_count();
  pbf_params params = test_params();
  params.iterations = 1;
  params.time_step = 1e-6;
  pbf_desc desc = cpu_desc("openmp", 3, PBF_FLOAT32, count, 2);
  pbf_solver *solver = test_create(&desc, &params);
  double *x = crowd(count, 0.02);
  cpu_add(solver, PBF_FLOAT32, 3, count, x, NULL);
  assert_ok(pbf_step(solver, 1));
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  double pairs = (double)count * count;
  assert_true((double)plan.bytes < 0.25 * pairs + 1000.0 * count);
  double *after = cpu_get(solver, PBF_FIELD_POSITION);
  for (uint32_t i = 0; i < 3 * count; ++i) assert_true(after[i] >= 0 && after[i] <= 1);
  free(x);
  free(after);
  pbf_destroy(solver);
}

/* A second step that needs more memory than there is leaves everything as it was, and succeeds
 * once there is some. */
static void growth_that_fails(const char *backend, uint32_t threads) {
  enum { COUNT = TEST_INSTRUMENTED ? 500 : 3000 };
  char wanted[64];
  snprintf(wanted, sizeof wanted, "neighbours of %d particles", COUNT);
  pbf_params params = test_params();
  params.collide = PBF_COLLIDE_AFTER_PREDICTION;
  params.prestabilization = 0; /* which wants memory of its own before */
  pbf_desc desc = cpu_desc(backend, 3, PBF_FLOAT32, COUNT, threads);
  desc.allocator = &test_allocator;
  pbf_solver *solver = test_create(&desc, &params), *other = test_create(&desc, &params);
  double *loose = crowd(COUNT, 0.9), *tight = crowd(COUNT, 0.1);
  float values[3 * COUNT];
  cpu_add(solver, PBF_FLOAT32, 3, COUNT, loose, NULL);
  assert_ok(pbf_step(solver, 2));
  for (uint32_t i = 0; i < 3 * COUNT; ++i) values[i] = (float)tight[i];
  assert_ok(pbf_set_positions(solver, 0, COUNT, values));
  uint64_t before = test_hash(solver), size;
  void *saved = test_save(solver, &size);
  assert_ok(pbf_load(other, saved, size));
  test_count.failing_call = test_count.calls + 1;
  assert_fails(pbf_step(solver, 5), PBF_ERROR_OUT_OF_MEMORY, wanted);
  assert_true(test_hash(solver) == before);
  test_count.failing_call = 0;
  assert_ok(pbf_step(solver, 3));
  assert_ok(pbf_step(other, 3));
  assert_true(test_hash(solver) == test_hash(other));
  free(saved);
  free(loose);
  free(tight);
  pbf_destroy(solver);
  pbf_destroy(other);
  assert_int_equal(test_count.live_bytes, 0);
}

static void growth_fails_in_serial(void **state) {
  (void)state;
  growth_that_fails("serial", 1);
}

static void growth_fails_in_openmp(void **state) {
  (void)state;
  growth_that_fails("openmp", 3);
}

static void growth_fails_in_threads(void **state) {
  (void)state;
  growth_that_fails("threads", 3);
}

/* Positions of adding order, far from sorted: the sort by threads takes any. */
static void backwards_and_shuffled(void **state) {
  (void)state;
  enum { COUNT = TEST_INSTRUMENTED ? 4000 : 20000 };
  pbf_params params = test_params();
  static const char *const backends[] = {"serial", "openmp", "threads"};
  uint64_t hashes[3];
  double *x = crowd(COUNT, 0.99);
  for (int k = 0; k < 3; ++k) {
    pbf_desc desc = cpu_desc(backends[k], 3, PBF_FLOAT32, COUNT, k ? 5 : 1);
    pbf_solver *solver = test_create(&desc, &params);
    cpu_add(solver, PBF_FLOAT32, 3, COUNT, x, NULL);
    assert_ok(pbf_step(solver, 2));
    hashes[k] = test_hash(solver);
    pbf_destroy(solver);
  }
  assert_true(hashes[0] == hashes[1] && hashes[0] == hashes[2]);
  free(x);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(growth_fails_in_serial),  cmocka_unit_test(growth_fails_in_openmp),
      cmocka_unit_test(growth_fails_in_threads), cmocka_unit_test(backwards_and_shuffled),
      cmocka_unit_test(all_in_one_cell),
  };
  return TEST_RUN(tests);
}
