/* Windows, from 8 on. */
#define WIN32_LEAN_AND_MEAN
#define _WIN32_WINNT 0x0602
#include <windows.h>

#include <locale.h>
#include <malloc.h>
#include <stdio.h>
#include <string.h>

#include "os.h"

/* ---- Memory, time, numbers ------------------------------------------------------------------ */

void *pbf_os_allocate(size_t size, size_t alignment) { return _aligned_malloc(size, alignment); }

void pbf_os_release(void *memory) { _aligned_free(memory); }

int pbf_os_memory(uint64_t *left, uint64_t *written) {
  (void)left, (void)written;
  return 0;
}

/* In milliseconds, as the system counts. */
void pbf_os_sleep(uint32_t microseconds) { Sleep((microseconds + 999) / 1000); }

/* The thread has a locale of its own for the while. */
void pbf_os_print_plain(char *text, size_t size, const char *format, va_list arguments) {
  const int shared = _configthreadlocale(_ENABLE_PER_THREAD_LOCALE);
  const char *now = setlocale(LC_NUMERIC, NULL);
  char before[128] = "C";
  if (now && strlen(now) < sizeof before) strcpy(before, now);
  setlocale(LC_NUMERIC, "C");
  vsnprintf(text, size, format, arguments);
  setlocale(LC_NUMERIC, before);
  if (shared != -1) _configthreadlocale(shared);
}

/* ---- A thread that another one cancels: TerminateThread asks nothing ------------------------ */

int pbf_uncancelled_begin(void) { return 0; }
void pbf_uncancelled_end(int before) { (void)before; }

/* ---- Stacks --------------------------------------------------------------------------------- */

void pbf_os_find_stack(void) {}
void pbf_os_watch_threads(void (*ended)(void)) { (void)ended; }

int pbf_os_is_on_stack(const volatile void *place) {
  ULONG_PTR lowest, end;
  GetCurrentThreadStackLimits(&lowest, &end);
  return (uintptr_t)place >= lowest && (uintptr_t)place < end;
}

/* Handlers run on the stack of their thread. */
int pbf_os_on_signal_stack(void) { return 0; }

/* ---- Paths ---------------------------------------------------------------------------------- */

static int is_separator(char c) { return c == '\\' || c == '/'; }

/* With a drive or a server: \name is on the working directory's drive. */
int pbf_os_is_absolute(const char *path) {
  const int letter = path[0] | 0x20;
  if (letter >= 'a' && letter <= 'z' && path[1] == ':') return is_separator(path[2]);
  return is_separator(path[0]) && is_separator(path[1]);
}
