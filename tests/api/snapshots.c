/* Snapshots: what was there at the end of a step, for other threads, while the next ones run. */
#include <pthread.h>
#include <stdatomic.h>

#include "support.h"

enum { COUNT = 60, CAPACITY = 64, STEPS = 200, READERS = 2 };

static size_t field_bytes(const pbf_snapshot *s) {
  return (size_t)s->count * s->dimension * s->element_type;
}

static uint64_t hash_of(const pbf_snapshot *s) {
  uint64_t hash = UINT64_C(14695981039346656037);
  const unsigned char *fields[] = {s->positions, s->velocities};
  for (int f = 0; f < 2; ++f)
    for (size_t i = 0; i < field_bytes(s); ++i)
      hash = (hash ^ fields[f][i]) * UINT64_C(1099511628211);
  return hash;
}

static pbf_snapshot acquired(pbf_solver *s) {
  pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
  assert_ok(pbf_acquire_snapshot(s, &snapshot));
  assert_non_null(snapshot.owner);
  return snapshot;
}

static void check_present(pbf_solver *s, const pbf_snapshot *snapshot) {
  double x[3 * CAPACITY], v[3 * CAPACITY];
  uint32_t ids[CAPACITY], count;
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_get_velocities(s, 0, count, v));
  assert_ok(pbf_get_ids(s, 0, count, ids));
  assert_int_equal(snapshot->count, count);
  assert_int_equal(snapshot->dimension, info.dimension);
  assert_int_equal(snapshot->element_type, info.precision);
  assert_int_equal(snapshot->step, info.step);
  assert_memory_equal(&snapshot->time, &info.time, sizeof info.time);
  assert_memory_equal(snapshot->positions, x, field_bytes(snapshot));
  assert_memory_equal(snapshot->velocities, v, field_bytes(snapshot));
  assert_memory_equal(snapshot->ids, ids, count * sizeof *ids);
}

static void check_contents(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_filled(dimension, precision, COUNT, CAPACITY);
  assert_ok(pbf_set_snapshots(s, 3));
  pbf_snapshot first = acquired(s);
  check_present(s, &first);
  const uint64_t before = hash_of(&first);
  assert_ok(pbf_step(s, 3));
  pbf_snapshot second = acquired(s);
  check_present(s, &second);
  assert_ok(pbf_remove_particles(s, 3, (const uint32_t[]){0, 9, 59}));
  assert_int_equal(second.count, COUNT);
  assert_ok(pbf_release_snapshot(&second));
  assert_null(second.positions);
  for (int k = 0; k < 5; ++k) {
    assert_ok(pbf_step(s, 1));
    second = acquired(s);
    check_present(s, &second);
    assert_ok(pbf_release_snapshot(&second));
  }
  assert_true(hash_of(&first) == before);
  assert_int_equal(first.step, 0);
  assert_ok(pbf_release_snapshot(&first));
  pbf_destroy(s);
}

static void snapshots_are_of_the_last_step(void **state) {
  (void)state;
  test_for_each_kind(check_contents);
}

/* Two are held: the third is the latest one, and stays. */
static void steps_wait_for_nobody(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_snapshot held[4];
  assert_ok(pbf_set_snapshots(s, 3));
  for (int k = 0; k < 4; ++k) {
    held[k] = acquired(s);
    assert_int_equal(held[k].step, k < 2 ? k : 2);
    assert_ok(pbf_step(s, 1));
  }
  assert_ptr_equal(held[2].positions, held[3].positions);
  assert_ok(pbf_release_snapshot(&held[0]));
  assert_ok(pbf_step(s, 1));
  held[0] = acquired(s);
  check_present(s, &held[0]);
  for (int k = 0; k < 4; ++k) assert_ok(pbf_release_snapshot(&held[k]));
  pbf_destroy(s);
}

/* ---- Threads --------------------------------------------------------------------------------- */

typedef struct audience {
  pbf_solver *solver;
  uint64_t hashes[STEPS + 1]; /* of each step */
  atomic_int over, wrong, seen;
} audience;

static void *watch(void *user) {
  audience *a = user;
  uint64_t last = 0;
  do {
    pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
    if (pbf_acquire_snapshot(a->solver, &snapshot) != PBF_OK) {
      atomic_fetch_add(&a->wrong, 1);
      break;
    }
    int right = snapshot.step >= last && snapshot.step <= STEPS &&
                hash_of(&snapshot) == a->hashes[snapshot.step];
    atomic_fetch_add(&a->wrong, !right);
    atomic_fetch_add(&a->seen, snapshot.step > last);
    last = snapshot.step;
    if (pbf_release_snapshot(&snapshot) != PBF_OK) atomic_fetch_add(&a->wrong, 1);
  } while (!atomic_load(&a->over));
  return NULL;
}

static void hash_steps(audience *a) {
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  assert_ok(pbf_set_snapshots(s, 2));
  for (int k = 0; k <= STEPS; ++k) {
    pbf_snapshot snapshot = acquired(s);
    a->hashes[k] = hash_of(&snapshot);
    assert_ok(pbf_release_snapshot(&snapshot));
    assert_ok(pbf_step(s, 1));
  }
  pbf_destroy(s);
}

static void read_while_steps_run(void **state) {
  (void)state;
  static audience a;
  pthread_t threads[READERS];
  hash_steps(&a);
  a.solver = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  assert_ok(pbf_set_snapshots(a.solver, READERS + 2));
  for (int k = 0; k < READERS; ++k)
    assert_int_equal(pthread_create(&threads[k], NULL, watch, &a), 0);
  for (int k = 0; k < STEPS; ++k) assert_ok(pbf_step(a.solver, 1));
  atomic_store(&a.over, 1);
  for (int k = 0; k < READERS; ++k) assert_int_equal(pthread_join(threads[k], NULL), 0);
  assert_int_equal(atomic_load(&a.wrong), 0);
  pbf_snapshot last = acquired(a.solver);
  assert_int_equal(last.step, STEPS);
  assert_ok(pbf_release_snapshot(&last));
  pbf_destroy(a.solver);
}

static void take_inside(void *user) {
  pbf_snapshot snapshot = acquired(user);
  assert_int_equal(snapshot.step, 1);
  assert_ok(pbf_release_snapshot(&snapshot));
}

static void taken_while_a_call_is_inside(void **state) {
  (void)state;
  if (!test_is_stub()) test_skip("the stub alone calls back from inside a step");
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  assert_ok(pbf_set_snapshots(s, 2));
  assert_ok(pbf_step(s, 1));
  control->inside_step = take_inside;
  control->user = s;
  assert_ok(pbf_step(s, 1));
  test_stub_control();
  pbf_destroy(s);
}

/* ---- Memory -----------------------------------------------------------------------------------
 */

static void held_beyond_the_solver(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  assert_ok(pbf_set_snapshots(s, 2));
  assert_ok(pbf_step(s, 2));
  pbf_snapshot held = acquired(s), other = acquired(s), none = {.struct_size = sizeof none};
  const uint64_t hash = hash_of(&held);
  pbf_destroy(s);
  assert_fails(pbf_acquire_snapshot(s, &none), PBF_ERROR_INVALID_ARGUMENT, "has taken back");
  assert_ok(pbf_release_snapshot(&other));
  assert_true(test_count.live_blocks > 0);
  assert_true(hash_of(&held) == hash);
  assert_ok(pbf_release_snapshot(&held));
  assert_int_equal(test_count.live_blocks, 0);
}

static void made_on_request_only(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_step(s, 1));
  const uint64_t bytes = test_count.live_bytes;
  assert_ok(pbf_set_snapshots(s, 4));
  assert_true(test_count.live_bytes - bytes >= 4 * CAPACITY * (2 * 12 + 4));
  assert_ok(pbf_get_plan(s, &plan));
  assert_string_equal(plan.arrays[plan.array_count - 1].name, "snapshots (host)");
  assert_int_equal(plan.arrays[plan.array_count - 1].bytes, test_count.live_bytes - bytes);
  const uint64_t calls = test_count.calls;
  assert_ok(pbf_step(s, 3));
  assert_int_equal(test_count.calls, calls);
  pbf_snapshot held = acquired(s);
  assert_fails(pbf_set_snapshots(s, 0), PBF_ERROR_STATE, "snapshots are held, 1 times");
  assert_int_equal(test_count.live_bytes - bytes, plan.arrays[plan.array_count - 1].bytes);
  assert_fails(pbf_set_snapshots(s, 8), PBF_ERROR_STATE, "snapshots are held");
  assert_ok(pbf_release_snapshot(&held));
  assert_ok(pbf_set_snapshots(s, 0));
  assert_int_equal(test_count.live_bytes, bytes);
  pbf_destroy(s);
}

static void bits_are_as_without(void **state) {
  (void)state;
  pbf_solver *with = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_solver *without = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  assert_ok(pbf_set_snapshots(with, 2));
  for (int k = 0; k < 10; ++k) {
    assert_ok(pbf_step(with, 2));
    assert_ok(pbf_step(without, 2));
  }
  assert_true(test_hash(with) == test_hash(without));
  pbf_destroy(with);
  pbf_destroy(without);
}

static void refusals(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  const pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;
  pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
  assert_fails(pbf_set_snapshots(s, 1), bad, "snapshots is 1; it must be 2 … 16, or 0");
  assert_fails(pbf_set_snapshots(s, PBF_MAX_SNAPSHOTS + 1), bad, "snapshots is 17");
  assert_fails(pbf_acquire_snapshot(s, &snapshot), PBF_ERROR_STATE, "pbf_set_snapshots");
  assert_ok(pbf_set_snapshots(s, PBF_MAX_SNAPSHOTS));
  assert_fails(pbf_acquire_snapshot(NULL, &snapshot), bad, "solver is null");
  assert_fails(pbf_acquire_snapshot(s, NULL), bad, "snapshot is null");
  assert_fails(pbf_release_snapshot(NULL), bad, "snapshot is null");
  assert_fails(pbf_release_snapshot(&snapshot), PBF_ERROR_STATE, "nothing is held");
  assert_ok(pbf_acquire_snapshot(s, &snapshot));
  assert_fails(pbf_acquire_snapshot(s, &snapshot), PBF_ERROR_STATE, "released first");
  assert_ok(pbf_release_snapshot(&snapshot));
  assert_fails(pbf_release_snapshot(&snapshot), PBF_ERROR_STATE, "nothing is held");
  /* A copy of what has been released, and what never was one. */
  assert_ok(pbf_acquire_snapshot(s, &snapshot));
  pbf_snapshot copy = snapshot;
  assert_ok(pbf_release_snapshot(&snapshot));
  assert_fails(pbf_release_snapshot(&copy), bad, "pbf_acquire_snapshot did not give");
  assert_ok(pbf_set_snapshots(s, 0)); /* none is held any more, and none less than none */
  void *const others[] = {(void *)1, (void *)UINTPTR_MAX, s, &copy, copy.owner};
  for (size_t k = 0; k < sizeof others / sizeof *others; ++k) {
    copy.owner = others[k];
    assert_fails(pbf_release_snapshot(&copy), bad, "pbf_acquire_snapshot did not give");
    assert_true(copy.owner == others[k]);
  }
  snapshot.struct_size = 4;
  assert_fails(pbf_acquire_snapshot(s, &snapshot), PBF_ERROR_STRUCT_SIZE, "pbf_snapshot");
  assert_fails(pbf_release_snapshot(&snapshot), PBF_ERROR_STRUCT_SIZE, "pbf_snapshot");
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(snapshots_are_of_the_last_step),
      cmocka_unit_test(steps_wait_for_nobody),
      cmocka_unit_test(read_while_steps_run),
      cmocka_unit_test(taken_while_a_call_is_inside),
      cmocka_unit_test(held_beyond_the_solver),
      cmocka_unit_test(made_on_request_only),
      cmocka_unit_test(bits_are_as_without),
      cmocka_unit_test(refusals),
  };
  return TEST_RUN(tests);
}
