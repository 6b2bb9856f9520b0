/* Particles on their way into a solver: where they are written, and their numbers. */
#ifndef PBF_LIB_EMISSION_NEW_PARTICLES_H
#define PBF_LIB_EMISSION_NEW_PARTICLES_H

#include "emission.h"

/* Room for so many particles' positions and velocities. */
pbf_status pbf_emission_reserve(pbf_solver *solver, pbf_emission *e, uint64_t count);

/* A number of a particle, in the solver's precision, as an element of `array`. */
void pbf_emission_put(const pbf_solver *solver, void *array, uint64_t index, double number);

/* Whether a place, rounded to the solver's precision, is in the domain as it now is. */
int pbf_emission_is_inside(const pbf_solver *solver, const double place[3]);

#endif
