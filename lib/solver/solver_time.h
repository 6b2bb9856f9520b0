/* A solver's time: of the steps that are done, and of those to come. */
#ifndef PBF_LIB_SOLVER_SOLVER_TIME_H
#define PBF_LIB_SOLVER_SOLVER_TIME_H

#include "solver.h"

double pbf_solver_time(const pbf_solver *solver);

/* How long the step is that is next, or the part of one where parts are made one by one. */
double pbf_part_time_step(const pbf_solver *solver);

/* When the last of so many steps more ends. */
double pbf_time_of_step(const pbf_solver *solver, uint32_t steps);

/* From now on steps have another length. */
void pbf_solver_rebase_time(pbf_solver *solver);

#endif
