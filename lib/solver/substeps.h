/* Steps that the library divides: pbf_params.max_substeps. */
#ifndef PBF_LIB_SOLVER_SUBSTEPS_H
#define PBF_LIB_SOLVER_SUBSTEPS_H

#include "solver.h"

/* Into how many parts the next step is divided: 1 … max_substeps, by the state alone. */
pbf_status pbf_substeps_of(pbf_solver *solver, uint32_t *substeps);

/* Has the backend make steps of a `substeps`-th. */
pbf_status pbf_divide_step(pbf_solver *solver, uint32_t substeps);

#endif
