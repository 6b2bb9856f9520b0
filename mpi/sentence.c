#include "sentence.h"

#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <pbf/mpi.h>

static _Thread_local char last_error[PBF_MPI_SENTENCE_SIZE];

const char *pbf_mpi_last_error(void) { return last_error; }

/* Of a character of UTF-8 that begins with this byte; 0: it begins none. */
static size_t length_by(unsigned char first) {
  if (first < 0x80) return 1;
  return first < 0xc0 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
}

static void end_whole(char *text) {
  const size_t size = strlen(text);
  for (size_t back = 1; back <= 4 && back <= size; ++back) {
    const size_t length = length_by((unsigned char)text[size - back]);
    if (length > back) text[size - back] = 0;
    if (length > 0) return;
  }
}

/* Without memory for a locale the program's serves. */
static void write_list(char *text, size_t size, const char *format, va_list arguments) {
  const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  const locale_t before = plain ? uselocale(plain) : (locale_t)0;
  vsnprintf(text, size, format, arguments);
  if (before) uselocale(before);
  if (plain) freelocale(plain);
  end_whole(text);
}

void pbf_mpi_write(char *text, size_t size, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_list(text, size, format, arguments);
  va_end(arguments);
}

pbf_status pbf_mpi_fail(pbf_status status, const char *format, ...) {
  char text[PBF_MPI_SENTENCE_SIZE]; /* the last sentence may be among the arguments */
  va_list arguments;
  va_start(arguments, format);
  write_list(text, sizeof text, format, arguments);
  va_end(arguments);
  memcpy(last_error, text, sizeof text);
  return status;
}
