/* The positions from before the last step, by row, for drawing between two. */
#ifndef PBF_LIB_SOLVER_PREVIOUS_H
#define PBF_LIB_SOLVER_PREVIOUS_H

#include "solver.h"

static inline uint64_t pbf_previous_bytes(const pbf_solver *solver) {
  return solver->capacity * pbf_point_bytes(solver);
}

/* Takes the present positions for those before the step that follows. */
pbf_status pbf_previous_note(pbf_solver *solver);

/* All particles have been where they are. */
static inline void pbf_previous_forget(pbf_solver *solver) { solver->previous_count = 0; }

/* What was set elsewhere has been there. */
void pbf_previous_set(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions);

#endif
