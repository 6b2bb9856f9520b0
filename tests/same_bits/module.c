/* The scenes in a module of WebAssembly with threads: what they print goes to the host's log. */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

__attribute__((import_module("pbf"), import_name("log"))) void host_log(uint32_t user,
                                                                        int32_t level,
                                                                        const char *message);

static int tell(const char *format, ...) {
  char line[128];
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  host_log(0, 0, line);
  return length;
}

int scenes_main(int count, char **arguments);

#define main scenes_main
#define printf tell
#include "scenes.c"

__attribute__((export_name("run_scenes"))) void run_scenes(uint32_t dimension, uint32_t precision,
                                                           uint32_t count);

void run_scenes(uint32_t dimension, uint32_t precision, uint32_t count) {
  threads = count;
  run_variant(dimension, precision, NULL);
}
