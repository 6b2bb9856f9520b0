/* The cuda backend on a device: memory that is not there, dense cells, particles far apart, views,
 * what is freed. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* A box full of fluid; *positions and *velocities are the caller's to free. The velocities take
 * every particle to the place of one far away in one step. */
static pbf_solver *full_box(uint32_t dimension, uint32_t count, float **positions,
                            float **velocities) {
  const uint32_t side = dimension == 3 ? 32 : 200;
  pbf_desc desc = test_desc(dimension, PBF_FLOAT32, count);
  pbf_params params = test_params();
  params.spacing = 0.05;
  params.smoothing_radius = 0.05 / 0.6;
  params.gravity[1] = 0;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 0.05 * (k + 1u == dimension ? 200 : side);
  *positions = malloc(sizeof(float) * count * dimension);
  *velocities = malloc(sizeof(float) * count * dimension);
  assert_true(*positions && *velocities);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t rest = i;
    for (uint32_t k = 0; k < dimension; ++k, rest /= side)
      (*positions)[i * dimension + k] =
          0.05f * ((float)(k + 1 == dimension ? rest : rest % side) + 0.5f);
  }
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < dimension; ++k)
      (*velocities)[i * dimension + k] = ((*positions)[(uint64_t)i * 7919 % count * dimension + k] -
                                          (*positions)[i * dimension + k]) /
                                         (float)params.time_step;
  pbf_solver *solver = test_create(&desc, &params);
  assert_ok(pbf_add_particles(solver, count, *positions, *velocities, NULL));
  return solver;
}

/* Who worked on neighbours before a step works on particles far apart after it, and a solver that
 * takes over from there does not: no matter to the bits. */
static void particles_far_apart_keep_their_bits(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    uint32_t count = 30720;
    float *positions, *velocities;
    pbf_solver *solver = full_box(dimension, count, &positions, &velocities);
    assert_ok(pbf_step(solver, 1));
    memset(velocities, 0, sizeof(float) * count * dimension);
    assert_ok(pbf_set_velocities(solver, 0, count, velocities));
    uint64_t size;
    void *saved = test_save(solver, &size);
    assert_ok(pbf_step(solver, 3));

    free(positions);
    free(velocities);
    pbf_solver *other = full_box(dimension, count, &positions, &velocities);
    assert_ok(pbf_load(other, saved, size));
    assert_ok(pbf_step(other, 3));
    assert_true(test_hash(solver) == test_hash(other));
    free(positions);
    free(velocities);
    free(saved);
    pbf_destroy(solver);
    pbf_destroy(other);
  }
}

/* Bytes of an array of the plan; 0: there is none. */
static uint64_t array_bytes(pbf_solver *solver, const char *name) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  for (uint32_t k = 0; k < plan.array_count; ++k)
    if (strcmp(plan.arrays[k].name, name) == 0) return plan.arrays[k].bytes;
  return 0;
}

static void frees_what_parameters_no_longer_want(void **state) {
  enum { CAPACITY = 100000 };
  (void)state;
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 1000, CAPACITY);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(solver, &params));
  uint64_t before = plan_bytes(solver);
  params.vorticity = params.viscosity = 0.1;
  assert_ok(pbf_set_params(solver, &params));
  assert_int_equal(array_bytes(solver, "curl"), CAPACITY * 12);
  assert_int_equal(array_bytes(solver, "smoothed velocity"), CAPACITY * 12);
  params.vorticity = params.viscosity = 0;
  assert_ok(pbf_set_params(solver, &params));
  assert_int_equal(plan_bytes(solver), before);
  pbf_destroy(solver);
}

/* What small scenes need is there only while one of them may run. */
static void small_scenes_have_arrays_of_their_own(void **state) {
  (void)state;
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 1000, 1000);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(solver, &params));
  uint64_t before = plan_bytes(solver), lists = array_bytes(solver, "neighbor list");
  assert_true(array_bytes(solver, "small: owners") > 0);
  params.viscosity = 0.1;
  assert_ok(pbf_set_params(solver, &params));
  assert_int_equal(array_bytes(solver, "small: owners"), 0);
  assert_true(array_bytes(solver, "neighbor list") < lists);
  params.viscosity = 0;
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
      cmocka_unit_test(particles_far_apart_keep_their_bits),
      cmocka_unit_test(frees_what_parameters_no_longer_want),
      cmocka_unit_test(small_scenes_have_arrays_of_their_own),
      cmocka_unit_test(views_are_on_the_device),
  };
  return TEST_RUN(tests);
}
