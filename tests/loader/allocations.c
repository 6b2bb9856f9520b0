/* Memory that is short for a moment while backends are first looked for: they are found later, when
 * there is some, and none is called damaged. Each allocation of that search fails in turn, be it of
 * the library or of the dynamic loader. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "child.h"

/* ---- The C library's allocator, which fails ---- */

static struct {
  int left;    /* allocations until one fails; 0: none does */
  int and_all; /* those after it fail, too */
} failing;

#if defined(__GLIBC__) && !TEST_INSTRUMENTED /* a sanitizer has an allocator of its own */
enum { CAN_FAIL = 1 };

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

static int fails(void) {
  if (failing.left == 0 || (failing.left > 1 && failing.left--)) return 0;
  if (!failing.and_all) failing.left = 0;
  errno = ENOMEM;
  return 1;
}

#pragma GCC visibility push(default)
void *malloc(size_t size) { return fails() ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return fails() ? NULL : __libc_calloc(count, size); }
void *realloc(void *memory, size_t size) { return fails() ? NULL : __libc_realloc(memory, size); }
#pragma GCC visibility pop
#else
enum { CAN_FAIL = 0 };
#endif

/* ---- Processes that look for backends ---- */

enum { NAMES = 4, OPENMP = 3 };

static const char *const names[NAMES] = {"reference", "serial", "threads", "openmp"};

/* What a child has found: of each backend the device, with the instruction set; empty: none. */
typedef struct finding {
  int was_short, called_damaged;
  int was_ended; /* by a runtime of another's, as docs/limits.md has it */
  char devices[NAMES][96];
} finding;

static finding *shared; /* with the child that looks */

/* CUDA's runtime, which is a part of the plugin, ends the process while it is loaded. */
static int has_cuda(void) { return access(BACKEND_DIR "/pbf_backend_cuda.so", F_OK) == 0; }

static int is_end_of_runtime(int status) {
  const int of_openmp = 1 << 8, of_cuda[2] = {2 << 8, 127 << 8};
  return status == of_openmp || (has_cuda() && (status == of_cuda[0] || status == of_cuda[1]));
}

static pbf_status look_for(const char *backend, char device[96]) {
  pbf_desc desc;
  pbf_info info = {.struct_size = sizeof info};
  pbf_solver *solver = NULL;
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return PBF_ERROR_STATE;
  desc.capacity = 8;
  desc.strict = backend != NULL;
  desc.backend = backend;
  pbf_status status = pbf_create(&desc, NULL, &solver);
  if (status == PBF_OK) status = pbf_get_info(solver, &info);
  snprintf(device, 96, "%s", status == PBF_OK ? info.device_name : "");
  pbf_destroy(solver);
  return status;
}

/* Allocation `number` of the first search fails. */
static void look(int number, int and_all) {
  char unused[96];
  failing.and_all = and_all;
  failing.left = number;
  const pbf_status status = look_for(NULL, unused);
  shared->was_short = number > 0 && failing.left == and_all;
  failing.left = 0;
  const char *why = status == PBF_OK ? "" : pbf_last_error();
  shared->called_damaged = strstr(why, "damaged") || strstr(why, "garbage");
  for (int k = 0; k < NAMES; ++k) look_for(names[k], shared->devices[k]);
}

static finding found_by_child(int number, int and_all) {
  int status = 0;
  memset(shared, 0, sizeof *shared);
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    look(number, and_all);
    _exit(0);
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  if (is_end_of_runtime(status))
    shared->was_ended = 1;
  else if (status != 0)
    fail_msg("allocation %d: the child ends with %d", number, status);
  return *shared;
}

/* How many backends are not what they would be. */
static int lost(const finding *found, const finding *all, int number) {
  int count = 0;
  for (int k = 0; k < NAMES; ++k) {
    if (strcmp(found->devices[k], all->devices[k]) == 0) continue;
    printf("allocation %d: %s on '%s'\n", number, names[k], found->devices[k]);
    ++count;
  }
  return count;
}

static void assert_found_later(int and_all) {
  enum { SOME = 10 }; /* the search does allocate */
  if (!CAN_FAIL) test_skip("the allocator is not glibc's");
  const finding all = found_by_child(0, 0);
  int number = 0, faults = 0;
  for (finding found = {.was_short = 1}; found.was_short && number < 100 * SOME;) {
    found = found_by_child(++number, and_all);
    if (found.was_ended && (all.devices[OPENMP][0] || has_cuda())) {
      found.was_short = 1;
      continue;
    }
    faults += lost(&found, &all, number) + found.called_damaged;
  }
  assert_true(number > SOME);
  assert_int_equal(faults, 0);
}

static void where_one_fails(void **state) {
  (void)state;
  assert_found_later(0);
}

static void where_all_that_follow_fail(void **state) {
  (void)state;
  assert_found_later(1);
}

int main(void) {
  shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return 1;
  const struct CMUnitTest tests[] = {cmocka_unit_test(where_one_fails),
                                     cmocka_unit_test(where_all_that_follow_fail)};
  return TEST_RUN(tests);
}
