/* WebAssembly with threads: a static library, without files, locales, signals and processes. */
#include "os.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- Memory, time, numbers ------------------------------------------------------------------ */

void *pbf_os_allocate(size_t size, size_t alignment) { return aligned_alloc(alignment, size); }

void pbf_os_release(void *memory) { free(memory); }

int pbf_os_memory(uint64_t *left, uint64_t *written) {
  (void)left, (void)written;
  return 0;
}

void pbf_os_sleep(uint32_t microseconds) {
  for (const double begin = pbf_seconds(); pbf_seconds() - begin < 1e-6 * microseconds;)
    pbf_yield();
}

void pbf_os_print_plain(char *text, size_t size, const char *format, va_list arguments) {
  vsnprintf(text, size, format, arguments);
}

/* ---- A thread that another one cancels ------------------------------------------------------ */

int pbf_uncancelled_begin(void) { return 0; }
void pbf_uncancelled_end(int before) { (void)before; }

/* ---- Stacks: unknown ------------------------------------------------------------------------ */

void pbf_os_find_stack(void) {}
void pbf_os_watch_threads(void (*ended)(void)) { (void)ended; }
int pbf_os_is_on_stack(const volatile void *place) { return (void)place, 0; }
int pbf_os_on_signal_stack(void) { return 1; }

/* ---- Paths ---------------------------------------------------------------------------------- */

int pbf_os_is_absolute(const char *path) { return path[0] == '/'; }
