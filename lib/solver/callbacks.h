/* The caller's functions, allocator and log, as the library and backends call them: a C++ exception
 * or a longjmp may leave one, and with it the call that it runs in. */
#ifndef PBF_LIB_SOLVER_CALLBACKS_H
#define PBF_LIB_SOLVER_CALLBACKS_H

#include "solver.h"

/* Sets solver->allocator, log and log_user to functions that call these. */
void pbf_callbacks_wrap(pbf_solver *solver, const pbf_allocator *allocator, pbf_log_fn log,
                        void *log_user);

/* Whether the call that is said to run in the solver has been left through a callback: this thread
 * made it, and the callback's frame is not on its stack any more. Called with the lock of solvers
 * held. In doubt, no. */
int pbf_callbacks_were_left(const pbf_solver *solver);

/* A block that the caller's allocator will get back by another way. */
void pbf_callbacks_forget(pbf_solver *solver, const void *memory);

/* Releases what a call that was left has taken and nothing points to: after the backend has
 * released what it has, and the host. */
void pbf_callbacks_release_rest(pbf_solver *solver);

#endif
