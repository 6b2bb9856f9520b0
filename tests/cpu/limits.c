/* A process that may not start as many threads as a solver wants: it gets fewer, the bits are the
 * same, and the process goes on. Each case runs in a child, which a limit does not leave. */
#define _GNU_SOURCE /* setresuid */
#include <dlfcn.h>
#include <errno.h>
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

enum { COUNT = 2000, THREADS = 6, STEPS = 5 };

typedef struct outcome {
  pbf_status status;
  uint32_t threads;
  uint64_t hash;
} outcome;

static outcome run(const char *backend, uint32_t threads) {
  outcome it = {.status = PBF_OK};
  pbf_desc desc;
  pbf_solver *solver = NULL;
  pbf_info info = {.struct_size = sizeof info};
  pbf_desc_init(&desc, sizeof desc);
  desc.backend = backend;
  desc.strict = 1;
  desc.capacity = COUNT;
  desc.threads = threads;
  float *x = test_lattice(3, PBF_FLOAT32, COUNT);
  it.status = pbf_create(&desc, NULL, &solver);
  for (uint32_t i = 0; i < COUNT; ++i) x[3 * i + 2] = 0.02f + 0.015f * (float)(i / 64);
  if (it.status == PBF_OK) it.status = pbf_add_particles(solver, COUNT, x, NULL, NULL);
  for (int step = 0; step < STEPS && it.status == PBF_OK; ++step) it.status = pbf_step(solver, 1);
  if (it.status == PBF_OK) it.status = pbf_hash(solver, &it.hash);
  if (it.status == PBF_OK) it.status = pbf_get_info(solver, &info);
  it.threads = info.threads;
  pbf_destroy(solver);
  free(x);
  return it;
}

/* As a user with no other processes, where that can be: root has no limit of them. Another run of
 * this test may be at it meanwhile: so a user for each process. */
static int limit_threads(unsigned most) {
  enum { FIRST_USER = 20000, USERS = 40000 };
  const struct rlimit limit = {most, most};
  const uid_t user = FIRST_USER + (uid_t)(getpid() % USERS);
  return setrlimit(RLIMIT_NPROC, &limit) == 0 &&
         (geteuid() != 0 || setresuid(user, user, user) == 0);
}

static int limit_memory(unsigned more) {
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file || fscanf(file, "%lu", &pages) != 1) return 0;
  fclose(file);
  rlim_t most = pages * (rlim_t)sysconf(_SC_PAGESIZE) + more;
  const struct rlimit limit = {most, most};
  return setrlimit(RLIMIT_AS, &limit) == 0;
}

/* A sandbox in which threads may not ask for others: a signal 0 is sent to none. */
#if defined(__linux__)

static int forbid_signals(unsigned most) {
  struct sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const struct sock_fprog program = {sizeof filter / sizeof *filter, filter};
  return most == 0 && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

#else

static int forbid_signals(unsigned most) { return (void)most, 0; }

#endif

static outcome run_within(int (*limit)(unsigned), unsigned most, const char *backend) {
  int ends[2], status = 0;
  outcome it = {0};
  assert_int_equal(pipe(ends), 0);
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) {
    uint32_t count;
    alarm(120);                    /* of what hangs */
    pbf_get_backend_count(&count); /* loads them while their files may be read */
    if (!limit(most)) _exit(77);
    it = run(backend, THREADS);
    _exit(write(ends[1], &it, sizeof it) != sizeof it);
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) test_skip("the limit can't be set here");
  assert_int_equal(WEXITSTATUS(status), 0);
  assert_int_equal(read(ends[0], &it, sizeof it), sizeof it);
  close(ends[0]);
  close(ends[1]);
  return it;
}

static int unlimited(unsigned most) { return most == 0; }

static void assert_serves(const outcome *it, uint32_t threads) {
  outcome serial = run_within(unlimited, 0, "serial");
  assert_int_equal(it->status, PBF_OK);
  assert_int_equal(it->hash, serial.hash);
  assert_int_equal(it->threads, threads);
}

static void without_a_limit(void **state) {
  (void)state;
  outcome it = run_within(unlimited, 0, "openmp");
  assert_serves(&it, THREADS);
}

static void no_further_thread(void **state) {
  (void)state;
  outcome it = run_within(limit_threads, 1, "openmp");
  assert_serves(&it, 1);
}

/* Another user's processes may count. */
static void some_threads(void **state) {
  (void)state;
  if (geteuid() != 0) test_skip("only root can become a user without other processes");
  for (unsigned most = 2; most <= THREADS; ++most) {
    outcome it = run_within(limit_threads, most, "openmp");
    assert_serves(&it, most);
  }
}

static void no_memory_for_stacks(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer needs the address space");
  outcome it = run_within(limit_memory, 20u << 20, "openmp");
  assert_int_equal(it.status, PBF_OK);
  assert_in_range(it.threads, 1, 3); /* stacks have 8 MiB */
}

static void no_questions_about_threads(void **state) {
  (void)state;
  outcome it = run_within(forbid_signals, 0, "openmp");
  assert_serves(&it, THREADS);
}

/* ---- A program with loops of its own ---- */

typedef void (*parallel_fn)(void (*function)(void *), void *data, unsigned threads, unsigned flags);

static void nothing(void *data) { (void)data; }

/* GCC's runtime lets threads go that its next loop does not need. Returns 77 where it is another.
 */
static int step_after_a_smaller_loop(void) {
  pbf_solver *solver = NULL;
  pbf_desc desc;
  float x[3] = {0.5f, 0.5f, 0.5f};
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return 1;
  desc.backend = "openmp";
  desc.strict = 1;
  desc.threads = THREADS;
  desc.capacity = 8;
  if (pbf_create(&desc, NULL, &solver) != PBF_OK) return 2;
  if (pbf_add_particles(solver, 1, x, NULL, NULL) != PBF_OK || pbf_step(solver, 1) != PBF_OK)
    return 3;
  void *runtime = dlopen("libgomp.so.1", RTLD_NOW | RTLD_NOLOAD);
  parallel_fn parallel = NULL;
  if (runtime) *(void **)&parallel = dlsym(runtime, "GOMP_parallel");
  if (!parallel) return 77;
  parallel(nothing, NULL, 2, 0);
  for (int looks = 0; cpu_threads_now() > 2 && looks < 60000; ++looks) usleep(1000);
  if (!limit_threads(1)) return 77;
  return pbf_step(solver, 1) == PBF_OK ? 0 : 4;
}

static void the_program_lets_threads_go(void **state) {
  int status = 0;
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("clang's runtime keeps its threads");
  fflush(NULL);
  pid_t child = fork();
  if (child == 0) _exit(step_after_a_smaller_loop());
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) test_skip("there is no such runtime, or limit");
  assert_int_equal(WEXITSTATUS(status), 0);
}

/* What OpenMP's threads end by is loaded with the backend: later there may be no memory for it. */
static void the_unwinder_is_there(void **state) {
  (void)state;
#if defined(__GLIBC__)
  uint32_t count;
  assert_ok(pbf_get_backend_count(&count));
  assert_non_null(dlopen("libgcc_s.so.1", RTLD_NOW | RTLD_NOLOAD));
#endif
}

int main(void) {
  const struct CMUnitTest limits[] = {
      cmocka_unit_test(without_a_limit),
      cmocka_unit_test(no_further_thread),
      cmocka_unit_test(some_threads),
      cmocka_unit_test(no_memory_for_stacks),
      cmocka_unit_test(no_questions_about_threads),
      cmocka_unit_test(the_program_lets_threads_go),
      cmocka_unit_test(the_unwinder_is_there),
  };
  return cmocka_run_group_tests(limits, NULL, NULL);
}
