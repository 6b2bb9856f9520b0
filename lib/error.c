#include "error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char last_sentence[PBF_SENTENCE_SIZE];
static _Thread_local char plugin_sentence[PBF_SENTENCE_SIZE];

pbf_status pbf_fail(pbf_status status, const char *format, ...) {
  /* The arguments may point into the sentence that is about to be replaced. */
  char sentence[PBF_SENTENCE_SIZE];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  memcpy(last_sentence, sentence, sizeof sentence);
  return status;
}

const char *pbf_last_error(void) { return last_sentence; }

void pbf_plugin_sentence_set(const char *sentence) {
  snprintf(plugin_sentence, sizeof plugin_sentence, "%s", sentence ? sentence : "");
}

void pbf_plugin_sentence_clear(void) { plugin_sentence[0] = 0; }

const char *pbf_plugin_sentence(void) { return plugin_sentence; }
