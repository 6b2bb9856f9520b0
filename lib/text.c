#include "text.h"

#include "os.h"

void pbf_text_write_list(char *text, size_t size, const char *format, va_list arguments) {
  pbf_os_print_plain(text, size, format, arguments);
}

void pbf_text_write(char *text, size_t size, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  pbf_text_write_list(text, size, format, arguments);
  va_end(arguments);
}
