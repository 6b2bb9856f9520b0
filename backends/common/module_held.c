/* Of the static library: the module that it was linked into, if that is not the program. */
#define _GNU_SOURCE /* dladdr */
#include "common/module.h"

#if defined(__linux__)

#include <dlfcn.h>
#include <errno.h>
#include <stddef.h>
#include <string.h>
#include <sys/auxv.h>

/* Which a program that is linked statically does not have; of dlopen linkers would warn there, so
 * that it is looked up. */
#pragma weak dladdr
#pragma weak dlclose
#pragma weak dlsym

static const char here;

static int is_program(const Dl_info *object) {
  Dl_info program;
  const unsigned long entry = getauxval(AT_ENTRY);
  return dladdr((void *)entry, &program) == 0 || program.dli_fbase == object->dli_fbase;
}

static void *hold(const char *path) {
  void *(*open)(const char *path, int mode) = NULL;
  void *const found = dlsym(RTLD_DEFAULT, "dlopen");
  memcpy(&open, &found, sizeof open);
  return open ? open(path, RTLD_LAZY | RTLD_NOLOAD) : NULL;
}

void *pbf_module_hold(void) {
  Dl_info own;
  if (!dladdr || !dlsym || !dlclose || dladdr(&here, &own) == 0 || is_program(&own)) return NULL;
  const int before = errno;
  void *held = hold(own.dli_fname);
  errno = before;
  return held;
}

void pbf_module_release(void *held) {
  if (held) dlclose(held);
}

#else /* unknown */

void *pbf_module_hold(void) { return 0; }
void pbf_module_release(void *held) { (void)held; }

#endif
