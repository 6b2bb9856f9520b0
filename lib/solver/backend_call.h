/* The status that a plugin's function returns, checked. */
#ifndef PBF_LIB_SOLVER_BACKEND_CALL_H
#define PBF_LIB_SOLVER_BACKEND_CALL_H

#include <stddef.h>

#include "solver.h"

/* What the caller gets for what a backend's function returned: a known code, and a message where
 * the backend has set none. */
pbf_status pbf_backend_result(const pbf_solver *solver, pbf_status status, const char *function);

/* The same for a plugin without a solver yet, with the message in `why`. */
pbf_status pbf_backend_check_status(const pbf_plugin *plugin, pbf_status status,
                                    const char *function, char *why, size_t size);

#endif
