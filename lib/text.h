#ifndef PBF_LIB_TEXT_H
#define PBF_LIB_TEXT_H

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Appends as much of `addition` as fits. */
static inline void pbf_text_append(char *text, size_t size, const char *addition) {
  size_t used = strlen(text), available = size - used - 1, length = strlen(addition);
  if (length > available) length = available;
  memcpy(text + used, addition, length);
  text[used + length] = 0;
}

enum { PBF_NUMBER_SIZE = 32 };

/* A number with up to 9 digits. NaN is always spelled so: printf may write nan or -nan. */
static inline const char *pbf_text_number(char text[PBF_NUMBER_SIZE], double value) {
  if (isnan(value)) return "NaN";
  snprintf(text, PBF_NUMBER_SIZE, "%.9g", value);
  return text;
}

#endif
