/* Particles put at one and the same point: they would have no direction to part in. */
#ifndef PBF_LIB_PARTICLES_SEPARATE_H
#define PBF_LIB_PARTICLES_SEPARATE_H

#include "solver/solver.h"

/* Positions like those of a call, no two of which are the same. */
typedef struct pbf_separated {
  const void *positions; /* the caller's own, unless some had to be set apart */
  void *copy;
  uint64_t bytes;
} pbf_separated;

/* Of the `count` positions, those at one point are set apart about it, as physics/coincident.h
 * says. Fails with PBF_ERROR_OUT_OF_MEMORY. */
pbf_status pbf_separate(const pbf_solver *solver, const void *positions, uint32_t count,
                        pbf_separated *separated);
void pbf_separated_free(const pbf_solver *solver, pbf_separated *separated);

#endif
