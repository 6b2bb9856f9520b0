/* Pre-stabilization: particles that were placed too densely are moved apart before the next step.
 */
#ifndef PBF_LIB_SOLVER_PRESTABILIZE_H
#define PBF_LIB_SOLVER_PRESTABILIZE_H

#include "solver.h"

/* `count` particles are now where no step has moved them. */
void pbf_note_placed(pbf_solver *solver, uint32_t count);

/* The parameters change to these: densities may change with them, or walls jump over particles. */
void pbf_note_params(pbf_solver *solver, const pbf_params *params);

/* Acts only where enough particles have been placed since the last step, and
 * params.prestabilization asks for it. */
pbf_status pbf_prestabilize(pbf_solver *solver);

#endif
