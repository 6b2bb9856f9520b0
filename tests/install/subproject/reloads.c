/* reloads MODULE BACKEND: a module that has destroyed its solvers is unloaded; one that has left
 * some stays, for their threads run its code. */
#define _GNU_SOURCE /* RTLD_NOLOAD */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

typedef int (*use_fn)(const char *backend, int leaves_it);

static int stays_loaded(const char *module) {
  void *there = dlopen(module, RTLD_LAZY | RTLD_NOLOAD);
  if (there) dlclose(there);
  return there != NULL;
}

static int used(const char *module, const char *backend, int leaves_it) {
  void *loaded = dlopen(module, RTLD_NOW | RTLD_LOCAL);
  void *const found = loaded ? dlsym(loaded, "use_pbf") : NULL;
  use_fn use = NULL;
  memcpy(&use, &found, sizeof use);
  const int failed = use ? use(backend, leaves_it) : -1;
  if (loaded) dlclose(loaded);
  if (!failed && stays_loaded(module) == leaves_it) return 1;
  printf("%s, its solver %s: failed %d, and %s\n", backend, leaves_it ? "left" : "destroyed",
         failed, leaves_it ? "gone" : "there");
  return 0;
}

int main(int count, char **arguments) {
  if (count != 3) return 2;
  for (int leaves_it = 0; leaves_it < 2; ++leaves_it)
    if (!used(arguments[1], arguments[2], leaves_it)) return 1;
  return 0;
}
