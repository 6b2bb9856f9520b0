#ifndef PBF_LIB_SOLVER_STEP_H
#define PBF_LIB_SOLVER_STEP_H

#include "solver.h"

/* Tells the backend what the time is, for where walls and colliders stand in densities and
 * statistics: after any change of it that was no step of the backend's. */
pbf_status pbf_solver_tell_time(pbf_solver *solver, double time);

#endif
