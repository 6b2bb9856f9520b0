#ifndef PBF_LIB_SOLVER_COLLIDERS_H
#define PBF_LIB_SOLVER_COLLIDERS_H

#include "solver.h"

static inline uint64_t pbf_colliders_bytes(uint32_t count) {
  return (uint64_t)count * sizeof(pbf_collider);
}

/* Hands checked colliders, whose poses hold at `time`, to the backend. */
pbf_status pbf_colliders_to_backend(pbf_solver *solver, uint32_t count,
                                    const pbf_collider *colliders, double time);

/* The solver owns `colliders` from now on and frees what it had. */
void pbf_colliders_replace(pbf_solver *solver, uint32_t count, pbf_collider *colliders,
                           double time);

#endif
