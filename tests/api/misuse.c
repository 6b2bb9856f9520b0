/* What a program can do wrong beside a wrong value: sizes that overflow, calls from within calls,
 * from many threads, in the wrong order. */
#include <pthread.h>

#include "support.h"

/* ---- Sizes ---- */

/* No more than so many bytes a call; notes the largest that was asked for. */
typedef struct thrifty {
  uint64_t most, largest_asked;
} thrifty;

static void *allocate_little(void *user, uint64_t size, uint64_t alignment) {
  thrifty *t = user;
  if (size > t->largest_asked) t->largest_asked = size;
  return size > t->most ? NULL : test_allocator.allocate(test_allocator.user, size, alignment);
}

static void release_little(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user;
  test_allocator.release(test_allocator.user, memory, size, alignment);
}

/* The largest capacity there is: 64 bits or nothing. An array that wrapped around at 2^32 bytes
 * would fit into what this allocator gives. */
static void the_largest_capacity(uint32_t dimension, uint32_t precision) {
  thrifty t = {.most = UINT64_C(1) << 20};
  const pbf_allocator allocator = {sizeof allocator, 0, &t, allocate_little, release_little};
  pbf_desc desc = test_desc(dimension, precision, PBF_MAX_CAPACITY);
  pbf_solver *none = NULL;
  desc.allocator = &allocator;
  pbf_status status = pbf_create(&desc, NULL, &none);
  assert_int_equal(status, PBF_ERROR_OUT_OF_MEMORY);
  assert_true(pbf_last_error()[0]);
  assert_null(none);
  assert_true(t.largest_asked >= (uint64_t)PBF_MAX_CAPACITY * 4);
  assert_int_equal(test_count.live_blocks, 0);
}

static void capacities_without_memory(void **state) {
  (void)state;
  if (strcmp(test_backend(), "cuda") == 0)
    test_skip("cuda's memory is the device's, which no allocator of the caller's gives");
  test_for_each_kind(the_largest_capacity);
}

static void counts_without_memory(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT64, 4, 8);
  double x[3] = {0.5, 0.5, 0.5};
  uint32_t id = 0;
  uint64_t before = test_hash(s), size = UINT64_MAX;
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  assert_fails(pbf_add_particles(s, UINT32_MAX, x, x, NULL), PBF_ERROR_CAPACITY, "4294967295");
  assert_fails(pbf_add_particles(s, UINT32_MAX - 3, x, x, NULL), PBF_ERROR_CAPACITY, "4294967292");
  assert_fails(pbf_remove_particles(s, UINT32_MAX, &id), PBF_ERROR_NOT_FOUND, "4294967295");
  assert_fails(pbf_set_velocities(s, 1, UINT32_MAX, x), PBF_ERROR_INVALID_ARGUMENT, "4294967295");
  assert_fails(pbf_get_ids(s, UINT32_MAX, UINT32_MAX, &id), PBF_ERROR_INVALID_ARGUMENT, "first is");
  assert_fails(pbf_set_colliders(s, UINT32_MAX, &ball), PBF_ERROR_INVALID_ARGUMENT, "at most 4096");
  assert_fails(pbf_get_collider(s, UINT32_MAX, &ball), PBF_ERROR_NOT_FOUND, "4294967295");
  assert_fails(pbf_load(s, "PBFSTATE", 8), PBF_ERROR_DATA, "cut short");
  unsigned char *buffer = malloc(1 << 16);
  assert_ok(pbf_save(s, buffer, &size)); /* room without end is room enough */
  assert_fails(pbf_load(s, buffer, size - 1), PBF_ERROR_DATA, "cut short");
  assert_int_equal(test_hash(s), before);
  free(buffer);
  pbf_destroy(s);
}

/* ---- Calls from within calls ---- */

typedef struct reentrant {
  pbf_solver *solver;
  uint32_t asked;
  pbf_status seen;
} reentrant;

static void *allocate_and_call(void *user, uint64_t size, uint64_t alignment) {
  reentrant *r = user;
  uint32_t count;
  if (r->solver) {
    ++r->asked;
    r->seen = pbf_get_count(r->solver, &count);
  }
  return test_allocator.allocate(test_allocator.user, size, alignment);
}

static void release_back(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user;
  test_allocator.release(test_allocator.user, memory, size, alignment);
}

/* An allocator that asks the solver it works for: refused, where a lock would have waited for ever.
 */
static void a_call_from_the_allocator(void **state) {
  (void)state;
  reentrant r = {.seen = PBF_OK};
  const pbf_allocator allocator = {sizeof allocator, 0, &r, allocate_and_call, release_back};
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  desc.allocator = &allocator;
  pbf_solver *s = test_create(&desc, NULL);
  float x[3] = {0.5f, 0.5f, 0.5f};
  r.solver = s;
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_int_not_equal(r.asked, 0);
  assert_int_equal(r.seen, PBF_ERROR_BUSY);
  r.solver = NULL;
  assert_int_not_equal(test_hash(s), 0);
  pbf_destroy(s);
}

/* ---- Many threads, one solver ---- */

enum { THREADS = 4, ROUNDS = 200 };

typedef struct rival {
  pbf_solver *solver;
  uint32_t added, others; /* calls that were neither done nor refused as they should be */
} rival;

static void note(rival *r, pbf_status status, uint32_t adds) {
  if (status == PBF_OK) {
    r->added += adds;
  } else if (status != PBF_ERROR_BUSY) {
    ++r->others;
  }
}

static void *compete(void *user) {
  rival *r = user;
  float x[3] = {0.5f, 0.5f, 0.5f};
  for (int round = 0; round < ROUNDS; ++round) {
    uint32_t count;
    uint64_t hash;
    pbf_params params = {.struct_size = sizeof params};
    note(r, pbf_add_particles(r->solver, 1, x, NULL, NULL), 1);
    note(r, pbf_step(r->solver, 1), 0);
    note(r, pbf_get_count(r->solver, &count), 0);
    note(r, pbf_hash(r->solver, &hash), 0);
    note(r, pbf_get_params(r->solver, &params), 0);
  }
  return NULL;
}

/* Each call is done as a whole or refused: in the end the books are right. */
static void rivals(void **state) {
  (void)state;
  pthread_t threads[THREADS];
  rival all[THREADS];
  pbf_desc desc = test_desc(3, PBF_FLOAT32, THREADS * ROUNDS);
  desc.allocator = NULL;
  desc.threads = 1;
  pbf_solver *s = test_create(&desc, NULL);
  for (int i = 0; i < THREADS; ++i) {
    all[i] = (rival){.solver = s};
    assert_int_equal(pthread_create(&threads[i], NULL, compete, &all[i]), 0);
  }
  uint32_t added = 0, count = 0, ids[THREADS * ROUNDS];
  for (int i = 0; i < THREADS; ++i) {
    assert_int_equal(pthread_join(threads[i], NULL), 0);
    added += all[i].added;
    assert_int_equal(all[i].others, 0);
  }
  assert_ok(pbf_get_count(s, &count));
  assert_int_equal(count, added);
  assert_ok(pbf_get_ids(s, 0, count, ids));
  for (uint32_t i = 0; i < count; ++i) assert_int_equal(ids[i], i);
  pbf_destroy(s);
}

/* ---- The wrong order ---- */

static void times_before_timing(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 8);
  pbf_timings timings = {.struct_size = sizeof timings};
  pbf_status status = pbf_get_timings(s, &timings);
  assert_true(status == PBF_OK || status == PBF_ERROR_UNSUPPORTED);
  for (uint32_t i = 0; i < timings.stage_count; ++i) assert_int_equal(timings.stages[i].runs, 0);
  assert_fails(pbf_unmap(s, PBF_FIELD_POSITION), PBF_ERROR_STATE, "no view is mapped");
  assert_fails(pbf_get_collider(s, 0, &(pbf_collider){.struct_size = sizeof(pbf_collider)}),
               PBF_ERROR_NOT_FOUND, "0 colliders");
  assert_ok(pbf_step(s, 0));
  assert_ok(pbf_synchronize(s));
  pbf_destroy(s);
}

/* A new solver where a destroyed one was may get its handle, but never its particles. */
static void a_handle_that_comes_back(void **state) {
  (void)state;
  for (int round = 0; round < 20; ++round) {
    pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 8);
    uint32_t count = 9;
    pbf_destroy(s);
    assert_fails(pbf_get_count(s, &count), PBF_ERROR_INVALID_ARGUMENT, "has taken back");
    pbf_solver *next = test_solver(3, PBF_FLOAT32, 8);
    assert_ok(pbf_get_count(next, &count));
    assert_int_equal(count, 0);
    pbf_destroy(next);
    pbf_destroy(next);
    pbf_destroy(s);
  }
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- What a CPU has not ---- */

static void devices_and_streams_of_a_cpu(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *solver = NULL;
  int stream;
  if (test_is_stub() || strcmp(desc.backend, "cuda") == 0) test_skip("no backend on a CPU");
  desc.device = 7;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE,
               "desc.device is 7; it must be 0");
  desc.device = 0;
  desc.stream = &stream;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT,
               "desc.stream is not null");
  assert_null(solver);
  assert_int_equal(test_count.live_blocks, 0);
}

/* They are those of the backend that was asked for; what serves instead takes its own. */
static void devices_of_another_backend(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *solver = NULL;
  pbf_info info = {.struct_size = sizeof info};
  int stream;
  if (pbf_load_backend(PBF_STUB_DIR "/failing_probe.so") == PBF_ERROR_UNSUPPORTED)
    test_skip("a static build has no stub");
  desc.backend = "failing";
  desc.strict = 0;
  desc.device = 7;
  desc.stream = &stream;
  assert_ok(pbf_create(&desc, NULL, &solver));
  assert_ok(pbf_get_info(solver, &info));
  assert_int_equal(info.fell_back, 1);
  assert_int_equal(info.device, 0);
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest misuse[] = {
      cmocka_unit_test(capacities_without_memory),  cmocka_unit_test(counts_without_memory),
      cmocka_unit_test(a_call_from_the_allocator),  cmocka_unit_test(rivals),
      cmocka_unit_test(times_before_timing),        cmocka_unit_test(devices_and_streams_of_a_cpu),
      cmocka_unit_test(devices_of_another_backend), cmocka_unit_test(a_handle_that_comes_back),
  };
  return TEST_RUN(misuse);
}
