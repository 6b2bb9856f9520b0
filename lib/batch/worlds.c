#include "worlds.h"

#include "error.h"
#include "text.h"

typedef struct journey {
  pbf_batch *batch;
  const uint8_t *mask;
  pbf_world_fn function;
  void *context;
} journey;

/* In any thread. */
static void visit(void *user, uint32_t k) {
  const journey *j = user;
  pbf_world *world = &j->batch->worlds[k];
  world->status = PBF_OK;
  world->sentence[0] = 0;
  if (j->mask && !j->mask[k]) return;
  world->status = j->function(j->batch, k, j->context);
  if (world->status == PBF_OK) return;
  pbf_text_append(world->sentence, sizeof world->sentence, pbf_last_error());
}

static pbf_status first_failure(const pbf_batch *batch) {
  for (uint32_t k = 0; k < batch->world_count; ++k) {
    const pbf_world *world = &batch->worlds[k];
    if (world->status != PBF_OK) return pbf_fail(world->status, "world %u: %s", k, world->sentence);
  }
  return PBF_OK;
}

/* A device takes work from one thread. */
pbf_status pbf_batch_for_worlds(pbf_batch *batch, const uint8_t *mask, pbf_worlds_by by,
                                pbf_world_fn function, void *context) {
  journey j = {batch, mask, function, context};
  if (by == PBF_BY_THREADS && batch->device_type == PBF_DEVICE_CPU) {
    pbf_thread_pool_run(&batch->pool, &batch->allocator, batch->world_count, visit, &j);
  } else {
    for (uint32_t k = 0; k < batch->world_count; ++k) visit(&j, k);
  }
  return first_failure(batch);
}
