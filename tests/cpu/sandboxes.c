/* A process that forbids itself system calls, before it has a solver or while it has some: the bits
 * stay what they are, and nothing ends the process or waits for ever. And the threads that OpenMP's
 * runtime has by what its environment says. Each case runs in a process of its own. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__linux__)
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

#include "cpu_support.h"

enum { COUNT = 1500, THREADS = 3, STEPS = 20, SKIPPED = 77 };

static pbf_solver *make(const char *backend) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return NULL;
  desc.backend = backend;
  desc.strict = 1;
  desc.capacity = COUNT;
  desc.threads = THREADS;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return NULL;
  float *x = test_lattice(3, PBF_FLOAT32, COUNT);
  for (uint32_t i = 0; i < COUNT; ++i) x[3 * i + 2] = 0.02f + 0.015f * (float)(i / 64);
  const pbf_status status = pbf_add_particles(solver, COUNT, x, NULL, NULL);
  free(x);
  return status == PBF_OK ? solver : NULL;
}

static void step(pbf_solver *solver, int steps) {
  for (int k = 0; k < steps; ++k)
    if (pbf_step(solver, 1) != PBF_OK) _exit(10);
}

#if defined(__linux__)

/* 0: this thread can't; `all`: in the others that there are, too. */
static int forbid(int call, int all) {
  struct sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)call, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const struct sock_fprog program = {sizeof filter / sizeof *filter, filter};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, all ? SECCOMP_FILTER_FLAG_TSYNC : 0,
                 &program) == 0;
}

typedef enum moment { AT_FIRST, MEANWHILE, MEANWHILE_IN_ALL } moment;

/* In a process: where a step can't begin in one call and end in another, a sentence says so. */
static uint64_t hash_within(const char *backend, int call, moment when) {
  uint64_t hash = 0, second = 0;
  uint32_t backends;
  if (pbf_get_backend_count(&backends) != PBF_OK) _exit(3); /* their files can be read */
  if (when == AT_FIRST && !forbid(call, 0)) _exit(SKIPPED);
  pbf_solver *solver = make(backend);
  if (!solver) _exit(4);
  step(solver, STEPS / 2);
  if (when != AT_FIRST && pbf_begin_step(solver, 1) == PBF_OK && pbf_end_step(solver) != PBF_OK)
    _exit(5);
  if (when == AT_FIRST) step(solver, 1);
  if (when != AT_FIRST && !forbid(call, when == MEANWHILE_IN_ALL)) _exit(SKIPPED);
  const pbf_status begun = pbf_begin_step(solver, 1);
  if (begun == PBF_OK ? pbf_end_step(solver) != PBF_OK : !pbf_last_error()[0]) _exit(6);
  step(solver, STEPS / 2 - (begun == PBF_OK));
  pbf_solver *other = make(backend);
  if (!other) _exit(7);
  step(other, STEPS + 1);
  if (pbf_hash(solver, &hash) != PBF_OK || pbf_hash(other, &second) != PBF_OK) _exit(8);
  pbf_destroy(other);
  pbf_destroy(solver);
  return hash == second ? hash : 0;
}

static uint64_t run_within(const char *backend, int call, moment when) {
  int ends[2], status = 0;
  uint64_t hash = 0;
  assert_int_equal(pipe(ends), 0);
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    alarm(120); /* of what hangs */
    hash = hash_within(backend, call, when);
    _exit(write(ends[1], &hash, sizeof hash) != sizeof hash);
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  close(ends[1]);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
    assert_int_equal(read(ends[0], &hash, sizeof hash), sizeof hash);
  close(ends[0]);
  if (WIFEXITED(status) && WEXITSTATUS(status) == SKIPPED) test_skip("there is no seccomp");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    fail_msg("%s without call %d, moment %d: status %x", backend, call, (int)when, status);
  return hash;
}

enum { NO_CALL = 9999 };

static void forbid_in_each(int call) {
  static const char *const backends[] = {"serial", "threads", "openmp"};
  const uint64_t hash = run_within("serial", NO_CALL, AT_FIRST);
  for (int k = 0; k < 3; ++k)
    for (int when = AT_FIRST; when <= MEANWHILE_IN_ALL; ++when)
      assert_int_equal(run_within(backends[k], call, (moment)when), hash);
}

static void threads_may_not_wait(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime waits by that call");
  forbid_in_each(SYS_futex);
}

static void processes_have_no_number(void **state) {
  (void)state;
  forbid_in_each(SYS_getpid);
  forbid_in_each(SYS_getpid); /* what a process leaves behind is not in the way of the next */
}

static void stacks_and_memory_stay_as_they_are(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime needs those");
  forbid_in_each(SYS_mprotect);
  forbid_in_each(SYS_madvise);
  forbid_in_each(SYS_sched_getaffinity);
  forbid_in_each(SYS_sched_yield);
  forbid_in_each(SYS_rt_sigprocmask);
}

static void threads_may_not_register(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime has threads of its own");
#if defined(SYS_rseq)
  forbid_in_each(SYS_rseq);
#else
  test_skip("there are no restartable sequences");
#endif
}

static int found_without_links(void) {
#if defined(SYS_readlink)
  if (!forbid(SYS_readlink, 0)) return SKIPPED;
#endif
  if (!forbid(SYS_readlinkat, 0)) return SKIPPED;
  pbf_solver *solver = make("serial");
  if (!solver) return 2;
  pbf_destroy(solver);
  return 0;
}

static void assert_child(int (*run)(void));

static void links_may_not_be_read(void **state) {
  (void)state;
  assert_child(found_without_links);
}

#else

static void threads_may_not_wait(void **state) {
  (void)state;
  test_skip("there is no seccomp");
}

static void processes_have_no_number(void **state) { threads_may_not_wait(state); }
static void stacks_and_memory_stay_as_they_are(void **state) { threads_may_not_wait(state); }
static void threads_may_not_register(void **state) { threads_may_not_wait(state); }
static void links_may_not_be_read(void **state) { threads_may_not_wait(state); }

#endif

/* ---- OpenMP's threads ------------------------------------------------------------------------ */

static int threads_there(void) {
  int count = -2;
  DIR *folder = opendir("/proc/self/task");
  if (!folder) return 0;
  while (readdir(folder)) ++count;
  closedir(folder);
  return count;
}

enum { CALLERS = 8 };

typedef struct caller {
  pthread_t thread;
  pbf_solver *solver;
  pthread_mutex_t turn; /* open when it is its turn, … */
  pthread_mutex_t done; /* … and when that is over */
} caller;

static void *call_when_it_is_its_turn(void *user) {
  caller *own = user;
  for (;;) {
    pthread_mutex_lock(&own->turn);
    step(own->solver, 1);
    pthread_mutex_unlock(&own->done);
  }
  return user;
}

/* Returns 0 where there are no more threads than the callers and a team's. */
static int run_by_turns(void) {
  static caller callers[CALLERS];
  pbf_solver *solver = make("openmp");
  if (!solver) return 2;
  for (int k = 0; k < CALLERS; ++k) {
    callers[k].solver = solver;
    pthread_mutex_init(&callers[k].turn, NULL);
    pthread_mutex_init(&callers[k].done, NULL);
    pthread_mutex_lock(&callers[k].turn);
    pthread_mutex_lock(&callers[k].done);
    if (pthread_create(&callers[k].thread, NULL, call_when_it_is_its_turn, &callers[k]) != 0)
      return 3;
  }
  for (int k = 0; k < 2 * CALLERS; ++k) {
    pthread_mutex_unlock(&callers[k % CALLERS].turn);
    pthread_mutex_lock(&callers[k % CALLERS].done);
  }
  if (threads_there() < 1) return SKIPPED;
  for (int looks = 0; threads_there() > 1 + CALLERS + THREADS - 1; ++looks) {
    if (looks == 60000) return 4;
    usleep(1000); /* one that has ended counts a little longer */
  }
  return 0;
}

static void assert_ends_well(pid_t child, const char *why_skipped) {
  int status = 0;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == SKIPPED) test_skip(why_skipped);
  assert_int_equal(WEXITSTATUS(status), 0);
}

static void assert_child(int (*run)(void)) {
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    alarm(120);
    _exit(run());
  }
  assert_ends_well(child, "the system does not tell");
}

static void callers_by_turns_have_one_pool(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("clang's runtime has one pool for all");
  assert_child(run_by_turns);
}

/* ---- What its environment says --------------------------------------------------------------- */

/* With OMP_NUM_THREADS far above the CPUs there are. */
static int auto_is_not_openmp(void) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  pbf_info info = {.struct_size = sizeof info};
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return 2;
  desc.capacity = 1000000;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK || pbf_get_info(solver, &info) != PBF_OK) return 3;
  pbf_destroy(solver);
  return strcmp(info.backend, "openmp") == 0 ? 4 : 0;
}

/* With OMP_STACKSIZE above what there is room for. */
static int stacks_are_too_large(void) {
  uint32_t backends;
  unsigned long pages = 0;
  if (pbf_get_backend_count(&backends) != PBF_OK) return 2;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file || fscanf(file, "%lu", &pages) != 1) return SKIPPED;
  fclose(file);
  const rlim_t most = pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)512 << 20);
  const struct rlimit limit = {most, most};
  if (setrlimit(RLIMIT_AS, &limit) != 0) return SKIPPED;
  pbf_solver *solver = make("openmp");
  if (!solver) return 3;
  step(solver, 1);
  pbf_destroy(solver);
  return 0;
}

static int run_named(const char *name) {
  return strcmp(name, "auto") == 0 ? auto_is_not_openmp() : stacks_are_too_large();
}

/* The runtime reads its environment when it is loaded. */
static void assert_with(const char *variable, const char *value, const char *name) {
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    alarm(120);
    setenv(variable, value, 1);
    execl("/proc/self/exe", "sandboxes", name, (char *)NULL);
    _exit(SKIPPED);
  }
  assert_ends_well(child, "the system has no such limit");
}

static void more_threads_than_processors(void **state) {
  (void)state;
  assert_with("OMP_NUM_THREADS", "512", "auto");
}

static void stacks_without_room(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer needs the address space");
  assert_with("OMP_STACKSIZE", "1 G", "stacks");
  assert_with("OMP_STACKSIZE", "1048576", "stacks");
  assert_with("OMP_STACKSIZE", "nonsense", "stacks");
}

int main(int count, char **arguments) {
  if (count > 1) return run_named(arguments[1]);
  const struct CMUnitTest sandboxes[] = {
      cmocka_unit_test(threads_may_not_wait),
      cmocka_unit_test(processes_have_no_number),
      cmocka_unit_test(stacks_and_memory_stay_as_they_are),
      cmocka_unit_test(threads_may_not_register),
      cmocka_unit_test(links_may_not_be_read),
      cmocka_unit_test(callers_by_turns_have_one_pool),
      cmocka_unit_test(more_threads_than_processors),
      cmocka_unit_test(stacks_without_room),
  };
  return cmocka_run_group_tests(sandboxes, NULL, NULL);
}
