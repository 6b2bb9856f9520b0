/* Accelerations of particles that the caller gives, by row. */
#ifndef PBF_LIB_PARTICLES_ACCELERATIONS_H
#define PBF_LIB_PARTICLES_ACCELERATIONS_H

#include "solver/solver.h"

static inline uint64_t pbf_accelerations_bytes(const pbf_solver *solver) {
  return (uint64_t)solver->capacity * pbf_point_bytes(solver);
}

static inline char *pbf_acceleration_of_row(const pbf_solver *solver, uint32_t row) {
  return (char *)solver->accelerations + (uint64_t)row * pbf_point_bytes(solver);
}

static inline int pbf_has_accelerations(const pbf_solver *solver) {
  return solver->accelerations != NULL;
}

/* The largest sum of gravity and one of them. */
double pbf_largest_acceleration(const pbf_solver *solver);

/* Without the backend's. */
void pbf_accelerations_free(pbf_solver *solver);

/* To the backend, after the `count` particles with these ids, of which the first `rows` have these
 * accelerations; null: none has any. */
pbf_status pbf_accelerations_to_backend(pbf_solver *solver, const void *accelerations,
                                        uint32_t rows, uint32_t count, const uint32_t *ids);

#endif
