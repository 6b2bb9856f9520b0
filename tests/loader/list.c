/* list LIBPBF: what that library finds, a line each, "name|available|path|reason"; then
 * "auto|BACKEND" or "auto|none". First comes "secure|N", the kernel's word on our privileges. */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <sys/auxv.h>
#include <unistd.h>

#include <pbf/pbf.h>

typedef struct library {
  pbf_status (*get_count)(uint32_t *count);
  pbf_status (*get_info)(const pbf_desc *desc, uint32_t index, pbf_backend_info *info);
  pbf_status (*create)(const pbf_desc *desc, const pbf_params *params, pbf_solver **solver);
  pbf_status (*desc_init)(pbf_desc *desc, uint32_t struct_size);
  pbf_status (*solver_info)(pbf_solver *solver, pbf_info *info);
} library;

static int look_up(void *handle, const char *name, void *function) {
  void *symbol = dlsym(handle, name);
  memcpy(function, &symbol, sizeof symbol);
  return symbol != NULL;
}

static int open_library(const char *path, library *lib) {
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!handle) return fprintf(stderr, "%s\n", dlerror()), 0;
  return look_up(handle, "pbf_get_backend_count", &lib->get_count) &&
         look_up(handle, "pbf_get_backend_info", &lib->get_info) &&
         look_up(handle, "pbf_create", &lib->create) &&
         look_up(handle, "pbf_desc_init", &lib->desc_init) &&
         look_up(handle, "pbf_get_info", &lib->solver_info);
}

static int list(const library *lib) {
  uint32_t count;
  if (lib->get_count(&count) != PBF_OK) return 0;
  for (uint32_t i = 0; i < count; ++i) {
    pbf_backend_info info = {.struct_size = sizeof info};
    if (lib->get_info(NULL, i, &info) != PBF_OK) return 0;
    printf("%s|%u|%s|%s\n", info.name, info.available, info.path, info.reason);
  }
  return 1;
}

static void choose(const library *lib) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  pbf_info info = {.struct_size = sizeof info};
  lib->desc_init(&desc, sizeof desc);
  desc.capacity = 10;
  int made = lib->create(&desc, NULL, &solver) == PBF_OK;
  if (made) lib->solver_info(solver, &info);
  printf("auto|%s\n", made ? info.backend : "none");
}

int main(int argc, char **argv) {
  library lib;
  if (argc != 2 || !open_library(argv[1], &lib)) return 2;
  printf("secure|%lu\n", getauxval(AT_SECURE));
  if (!list(&lib)) return 3;
  choose(&lib);
  fflush(stdout);
  _exit(0); /* with its solver: the system takes it back */
}
