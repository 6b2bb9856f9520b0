/* The sentence behind pbf_last_error. */
#ifndef PBF_LIB_ERROR_H
#define PBF_LIB_ERROR_H

#include <pbf/pbf.h>

/* Room for a sentence that lists the reasons of several backends. */
enum { PBF_SENTENCE_SIZE = 2048 };

/* Keeps the sentence for pbf_last_error and gives `status` back. */
__attribute__((format(printf, 2, 3))) pbf_status pbf_fail(pbf_status status, const char *format,
                                                          ...);

/* What the plugin last said through host->set_error in this thread. It is kept apart, so that a
 * call that succeeds in the end leaves the sentence of the last failure alone. */
void pbf_plugin_sentence_set(const char *sentence);
void pbf_plugin_sentence_clear(void);
const char *pbf_plugin_sentence(void);

#endif
