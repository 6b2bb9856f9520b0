/* Whether a call of several steps is to end between two of them: pbf_cancel. */
#ifndef PBF_LIB_SOLVER_CANCELLED_H
#define PBF_LIB_SOLVER_CANCELLED_H

#include "solver.h"

/* On ranks once all know it. */
int pbf_is_cancelled(const pbf_solver *solver);

/* Tells all ranks of a cancellation by any of them: each asks here after the same step, and would
 * else wait for one that has gone on to another call. */
pbf_status pbf_tell_cancelled(pbf_solver *solver);

#endif
