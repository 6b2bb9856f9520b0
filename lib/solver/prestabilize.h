/* Starts that are too dense are moved apart before they are stepped. */
#ifndef PBF_LIB_SOLVER_PRESTABILIZE_H
#define PBF_LIB_SOLVER_PRESTABILIZE_H

#include "solver.h"

/* `count` particles have come to where they are by other means than a step. */
void pbf_note_placed(pbf_solver *solver, uint32_t count);

/* The parameters change to these: particles may be of another size where they are, or behind walls
 * that have jumped. */
void pbf_note_params(pbf_solver *solver, const pbf_params *params);

/* Where enough particles have been placed since the last step, and params.prestabilization asks for
 * it. */
pbf_status pbf_prestabilize(pbf_solver *solver);

#endif
