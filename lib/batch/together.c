#include "together.h"

#include "error.h"
#include "memory.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/step.h"
#include "text.h"
#include "worlds.h"

static uint64_t handles_bytes(const pbf_batch *batch) {
  return batch->world_count * sizeof(pbf_backend_solver *);
}

pbf_status pbf_batch_find_together(pbf_batch *batch) {
  const pbf_backend_api *api = &batch->worlds[0].solver->api;
  const pbf_backend_worlds *found =
      api->get_extension ? api->get_extension(PBF_BACKEND_WORLDS) : NULL;
  void *memory;
  if (!found || found->struct_size < sizeof *found) return PBF_OK;
  const pbf_status status = pbf_memory_allocate(&batch->allocator, handles_bytes(batch),
                                                "the handles of a batch's worlds", &memory);
  if (status != PBF_OK) return status;
  batch->handles = memory;
  batch->together = found;
  return PBF_OK;
}

void pbf_batch_free_together(pbf_batch *batch) {
  pbf_memory_free(&batch->allocator, batch->handles, handles_bytes(batch));
}

/* As pbf_step, but for that the backend may note the steps alone. */
static pbf_status note_steps(pbf_batch *batch, uint32_t world, void *context) {
  pbf_solver *solver = batch->worlds[world].solver;
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  batch->together->put_off(solver->backend, 1);
  status = pbf_run_steps(solver, *(const uint32_t *)context);
  batch->together->put_off(solver->backend, 0);
  return pbf_leave(solver, status);
}

static void note_failure(pbf_world *world, pbf_status status) {
  world->status = status;
  world->sentence[0] = 0;
  pbf_text_append(world->sentence, sizeof world->sentence, pbf_last_error());
}

/* A world in which another thread is by now has done its steps before that thread's call. */
static pbf_status run_noted(pbf_batch *batch) {
  uint32_t entered = 0;
  pbf_solver *first = NULL;
  for (uint32_t k = 0; k < batch->world_count; ++k) {
    pbf_solver *solver = batch->worlds[k].solver;
    batch->worlds[k].entered = pbf_enter(solver) == PBF_OK;
    if (!batch->worlds[k].entered) continue;
    batch->handles[entered++] = solver->backend;
    if (!first) first = solver;
  }
  pbf_status status = PBF_OK;
  if (first)
    status = pbf_backend_result(first, batch->together->run(batch->handles, entered), "run");
  for (uint32_t k = batch->world_count; k-- > 0;) {
    pbf_world *world = &batch->worlds[k];
    if (!world->entered) continue;
    pbf_leave(world->solver, PBF_OK);
    if (status != PBF_OK && world->status == PBF_OK) note_failure(world, status);
  }
  return status;
}

pbf_status pbf_batch_step_together(pbf_batch *batch, const uint8_t *mask, uint32_t steps) {
  const pbf_status noted = pbf_batch_for_worlds(batch, mask, PBF_BY_THREADS, note_steps, &steps);
  if (noted == PBF_OK) return run_noted(batch);
  char why[PBF_MESSAGE_SIZE] = "";
  pbf_text_append(why, sizeof why, pbf_last_error());
  run_noted(batch);
  return pbf_fail(noted, "%s", why);
}
