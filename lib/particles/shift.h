/* A floating origin: all particles are set farther by the same way, which is no new placement. */
#ifndef PBF_LIB_PARTICLES_SHIFT_H
#define PBF_LIB_PARTICLES_SHIFT_H

#include "solver/solver.h"

/* *is_shift: whether most particles go the same way, *shift, to the new positions, which are those
 * of all. Reads the old ones: PBF_ERROR_OUT_OF_MEMORY. */
pbf_status pbf_shift_to(pbf_solver *solver, const void *positions, int *is_shift, double shift[3]);

#endif
