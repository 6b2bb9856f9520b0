/* Two libpbf in one process, as of two plug-ins of a host that bring their own, with the same files
 * of backends: each has its own sentences and its own list, also when the other one is closed. */
#include <dlfcn.h>
#include <stdio.h>

#include "child.h"

typedef struct library {
  void *handle;
  pbf_status (*desc_init)(pbf_desc *, uint32_t);
  pbf_status (*create)(const pbf_desc *, const pbf_params *, pbf_solver **);
  pbf_status (*get_stats)(pbf_solver *, pbf_stats *);
  pbf_status (*add)(pbf_solver *, uint32_t, const void *, const void *, uint32_t *);
  pbf_status (*load)(const char *);
  pbf_status (*get_count)(uint32_t *);
  pbf_status (*step)(pbf_solver *, uint32_t);
  void (*destroy)(pbf_solver *);
  const char *(*last_error)(void);
} library;

static char folder[64];

static void look_up(void *handle, const char *name, void *function) {
  void *symbol = dlsym(handle, name);
  check(symbol != NULL);
  memcpy(function, &symbol, sizeof symbol);
}

static library open_copy(const char *name, int scope) {
  char path[128];
  library it = {0};
  snprintf(path, sizeof path, "%s/%s", folder, name);
  it.handle = dlopen(path, RTLD_NOW | scope);
  check(it.handle != NULL);
  look_up(it.handle, "pbf_desc_init", &it.desc_init);
  look_up(it.handle, "pbf_create", &it.create);
  look_up(it.handle, "pbf_get_stats", &it.get_stats);
  look_up(it.handle, "pbf_add_particles", &it.add);
  look_up(it.handle, "pbf_load_backend", &it.load);
  look_up(it.handle, "pbf_get_backend_count", &it.get_count);
  look_up(it.handle, "pbf_step", &it.step);
  look_up(it.handle, "pbf_destroy", &it.destroy);
  look_up(it.handle, "pbf_last_error", &it.last_error);
  return it;
}

static const char *backend;

/* The library's own allocations are small. */
static void *give_little(void *user, uint64_t size, uint64_t alignment) {
  uint64_t *most = user;
  return size > *most ? NULL
                      : aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void take_back(void *user, void *memory, uint64_t size, uint64_t alignment) {
  (void)user, (void)size, (void)alignment;
  free(memory);
}

static pbf_status make(const library *it, uint64_t *most, pbf_solver **solver) {
  pbf_allocator allocator = {sizeof allocator, 0, most, give_little, take_back};
  pbf_desc desc;
  check_ok(it->desc_init(&desc, sizeof desc));
  desc.backend = backend;
  desc.strict = 1;
  desc.capacity = 1000;
  desc.allocator = &allocator;
  return it->create(&desc, NULL, solver);
}

/* A failure that the backend puts into words. */
static void fail_in_backend(const library *it) {
  uint64_t most = 1 << 13;
  pbf_solver *solver = NULL;
  check(make(it, &most, &solver) == PBF_ERROR_OUT_OF_MEMORY);
  check(strstr(it->last_error(), "no memory for ") != NULL);
}

static void own_sentences(void) {
  library a = open_copy("liba.so", RTLD_LOCAL), b = open_copy("libb.so", RTLD_LOCAL);
  fail_in_backend(&a);
  check(b.last_error()[0] == 0);
  fail_in_backend(&b);
  check(b.load("/nowhere.so") == PBF_ERROR_NOT_FOUND);
  fail_in_backend(&a);
  check(strstr(b.last_error(), "/nowhere.so") != NULL);
  dlclose(b.handle);
  fail_in_backend(&a);
}

static void own_solvers(void) {
  library a = open_copy("liba.so", RTLD_GLOBAL), b = open_copy("libb.so", RTLD_GLOBAL);
  uint64_t most = UINT64_MAX;
  const float x[6] = {0.5f, 0.5f, 0.5f, 0.4f, 0.4f, 0.4f};
  pbf_solver *of_a = NULL, *of_b = NULL;
  check(make(&a, &most, &of_a) == PBF_OK && make(&b, &most, &of_b) == PBF_OK);
  check(a.add(of_a, 2, x, NULL, NULL) == PBF_OK && b.add(of_b, 2, x, NULL, NULL) == PBF_OK);
  check(a.step(of_b, 1) == PBF_ERROR_INVALID_ARGUMENT); /* none of its own */
  check(a.step(of_a, 3) == PBF_OK && b.step(of_b, 3) == PBF_OK);
  most = 64;
  check(a.step(of_a, 1) == PBF_OK); /* takes nothing more */
  b.destroy(of_b);
  dlclose(b.handle);
  check(a.step(of_a, 3) == PBF_OK);
  a.destroy(of_a);
}

static void own_lists(void) {
  library a = open_copy("liba.so", RTLD_GLOBAL), b = open_copy("libb.so", RTLD_GLOBAL);
  uint32_t of_a = 0, of_b = 0;
  check(a.load("/nowhere.so") == PBF_ERROR_NOT_FOUND);
  check(a.get_count(&of_a) == PBF_OK && b.get_count(&of_b) == PBF_OK);
  check(of_a == of_b + 1);
}

static void for_each_backend(void (*body)(void)) {
  static const char *const names[] = {"reference", "serial", "openmp"};
  for (int i = 0; i < 3; ++i) {
    char file[256];
    backend = names[i];
    snprintf(file, sizeof file, BACKEND_DIR "/pbf_backend_%s.so", backend);
    FILE *built = fopen(file, "rb");
    if (!built) continue;
    fclose(built);
    in_child(body);
  }
}

static void sentences(void **state) {
  (void)state;
  for_each_backend(own_sentences);
}

static void solvers(void **state) {
  (void)state;
  for_each_backend(own_solvers);
}

static void lists(void **state) {
  (void)state;
  in_child(own_lists);
}

static int set_up(void **state) {
  (void)state;
  make_folder(folder, sizeof folder);
  put_file(folder, "liba.so", LIBPBF_FILE);
  put_file(folder, "libb.so", LIBPBF_FILE);
  return setenv("PBF_BACKEND_PATH", BACKEND_DIR, 1);
}

static int tear_down(void **state) {
  (void)state;
  drop_folder(folder);
  return 0;
}

int main(void) {
  const struct CMUnitTest copies[] = {
      cmocka_unit_test(sentences),
      cmocka_unit_test(solvers),
      cmocka_unit_test(lists),
  };
  return cmocka_run_group_tests(copies, set_up, tear_down);
}
