/* Parameters and phases on their way to the backend. */
#ifndef PBF_LIB_SOLVER_SET_PARAMS_H
#define PBF_LIB_SOLVER_SET_PARAMS_H

#include "solver.h"

/* Hands checked parameters to the backend. */
pbf_status pbf_params_to_backend(pbf_solver *solver, const pbf_params *params);

/* The same with these phases in place of the solver's. */
pbf_status pbf_params_with_phases(pbf_solver *solver, const pbf_params *params,
                                  const struct pbf_phases *phases);

#endif
