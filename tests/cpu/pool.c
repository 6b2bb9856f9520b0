/* The pool of `threads`: how many threads there are, and what they come to when the system gives
 * none, when the process forks, and when its solvers are gone. */
#define _GNU_SOURCE /* unshare, syscall */
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#if defined(__linux__)
#include <sched.h>
#include <sys/syscall.h>
#endif
#include <unistd.h>

#include "cpu_support.h"

enum { COUNT = 2000, STEPS = 6 };

static pbf_solver *make(const char *backend, uint32_t threads) {
  pbf_desc desc = cpu_desc(backend, 3, PBF_FLOAT32, COUNT, threads);
  pbf_params params = test_params();
  pbf_solver *solver = test_create(&desc, &params);
  cpu_add_column(solver, COUNT);
  return solver;
}

static uint64_t hash_after(pbf_solver *solver, uint32_t steps) {
  for (uint32_t k = 0; k < steps; ++k) assert_ok(pbf_step(solver, 1));
  return test_hash(solver);
}

static uint64_t expected_hash(void) {
  pbf_solver *solver = make("serial", 1);
  uint64_t hash = hash_after(solver, STEPS);
  pbf_destroy(solver);
  return hash;
}

/* The program's own. */
static int at_rest;

/* One that has ended counts a little longer, and longer where processors are busy. */
static int come_to(int threads) {
  enum { LOOKS = 60000 };
  for (int k = 0; k < LOOKS && cpu_threads_now() != threads; ++k) usleep(1000);
  return cpu_threads_now();
}

static void assert_threads(int expected) { assert_int_equal(come_to(expected), expected); }

static void no_more_than_asked_for_and_gone_at_the_end(void **state) {
  (void)state;
  const uint64_t expected = expected_hash();
  const int before = at_rest;
  pbf_solver *alone = make("threads", 1);
  assert_ok(pbf_step(alone, 2));
  assert_threads(before);
  pbf_solver *two = make("threads", 2), *four = make("threads", 4), *three = make("threads", 3);
  assert_ok(pbf_step(four, 2));
  assert_threads(before + 3);
  assert_true(hash_after(two, STEPS) == expected); /* beside more threads than it wants */
  assert_true(hash_after(three, STEPS) == expected);
  assert_threads(before + 3);
  pbf_destroy(four);
  assert_ok(pbf_step(two, 2));
  assert_ok(pbf_step(three, 2));
  assert_threads(before + 3);
  pbf_destroy(two);
  pbf_destroy(three);
  pbf_destroy(alone);
  assert_threads(before);
}

/* ---- Callers in many threads --------------------------------------------------------------- */

typedef struct caller {
  pbf_solver *solver;
  uint64_t hash;
  int threads;
} caller;

static void *call(void *user) {
  caller *c = user;
  c->hash = hash_after(c->solver, STEPS);
  c->threads = cpu_threads_now();
  return NULL;
}

static void solvers_at_once_share_the_pool(void **state) {
  (void)state;
  enum { CALLERS = 5 };
  const uint64_t expected = expected_hash();
  const int before = at_rest;
  pthread_t threads[CALLERS];
  caller callers[CALLERS];
  for (uint32_t k = 0; k < CALLERS; ++k) callers[k].solver = make("threads", 1 + k % 4);
  for (uint32_t k = 0; k < CALLERS; ++k)
    assert_int_equal(pthread_create(&threads[k], NULL, call, &callers[k]), 0);
  for (uint32_t k = 0; k < CALLERS; ++k) assert_int_equal(pthread_join(threads[k], NULL), 0);
  for (uint32_t k = 0; k < CALLERS; ++k) {
    assert_true(callers[k].hash == expected);
    assert_true(callers[k].threads <= before + CALLERS + 3);
    pbf_destroy(callers[k].solver);
  }
  assert_threads(before);
}

/* Each caller has the same threads beside it, not some of its own. */
static void callers_by_turns_have_one_pool(void **state) {
  (void)state;
  const int before = at_rest;
  pbf_solver *solver = make("threads", 3);
  for (int k = 0; k < 6; ++k) {
    caller c = {.solver = solver};
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, call, &c), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
  }
  assert_threads(before + 2);
  pbf_destroy(solver);
  assert_threads(before);
}

static void *create_and_destroy(void *user) {
  caller *c = user;
  for (int k = 0; k < 8; ++k) {
    pbf_solver *solver = make("threads", 3);
    c->hash = hash_after(solver, STEPS);
    pbf_destroy(solver);
  }
  return NULL;
}

/* A pool that ends while another begins. */
static void pools_come_and_go(void **state) {
  (void)state;
  enum { CALLERS = 3 };
  const uint64_t expected = expected_hash();
  const int before = at_rest;
  pthread_t threads[CALLERS];
  caller callers[CALLERS];
  for (uint32_t k = 0; k < CALLERS; ++k)
    assert_int_equal(pthread_create(&threads[k], NULL, create_and_destroy, &callers[k]), 0);
  for (uint32_t k = 0; k < CALLERS; ++k) {
    assert_int_equal(pthread_join(threads[k], NULL), 0);
    assert_true(callers[k].hash == expected);
  }
  assert_threads(before);
}

static int threads_that_block(int signal) {
  int count = 0;
  DIR *tasks = opendir("/proc/self/task");
  assert_non_null(tasks);
  for (const struct dirent *entry; (entry = readdir(tasks));) {
    char path[300], line[200];
    snprintf(path, sizeof path, "/proc/self/task/%s/status", entry->d_name);
    FILE *status = entry->d_name[0] == '.' ? NULL : fopen(path, "r");
    unsigned long long blocked;
    while (status && fgets(line, sizeof line, status))
      if (sscanf(line, "SigBlk: %llx", &blocked) == 1) count += blocked >> (signal - 1) & 1;
    if (status) fclose(status);
  }
  closedir(tasks);
  return count;
}

/* A program's signals are handled in its own threads. */
static void signals_are_blocked(void **state) {
  (void)state;
  assert_threads(at_rest);
  const int before = threads_that_block(SIGTERM);
  pbf_solver *solver = make("threads", 3);
  assert_ok(pbf_step(solver, 1));
  assert_int_equal(threads_that_block(SIGTERM), before + 2);
  pbf_destroy(solver);
}

/* ---- In a process of its own --------------------------------------------------------------- */

/* Runs `work` in a child, which must return 0 in some minutes. */
static void assert_in_child(int (*work)(void *), void *user) {
  enum { LIMIT = 200 };
  int status = 0;
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    alarm(LIMIT);
    _exit(work(user));
  }
  assert_true(waitpid(child, &status, 0) == child);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_msg("the child ended with %x", status);
}

static int step_without_threads(void *user) {
  const uint64_t *expected = user;
  const struct rlimit one = {1, 1};
  enum { NOBODY = 65534 };
  pthread_t thread;
  caller unused = {NULL, 0, 0};
  const int before = cpu_threads_now();
  setrlimit(RLIMIT_NPROC, &one);
  if (geteuid() == 0 && setuid(NOBODY) != 0) return 2;
  pbf_solver *solver = make("threads", 4);
  uint64_t hash = hash_after(solver, STEPS);
  int threads = cpu_threads_now();
  pbf_destroy(solver);
  if (pthread_create(&thread, NULL, call, &unused) == 0) return 3; /* there was no limit */
  return hash != *expected || threads != before;
}

static void without_threads_the_caller_does_it(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime has threads of its own");
  uint64_t expected = expected_hash();
  assert_in_child(step_without_threads, &expected);
}

static int step_in_child(void *user) {
  const caller *c = user;
  const int before = cpu_threads_now();
  if (before != 1 || hash_after(c->solver, STEPS) != c->hash) return 1;
  pbf_solver *solver = make("threads", 3);
  if (hash_after(solver, STEPS) != c->hash) return 2;
  if (cpu_threads_now() != before + 2) return 3;
  pbf_destroy(solver);
  pbf_destroy(c->solver);
  return come_to(before) == before ? 0 : 4;
}

/* A child has copies of the solvers, and threads of its own. */
static void a_child_has_a_new_pool(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("ThreadSanitizer has no threads in a child of threads");
  caller c = {.solver = make("threads", 3), .hash = expected_hash()};
  pbf_solver *other = make("threads", 3);
  assert_ok(pbf_step(other, 1)); /* the pool is there */
  pbf_destroy(other);
  assert_in_child(step_in_child, &c);
  assert_true(hash_after(c.solver, STEPS) == c.hash);
  assert_threads(at_rest + 2);
  pbf_destroy(c.solver);
}

/* ---- Processes that look alike --------------------------------------------------------------- */

enum { TOO_LONG = 120 /* seconds: for what waits for threads that are not there */ };

/* The child of a fork of which nothing is told: runtimes make them by the system call. */
static void a_child_that_was_not_told(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime wants to be told of forks");
#if defined(__linux__)
  int status = 0;
  caller c = {.solver = make("threads", 3), .hash = expected_hash()};
  assert_ok(pbf_begin_step(c.solver, 1));
  assert_ok(pbf_end_step(c.solver));
  const pid_t child = (pid_t)syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0);
  if (child == 0) {
    alarm(TOO_LONG);
    if (pbf_step(c.solver, 1) != PBF_OK) _exit(1);
    if (pbf_begin_step(c.solver, STEPS - 2) != PBF_OK || pbf_end_step(c.solver) != PBF_OK) _exit(2);
    if (test_hash(c.solver) != c.hash) _exit(3);
    pbf_destroy(c.solver);
    _exit(0);
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  pbf_destroy(c.solver);
  assert_int_equal(status, 0);
#endif
}

#if defined(__linux__)

/* In the first process of a namespace; its child is the first one of another. */
static int fork_as_the_first(void) {
  caller c = {.solver = make("threads", 3)};
  int status = 0;
  if (getpid() != 1) return 10;
  if (pbf_begin_step(c.solver, 1) != PBF_OK || pbf_end_step(c.solver) != PBF_OK) return 11;
  if (unshare(CLONE_NEWPID) != 0) return 77;
  const pid_t child = fork();
  if (child == 0) {
    alarm(TOO_LONG);
    if (getpid() != 1) _exit(12);
    if (pbf_begin_step(c.solver, 1) != PBF_OK || pbf_end_step(c.solver) != PBF_OK) _exit(13);
    if (pbf_step(c.solver, 1) != PBF_OK) _exit(14);
    pbf_destroy(c.solver);
    _exit(0);
  }
  if (waitpid(child, &status, 0) != child) return 15;
  pbf_destroy(c.solver);
  return status == 0 ? 0 : 16;
}

#endif

static void a_child_of_the_same_number(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("ThreadSanitizer has no threads in a child of threads");
#if defined(__linux__)
  int status = 0;
  const pid_t outer = fork();
  if (outer == 0) {
    if (unshare(CLONE_NEWPID) != 0) _exit(77);
    const pid_t first = fork();
    if (first == 0) _exit(fork_as_the_first());
    if (waitpid(first, &status, 0) != first || !WIFEXITED(status)) _exit(17);
    _exit(WEXITSTATUS(status));
  }
  assert_int_equal(waitpid(outer, &status, 0), outer);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) test_skip("this process may not make namespaces");
  assert_int_equal(WEXITSTATUS(status), 0);
#endif
}

/* ---- Signal handlers ----------------------------------------------------------------------- */

/* What the handler has: a solver of its own. */
static pbf_solver *of_handler;
static atomic_int steps_of_handler, put_off_in_handler, refused_to_handler, over;

/* Where a call begins or ends, its thread holds a lock for a moment: a call there is put off. */
static void step_in_handler(int number) {
  pbf_info info = {.struct_size = sizeof info};
  const int error = errno; /* of what it interrupts */
  (void)number;
  pbf_status status = pbf_get_info(of_handler, &info);
  if (status == PBF_OK) status = pbf_step(of_handler, 1);
  if (status == PBF_OK)
    ++steps_of_handler;
  else if (status == PBF_ERROR_BUSY)
    ++put_off_in_handler;
  else
    ++refused_to_handler;
  errno = error;
}

static int calls_of_handler(void) {
  return steps_of_handler + put_off_in_handler + refused_to_handler;
}

static void *send_signals(void *to) {
  const pthread_t thread = *(pthread_t *)to;
  while (!over) {
    const int before = calls_of_handler();
    pthread_kill(thread, SIGUSR1);
    while (!over && calls_of_handler() == before) usleep(50);
    usleep(200); /* for the thread's own step */
  }
  return NULL;
}

/* One that interrupts a step where that holds the pool's lock does not wait for it. */
static void a_handler_steps_another_solver(void **state) {
  (void)state;
  enum {
    ENOUGH = TEST_INSTRUMENTED ? 100 : 500,
    TIME_LIMIT = 400 /* seconds: for what waits for itself */
  };
  pbf_solver *solver = make("threads", 4), *twin = make("serial", 1), *small = make("serial", 1);
  of_handler = make("threads", 4);
  pthread_t sender, self = pthread_self();
  const struct sigaction action = {.sa_handler = step_in_handler, .sa_flags = SA_RESTART};
  struct sigaction before;
  uint32_t steps = 0;
  assert_ok(pbf_step(of_handler, 20)); /* what it allocates, it has then */
  assert_int_equal(sigaction(SIGUSR1, &action, &before), 0);
  alarm(TIME_LIMIT);
  assert_int_equal(pthread_create(&sender, NULL, send_signals, &self), 0);
  for (; steps_of_handler < ENOUGH; ++steps) assert_ok(pbf_step(solver, 1));
  over = 1;
  pthread_join(sender, NULL);
  alarm(0);
  sigaction(SIGUSR1, &before, NULL);
  assert_int_equal(refused_to_handler, 0);
  assert_in_range(put_off_in_handler, 0, steps_of_handler / 10);
  assert_ok(pbf_step(twin, steps));
  assert_ok(pbf_step(small, 20 + (uint32_t)steps_of_handler));
  assert_true(test_hash(solver) == test_hash(twin));
  assert_true(test_hash(of_handler) == test_hash(small));
  pbf_destroy(solver);
  pbf_destroy(twin);
  pbf_destroy(small);
  pbf_destroy(of_handler);
}

static void *begin(void *unused) { return unused; }

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_more_than_asked_for_and_gone_at_the_end),
      cmocka_unit_test(solvers_at_once_share_the_pool),
      cmocka_unit_test(callers_by_turns_have_one_pool),
      cmocka_unit_test(pools_come_and_go),
      cmocka_unit_test(signals_are_blocked),
      cmocka_unit_test(without_threads_the_caller_does_it),
      cmocka_unit_test(a_child_has_a_new_pool),
      cmocka_unit_test(a_child_that_was_not_told),
      cmocka_unit_test(a_child_of_the_same_number),
      cmocka_unit_test(a_handler_steps_another_solver),
  };
  /* A sanitizer's own thread comes with the first one. */
  pthread_t first;
  if (pthread_create(&first, NULL, begin, NULL) != 0 || pthread_join(first, NULL) != 0) return 1;
  usleep(10000);
  at_rest = cpu_threads_now();
  return TEST_RUN(tests);
}
