/* Live solvers: the calls that run in them and the references that keep them. */
#ifndef PBF_LIB_SOLVER_HANDLES_H
#define PBF_LIB_SOLVER_HANDLES_H

#include "solver.h"

/* Begins a call. Fails for null, for a pointer to no live solver, and with PBF_ERROR_BUSY. After a
 * success the call ends with one pbf_leave, which returns `status`. Between them the thread has the
 * floating-point environment that everything computes under. */
pbf_status pbf_enter(pbf_solver *solver);
pbf_status pbf_leave(pbf_solver *solver, pbf_status status);

/* Of pbf_begin_step: the call stays inside, run by that thread, … */
void pbf_stay(pbf_solver *solver, uintptr_t runner);

/* … until the one thread that this succeeds for leaves with its status. Fails with PBF_ERROR_STATE
 * where nothing has begun. */
pbf_status pbf_begin_end(pbf_solver *solver);
pbf_status pbf_leave_begun(pbf_solver *solver, pbf_status status);

/* 1: one of their callbacks has destroyed the solver, so that the thread that runs them leaves. */
int pbf_is_alone(pbf_solver *solver);

/* A reference to a solver that there is, whatever call is inside. Fails as pbf_enter, but for
 * that. */
pbf_status pbf_hold(pbf_solver *solver);
void pbf_let_go(pbf_solver *solver);

/* Makes the handle valid, with one reference: the handle itself. */
void pbf_solver_publish(pbf_solver *solver);

/* 1: pbf_destroy leaves the solver to its batch. */
void pbf_solver_set_in_batch(pbf_solver *solver, uint32_t in_batch);

/* From now on its calls log nothing, as after pbf_destroy. */
void pbf_solver_silence(pbf_solver *solver);

/* An exported tensor keeps the solver's memory alive. */
void pbf_solver_add_export(pbf_solver *solver);
void pbf_solver_drop_export(pbf_solver *solver);

/* Fails with PBF_ERROR_STATE while a view is mapped or a tensor exported. */
pbf_status pbf_check_unmapped(pbf_solver *solver);

#endif
