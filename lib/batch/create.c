/* Creation of a batch. */
#include <string.h>

#include "desc.h"
#include "error.h"
#include "free.h"
#include "handles.h"
#include "lock.h"
#include "memory.h"
#include "solver/create.h"
#include "solver/handles.h"
#include "os.h"
#include "together.h"

/* Of a world: one thread, which the batch has it stepped by. */
static pbf_desc desc_of_world(const pbf_checked_desc *checked) {
  pbf_desc desc = checked->desc;
  desc.allocator = &checked->allocator;
  desc.backend = checked->backend;
  desc.isa = checked->isa_by_environment || !checked->isa[0] ? NULL : checked->isa;
  desc.threads = 1;
  desc.enqueue_task = NULL;
  desc.finish_task = NULL;
  desc.task_user = NULL;
  return desc;
}

static pbf_status fail_as_world(pbf_status status, uint32_t world) {
  char why[PBF_MESSAGE_SIZE];
  memcpy(why, pbf_last_error(), sizeof why);
  return pbf_fail(status, "world %u: %s", world, why);
}

/* The backend of the first world serves all. */
static pbf_status create_worlds(pbf_batch *batch, const pbf_desc *first, const pbf_params *params) {
  pbf_info info = {.struct_size = sizeof info};
  pbf_desc desc = *first;
  for (uint32_t k = 0; k < batch->world_count; ++k) {
    pbf_world *world = &batch->worlds[k];
    pbf_status status = pbf_create_world(&desc, params, batch->world_count, &world->solver);
    if (status != PBF_OK) return k > 0 ? fail_as_world(status, k) : status;
    pbf_solver_set_in_batch(world->solver, 1);
    if (k > 0) continue;
    status = pbf_get_info(world->solver, &info);
    if (status != PBF_OK) return status;
    batch->device_type = info.device_type;
    desc.backend = info.backend;
    if (!info.fell_back) continue;
    desc.device = info.device;
    desc.stream = NULL;
  }
  return PBF_OK;
}

static pbf_status fill(pbf_batch *batch, const pbf_checked_desc *checked, const pbf_params *params,
                       uint32_t worlds) {
  void *memory;
  pbf_desc desc = desc_of_world(checked);
  pbf_status status =
      pbf_memory_allocate(&batch->allocator, pbf_worlds_bytes(worlds), "the worlds", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, pbf_worlds_bytes(worlds));
  batch->worlds = memory;
  batch->world_count = worlds;
  batch->kind = (pbf_check_kind){desc.dimension, desc.precision};
  batch->pool.size = pbf_thread_pool_size(checked->desc.threads, worlds);
  batch->pool.enqueue_task = checked->desc.enqueue_task;
  batch->pool.finish_task = checked->desc.finish_task;
  batch->pool.task_user = checked->desc.task_user;
  status = create_worlds(batch, &desc, params);
  return status == PBF_OK ? pbf_batch_find_together(batch) : status;
}

static pbf_status create(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                         pbf_batch **batch) {
  pbf_checked_desc checked;
  void *memory;
  pbf_status status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_desc_check(desc, &checked);
  if (status == PBF_OK)
    status = pbf_memory_allocate(&checked.allocator, sizeof **batch, "a batch", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, sizeof **batch);
  ((pbf_batch *)memory)->allocator = checked.allocator;
  status = fill(memory, &checked, params, worlds);
  if (status != PBF_OK) {
    pbf_batch_free(memory);
    return status;
  }
  pbf_batch_publish(memory);
  *batch = memory;
  return PBF_OK;
}

pbf_status pbf_batch_create(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                            pbf_batch **batch) {
  if (!desc) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "desc is null; pbf_desc_init fills one");
  if (!batch) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "batch is null; it receives the new one");
  if (worlds == 0 || worlds > PBF_MAX_WORLDS) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "worlds is %u; it must be 1 … %u", worlds,
                    PBF_MAX_WORLDS);
  }
  const int cancellation = pbf_uncancelled_begin();
  pbf_status status = create(desc, params, worlds, batch);
  pbf_uncancelled_end(cancellation);
  return status;
}
