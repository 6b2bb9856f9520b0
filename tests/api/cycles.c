/* Solvers and batches that come and go by the thousand, as for requests of a service: the process
 * does not grow, as the system sees it from outside. */
#include <pbf/batch.h>
#include <stdio.h>
#include <unistd.h>

#include "support.h"

enum {
  COUNT = 64,
  CYCLES = TEST_INSTRUMENTED ? 500 : 10000,
  WARM_UP = CYCLES / 5,
  TEAM_EACH = 10, /* threads that begin and end take longer than all else */
  BATCHES = TEST_INSTRUMENTED ? 100 : 1000,
  WORLDS = 8
};

/* 0: the system does not tell. */
static uint64_t resident_bytes(void) {
  unsigned long long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file) return 0;
  if (fscanf(file, "%*u %llu", &pages) != 1) pages = 0;
  fclose(file);
  return pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* Less than the smallest block that malloc has, in each cycle. A sanitizer keeps what was freed. */
static void assert_flat(uint64_t before) {
  const uint64_t after = resident_bytes(), most = TEST_INSTRUMENTED ? UINT64_C(1) << 28 : 131072;
  if (after > before + most)
    fail_msg("the process has grown from %llu to %llu bytes", (unsigned long long)before,
             (unsigned long long)after);
}

static pbf_desc desc_of(uint32_t threads) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  desc.allocator = NULL;
  desc.threads = threads;
  return desc;
}

static void live(const pbf_desc *desc, const pbf_params *params, const void *positions) {
  pbf_solver *solver = test_create(desc, params);
  assert_ok(pbf_add_particles(solver, COUNT, positions, NULL, NULL));
  assert_ok(pbf_step(solver, 1));
  pbf_destroy(solver);
}

/* Requests differ: in colliders, and in parameters that all derived ones follow from. */
static void solvers_come_and_go(void **state) {
  (void)state;
  void *positions = test_lattice(3, PBF_FLOAT32, COUNT);
  uint64_t before = 0;
  for (uint32_t k = 0; k < CYCLES; ++k) {
    const pbf_desc desc = desc_of(k % TEAM_EACH ? 1 : 2);
    pbf_params params = test_params();
    params.smoothing_radius *= 1 + 0.001 * (k / 100 % 8);
    if (k == WARM_UP) before = resident_bytes();
    live(&desc, &params, positions);
  }
  free(positions);
  assert_flat(before);
}

static void batches_come_and_go(void **state) {
  (void)state;
  void *positions = test_lattice(3, PBF_FLOAT32, COUNT);
  float *all = malloc(sizeof(float) * 3 * COUNT * WORLDS);
  uint32_t counts[WORLDS];
  uint64_t before = 0;
  for (uint32_t k = 0; k < WORLDS; ++k) {
    counts[k] = COUNT;
    memcpy(all + 3 * COUNT * k, positions, sizeof(float) * 3 * COUNT);
  }
  for (uint32_t k = 0; k < BATCHES; ++k) {
    const pbf_desc desc = desc_of(2);
    pbf_batch *batch = NULL;
    if (k == BATCHES / 5) before = resident_bytes();
    assert_ok(pbf_batch_create(&desc, NULL, WORLDS, &batch));
    assert_ok(pbf_batch_add_particles(batch, counts, all, NULL));
    assert_ok(pbf_batch_set_start(batch, NULL, NULL, 0));
    assert_ok(pbf_batch_step(batch, NULL, 1));
    assert_ok(pbf_batch_reset(batch, NULL));
    pbf_batch_destroy(batch);
  }
  free(all);
  free(positions);
  assert_flat(before);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solvers_come_and_go),
      cmocka_unit_test(batches_come_and_go),
  };
  return TEST_RUN(tests);
}
