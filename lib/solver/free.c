#include "free.h"

#include "colliders.h"
#include "ids.h"
#include "memory.h"

void pbf_solver_free(pbf_solver *solver) {
  pbf_allocator allocator = solver->allocator;
  solver->api.destroy(solver->backend);
  pbf_memory_free(&allocator, solver->ids, pbf_ids_bytes(solver));
  pbf_memory_free(&allocator, solver->colliders, pbf_colliders_bytes(solver->collider_count));
  pbf_memory_free(&allocator, solver, sizeof *solver);
}
