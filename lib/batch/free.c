#include "free.h"

#include "memory.h"
#include "solver/handles.h"
#include "starts.h"
#include "together.h"

void pbf_batch_free(pbf_batch *batch) {
  const pbf_allocator allocator = batch->allocator;
  pbf_thread_pool_free(&batch->pool, &allocator);
  for (uint32_t k = 0; k < batch->world_count; ++k) {
    pbf_world *world = &batch->worlds[k];
    pbf_start_drop(batch, &world->start);
    if (!world->solver) continue;
    pbf_solver_set_in_batch(world->solver, 0);
    pbf_destroy(world->solver);
  }
  pbf_batch_free_together(batch);
  pbf_memory_free(&allocator, batch->worlds, pbf_worlds_bytes(batch->world_count));
  pbf_memory_free(&allocator, batch, sizeof *batch);
}
