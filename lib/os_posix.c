/* Linux, and what else has POSIX's threads and locales. */
#define _GNU_SOURCE /* pthread_getattr_np, newlocale */
#include "os.h"
#include "compiler.h"

#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#if defined(__APPLE__)
#include <xlocale.h>
#endif

/* ---- Memory, time, numbers ------------------------------------------------------------------ */

void *pbf_os_allocate(size_t size, size_t alignment) { return aligned_alloc(alignment, size); }

void pbf_os_release(void *memory) { free(memory); }

#if defined(__linux__)

/* What Linux tells of itself, as far as there is room for it; without memory of its own. */
static int read_text(const char *path, char *text, size_t size) {
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t length = read(file, text, size - 1);
  close(file);
  text[length > 0 ? length : 0] = 0;
  return length > 0;
}

static uint64_t kilobytes_of(const char *text, const char *name, int *is_there) {
  const char *found = strstr(text, name);
  *is_there = found != NULL;
  return found ? strtoull(found + strlen(name), NULL, 10) : 0;
}

int pbf_os_memory(uint64_t *left, uint64_t *written) {
  char text[4096];
  int is_there, swaps;
  if (!read_text("/proc/meminfo", text, sizeof text)) return 0;
  *left = kilobytes_of(text, "\nMemAvailable:", &is_there);
  *left = (*left + kilobytes_of(text, "\nSwapFree:", &swaps)) * 1024;
  if (!is_there || !read_text("/proc/self/statm", text, sizeof text)) return 0;
  const char *resident = strchr(text, ' ');
  *written = resident ? strtoull(resident, NULL, 10) * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
  return resident != NULL;
}

#else

int pbf_os_memory(uint64_t *left, uint64_t *written) {
  (void)left, (void)written;
  return 0;
}

#endif

void pbf_os_sleep(uint32_t microseconds) {
  const struct timespec nap = {microseconds / 1000000, microseconds % 1000000 * 1000L};
  nanosleep(&nap, NULL);
}

/* Made before there are threads; 0 where it can't be. */
static locale_t plain;

PBF_AT_LOAD(make_plain) { plain = newlocale(LC_ALL_MASK, "C", (locale_t)0); }

void pbf_os_print_plain(char *text, size_t size, const char *format, va_list arguments) {
  locale_t before = plain ? uselocale(plain) : (locale_t)0;
  vsnprintf(text, size, format, arguments);
  if (before) uselocale(before);
}

/* ---- A thread that another one cancels ------------------------------------------------------ */

int pbf_uncancelled_begin(void) {
  int before = PTHREAD_CANCEL_ENABLE;
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &before);
  return before;
}

void pbf_uncancelled_end(int before) { pthread_setcancelstate(before, NULL); }

/* ---- Stacks --------------------------------------------------------------------------------- */

#if defined(__linux__)

typedef struct stack_bounds {
  uintptr_t lowest, size;
} stack_bounds;

static pbf_per_thread own_stack;

/* Of the C library threads' ends are heard by what they have under a key. */
static struct {
  pthread_key_t key;
  int is_there;
  void (*ended)(void);
} watch;

static void call_ended(void *unused) {
  (void)unused;
  watch.ended();
}

void pbf_os_watch_threads(void (*ended)(void)) {
  watch.ended = ended;
  watch.is_there = pthread_key_create(&watch.key, call_ended) == 0;
}

PBF_AT_LOAD(begin_stacks) { pbf_per_thread_begin(&own_stack, sizeof(stack_bounds)); }

PBF_AT_UNLOAD(end_stacks) {
  pbf_per_thread_end(&own_stack);
  if (watch.is_there) pthread_key_delete(watch.key);
  watch.is_there = 0;
}

void pbf_os_find_stack(void) {
  pthread_attr_t attributes;
  void *lowest;
  size_t size;
  stack_bounds *own = pbf_per_thread_take(&own_stack);
  if (watch.is_there && !pthread_getspecific(watch.key)) pthread_setspecific(watch.key, &watch);
  if (!own || own->size || pthread_getattr_np(pthread_self(), &attributes) != 0) return;
  if (pthread_attr_getstack(&attributes, &lowest, &size) == 0) {
    own->lowest = (uintptr_t)lowest;
    own->size = size;
  }
  pthread_attr_destroy(&attributes);
}

int pbf_os_is_on_stack(const volatile void *place) {
  const stack_bounds *own = pbf_per_thread_look(&own_stack);
  return own && (uintptr_t)place - own->lowest < own->size;
}

int pbf_os_on_signal_stack(void) {
  stack_t stack;
  return sigaltstack(NULL, &stack) != 0 || stack.ss_flags & SS_ONSTACK;
}

#else /* unknown */

void pbf_os_find_stack(void) {}
void pbf_os_watch_threads(void (*ended)(void)) { (void)ended; }
int pbf_os_is_on_stack(const volatile void *place) { return (void)place, 0; }
int pbf_os_on_signal_stack(void) { return 1; }

#endif

/* ---- Paths ---------------------------------------------------------------------------------- */

int pbf_os_is_absolute(const char *path) { return path[0] == '/'; }
