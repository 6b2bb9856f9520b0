/* What a batch is, and what became of its worlds. */
#include "check.h"
#include "error.h"
#include "handles.h"
#include "structs.h"

static pbf_status get_info(const pbf_batch *batch, pbf_batch_info *theirs) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_batch_info, theirs);
  if (status != PBF_OK) return status;
  const pbf_batch_info info = {
      .struct_size = sizeof info,
      .worlds = batch->world_count,
      .threads = batch->device_type == PBF_DEVICE_CPU ? batch->pool.size : 0,
      .device_type = batch->device_type,
  };
  pbf_struct_out(&pbf_kind_batch_info, &info, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_batch_get_info(pbf_batch *batch, pbf_batch_info *info) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, get_info(batch, info));
}

static pbf_status check_world(const pbf_batch *batch, uint32_t world, const void *out,
                              const char *name) {
  if (!out) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", name);
  if (world < batch->world_count) return PBF_OK;
  return pbf_fail(PBF_ERROR_NOT_FOUND, "world is %u; the batch has %u worlds", world,
                  batch->world_count);
}

pbf_status pbf_batch_get_world(pbf_batch *batch, uint32_t world, pbf_solver **solver) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  status = check_world(batch, world, solver, "solver");
  if (status == PBF_OK) *solver = batch->worlds[world].solver;
  return pbf_batch_leave(batch, status);
}

pbf_status pbf_batch_get_statuses(pbf_batch *batch, pbf_status *statuses) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("statuses", statuses, sizeof *statuses);
  for (uint32_t k = 0; k < batch->world_count && status == PBF_OK; ++k)
    statuses[k] = batch->worlds[k].status;
  return pbf_batch_leave(batch, status);
}

pbf_status pbf_batch_get_sentence(pbf_batch *batch, uint32_t world, const char **sentence) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  status = check_world(batch, world, sentence, "sentence");
  if (status == PBF_OK) *sentence = batch->worlds[world].sentence;
  return pbf_batch_leave(batch, status);
}
