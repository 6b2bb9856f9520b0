/* The library's copy of accelerations, a row a particle. */
#include "accelerations.h"

#include "memory.h"

void pbf_accelerations_free(pbf_solver *solver) {
  pbf_memory_free(&solver->allocator, solver->accelerations, pbf_accelerations_bytes(solver));
  solver->accelerations = NULL;
  solver->acceleration_count = 0;
}
