/* Processes that fork, as servers and pools of workers do: in the child every call works, or says
 * why not; none waits for threads that are not there. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "support.h"

enum { COUNT = 500, TIME_LIMIT = 120 /* seconds: in a child that hangs */ };

/* A backend's device may not come along. */
static int may_refuse(void) { return strcmp(test_backend(), "cuda") == 0; }

static int is_fine(pbf_status status) {
  return status == PBF_OK || (may_refuse() && pbf_last_error()[0]);
}

/* In a child, where cmocka's own checks would go back into the test. */
static int failed;
static void check_at(int condition, const char *what, int line) {
  if (condition) return;
  failed = 1;
  fprintf(stderr, "line %d, in the child: not so: %s (\"%s\")\n", line, what, pbf_last_error());
}
#define check(condition) check_at((condition) != 0, #condition, __LINE__)

static pid_t begin_child(void) {
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) alarm(TIME_LIMIT);
  return child;
}

static void end_child(void) {
  fflush(NULL);
  _exit(failed);
}

static void assert_child_ended_well(pid_t child) {
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status)); /* no alarm */
  assert_int_equal(WEXITSTATUS(status), 0);
}

static uint64_t hash_of(pbf_solver *solver) {
  uint64_t hash = 0;
  return pbf_hash(solver, &hash) == PBF_OK ? hash : 0;
}

static void use_a_new_solver(void) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  pbf_solver *solver = NULL;
  pbf_status status = pbf_create(&desc, NULL, &solver);
  check(is_fine(status));
  if (status != PBF_OK) return;
  float *x = test_lattice(3, PBF_FLOAT32, COUNT);
  check(is_fine(pbf_add_particles(solver, COUNT, x, NULL, NULL)));
  check(is_fine(pbf_step(solver, 2)));
  free(x);
  pbf_destroy(solver);
}

/* A sanitizer's runtime has locks of its own, which a fork leaves taken,
 * and counts the threads of the parent as lost. */
static void skip_under_sanitizers(void) {
  if (TEST_INSTRUMENTED) test_skip("forks beside threads hang in the sanitizer's own locks");
}

static void parent_and_child_go_on(void **state) {
  (void)state;
  skip_under_sanitizers();
  for (int before = 0; before <= 3; before += 3) {
    pbf_solver *solver = test_filled(3, PBF_FLOAT32, COUNT, COUNT);
    int ends[2];
    uint64_t theirs = 0;
    assert_ok(pbf_step(solver, (uint32_t)before));
    assert_int_equal(pipe(ends), 0);
    pid_t child = begin_child();
    if (child == 0) {
      check(is_fine(pbf_step(solver, 4)));
      theirs = hash_of(solver);
      check(write(ends[1], &theirs, sizeof theirs) == sizeof theirs);
      use_a_new_solver();
      pbf_destroy(solver);
      end_child();
    }
    assert_ok(pbf_step(solver, 4));
    assert_child_ended_well(child);
    assert_int_equal(read(ends[0], &theirs, sizeof theirs), sizeof theirs);
    if (!may_refuse()) assert_int_equal(theirs, test_hash(solver));
    close(ends[0]);
    close(ends[1]);
    pbf_destroy(solver);
  }
}

/* ---- Beside a thread that is busy ---- */

typedef struct busy {
  pbf_solver *solver;
  volatile int over;
} busy;

static void *ask_and_ask(void *user) {
  busy *b = user;
  while (!b->over) {
    uint32_t count;
    pbf_get_count(b->solver, &count);
    pbf_get_backend_count(&count);
  }
  return NULL;
}

static void *step_and_step(void *user) {
  busy *b = user;
  while (!b->over) pbf_step(b->solver, 20);
  return NULL;
}

/* What the other thread is in the middle of is not there in the child, and says so. */
static void use_what_was_busy(pbf_solver *solver, int *was_inside) {
  pbf_status status = pbf_step(solver, 1);
  *was_inside = status == PBF_ERROR_STATE && strstr(pbf_last_error(), "was forked off");
  check(is_fine(status) || *was_inside);
  pbf_destroy(solver);
}

static void fork_beside(void *(*work)(void *), int forks, int *inside) {
  busy b = {.solver = test_filled(3, PBF_FLOAT32, COUNT, COUNT)};
  pthread_t thread;
  int ends[2];
  assert_int_equal(pipe(ends), 0);
  assert_int_equal(pthread_create(&thread, NULL, work, &b), 0);
  for (int i = 0; i < forks; ++i) {
    pid_t child = begin_child();
    if (child == 0) {
      int was_inside = 0;
      use_what_was_busy(b.solver, &was_inside);
      use_a_new_solver();
      check(write(ends[1], &was_inside, sizeof was_inside) == sizeof was_inside);
      end_child();
    }
    assert_child_ended_well(child);
    int was_inside = 0;
    assert_int_equal(read(ends[0], &was_inside, sizeof was_inside), sizeof was_inside);
    *inside += was_inside;
  }
  b.over = 1;
  assert_int_equal(pthread_join(thread, NULL), 0);
  close(ends[0]);
  close(ends[1]);
  assert_ok(pbf_step(b.solver, 1));
  pbf_destroy(b.solver);
}

static void locks_are_free_in_the_child(void **state) {
  (void)state;
  skip_under_sanitizers();
  int inside = 0;
  fork_beside(ask_and_ask, 60, &inside);
}

static void calls_end_with_the_fork(void **state) {
  (void)state;
  skip_under_sanitizers();
  int inside = 0;
  fork_beside(step_and_step, 20, &inside);
  assert_true(inside > 0);
}

/* ---- While it forks ---- */

/* A thread that a signal has interrupted within malloc, with the C library's locks in hand, and
 * whose handler calls: it must not wait for the fork, which waits for these locks. */
static struct {
  pbf_solver *solver;
  atomic_int answered;
  int in_time;
} asked;

static void *ask_once(void *unused) {
  uint32_t count;
  (void)unused;
  atomic_store(&asked.answered, pbf_get_count(asked.solver, &count) == PBF_OK && count == COUNT);
  return NULL;
}

/* The last function before the C library takes its own locks: what is registered first comes last.
 */
static void ask_while_forking(void) {
  const struct timespec nap = {0, 10000000};
  pthread_t thread;
  if (!asked.solver || pthread_create(&thread, NULL, ask_once, NULL) != 0) return;
  for (int naps = 0; naps < 10000 && !atomic_load(&asked.answered); ++naps) nanosleep(&nap, NULL);
  asked.in_time = atomic_load(&asked.answered);
  pthread_detach(thread);
}

static void watch_forks(void) { pthread_atfork(ask_while_forking, NULL, NULL); }

/* Before the constructors of libraries. */
__attribute__((section(".preinit_array"),
               used)) static void (*const first_of_all)(void) = watch_forks;

static void calls_go_on_meanwhile(void **state) {
  (void)state;
  skip_under_sanitizers();
  asked.solver = test_filled(3, PBF_FLOAT32, COUNT, COUNT);
  pid_t child = begin_child();
  if (child == 0) end_child();
  assert_child_ended_well(child);
  assert_true(asked.in_time);
  pbf_destroy(asked.solver);
  asked.solver = NULL;
}

int main(void) {
  const struct CMUnitTest forks[] = {
      cmocka_unit_test(calls_go_on_meanwhile),
      cmocka_unit_test(parent_and_child_go_on),
      cmocka_unit_test(locks_are_free_in_the_child),
      cmocka_unit_test(calls_end_with_the_fork),
  };
  return TEST_RUN(forks);
}
