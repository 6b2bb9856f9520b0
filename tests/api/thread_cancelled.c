/* pthread_cancel: a call that it meets is done as a whole, and leaves the solver as a call does.
 * pthread_exit in a callback: nothing waits for the thread, and the solver can be destroyed. And
 * signals: they go to none of the library's threads. */
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "support.h"

enum { COUNT = 1000, ROUNDS = 12 };

static void skip_where_it_is_not_to_be_seen(void) {
  if (TEST_INSTRUMENTED)
    test_skip("sanitizers have locks of their own, which threads leave closed");
}

static pbf_solver *block(uint32_t threads) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  desc.threads = threads;
  pbf_solver *s = test_create(&desc, NULL);
  float x[COUNT][3];
  for (int i = 0; i < COUNT; ++i)
    for (int k = 0, rest = i; k < 3; ++k, rest /= 10) x[i][k] = 0.125f + 0.05f * (float)(rest % 10);
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  return s;
}

/* So many calls have begun, in the thread that is to be cancelled. */
static _Atomic uint32_t begun;
static char why[512]; /* one failed */

static void *failed(void) {
  snprintf(why, sizeof why, "%s", pbf_last_error());
  return why;
}

static void *steps_for_ever(void *solver) {
  for (;; pthread_testcancel()) {
    ++begun;
    if (pbf_step((pbf_solver *)solver, 1) != PBF_OK) return failed();
  }
}

static void *steps_at_any_time(void *solver) {
  pthread_setcanceltype(PTHREAD_CANCEL_ASYNCHRONOUS, NULL);
  return steps_for_ever(solver);
}

static void *begins_for_ever(void *solver) {
  for (;; pthread_testcancel()) {
    ++begun;
    if (pbf_begin_step((pbf_solver *)solver, 1) != PBF_OK) return failed();
    if (pbf_end_step((pbf_solver *)solver) != PBF_OK) return failed();
  }
}

static void *creates_for_ever(void *unused) {
  for (;; pthread_testcancel()) {
    pbf_solver *s = NULL;
    pbf_desc desc = test_desc(2, PBF_FLOAT64, 10);
    ++begun;
    desc.allocator = NULL; /* a solver that a thread forgets is no leak of the library's */
    if (pbf_create(&desc, NULL, &s) != PBF_OK) return failed();
    pbf_destroy(s);
  }
  return unused;
}

static void cancel_after(void *(*function)(void *), void *user, uint32_t calls, long nanoseconds) {
  pthread_t thread;
  void *result = NULL;
  begun = 0;
  assert_int_equal(pthread_create(&thread, NULL, function, user), 0);
  const struct timespec nap = {0, nanoseconds};
  do nanosleep(&nap, NULL);
  while (begun < calls);
  assert_int_equal(pthread_cancel(thread), 0);
  assert_int_equal(pthread_join(thread, &result), 0);
  if (result == why) fail_msg("a call failed: %s", why);
}

/* As many steps as it counts have been made, to the bit. */
static void goes_on(pbf_solver *s) {
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_info(s, &info));
  pbf_solver *undisturbed = block(1);
  assert_ok(pbf_step(undisturbed, (uint32_t)info.step));
  assert_true(test_hash(s) == test_hash(undisturbed));
  pbf_destroy(undisturbed);
}

static void cancel(void *(*function)(void *)) {
  skip_where_it_is_not_to_be_seen();
  for (long round = 0; round < ROUNDS; ++round) {
    pbf_solver *s = block(3);
    cancel_after(function, s, 2, 30000 + 170000 * round);
    goes_on(s);
    pbf_destroy(s);
  }
  assert_int_equal(test_count.live_bytes, 0);
}

static void in_a_step(void **state) {
  (void)state;
  cancel(steps_for_ever);
}

static void at_any_time(void **state) {
  (void)state;
  /* Seen on an H100: the thread ends inside a step, which leaves the solver busy. */
  if (strcmp(test_backend(), "cuda") == 0)
    test_skip("asynchronous cancellation ends a step on cuda");
  cancel(steps_at_any_time);
}

static void in_steps_that_have_begun(void **state) {
  (void)state;
  cancel(begins_for_ever);
}

static void while_solvers_are_made(void **state) {
  (void)state;
  skip_where_it_is_not_to_be_seen();
  (void)test_desc(2, PBF_FLOAT64, 10); /* which skips in this thread what is not built */
  for (long round = 0; round < ROUNDS; ++round)
    cancel_after(creates_for_ever, NULL, 3, 10000 + 30000 * round);
  pbf_destroy(block(2));
  assert_int_equal(test_count.live_bytes, 0);
}

/* ---- Threads that end in a callback ------------------------------------------------------------
 */

static pthread_t waiting; /* which is to go on */

static void end_thread(void *user, int32_t level, const char *message) {
  (void)user, (void)level, (void)message;
  if (!pthread_equal(pthread_self(), waiting)) pthread_exit(NULL);
}

/* Its steps are so long that it warns of them. */
static pbf_solver *ending_threads(void) {
  waiting = pthread_self();
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  pbf_params params = test_params();
  desc.log = end_thread;
  params.time_step = 0.2;
  pbf_solver *s = test_create(&desc, &params);
  const float x[3] = {0.5f, 0.5f, 0.5f};
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  return s;
}

static void can_only_be_destroyed(pbf_solver *s) {
  assert_fails(pbf_step(s, 1), PBF_ERROR_STATE, "the end of its thread");
  assert_fails(pbf_begin_step(s, 1), PBF_ERROR_STATE, "the end of its thread");
  assert_fails(pbf_end_step(s), PBF_ERROR_STATE, "the end of its thread");
  pbf_destroy(s);
  assert_int_equal(test_count.live_blocks, 0);
}

static void *step_once(void *solver) {
  (void)pbf_step((pbf_solver *)solver, 1);
  return solver;
}

static void a_callback_ends_the_calling_thread(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub warns of nothing");
  pthread_t thread;
  void *returned;
  pbf_solver *s = ending_threads();
  assert_int_equal(pthread_create(&thread, NULL, step_once, s), 0);
  assert_int_equal(pthread_join(thread, &returned), 0);
  assert_null(returned);
  can_only_be_destroyed(s);
}

static void a_callback_ends_the_thread_of_begun_steps(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub warns of nothing");
  for (int waits = 0; waits < 2; ++waits) {
    pbf_solver *s = ending_threads();
    assert_ok(pbf_begin_step(s, 1));
    pbf_status status = PBF_OK;
    if (waits) { /* until it has ended */
      uint32_t count;
      while ((status = pbf_get_count(s, &count)) == PBF_ERROR_BUSY) sched_yield();
    } else {
      status = pbf_end_step(s);
    }
    assert_int_equal(status, PBF_ERROR_STATE);
    assert_non_null(strstr(pbf_last_error(), "can only be destroyed"));
    can_only_be_destroyed(s);
  }
}

/* ---- Signals --------------------------------------------------------------------------------- */

static pthread_t program;
static _Atomic int calls, takes_signals;

static void look_at_the_mask(void *user, int32_t level, const char *message) {
  sigset_t blocked;
  (void)user, (void)level, (void)message;
  if (pthread_equal(pthread_self(), program)) return;
  pthread_sigmask(SIG_SETMASK, NULL, &blocked);
  ++calls;
  if (!sigismember(&blocked, SIGALRM) || !sigismember(&blocked, SIGUSR1)) takes_signals = 1;
}

static void signals_are_for_the_program(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub warns of nothing");
  program = pthread_self();
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  pbf_params params = test_params();
  desc.log = look_at_the_mask;
  params.time_step = 0.2; /* of which it warns */
  pbf_solver *s = test_create(&desc, &params);
  const float x[3] = {0.5f, 0.5f, 0.5f};
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_ok(pbf_begin_step(s, 1));
  assert_ok(pbf_end_step(s));
  pbf_destroy(s);
  assert_true(calls > 0);
  assert_false(takes_signals);
}

enum { SIGNALS = 32 }; /* those that may be looked at everywhere */

static void look_at_handlers(struct sigaction actions[SIGNALS], sigset_t *blocked) {
  for (int k = 1; k < SIGNALS; ++k) assert_int_equal(sigaction(k, NULL, &actions[k]), 0);
  assert_int_equal(pthread_sigmask(SIG_SETMASK, NULL, blocked), 0);
}

static void ignore(int number) { (void)number; }

static void handlers_stay_as_they_are(void **state) {
  (void)state;
  struct sigaction before[SIGNALS], own = {.sa_handler = ignore}, crash, after[SIGNALS];
  sigset_t blocked_before, blocked;
  assert_int_equal(sigaction(SIGSEGV, &own, &crash), 0);
  look_at_handlers(before, &blocked_before);
  pbf_solver *s = block(3);
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_begin_step(s, 1));
  assert_ok(pbf_end_step(s));
  pbf_destroy(s);
  look_at_handlers(after, &blocked);
  for (int k = 1; k < SIGNALS; ++k) {
    assert_true(after[k].sa_handler == before[k].sa_handler);
    assert_int_equal(sigismember(&blocked, k), sigismember(&blocked_before, k));
  }
  assert_int_equal(sigaction(SIGSEGV, &crash, NULL), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(in_a_step),
      cmocka_unit_test(at_any_time),
      cmocka_unit_test(in_steps_that_have_begun),
      cmocka_unit_test(while_solvers_are_made),
      cmocka_unit_test(a_callback_ends_the_calling_thread),
      cmocka_unit_test(a_callback_ends_the_thread_of_begun_steps),
      cmocka_unit_test(signals_are_for_the_program),
      cmocka_unit_test(handlers_stay_as_they_are),
  };
  return TEST_RUN(tests);
}
