/* What comes back from a plugin's function: never taken at its word. */
#ifndef PBF_LIB_BACKEND_CALL_H
#define PBF_LIB_BACKEND_CALL_H

#include <stddef.h>

#include "solver.h"

/* The same as pbf_backend_result for a plugin without a solver yet, with the sentence in `why`. */
pbf_status pbf_backend_verdict(const pbf_plugin *plugin, pbf_status status, const char *function,
                               char *why, size_t size);

#endif
