/* The ids of the rows, which ascend. While no particle was removed, id and row are the same and
 * nothing is stored. */
#ifndef PBF_LIB_SOLVER_IDS_H
#define PBF_LIB_SOLVER_IDS_H

#include "solver.h"

uint32_t pbf_ids_of_row(const pbf_solver *solver, uint32_t row);

/* 1 and the row, or 0 when no particle has the id. */
int pbf_ids_find(const pbf_solver *solver, uint32_t id, uint32_t *row);

/* Stores the ids from now on. */
pbf_status pbf_ids_store(pbf_solver *solver);

static inline uint64_t pbf_ids_bytes(const pbf_solver *solver) {
  return (uint64_t)solver->capacity * sizeof *solver->ids;
}

pbf_rows pbf_ids_rows(const pbf_solver *solver, uint32_t first, uint32_t count);

#endif
