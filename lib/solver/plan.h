/* The number of particles by which a backend chooses what runs. */
#ifndef PBF_LIB_SOLVER_PLAN_H
#define PBF_LIB_SOLVER_PLAN_H

#include "solver.h"

/* Tells the backend what a step would be planned for now. Asking alone changes no later step. */
pbf_status pbf_plan_now(pbf_solver *solver);

/* The same for a step that begins: the plans of later ones follow from it. */
pbf_status pbf_plan_step(pbf_solver *solver);

#endif
