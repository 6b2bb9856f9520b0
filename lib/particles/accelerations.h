/* Accelerations of particles that the caller gives, by row. */
#ifndef PBF_LIB_PARTICLES_ACCELERATIONS_H
#define PBF_LIB_PARTICLES_ACCELERATIONS_H

#include "solver/solver.h"

/* What is given, and velocities before and after it has acted. */
static inline uint64_t pbf_accelerations_bytes(const pbf_solver *solver) {
  return 3 * (uint64_t)solver->capacity * pbf_point_bytes(solver);
}

/* `part` 0: the accelerations, 1 and 2: velocities before and after. */
static inline char *pbf_acceleration_values(const pbf_solver *solver, uint32_t part, uint32_t row) {
  return (char *)solver->accelerations +
         ((uint64_t)part * solver->capacity + row) * pbf_point_bytes(solver);
}

/* Whether steps have to be made one at a time. */
static inline int pbf_has_accelerations(const pbf_solver *solver) {
  return solver->accelerations != NULL;
}

/* The largest sum of gravity and one of them. */
double pbf_largest_acceleration(const pbf_solver *solver);

/* Rows of which velocities have been changed. */
typedef struct pbf_accelerated_rows {
  uint32_t first, count;
} pbf_accelerated_rows;

/* Before a step: they act over all of it. */
pbf_status pbf_accelerate(pbf_solver *solver, pbf_accelerated_rows *rows);

/* And takes that back, where the step has failed. */
void pbf_undo_accelerations(pbf_solver *solver, const pbf_accelerated_rows *rows);

/* A row becomes another one, which is no later. */
void pbf_accelerations_move(pbf_solver *solver, uint32_t from, uint32_t to);

void pbf_accelerations_free(pbf_solver *solver);

#endif
