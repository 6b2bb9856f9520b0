/* Paths, files and libraries of POSIX: of a libpbf that loads plugins. */
#define _GNU_SOURCE /* dladdr */
#include "os.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "os_privilege.h"

/* ---- Paths ---------------------------------------------------------------------------------- */

_Static_assert(PBF_OS_PATH_SIZE >= PATH_MAX, "realpath writes so many bytes");

const char pbf_os_list_separator = ':';

int pbf_os_is_elevated(void) {
  const pbf_identity identity = pbf_identity_of_process();
  return pbf_is_elevated(&identity);
}

const char *pbf_os_path_variable(const char *name) { return pbf_environment(name); }

const char *pbf_os_name_in(const char *path) { return strrchr(path, '/') + 1; }

int pbf_os_resolve(const char *path, char *file, size_t size) {
  char whole[PBF_OS_PATH_SIZE];
  return realpath(path, whole) && snprintf(file, size, "%s", whole) < (int)size;
}

/* The file mapped where this function is, as the kernel names it. */
static int file_by_map(char *path, size_t size) {
  FILE *maps = fopen("/proc/self/maps", "re");
  if (!maps) return 0;
  uintptr_t here = (uintptr_t)&file_by_map;
  char *line = NULL;
  size_t line_size = 0;
  int found = 0;
  while (!found && getline(&line, &line_size, maps) > 0) {
    uintptr_t first, end;
    if (sscanf(line, "%" SCNxPTR "-%" SCNxPTR, &first, &end) != 2) continue;
    const char *name = strchr(line, '/');
    if (here < first || here >= end || !name) continue;
    found = snprintf(path, size, "%.*s", (int)strcspn(name, "\n"), name) < (int)size;
  }
  free(line);
  fclose(maps);
  return found;
}

/* The dynamic loader knows the name by which the library was opened, which may be relative to a
 * working directory long gone. A sandbox may deny to read links. */
int pbf_os_own_folder(char *folder, size_t size) {
  Dl_info info;
  char path[PBF_OS_PATH_SIZE];
  if (!dladdr((void *)(uintptr_t)&pbf_os_own_folder, &info) || !info.dli_fname) return 0;
  const char *name = info.dli_fname;
  if (name[0] != '/') name = file_by_map(path, sizeof path) ? path : NULL;
  if (!name) return 0;
  if (!pbf_os_resolve(name, folder, size) && snprintf(folder, size, "%s", name) >= (int)size)
    return 0;
  *strrchr(folder, '/') = 0;
  return 1;
}

/* ---- Files ---------------------------------------------------------------------------------- */

int pbf_os_look(const char *path, int *is_regular) {
  struct stat file;
  if (stat(path, &file) != 0) return errno;
  *is_regular = S_ISREG(file.st_mode);
  return 0;
}

int pbf_os_open(const char *path, int *file, uint64_t *size) {
  struct stat there;
  do *file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  while (*file < 0 && errno == EINTR);
  if (*file < 0) return errno;
  if (fstat(*file, &there) == 0) {
    *size = (uint64_t)there.st_size;
    return 0;
  }
  const int why = errno;
  close(*file);
  return why;
}

void pbf_os_close(int file) { close(file); }

int pbf_os_read(int file, void *bytes, size_t count, uint64_t offset) {
  for (size_t done = 0; done < count;) {
    ssize_t got = pread(file, (char *)bytes + done, count - done, (off_t)(offset + done));
    if (got == 0) errno = 0;
    if (got == 0 || (got < 0 && errno != EINTR)) return 0;
    if (got > 0) done += (size_t)got;
  }
  return 1;
}

size_t pbf_os_page(void) { return (size_t)sysconf(_SC_PAGESIZE); }

/* ---- Libraries ------------------------------------------------------------------------------ */

int pbf_os_is_shortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOMEM || error == EAGAIN;
}

/* Why a file can't be loaded at present that could at another time; the loader's words, which end
 * with those of an error, do not always say it. */
static int shortage_for(const char *path, const char *words) {
  enum { OTHERS = 1 << 20 }; /* bytes: what it depends on */
  int file;
  uint64_t size = 0;
  void *some = malloc(OTHERS);
  free(some);
  if (!some || strstr(words, strerror(ENOMEM))) return ENOMEM;
  const int failed = pbf_os_open(path, &file, &size);
  if (failed) return failed;
  pbf_os_close(file);
  const size_t bytes = (size_t)size + OTHERS;
  void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return errno;
  munmap(memory, bytes);
  return 0;
}

int pbf_os_has_thread_key(void) {
  pthread_key_t key;
  return pthread_key_create(&key, NULL) == 0 && pthread_key_delete(key) == 0;
}

/* To stay for good, but that is said last: what glibc fails to load in the midst, and is to keep,
 * it keeps, and the next time it is there, and its constructors have never been run. What fails is
 * tried twice, since a shortage of memory may be over, and not all words for it can be told. */
static void *load_for_good(const char *path) {
  void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!library) library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library) (void)dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  return library;
}

void *pbf_os_load(const char *path, char *reason, size_t size, int *failed) {
  void *library = load_for_good(path);
  if (library) return library;
  snprintf(reason, size, "%s", dlerror());
  *failed = shortage_for(path, reason);
  return NULL;
}

pbf_os_function pbf_os_function_of(void *library, const char *name) {
  pbf_os_function function;
  *(void **)&function = dlsym(library, name);
  return function;
}

const void *pbf_os_own_image(void) {
  Dl_info info;
  return dladdr((void *)(uintptr_t)&pbf_os_own_image, &info) ? info.dli_fbase : NULL;
}
