/* The end of a solver. */
#ifndef PBF_LIB_SOLVER_FREE_H
#define PBF_LIB_SOLVER_FREE_H

#include "solver.h"

/* Frees the backend's solver and everything that the host keeps of it. Called by the call that
 * drops the last reference. */
void pbf_solver_free(pbf_solver *solver);

#endif
