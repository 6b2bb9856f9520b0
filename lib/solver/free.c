#include "free.h"

#include "memory.h"

void pbf_solver_free(pbf_solver *solver) {
  pbf_allocator allocator = solver->allocator;
  solver->api.destroy(solver->backend);
  pbf_memory_give(&allocator, solver->ids, (uint64_t)solver->capacity * sizeof *solver->ids);
  pbf_memory_give(&allocator, solver->colliders,
                  (uint64_t)solver->collider_count * sizeof *solver->colliders);
  pbf_memory_give(&allocator, solver, sizeof *solver);
}
