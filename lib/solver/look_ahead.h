/* How many steps can be made before walls or colliders are where they can't be. */
#ifndef PBF_LIB_SOLVER_LOOK_AHEAD_H
#define PBF_LIB_SOLVER_LOOK_AHEAD_H

#include "solver.h"

/* So many of the steps it pays to look at before the first of them is made: all, where a look at
 * the last one tells. At least 2 of 2. */
uint32_t pbf_steps_to_look_at(const pbf_solver *solver, uint32_t steps);

/* How many of the steps can be made; looks at each of them. */
uint32_t pbf_steps_possible(const pbf_solver *solver, uint32_t steps);

/* Says why the next step can't be, which is step number `step` of `steps`. */
pbf_status pbf_fail_to_move(const pbf_solver *solver, uint32_t step, uint32_t steps);

#endif
