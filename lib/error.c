#include "error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "text.h"

static _Thread_local char last_message[PBF_MESSAGE_SIZE];
static _Thread_local char plugin_message[PBF_MESSAGE_SIZE];

pbf_status pbf_fail(pbf_status status, const char *format, ...) {
  /* The arguments may point into the message that is about to be replaced. */
  char message[PBF_MESSAGE_SIZE];
  va_list arguments;
  va_start(arguments, format);
  pbf_text_write_list(message, sizeof message, format, arguments);
  va_end(arguments);
  memcpy(last_message, message, sizeof message);
  return status;
}

const char *pbf_last_error(void) { return last_message; }

void pbf_plugin_message_set(const char *message) {
  snprintf(plugin_message, sizeof plugin_message, "%s", message ? message : "");
}

void pbf_plugin_message_clear(void) { plugin_message[0] = 0; }

const char *pbf_plugin_message(void) { return plugin_message; }
