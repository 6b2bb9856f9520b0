/* A log that is called by the thread of begun steps: which signals it takes, and what it may
 * destroy.
 */
#define _GNU_SOURCE
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "support.h"

enum { COUNT = 60, FOREVER = 2000000000 };

static atomic_int blocks, logs;

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  (void)user;
  atomic_fetch_add(&blocks, 1);
  return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user, (void)size, (void)alignment;
  free(memory);
  atomic_fetch_sub(&blocks, 1);
}

/* Its steps are too long for two causes, each of which is logged. */
static pbf_solver *logging(pbf_log_fn log, void *user) {
  static const pbf_allocator counted = {sizeof counted, 0, NULL, allocate, release};
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  pbf_params params = test_params();
  float *x = test_lattice(3, PBF_FLOAT32, COUNT);
  desc.allocator = &counted;
  desc.log = log, desc.log_user = user;
  params.time_step = 1;
  params.attraction = 20;
  pbf_solver *solver = test_create(&desc, &params);
  assert_ok(pbf_add_particles(solver, COUNT, x, NULL, NULL));
  free(x);
  atomic_store(&logs, 0);
  return solver;
}

static void wait_until_free(void) {
  const struct timespec millisecond = {0, 1000000};
  for (int k = 0; k < 60000 && atomic_load(&blocks) > 0; ++k) nanosleep(&millisecond, NULL);
  assert_int_equal(atomic_load(&blocks), 0);
}

/* ---- Destroyed from inside ------------------------------------------------------------------- */

typedef struct owner {
  pbf_solver *_Atomic solver;
} owner;

static void destroy_it(void *user, int32_t level, const char *message) {
  owner *own = user;
  (void)level, (void)message;
  atomic_fetch_add(&logs, 1);
  pbf_destroy(atomic_exchange(&own->solver, NULL));
}

static void a_log_of_begun_steps_destroys(void **state) {
  (void)state;
  owner own = {NULL};
  pbf_solver *solver = logging(destroy_it, &own);
  atomic_store(&own.solver, solver);
  assert_ok(pbf_begin_step(solver, FOREVER));
  wait_until_free();
  assert_int_equal(atomic_load(&logs), 1); /* what it belongs to may be gone, too */
  assert_fails(pbf_end_step(solver), PBF_ERROR_INVALID_ARGUMENT, "has taken back");
}

static void a_snapshot_outlives_that(void **state) {
  (void)state;
  owner own = {NULL};
  pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
  pbf_solver *solver = logging(destroy_it, &own);
  assert_ok(pbf_set_snapshots(solver, 2));
  assert_ok(pbf_acquire_snapshot(solver, &snapshot));
  atomic_store(&own.solver, solver);
  assert_ok(pbf_begin_step(solver, FOREVER));
  while (atomic_load(&logs) == 0) sched_yield();
  assert_int_equal(snapshot.count, COUNT);
  assert_ok(pbf_release_snapshot(&snapshot));
  wait_until_free();
}

static void a_log_of_a_step_destroys(void **state) {
  (void)state;
  owner own = {NULL};
  pbf_solver *solver = logging(destroy_it, &own);
  atomic_store(&own.solver, solver);
  assert_ok(pbf_step(solver, 1));
  assert_int_equal(atomic_load(&blocks), 0);
  assert_int_equal(atomic_load(&logs), 1);
}

/* ---- Signals ----------------------------------------------------------------------------------
 */

static unsigned char *page;
static atomic_int faults, stops;

/* As runtimes make an exception of a null reference: here the page can be read from now on. */
static void mend(int signal) {
  (void)signal;
  atomic_fetch_add(&faults, 1);
  if (mprotect(page, 1, PROT_READ) != 0) _exit(3);
}

static void stop(int signal) {
  (void)signal;
  atomic_fetch_add(&stops, 1);
}

static int is_blocked(int signal) {
  sigset_t now;
  return pthread_sigmask(SIG_SETMASK, NULL, &now) != 0 || sigismember(&now, signal);
}

static void fault_and_stop(void *user, int32_t level, const char *message) {
  const volatile unsigned char *place = page;
  int *wrong = user;
  (void)level, (void)message;
  if (atomic_fetch_add(&logs, 1) > 0) return;
  if (*place != 0) *wrong |= 1;
  pthread_kill(pthread_self(), SIGRTMIN + 1);
  if (atomic_load(&stops) != 1) *wrong |= 2;
  if (!is_blocked(SIGTERM) || !is_blocked(SIGALRM) || !is_blocked(SIGCHLD)) *wrong |= 4;
  if (!is_blocked(SIGRTMIN + 2)) *wrong |= 8; /* as the thread that began has it */
}

static void catch_signal(int signal, void (*handler)(int)) {
  struct sigaction action = {.sa_handler = handler};
  sigemptyset(&action.sa_mask);
  assert_int_equal(sigaction(signal, &action, NULL), 0);
}

static void runtimes_take_faults_and_stops(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer takes faults");
  sigset_t waited_for;
  int wrong = 0;
  page = mmap(NULL, (size_t)sysconf(_SC_PAGESIZE), PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  assert_true(page != MAP_FAILED);
  catch_signal(SIGSEGV, mend);
  catch_signal(SIGRTMIN + 1, stop);
  sigemptyset(&waited_for);
  sigaddset(&waited_for, SIGRTMIN + 2);
  assert_int_equal(pthread_sigmask(SIG_BLOCK, &waited_for, NULL), 0);
  pbf_solver *solver = logging(fault_and_stop, &wrong);
  assert_ok(pbf_begin_step(solver, 1));
  assert_ok(pbf_end_step(solver));
  assert_true(atomic_load(&logs) > 0);
  assert_int_equal(atomic_load(&faults), 1);
  assert_int_equal(wrong, 0);
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_log_of_begun_steps_destroys),
      cmocka_unit_test(a_snapshot_outlives_that),
      cmocka_unit_test(a_log_of_a_step_destroys),
      cmocka_unit_test(runtimes_take_faults_and_stops),
  };
  return TEST_RUN(tests);
}
