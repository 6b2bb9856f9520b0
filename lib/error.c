#include "error.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "compiler.h"
#include "os.h"
#include "text.h"

/* Of each thread. */
typedef struct messages {
  char last[PBF_MESSAGE_SIZE];
  char plugin[PBF_MESSAGE_SIZE];
} messages;

static pbf_per_thread own_messages;

PBF_AT_LOAD(begin_messages) { pbf_per_thread_begin(&own_messages, sizeof(messages)); }
PBF_AT_UNLOAD(end_messages) { pbf_per_thread_end(&own_messages); }

/* Some thread had no memory for its messages. */
static atomic_int is_one_lost;
static const char lost[] = "there was no memory for the sentence that says what was wrong";

static messages *take(void) {
  messages *own = pbf_per_thread_take(&own_messages);
  if (!own) atomic_store_explicit(&is_one_lost, 1, memory_order_relaxed);
  return own;
}

/* What there is without memory. */
static const char *none(void) {
  return atomic_load_explicit(&is_one_lost, memory_order_relaxed) ? lost : "";
}

pbf_status pbf_fail(pbf_status status, const char *format, ...) {
  /* The arguments may point into the message that is about to be replaced. */
  char message[PBF_MESSAGE_SIZE];
  messages *own = take();
  va_list arguments;
  if (!own) return status;
  va_start(arguments, format);
  pbf_text_write_list(message, sizeof message, format, arguments);
  va_end(arguments);
  memcpy(own->last, message, sizeof message);
  return status;
}

/* One place for all sentences of a thread: a program may ask before the call that it asks about, as
 * where both are arguments of a function, which C evaluates in any order. There may be memory again
 * where there was none when the call failed: what was lost then stands in that place. */
const char *pbf_last_error(void) {
  messages *own = pbf_per_thread_take(&own_messages);
  if (own && !own->last[0]) snprintf(own->last, sizeof own->last, "%s", none());
  return own ? own->last : none();
}

/* A line at once: of half a character nothing is left, and then the backend has said nothing. */
void pbf_plugin_message_set(const char *message) {
  messages *own = take();
  if (!own) return;
  snprintf(own->plugin, sizeof own->plugin, "%s", message ? message : "");
  pbf_text_make_line(own->plugin);
}

void pbf_plugin_message_clear(void) {
  messages *own = pbf_per_thread_look(&own_messages);
  if (own) own->plugin[0] = 0;
}

const char *pbf_plugin_message(void) {
  const messages *own = pbf_per_thread_look(&own_messages);
  return own ? own->plugin : none();
}
