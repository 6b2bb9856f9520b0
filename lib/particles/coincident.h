/* Particles that are added at one and the same point are set apart. */
#ifndef PBF_LIB_PARTICLES_COINCIDENT_H
#define PBF_LIB_PARTICLES_COINCIDENT_H

#include "solver/solver.h"

/* Positions of which no two are the same. */
typedef struct pbf_distinct {
  const void *positions; /* the caller's array, or `copy` */
  void *copy;            /* null where no particles coincide */
  uint64_t bytes;
} pbf_distinct;

/* Coincident particles among the `count` are set apart as physics/coincident.h says; those in one
 * cell of this grain coincide, with 0 those at one point alone. Fails with PBF_ERROR_OUT_OF_MEMORY.
 */
pbf_status pbf_distinct_positions(const pbf_solver *solver, const void *positions, uint32_t count,
                                  double grain, pbf_distinct *distinct);
void pbf_distinct_free(const pbf_solver *solver, pbf_distinct *distinct);

#endif
