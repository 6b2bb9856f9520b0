/* Numbers in sentences, with a point whatever the program's locale writes. */
#ifndef PBF_COMMON_NUMBER_H
#define PBF_COMMON_NUMBER_H

#include <stdio.h>
#include <string.h>

enum { PBF_NUMBER_SIZE = 32 };

/* Up to 9 digits. What is neither a digit nor part of an exponent is the locale's point, of one
 * byte or more. */
static inline const char *pbf_number_text(char text[PBF_NUMBER_SIZE], double value) {
  snprintf(text, PBF_NUMBER_SIZE, "%.9g", value);
  char *point = text + strspn(text, "0123456789+-einfa");
  size_t length = strcspn(point, "0123456789");
  if (!*point || *point == '.') return text;
  *point = '.';
  memmove(point + 1, point + length, strlen(point + length) + 1);
  return text;
}

#endif
