/* How many steps can be made before walls or colliders are where they can't be. */
#ifndef PBF_LIB_SOLVER_LOOK_AHEAD_H
#define PBF_LIB_SOLVER_LOOK_AHEAD_H

#include "solver.h"

/* So many of the steps it pays to look at before the first of them is made: all, where a look at
 * the last one tells. At least 2 of 2. */
uint32_t pbf_steps_to_look_at(const pbf_solver *solver, uint32_t steps);

/* Of what stops the solver: walls that meet, or a collider beyond what its numbers hold. */
typedef struct pbf_steps_possible {
  uint32_t count; /* can be made */
  int walls_meet; /* 1: what stops the solver then, if count is less than was asked for */
} pbf_steps_possible;

/* Looks at each of the steps. */
pbf_steps_possible pbf_look_ahead(const pbf_solver *solver, uint32_t steps);

/* The sentence for the next step, which is step number `step` of `steps`. */
pbf_status pbf_fail_to_move(const pbf_solver *solver, const pbf_steps_possible *possible,
                            uint32_t step, uint32_t steps);

#endif
