/* A process that has no descriptor or no memory left when backends are first looked for finds them
 * later, when it has. */
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support.h"

enum { IT_WAS_NEVER_SHORT = 1, IT_FOUND_NONE_LATER, IT_GAVE_NO_REASON, IT_HAS_NO_LIMIT };

static pbf_status created(void) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return PBF_ERROR_STATE;
  desc.capacity = 8;
  const pbf_status status = pbf_create(&desc, NULL, &solver);
  pbf_destroy(solver);
  return status;
}

/* What a process finds that has next to nothing of a resource at first. */
static int look_twice(int resource, rlim_t next_to_nothing) {
  struct rlimit limit;
  if (getrlimit(resource, &limit) != 0) return IT_HAS_NO_LIMIT;
  const struct rlimit low = {next_to_nothing, limit.rlim_max};
  if (setrlimit(resource, &low) != 0) return IT_HAS_NO_LIMIT;
  for (int k = 0; k < 2; ++k) {
    if (created() == PBF_OK) return IT_WAS_NEVER_SHORT;
    if (!pbf_last_error()[0]) return IT_GAVE_NO_REASON;
  }
  setrlimit(resource, &limit);
  return created() == PBF_OK ? 0 : IT_FOUND_NONE_LATER;
}

/* Of address space that the process has. */
static rlim_t bytes(void) {
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (!file) return 0;
  if (fscanf(file, "%lu", &pages) != 1) pages = 0;
  fclose(file);
  return pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

static int look(const char *resource) {
  enum { A_LITTLE = 1 << 16 };
  if (strcmp(resource, "descriptors") == 0) return look_twice(RLIMIT_NOFILE, 3);
  return bytes() == 0 ? IT_HAS_NO_LIMIT : look_twice(RLIMIT_AS, bytes() + A_LITTLE);
}

/* A process of its own: backends are looked for once in each. */
static void assert_finds_later(const char *resource) {
  int status = 0;
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    execl("/proc/self/exe", "shortage", resource, (char *)NULL);
    _exit(IT_HAS_NO_LIMIT);
  }
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == IT_HAS_NO_LIMIT) test_skip("the system has no such limit");
  assert_int_equal(WEXITSTATUS(status), 0);
}

static void descriptors(void **state) {
  (void)state;
  assert_finds_later("descriptors");
}

static void memory(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime ends the process without memory");
  assert_finds_later("memory");
}

int main(int count, char **arguments) {
  if (count > 1) return look(arguments[1]);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(descriptors),
      cmocka_unit_test(memory),
  };
  return TEST_RUN(tests);
}
