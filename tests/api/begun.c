/* Steps that begin in one call and end in another one. */
#include <pthread.h>
#include <stdatomic.h>

#include "support.h"

enum { COUNT = 60, CAPACITY = 64, FOREVER = 2000000000 };

static pbf_solver *filled(void) { return test_filled(3, PBF_FLOAT32, COUNT, CAPACITY); }

static void check_bits(uint32_t dimension, uint32_t precision) {
  pbf_solver *begun = test_filled(dimension, precision, COUNT, CAPACITY);
  pbf_solver *other = test_filled(dimension, precision, COUNT, CAPACITY);
  for (uint32_t k = 0; k < 5; ++k) {
    assert_ok(pbf_begin_step(begun, k));
    assert_ok(pbf_end_step(begun));
    assert_ok(pbf_step(other, k));
    assert_true(test_hash(begun) == test_hash(other));
  }
  pbf_destroy(begun);
  pbf_destroy(other);
}

static void bits_are_those_of_a_step(void **state) {
  (void)state;
  test_for_each_kind(check_bits);
}

/* However soon they are done, they have not ended. */
static void others_are_refused(void **state) {
  (void)state;
  pbf_solver *s = filled();
  const char *words = "pbf_begin_step has begun";
  uint32_t count;
  pbf_params params = {.struct_size = sizeof params};
  pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
  float x[3 * COUNT];
  assert_ok(pbf_set_snapshots(s, 2));
  for (int k = 0; k < 20; ++k) {
    assert_ok(pbf_begin_step(s, 1));
    assert_fails(pbf_begin_step(s, 1), PBF_ERROR_BUSY, words);
    assert_fails(pbf_step(s, 1), PBF_ERROR_BUSY, words);
    assert_fails(pbf_get_count(s, &count), PBF_ERROR_BUSY, words);
    assert_fails(pbf_get_params(s, &params), PBF_ERROR_BUSY, words);
    assert_fails(pbf_get_positions(s, 0, COUNT, x), PBF_ERROR_BUSY, words);
    assert_fails(pbf_set_colliders(s, 0, NULL), PBF_ERROR_BUSY, words);
    assert_ok(pbf_acquire_snapshot(s, &snapshot));
    assert_ok(pbf_release_snapshot(&snapshot));
    assert_ok(pbf_end_step(s));
    assert_ok(pbf_acquire_snapshot(s, &snapshot));
    assert_int_equal(snapshot.step, k + 1);
    assert_ok(pbf_release_snapshot(&snapshot));
  }
  assert_fails(pbf_end_step(s), PBF_ERROR_STATE, "no steps have begun");
  pbf_destroy(s);
}

/* Its sentence comes with the end, in the thread that ends. */
static void failures_come_with_the_end(void **state) {
  (void)state;
  pbf_solver *s = filled();
  pbf_params params = test_params();
  pbf_view view = {.struct_size = sizeof view};
  params.wall_velocity[PBF_WALL_X_MAX] = -1; /* they meet after a time unit */
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_begin_step(s, 1000));
  assert_fails(pbf_get_count(s, &(uint32_t){0}), PBF_ERROR_BUSY, "has begun");
  assert_fails(pbf_end_step(s), PBF_ERROR_STATE, "the moving walls have left no room");
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_fails(pbf_begin_step(s, 1), PBF_ERROR_STATE, "mapped");
  assert_ok(pbf_unmap(s, PBF_FIELD_POSITION));
  assert_fails(pbf_begin_step(NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "solver is null");
  assert_fails(pbf_end_step(NULL), PBF_ERROR_INVALID_ARGUMENT, "solver is null");
  pbf_destroy(s);
  assert_fails(pbf_end_step(s), PBF_ERROR_INVALID_ARGUMENT, "has taken back");
}

static void *end_it(void *user) {
  static pbf_status status;
  status = pbf_end_step(user);
  return &status;
}

static void another_thread_may_end_them(void **state) {
  (void)state;
  pbf_solver *s = filled();
  pthread_t thread;
  void *status;
  assert_ok(pbf_begin_step(s, 20));
  assert_int_equal(pthread_create(&thread, NULL, end_it, s), 0);
  assert_int_equal(pthread_join(thread, &status), 0);
  assert_int_equal(*(pbf_status *)status, PBF_OK);
  assert_ok(pbf_step(s, 1));
  pbf_destroy(s);
}

enum { VIEWS = 100000 };

static atomic_int given_back;

static void *give_views_back(void *user) {
  static uint32_t refused;
  for (int k = 0; k < VIEWS; ++k) refused += pbf_unmap(user, PBF_FIELD_POSITION) != PBF_OK;
  atomic_store(&given_back, 1);
  return &refused;
}

/* As a collector of garbage does, while the solver's own thread reads. */
static void another_thread_may_unmap(void **state) {
  (void)state;
  pbf_solver *s = filled();
  pbf_view view = {.struct_size = sizeof view};
  float x[3 * COUNT];
  pthread_t thread;
  void *refused;
  for (int k = 0; k < VIEWS; ++k) assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_int_equal(pthread_create(&thread, NULL, give_views_back, s), 0);
  while (!atomic_load(&given_back)) assert_ok(pbf_get_positions(s, 0, COUNT, x));
  assert_int_equal(pthread_join(thread, &refused), 0);
  assert_int_equal(*(uint32_t *)refused, 0);
  assert_fails(pbf_unmap(s, PBF_FIELD_POSITION), PBF_ERROR_STATE, "no view is mapped");
  assert_ok(pbf_step(s, 1));
  pbf_destroy(s);
}

static void begun_steps_are_cancelled(void **state) {
  (void)state;
  pbf_solver *s = filled();
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_begin_step(s, FOREVER));
  assert_ok(pbf_cancel(s));
  assert_fails(pbf_end_step(s), PBF_ERROR_CANCELLED, "of 2000000000 steps");
  assert_ok(pbf_get_info(s, &info));
  assert_ok(pbf_begin_step(s, 2));
  assert_ok(pbf_end_step(s));
  pbf_destroy(s);
}

static void destroyed_before_the_end(void **state) {
  (void)state;
  pbf_solver *s = filled();
  assert_ok(pbf_begin_step(s, FOREVER));
  pbf_destroy(s);
  assert_int_equal(test_count.live_blocks, 0);
}

static void held_on_request_only(void **state) {
  (void)state;
  pbf_solver *s = filled();
  pbf_plan before = {.struct_size = sizeof before}, after = before;
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_get_plan(s, &before));
  const uint64_t bytes = test_count.live_bytes;
  assert_ok(pbf_begin_step(s, 1));
  assert_ok(pbf_end_step(s));
  assert_ok(pbf_get_plan(s, &after));
  assert_true(after.bytes > before.bytes);
  assert_int_equal(after.bytes - before.bytes, test_count.live_bytes - bytes);
  pbf_destroy(s);
}

/* From inside the steps, a thread that waited for them would wait for itself. */
static pbf_status inside;

static void end_from_inside(void *user) { inside = pbf_end_step(user); }

static void not_ended_from_inside(void **state) {
  (void)state;
  if (!test_is_stub()) test_skip("the stub alone calls back from inside a step");
  ballistic_control *control = test_stub_control();
  pbf_solver *s = filled();
  control->inside_step = end_from_inside;
  control->user = s;
  assert_ok(pbf_begin_step(s, 1));
  while (pbf_end_step(s) == PBF_ERROR_BUSY) continue;
  assert_true(inside == PBF_ERROR_BUSY);
  test_stub_control();
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bits_are_those_of_a_step),   cmocka_unit_test(others_are_refused),
      cmocka_unit_test(failures_come_with_the_end), cmocka_unit_test(another_thread_may_end_them),
      cmocka_unit_test(begun_steps_are_cancelled),  cmocka_unit_test(destroyed_before_the_end),
      cmocka_unit_test(another_thread_may_unmap),   cmocka_unit_test(held_on_request_only),
      cmocka_unit_test(not_ended_from_inside),
  };
  return TEST_RUN(tests);
}
