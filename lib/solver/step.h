/* Steps, within a call. */
#ifndef PBF_LIB_SOLVER_STEP_H
#define PBF_LIB_SOLVER_STEP_H

#include "solver.h"

/* Hands the time to the backend, which needs it to place walls and colliders for densities and
 * statistics: after any change of it that was no step of the backend. */
pbf_status pbf_time_to_backend(pbf_solver *solver, double time);

/* What pbf_step does inside a call. */
pbf_status pbf_run_steps(pbf_solver *solver, uint32_t steps);

#endif
