/* Starts that are too dense are moved apart before they are stepped. */
#ifndef PBF_LIB_PRESTABILIZE_H
#define PBF_LIB_PRESTABILIZE_H

#include "solver.h"

/* `count` particles have come to where they are by other means than a step, or are of another size
 * there than they were. */
void pbf_note_placed(pbf_solver *solver, uint32_t count);

/* Where enough particles have been placed since the last step, and params.prestabilization asks for
 * it. */
pbf_status pbf_prestabilize(pbf_solver *solver);

/* 1 where fluid at rest before this change of parameters may be too dense after it. */
int pbf_params_make_start(const pbf_params *before, const pbf_params *after);

#endif
