/* The thread that runs the steps of pbf_begin_step. A solver has one from the first of these on,
 * until it is freed: with OpenMP each thread that calls has a pool of its own. */
#ifndef PBF_LIB_SOLVER_WORKER_H
#define PBF_LIB_SOLVER_WORKER_H

#include "error.h"
#include "solver.h"

/* What its thread calls: the steps; whether one of their callbacks has destroyed the solver, so
 * that none waits for them; and what then gives the solver back, with all it has. */
typedef struct pbf_worker_calls {
  pbf_status (*run)(pbf_solver *solver, uint32_t steps);
  int (*is_alone)(pbf_solver *solver);
  pbf_status (*leave)(pbf_solver *solver, pbf_status status);
} pbf_worker_calls;

/* Unless the solver has one. Fails with PBF_ERROR_OUT_OF_MEMORY. */
pbf_status pbf_worker_start(pbf_solver *solver);

uintptr_t pbf_worker_thread(const pbf_solver *solver);

/* Has it run the steps. */
void pbf_worker_run(pbf_solver *solver, const pbf_worker_calls *calls, uint32_t steps);

/* Waits until steps that have begun are done. */
void pbf_worker_wait(pbf_solver *solver);

/* Its thread ends in a callback: the steps are not waited for any more. */
void pbf_worker_has_ended(pbf_solver *solver);

/* Of those; with the sentence of a failure. */
pbf_status pbf_worker_status(const pbf_solver *solver, char why[PBF_MESSAGE_SIZE]);

/* Bytes of it, or 0. */
uint64_t pbf_worker_bytes(const pbf_solver *solver);

/* Ends the thread, if there is one. */
void pbf_worker_free(pbf_solver *solver);

#endif
