#ifndef PBF_LIB_TEXT_H
#define PBF_LIB_TEXT_H

#include <stddef.h>
#include <string.h>

/* Appends as much of `piece` as there is room for. */
static inline void pbf_text_append(char *text, size_t size, const char *piece) {
  size_t used = strlen(text), room = size - used - 1, length = strlen(piece);
  if (length > room) length = room;
  memcpy(text + used, piece, length);
  text[used + length] = 0;
}

#endif
