/* Texts of bounded size, in UTF-8, and numbers in them. */
#ifndef PBF_LIB_TEXT_H
#define PBF_LIB_TEXT_H

#include <math.h>
#include <stdarg.h>
#include <stddef.h>

#include "compiler.h"
#include "common/number.h"

/* Appends as many whole characters of `addition` as fit. */
void pbf_text_append(char *text, size_t size, const char *addition);

/* Has a text end with a whole character, in UTF-8, where there was no room for its rest. */
void pbf_text_end_whole(char *text);

/* One line of UTF-8, whatever is quoted in it: control characters, and bytes that are none of a
 * character, become question marks. */
void pbf_text_make_line(char *text);

/* snprintf of one line, with a point in numbers whatever the program's locale writes. */
PBF_PRINTF(3, 4) void pbf_text_write(char *text, size_t size, const char *format, ...);
void pbf_text_write_list(char *text, size_t size, const char *format, va_list arguments);

/* A number with up to 9 digits. NaN is always spelled so: printf may write nan or -nan. */
static inline const char *pbf_text_number(char text[PBF_NUMBER_SIZE], double value) {
  return isnan(value) ? "NaN" : pbf_number_text(text, value);
}

#endif
