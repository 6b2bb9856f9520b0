/* Copies of the state for other threads. Which one is the latest, and which ones are held, is
 * guarded by the lock of solvers; what is in one, by its being neither while it is written. */
#ifndef PBF_LIB_SOLVER_SNAPSHOTS_H
#define PBF_LIB_SOLVER_SNAPSHOTS_H

#include "solver.h"

/* Of the present state, where they are wanted and there is room. */
pbf_status pbf_snapshots_make(pbf_solver *solver);

#endif
