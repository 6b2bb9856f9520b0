/* Particles that have just left their opening: of each a part is still outside. */
#ifndef PBF_LIB_EMISSION_ENTERING_H
#define PBF_LIB_EMISSION_ENTERING_H

#include "emission.h"

/* Those that the next step has; 0: none. */
int pbf_emission_find_entering(const pbf_solver *solver, pbf_entering *entering);

/* Tells the backend, which knows of an overlap, the part of each that is still outside. */
pbf_status pbf_emission_tell_entering(pbf_solver *solver, const pbf_entering *entering);

#endif
