#ifndef PBF_LIB_SOLVER_COLLIDERS_H
#define PBF_LIB_SOLVER_COLLIDERS_H

#include "solver.h"

static inline uint64_t pbf_colliders_bytes(uint32_t count) {
  return (uint64_t)count * sizeof(pbf_collider);
}

/* A reference to the geometry of colliders[index], where it has one. Fails for what is none. */
pbf_status pbf_collider_hold(const pbf_collider *collider, uint32_t index);

/* Gives the references of so many colliders back. */
void pbf_colliders_let_go(uint32_t count, const pbf_collider *colliders);

/* Hands checked colliders, whose poses hold at `time`, to the backend. */
pbf_status pbf_colliders_to_backend(pbf_solver *solver, uint32_t count,
                                    const pbf_collider *colliders, double time);

/* The solver owns `colliders`, and their references, from now on and frees what it had. */
void pbf_colliders_replace(pbf_solver *solver, uint32_t count, pbf_collider *colliders,
                           double time);

#endif
