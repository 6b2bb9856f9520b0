/* What comes back from a plugin's function: never taken at its word. */
#ifndef PBF_LIB_SOLVER_BACKEND_CALL_H
#define PBF_LIB_SOLVER_BACKEND_CALL_H

#include <stddef.h>

#include "solver.h"

/* What a backend's function returned, made into what the caller gets: a known code, and a message
 * where the backend gave none. */
pbf_status pbf_backend_result(const pbf_solver *solver, pbf_status status, const char *function);

/* The same for a plugin without a solver yet, with the message in `why`. */
pbf_status pbf_backend_verdict(const pbf_plugin *plugin, pbf_status status, const char *function,
                               char *why, size_t size);

#endif
