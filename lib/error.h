/* Error messages: that of pbf_last_error, and that of the plugin. */
#ifndef PBF_LIB_ERROR_H
#define PBF_LIB_ERROR_H

#include <pbf/pbf.h>

#include "compiler.h"

/* Long enough to list the reasons of several backends. */
enum { PBF_MESSAGE_SIZE = 2048 };

/* Sets the message of pbf_last_error and returns `status`. */
PBF_PRINTF(2, 3) pbf_status pbf_fail(pbf_status status, const char *format, ...);

/* What the plugin last said through host->set_error in this thread. It is kept apart, so that a
 * call that succeeds in the end leaves the message of the last failure alone. */
void pbf_plugin_message_set(const char *message);
void pbf_plugin_message_clear(void);
const char *pbf_plugin_message(void);

#endif
