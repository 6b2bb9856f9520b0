/* A process that has no descriptor or no memory left when backends are first looked for finds them
 * later, when it has; and a thread that is new then lives on. */
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "child.h"

enum {
  IT_WAS_NEVER_SHORT = 1,
  IT_FOUND_NONE,
  IT_FOUND_NONE_LATER,
  IT_GAVE_NO_REASON,
  IT_HAS_NO_LIMIT
};

static pbf_status created_by(const char *backend) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  if (pbf_desc_init(&desc, sizeof desc) != PBF_OK) return PBF_ERROR_STATE;
  desc.capacity = 8;
  desc.backend = backend;
  const pbf_status status = pbf_create(&desc, NULL, &solver);
  pbf_destroy(solver);
  return status;
}

static pbf_status created(void) { return created_by(NULL); }

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

/* Whether a backend that is there is left out, with that reason; 1 where it is not there. */
static int is_left_out(const char *name, const char *why) {
  pbf_backend_info info;
  if (find_backend(name, NULL, &info) < 0 || strstr(info.reason, "no pbf_backend_")) return 1;
  return !info.available && strstr(info.reason, why);
}

/* Of a process that has given all keys of thread-specific data to others. OpenMP's runtime would
 * end it; backends that bring no libraries serve. */
static int look_without_keys(void) {
  enum { MOST = 4096 };
  static pthread_key_t keys[MOST];
  pbf_backend_info info;
  int taken = 0;
  while (taken < MOST && pthread_key_create(&keys[taken], NULL) == 0) ++taken;
  if (taken == MOST) return IT_HAS_NO_LIMIT;
  for (int k = 0; k < 2; ++k) {
    if (created() != PBF_OK) return IT_FOUND_NONE;
    if (!is_left_out("openmp", "pthread_key_create")) return IT_GAVE_NO_REASON;
  }
  while (taken > 0) pthread_key_delete(keys[--taken]);
  const int is_there =
      find_backend("openmp", NULL, &info) >= 0 && !strstr(info.reason, "no pbf_backend_");
  return created_by(is_there ? "openmp" : NULL) == PBF_OK ? 0 : IT_FOUND_NONE_LATER;
}

static int look(const char *resource) {
  enum { A_LITTLE = 1 << 16 };
  if (strcmp(resource, "keys") == 0) return look_without_keys();
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

static void keys(void **state) {
  (void)state;
  assert_finds_later("keys");
}

static void memory(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime ends the process without memory");
  assert_finds_later("memory");
}

/* ---- Threads of a program that has loaded the library at run time ---------------------------- */

typedef struct loaded {
  pbf_status (*desc_init)(pbf_desc *, uint32_t);
  pbf_status (*create)(const pbf_desc *, const pbf_params *, pbf_solver **);
  pbf_status (*add)(pbf_solver *, uint32_t, const void *, const void *, uint32_t *);
  pbf_status (*get_count)(pbf_solver *, uint32_t *);
  pbf_status (*step)(pbf_solver *, uint32_t);
  const char *(*last_error)(void);
} loaded;

static void look_up(void *handle, const char *name, void *function) {
  void *symbol = dlsym(handle, name);
  check(symbol != NULL);
  memcpy(function, &symbol, sizeof symbol);
}

/* A copy, as the test is linked with the library. */
static loaded load_copy(const char *path) {
  loaded it = {0};
  void *handle = dlopen(path, RTLD_NOW);
  check(handle != NULL);
  look_up(handle, "pbf_desc_init", &it.desc_init);
  look_up(handle, "pbf_create", &it.create);
  look_up(handle, "pbf_add_particles", &it.add);
  look_up(handle, "pbf_get_count", &it.get_count);
  look_up(handle, "pbf_step", &it.step);
  look_up(handle, "pbf_last_error", &it.last_error);
  return it;
}

static char folder[64];
static loaded copy;
static pbf_solver *solvers[4];

static void make_solvers(void) {
  static const char *const names[] = {"reference", "serial", "threads", "openmp"};
  const float x[3] = {0.5f, 0.5f, 0.5f};
  pbf_desc desc;
  check_ok(copy.desc_init(&desc, sizeof desc));
  desc.capacity = 8;
  desc.threads = 2;
  desc.strict = 1;
  for (int k = 0; k < 4; ++k) {
    desc.backend = names[k];
    if (copy.create(&desc, NULL, &solvers[k]) != PBF_OK) continue; /* not of this build */
    check_ok(copy.add(solvers[k], 1, x, NULL, NULL));
    check_ok(copy.step(solvers[k], 1));
  }
}

static void limit_addresses(rlim_t bytes) {
  const struct rlimit limit = {bytes, RLIM_INFINITY};
  setrlimit(RLIMIT_AS, &limit);
}

static void use_up_memory(void) {
  limit_addresses(1);
  for (size_t size = 1 << 20; size >= 16; size /= 2)
    while (malloc(size)) continue;
}

static void *live_without_memory(void *user) {
  uint32_t count = 0;
  use_up_memory();
  check(copy.get_count(NULL, &count) == PBF_ERROR_INVALID_ARGUMENT);
  check(copy.last_error()[0] != 0);
  limit_addresses(RLIM_INFINITY); /* the sentence was lost: told when there is room again, too */
  check(copy.last_error()[0] != 0);
  use_up_memory();
  for (int k = 0; k < 4; ++k) {
    if (!solvers[k]) continue;
    check(copy.step(solvers[k], 2) == PBF_OK || copy.last_error()[0] != 0);
    check(copy.get_count(solvers[k], &count) == PBF_OK && count == 1);
  }
  return user;
}

static void new_thread(void) {
  char path[80];
  pthread_t thread;
  snprintf(path, sizeof path, "%s/libcopy.so", folder);
  copy = load_copy(path);
  make_solvers();
  check(pthread_create(&thread, NULL, live_without_memory, NULL) == 0);
  pthread_join(thread, NULL);
}

static void a_new_thread_without_memory_lives(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's runtime ends the process without memory");
  make_folder(folder, sizeof folder);
  put_file(folder, "libcopy.so", LIBPBF_FILE);
  setenv("PBF_BACKEND_PATH", BACKEND_DIR, 1);
  in_child(new_thread);
  unsetenv("PBF_BACKEND_PATH");
  drop_folder(folder);
}

int main(int count, char **arguments) {
  if (count > 1) return look(arguments[1]);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(descriptors),
      cmocka_unit_test(memory),
      cmocka_unit_test(keys),
      cmocka_unit_test(a_new_thread_without_memory_lives),
  };
  return TEST_RUN(tests);
}
