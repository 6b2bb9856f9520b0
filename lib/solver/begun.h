/* The thread that runs the steps of pbf_begin_step. A solver has one from the first of these on,
 * until it is freed: with OpenMP each thread that calls has a pool of its own. */
#ifndef PBF_LIB_SOLVER_BEGUN_H
#define PBF_LIB_SOLVER_BEGUN_H

#include "solver.h"

/* Waits until steps that have begun are done. */
void pbf_worker_wait(pbf_solver *solver);

/* Bytes of it, or 0. */
uint64_t pbf_worker_bytes(const pbf_solver *solver);

/* Ends the thread, if there is one. */
void pbf_worker_free(pbf_solver *solver);

#endif
