/* Two threads in one solver, many solvers in many threads. */
#include <pthread.h>

#include <dlpack/dlpack.h>

#include "support.h"

/* What a second thread met while the first one was inside. */
typedef struct visitor {
  pbf_solver *solver;
  pbf_status step, get, destroyed;
  int busy_was_named;
} visitor;

static void *visit(void *user) {
  visitor *v = user;
  uint32_t count;
  v->step = pbf_step(v->solver, 1);
  v->busy_was_named = strstr(pbf_last_error(), "one thread at a time") != NULL;
  v->get = pbf_get_count(v->solver, &count);
  return NULL;
}

static void let_another_thread_in(void *user) {
  pthread_t thread;
  assert_int_equal(pthread_create(&thread, NULL, visit, user), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
}

static void a_second_thread_is_refused(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  visitor v = {.solver = s};
  control->inside_step = let_another_thread_in;
  control->user = &v;
  assert_ok(pbf_step(s, 1));
  assert_int_equal(v.step, PBF_ERROR_BUSY);
  assert_int_equal(v.get, PBF_ERROR_BUSY);
  assert_true(v.busy_was_named);
  test_stub_control();
  assert_ok(pbf_step(s, 1));
  pbf_destroy(s);
}

static void *destroy_it(void *user) {
  visitor *v = user;
  pbf_destroy(v->solver);
  v->destroyed = pbf_step(v->solver, 1);
  return NULL;
}

static void let_another_thread_destroy(void *user) {
  pthread_t thread;
  assert_int_equal(pthread_create(&thread, NULL, destroy_it, user), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
}

/* A mistake of the caller, yet no memory is touched after it is freed: the last one out frees it.
 */
static void destroyed_while_inside(void **state) {
  (void)state;
  ballistic_control *control = test_stub_control();
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 8);
  visitor v = {.solver = s};
  control->inside_step = let_another_thread_destroy;
  control->user = &v;
  assert_ok(pbf_step(s, 1));
  assert_int_equal(v.destroyed, PBF_ERROR_INVALID_ARGUMENT);
  assert_int_equal(test_count.live_blocks, 0);
  test_stub_control();
}

static void *whole_life(void *user) {
  uint64_t *hash = user;
  pbf_desc desc = {0};
  pbf_desc_init(&desc, sizeof desc);
  desc.backend = "ballistic";
  desc.strict = 1;
  desc.capacity = 16;
  for (int round = 0; round < 50; ++round) {
    pbf_solver *s = NULL;
    DLManagedTensor *tensor = NULL;
    float x[3] = {0.5f, 0.5f, 0.5f};
    if (pbf_create(&desc, NULL, &s) || pbf_add_particles(s, 1, x, NULL, NULL) || pbf_step(s, 5) ||
        pbf_hash(s, hash) || pbf_export_dlpack(s, PBF_FIELD_POSITION, &tensor))
      *hash = 0;
    pbf_destroy(s);
    if (tensor) tensor->deleter(tensor);
  }
  return NULL;
}

static void solvers_side_by_side(void **state) {
  (void)state;
  enum { THREADS = 8 };
  pthread_t threads[THREADS];
  uint64_t hashes[THREADS] = {0};
  test_stub_control();
  for (int i = 0; i < THREADS; ++i)
    assert_int_equal(pthread_create(&threads[i], NULL, whole_life, &hashes[i]), 0);
  for (int i = 0; i < THREADS; ++i) assert_int_equal(pthread_join(threads[i], NULL), 0);
  assert_int_not_equal(hashes[0], 0);
  for (int i = 1; i < THREADS; ++i) assert_int_equal(hashes[i], hashes[0]);
}

static void *fail_here(void *user) {
  char **sentence = user;
  pbf_get_count(NULL, NULL);
  *sentence = strstr(pbf_last_error(), "solver is null") ? "as expected" : "something else";
  return NULL;
}

/* The sentence belongs to the thread. */
static void sentences_do_not_mix(void **state) {
  (void)state;
  pthread_t thread;
  const char *other = NULL;
  assert_fails(pbf_load_backend("relative"), PBF_ERROR_INVALID_ARGUMENT, "absolute");
  assert_int_equal(pthread_create(&thread, NULL, fail_here, &other), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  assert_string_equal(other, "as expected");
  assert_non_null(strstr(pbf_last_error(), "absolute"));
}

int main(void) {
  const struct CMUnitTest threads[] = {
      cmocka_unit_test(a_second_thread_is_refused),
      cmocka_unit_test(destroyed_while_inside),
      cmocka_unit_test(solvers_side_by_side),
      cmocka_unit_test(sentences_do_not_mix),
  };
  return TEST_RUN(threads);
}
