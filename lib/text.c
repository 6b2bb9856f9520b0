#define _GNU_SOURCE /* newlocale */
#include "text.h"

#include <locale.h>
#include <stdio.h>

/* Made before there are threads; 0 where it can't be. */
static locale_t plain;

__attribute__((constructor)) static void make_plain(void) {
  plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

void pbf_text_write_list(char *text, size_t size, const char *format, va_list arguments) {
  locale_t before = plain ? uselocale(plain) : (locale_t)0;
  vsnprintf(text, size, format, arguments);
  if (before) uselocale(before);
}

void pbf_text_write(char *text, size_t size, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  pbf_text_write_list(text, size, format, arguments);
  va_end(arguments);
}
