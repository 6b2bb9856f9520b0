/* What the module has beside libpbf: a log function that calls one of the page's. */
#include <pbf/pbf.h>

__attribute__((import_module("pbf"), import_name("log"))) void pbf_js_log(uint32_t user,
                                                                          int32_t level,
                                                                          const char *message);

static void call_log(void *user, int32_t level, const char *message) {
  pbf_js_log((uint32_t)(uintptr_t)user, level, message);
}

pbf_log_fn pbf_js_log_function(void);

/* What pbf_desc.log is to be; log_user is a number by which the page finds its own function. */
pbf_log_fn pbf_js_log_function(void) { return call_log; }
