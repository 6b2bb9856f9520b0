#ifndef PBF_LIB_TEXT_H
#define PBF_LIB_TEXT_H

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include "compiler.h"
#include "common/number.h"

/* Appends as much of `addition` as fits. */
static inline void pbf_text_append(char *text, size_t size, const char *addition) {
  size_t used = strlen(text), available = size - used - 1, length = strlen(addition);
  if (length > available) length = available;
  memcpy(text + used, addition, length);
  text[used + length] = 0;
}

/* snprintf, with a point in numbers whatever the program's locale writes. */
PBF_PRINTF(3, 4) void pbf_text_write(char *text, size_t size, const char *format, ...);
void pbf_text_write_list(char *text, size_t size, const char *format, va_list arguments);

/* A number with up to 9 digits. NaN is always spelled so: printf may write nan or -nan. */
static inline const char *pbf_text_number(char text[PBF_NUMBER_SIZE], double value) {
  return isnan(value) ? "NaN" : pbf_number_text(text, value);
}

#endif
