/* The cuda backend on a device: memory that is not there, dense cells, views, what is freed. */
#include <stdio.h>

#include "support.h"

static void too_large_for_the_device(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT64, PBF_MAX_CAPACITY);
  pbf_solver *solver = NULL;
  pbf_params params = test_params();
  params.smoothing_radius =
      4 * params.spacing; /* 168 bytes a particle of lists and as much again */
  assert_fails(pbf_create(&desc, &params, &solver), PBF_ERROR_OUT_OF_MEMORY, "capacity");
  assert_null(solver);
  assert_int_equal(test_count.live_blocks, 0);
  pbf_destroy(test_filled(3, PBF_FLOAT32, 100, 100)); /* the device is as good as before */
}

/* Both where lists and cells have room and where a step must do without. */
static void crowds_keep_their_bits(void **state) {
  enum { COUNT = 3000 };
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

static uint64_t plan_bytes(pbf_solver *solver) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  return plan.bytes;
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
      cmocka_unit_test(crowds_keep_their_bits),
      cmocka_unit_test(frees_what_parameters_no_longer_want),
      cmocka_unit_test(views_are_on_the_device),
  };
  return TEST_RUN(tests);
}
