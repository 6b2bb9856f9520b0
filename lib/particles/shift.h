/* A floating origin: all particles are set farther by the same way, which is no new placement. */
#ifndef PBF_LIB_PARTICLES_SHIFT_H
#define PBF_LIB_PARTICLES_SHIFT_H

#include "solver/solver.h"

/* Whether most particles go the same way, *shift, from the positions before to those that are set
 * of all. */
int pbf_is_shift(const pbf_solver *solver, const void *before, const void *positions,
                 double shift[3]);

#endif
