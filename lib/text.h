#ifndef PBF_LIB_TEXT_H
#define PBF_LIB_TEXT_H

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Appends as much of `piece` as there is room for. */
static inline void pbf_text_append(char *text, size_t size, const char *piece) {
  size_t used = strlen(text), room = size - used - 1, length = strlen(piece);
  if (length > room) length = room;
  memcpy(text + used, piece, length);
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
