#include "text.h"

#include <string.h>

#include "os.h"

/* Bytes of a character by the first of them; 0: it begins none. */
static size_t length_by(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4) return 0;
  return first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
}

/* How many of a character's bytes there are, the first included. */
static size_t present(const char *text, size_t length) {
  size_t k = 1;
  while (k < length && ((unsigned char)text[k] & 0xc0) == 0x80) ++k;
  return k;
}

/* Encoded in more bytes than it takes, half of a pair of UTF-16, or beyond Unicode. */
static int is_no_character(const unsigned char *c, size_t length) {
  return (length == 3 && c[0] == 0xe0 && c[1] < 0xa0) ||
         (length == 3 && c[0] == 0xed && c[1] > 0x9f) ||
         (length == 4 && c[0] == 0xf0 && c[1] < 0x90) ||
         (length == 4 && c[0] == 0xf4 && c[1] > 0x8f);
}

void pbf_text_end_whole(char *text) {
  const size_t size = strlen(text);
  for (size_t back = 1; back < 4 && back <= size; ++back) {
    const size_t length = length_by((unsigned char)text[size - back]);
    if (length > back && present(text + size - back, length) == back) text[size - back] = 0;
    if (length > 0) return;
  }
}

void pbf_text_append(char *text, size_t size, const char *addition) {
  size_t used = strlen(text), available = size - used - 1, length = strlen(addition);
  if (length > available) length = available;
  memcpy(text + used, addition, length);
  text[used + length] = 0;
  pbf_text_end_whole(text);
}

void pbf_text_make_line(char *text) {
  pbf_text_end_whole(text);
  while (*text) {
    const unsigned char first = (unsigned char)*text;
    size_t length = length_by(first);
    if (length > 1 &&
        (present(text, length) < length || is_no_character((const unsigned char *)text, length)))
      length = 0;
    if (length == 0 || first < ' ' || first == 0x7f) *text = '?';
    text += length ? length : 1;
  }
}

void pbf_text_write_list(char *text, size_t size, const char *format, va_list arguments) {
  pbf_os_print_plain(text, size, format, arguments);
  pbf_text_make_line(text);
}

void pbf_text_write(char *text, size_t size, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  pbf_text_write_list(text, size, format, arguments);
  va_end(arguments);
}
