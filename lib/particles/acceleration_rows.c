/* The library's copy of accelerations, a row a particle. */
#include "accelerations.h"

#include <string.h>

#include "memory.h"

void pbf_accelerations_move(pbf_solver *solver, uint32_t from, uint32_t to) {
  if (from == to) return;
  memcpy(pbf_acceleration_of_row(solver, to), pbf_acceleration_of_row(solver, from),
         pbf_point_bytes(solver));
}

void pbf_accelerations_free(pbf_solver *solver) {
  pbf_memory_free(&solver->allocator, solver->accelerations, pbf_accelerations_bytes(solver));
  solver->accelerations = NULL;
  solver->acceleration_count = 0;
}
