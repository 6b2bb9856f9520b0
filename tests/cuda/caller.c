/* A caller with CUDA work of its own finds its context and its stream as it left them, and is not
 * kept waiting. */
#include <stdio.h>

#include "driver.h"
#include "support.h"

enum { COUNT = 1000 };

static pbf_solver *filled_on(void *stream) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  desc.stream = stream;
  pbf_solver *solver = test_create(&desc, NULL);
  void *positions = test_lattice(3, PBF_FLOAT32, COUNT);
  assert_ok(pbf_add_particles(solver, COUNT, positions, NULL, NULL));
  free(positions);
  return solver;
}

/* Every call that reaches the device; `expected` is current after each. */
static uint64_t use(void *stream, cuda_context expected) {
  float room[3 * COUNT];
  uint32_t removed[2] = {3, 500};
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_params params = {.struct_size = sizeof params};
  pbf_view view = {.struct_size = sizeof view};
  pbf_solver *solver = filled_on(stream);
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_step(solver, 3));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_get_stats(solver, &stats));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_get_positions(solver, 0, COUNT, room));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_set_positions(solver, 0, COUNT, room));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_remove_particles(solver, 2, removed));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_get_params(solver, &params));
  params.vorticity = 0.1;
  assert_ok(pbf_set_params(solver, &params));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_set_timing(solver, 1));
  assert_ok(pbf_step(solver, 3));
  assert_ok(pbf_set_timing(solver, 0));
  assert_ptr_equal(cuda_current(), expected);
  assert_ok(pbf_map(solver, PBF_FIELD_POSITION, &view));
  assert_ok(pbf_unmap(solver, PBF_FIELD_POSITION));
  assert_ok(pbf_synchronize(solver));
  assert_ptr_equal(cuda_current(), expected);
  uint64_t hash = test_hash(solver);
  pbf_destroy(solver);
  assert_ptr_equal(cuda_current(), expected);
  return hash;
}

static void the_context_stays_current(void **state) {
  (void)state;
  cuda_context own = cuda_create_context();
  assert_ptr_equal(cuda_current(), own);
  uint64_t hash = use(NULL, own);
  cuda_set_current(NULL);
  assert_true(use(NULL, NULL) == hash);
  cuda_set_current(own);
  cuda_stream stream = cuda_create_stream();
  assert_true(use(stream, own) == hash); /* works in that context */
  cuda_set_current(NULL);
  assert_true(use(stream, NULL) == hash); /* finds it by the stream */
  cuda_set_current(own);
  assert_false(cuda_is_busy(stream));
  cuda_destroy_stream(stream);
  cuda_destroy_context(own);
}

/* Without a wait on the host, behind the work that is in the stream already, and in order. */
static void the_stream_is_worked_on_in_order(void **state) {
  (void)state;
  cuda_context primary = cuda_primary_context();
  cuda_stream stream = cuda_create_stream();
  volatile uint32_t *go = cuda_new_switch();
  for (uint32_t timing_way = 0; timing_way < 2; ++timing_way) {
    pbf_solver *solver = filled_on(stream);
    pbf_view view = {.struct_size = sizeof view};
    float seen[4 * COUNT], read[3 * COUNT];
    pbf_params params = {.struct_size = sizeof params};
    assert_ok(pbf_get_params(solver, &params));
    params.viscosity = timing_way ? 0.01 : 0; /* launch after launch, or all in one */
    assert_ok(pbf_set_params(solver, &params));
    assert_ok(pbf_step(solver, 1));
    assert_ok(pbf_synchronize(solver));
    *go = 0;
    cuda_hold(stream, go);
    assert_ok(pbf_step(solver, 2));
    assert_true(cuda_is_busy(stream));
    *go = 1;
    assert_ok(pbf_map(solver, PBF_FIELD_POSITION, &view));
    cuda_wait(stream); /* the caller's own wait is enough */
    cuda_read(seen, (cuda_address)(uintptr_t)view.data, sizeof seen);
    assert_ok(pbf_unmap(solver, PBF_FIELD_POSITION));
    assert_ok(pbf_get_positions(solver, 0, COUNT, read));
    double sum_seen = 0, sum_read = 0; /* the view has the solver's order */
    for (uint32_t i = 0; i < COUNT; ++i)
      for (uint32_t k = 0; k < 3; ++k) {
        sum_seen += (double)seen[4 * i + k];
        sum_read += (double)read[3 * i + k];
      }
    assert_true(fabs(sum_seen - sum_read) < 1e-9);
    pbf_destroy(solver);
    assert_false(cuda_is_busy(stream));
  }
  cuda_destroy_stream(stream);
  assert_ptr_equal(cuda_current(), primary);
  cuda_set_current(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_context_stays_current),
      cmocka_unit_test(the_stream_is_worked_on_in_order),
  };
  return TEST_RUN(tests);
}
