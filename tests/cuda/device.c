/* The cuda backend on a device: memory that is not there, dense cells, views, what is freed. */
#include <stdio.h>

#include "driver.h"
#include "support.h"

static uint64_t plan_bytes(pbf_solver *solver) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  return plan.bytes;
}

static void too_large_for_the_device(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT64, PBF_MAX_CAPACITY);
  pbf_solver *solver = NULL;
  pbf_params params = test_params();
  params.spacing = 0.05;
  params.smoothing_radius = 0.2; /* 256 bytes a particle of lists and as much again */
  assert_fails(pbf_create(&desc, &params, &solver), PBF_ERROR_OUT_OF_MEMORY, "capacity");
  assert_null(solver);
  assert_int_equal(test_count.live_blocks, 0);
  pbf_destroy(test_filled(3, PBF_FLOAT32, 100, 100)); /* the device is as good as before */
}

/* Takes what the device has but for less than 32 MB, in so many blocks. */
static uint32_t take_all(cuda_address *taken, uint32_t most) {
  uint32_t count = 0;
  for (uint64_t bytes = cuda_free_bytes(); bytes >= 32 << 20 && count < most; bytes /= 2)
    while (count < most && (taken[count] = cuda_take(bytes))) ++count;
  return count;
}

/* Memory that others hold: a new solver and new parameters get none, and nothing is lost. */
static void memory_that_others_hold(void **state) {
  enum { COUNT = 1000, CAPACITY = 8000000 };
  (void)state;
  cuda_address taken[64];
  pbf_params params = {.struct_size = sizeof params}, kept = {.struct_size = sizeof kept};
  pbf_solver *other = NULL, *solver = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  assert_ok(pbf_step(solver, 2));
  uint64_t hash = test_hash(solver), bytes = plan_bytes(solver), blocks = test_count.live_blocks;
  cuda_primary_context();
  uint32_t count = take_all(taken, 64);

  pbf_desc desc = test_desc(3, PBF_FLOAT32, CAPACITY);
  assert_fails(pbf_create(&desc, NULL, &other), PBF_ERROR_OUT_OF_MEMORY, "cudaMalloc");
  assert_null(other);
  assert_ok(pbf_get_params(solver, &params));
  params.vorticity = params.viscosity = 0.1;
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_OUT_OF_MEMORY, "cudaMalloc");
  assert_ok(pbf_get_params(solver, &kept));
  assert_true(kept.vorticity == 0 && kept.viscosity == 0);
  assert_int_equal(test_count.live_blocks, blocks);
  assert_int_equal(plan_bytes(solver), bytes);
  assert_true(test_hash(solver) == hash);
  assert_ok(pbf_step(solver, 2));
  hash = test_hash(solver);

  while (count) cuda_give_back(taken[--count]);
  cuda_set_current(NULL);
  assert_ok(pbf_set_params(solver, &params));
  assert_true(test_hash(solver) == hash);
  pbf_destroy(solver);
}

/* Both where lists and cells have room and where a step must do without. */
static void crowds_keep_their_bits(void **state) {
  enum { COUNT = 960 };
  (void)state;
  for (int crowded = 0; crowded < 2; ++crowded) {
    uint64_t hashes[2];
    for (int run = 0; run < 2; ++run) {
      pbf_solver *solver = test_filled(3, PBF_FLOAT32, COUNT, COUNT);
      float positions[3 * COUNT];
      for (int k = 0; k < 3 * COUNT; ++k)
        positions[k] = 0.5f + (crowded ? 1e-4f : 0.02f) * (float)(k * 7919 % 16);
      assert_ok(pbf_set_positions(solver, 0, COUNT, positions));
      if (run == 0) assert_ok(pbf_step(solver, 5));
      for (int k = 0; run == 1 && k < 5; ++k) assert_ok(pbf_step(solver, 1));
      hashes[run] = test_hash(solver);
      pbf_destroy(solver);
    }
    assert_true(hashes[0] == hashes[1]);
  }
}

static void frees_what_parameters_no_longer_want(void **state) {
  (void)state;
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 1000, 1000);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(solver, &params));
  uint64_t before = plan_bytes(solver);
  params.vorticity = params.viscosity = 0.1;
  assert_ok(pbf_set_params(solver, &params));
  assert_true(plan_bytes(solver) >= before + 1000 * (12 + 12));
  params.vorticity = params.viscosity = 0;
  assert_ok(pbf_set_params(solver, &params));
  assert_int_equal(plan_bytes(solver), before);
  pbf_destroy(solver);
}

static void views_are_on_the_device(void **state) {
  (void)state;
  pbf_solver *solver = test_filled(2, PBF_FLOAT32, 100, 100);
  pbf_view view = {.struct_size = sizeof view};
  assert_ok(pbf_map(solver, PBF_FIELD_POSITION, &view));
  assert_int_equal(view.device_type, PBF_DEVICE_CUDA);
  assert_int_equal(view.particle_stride, 16);
  assert_non_null(view.data);
  assert_non_null(view.ids);
  assert_ok(pbf_unmap(solver, PBF_FIELD_POSITION));
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(too_large_for_the_device),
      cmocka_unit_test(memory_that_others_hold),
      cmocka_unit_test(crowds_keep_their_bits),
      cmocka_unit_test(frees_what_parameters_no_longer_want),
      cmocka_unit_test(views_are_on_the_device),
  };
  return TEST_RUN(tests);
}
