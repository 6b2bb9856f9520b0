/* A lost device, as a kernel leaves it that writes where it must not: every call on solvers there
 * says so, they can be destroyed, and nothing aborts. Alone in its process, which is left without a
 * device. */
#include <stdio.h>

#include "driver.h"
#include "support.h"

enum { COUNT = 120 };

static pbf_solver *filled_on(void *stream) {
  pbf_desc desc = test_desc(2, PBF_FLOAT32, COUNT);
  desc.stream = stream;
  pbf_solver *solver = test_create(&desc, NULL);
  void *positions = test_lattice(2, PBF_FLOAT32, COUNT);
  assert_ok(pbf_add_particles(solver, COUNT, positions, NULL, NULL));
  free(positions);
  return solver;
}

/* Twice: a status must not be forgotten, nor stand in the way of the next call. */
static void says_that_it_is_lost(pbf_solver *solver) {
  float room[2 * COUNT];
  for (int k = 0; k < 2 * COUNT; ++k) room[k] = 0.5f;
  uint32_t removed[1] = {7};
  uint64_t size = 0;
  pbf_stats stats = {.struct_size = sizeof stats};
  for (int time = 0; time < 2; ++time) {
    assert_fails(pbf_step(solver, 2), PBF_ERROR_DEVICE, "cudaError");
    assert_fails(pbf_synchronize(solver), PBF_ERROR_DEVICE, "cudaStreamSynchronize");
    assert_fails(pbf_get_positions(solver, 0, COUNT, room), PBF_ERROR_DEVICE, "cudaError");
    assert_fails(pbf_set_positions(solver, 0, COUNT, room), PBF_ERROR_DEVICE, "cudaError");
    assert_fails(pbf_get_stats(solver, &stats), PBF_ERROR_DEVICE, "cudaError");
    assert_fails(pbf_remove_particles(solver, 1, removed), PBF_ERROR_DEVICE, "cudaError");
    assert_fails(pbf_set_timing(solver, 1), PBF_ERROR_DEVICE, "cudaError");
    assert_ok(pbf_save(solver, NULL, &size));
    void *saved = malloc(size);
    assert_fails(pbf_save(solver, saved, &size), PBF_ERROR_DEVICE, "cudaError");
    free(saved);
  }
}

static void a_lost_device_leaves_the_process_whole(void **state) {
  (void)state;
  pbf_desc desc = test_desc(2, PBF_FLOAT32, COUNT);
  pbf_solver *late = NULL, *elsewhere = filled_on(NULL);
  assert_ok(pbf_step(elsewhere, 3));

  cuda_context own = cuda_create_context();
  cuda_stream stream = cuda_create_stream();
  pbf_solver *solver = filled_on(stream);
  assert_ok(pbf_step(solver, 3));
  assert_ok(pbf_synchronize(solver));
  cuda_fault();
  says_that_it_is_lost(solver);
  assert_ptr_equal(cuda_current(), own);
  /* Such a fault takes the process's other contexts along. */
  says_that_it_is_lost(elsewhere);
  pbf_status status = pbf_create(&desc, NULL, &late);
  assert_true(status == PBF_ERROR_DEVICE || status == PBF_ERROR_UNAVAILABLE);
  assert_null(late);
  assert_true(pbf_last_error()[0] != 0);

  pbf_destroy(solver);
  assert_ptr_equal(cuda_current(), own);
  pbf_destroy(elsewhere);
  assert_int_equal(test_count.live_blocks, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_lost_device_leaves_the_process_whole)};
  return TEST_RUN(tests);
}
