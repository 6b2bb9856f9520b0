/* Parameters and phases on their way to the backend. */
#ifndef PBF_LIB_SOLVER_SET_PARAMS_H
#define PBF_LIB_SOLVER_SET_PARAMS_H

#include "solver.h"

/* Hands checked parameters to the backend. */
pbf_status pbf_params_to_backend(pbf_solver *solver, const pbf_params *params);

#endif
