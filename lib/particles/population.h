/* Adding particles that have been checked. */
#ifndef PBF_LIB_PARTICLES_POPULATION_H
#define PBF_LIB_PARTICLES_POPULATION_H

#include "solver/solver.h"

/* At least one, of finite numbers inside the domain, for which there are places and ids.
 * `is_placed`: they may overlap others, which is then undone slowly (overlap.h). */
pbf_status pbf_population_append(pbf_solver *solver, uint32_t count, const void *positions,
                                 const void *velocities, int is_placed, uint32_t phase);

#endif
