/* Steps of all worlds, and their starts. */
#include <inttypes.h>
#include <string.h>

#include "error.h"
#include "handles.h"
#include "starts.h"
#include "state/saved_state.h"
#include "together.h"
#include "worlds.h"

static pbf_status step_world(pbf_batch *batch, uint32_t world, void *context) {
  return pbf_step(batch->worlds[world].solver, *(const uint32_t *)context);
}

static pbf_status step(pbf_batch *batch, const uint8_t *mask, uint32_t steps) {
  if (batch->together) return pbf_batch_step_together(batch, mask, steps);
  return pbf_batch_for_worlds(batch, mask, PBF_BY_THREADS, step_world, &steps);
}

pbf_status pbf_batch_step(pbf_batch *batch, const uint8_t *mask, uint32_t steps) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, step(batch, mask, steps));
}

/* ---- Starts --------------------------------------------------------------------------------- */

static pbf_status keep_present(pbf_batch *batch, uint32_t world, void *context) {
  (void)context;
  pbf_world *own = &batch->worlds[world];
  uint64_t size = 0;
  pbf_start *start;
  pbf_status status = pbf_save(own->solver, NULL, &size);
  if (status == PBF_OK) status = pbf_start_take(batch, size, &start);
  if (status != PBF_OK) return status;
  status = pbf_save(own->solver, start->state, &size);
  if (status != PBF_OK) {
    pbf_start_drop(batch, &start);
    return status;
  }
  pbf_start_drop(batch, &own->start);
  own->start = start;
  return PBF_OK;
}

static pbf_status share(pbf_batch *batch, uint32_t world, void *context) {
  pbf_start *start = context;
  atomic_fetch_add(&start->worlds, 1);
  pbf_start_drop(batch, &batch->worlds[world].start);
  batch->worlds[world].start = start;
  return PBF_OK;
}

static pbf_status set_start(pbf_batch *batch, const uint8_t *mask, const void *state,
                            uint64_t size) {
  pbf_start *start;
  if (!state && size > 0)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "state is null and size %" PRIu64 "; it must be 0 then", size);
  if (!state) return pbf_batch_for_worlds(batch, mask, PBF_BY_THREADS, keep_present, NULL);
  pbf_status status = pbf_saved_state_check(batch->worlds[0].solver, state, size);
  if (status == PBF_OK) status = pbf_start_take(batch, size, &start);
  if (status != PBF_OK) return status;
  memcpy(start->state, state, size);
  status = pbf_batch_for_worlds(batch, mask, PBF_BY_CALLER, share, start);
  pbf_start_drop(batch, &start);
  return status;
}

pbf_status pbf_batch_set_start(pbf_batch *batch, const uint8_t *mask, const void *state,
                               uint64_t size) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, set_start(batch, mask, state, size));
}

static pbf_status reset_world(pbf_batch *batch, uint32_t world, void *context) {
  (void)context;
  const pbf_world *own = &batch->worlds[world];
  if (!own->start)
    return pbf_fail(PBF_ERROR_STATE,
                    "it has no start to go back to; pbf_batch_set_start gives one");
  return pbf_load(own->solver, own->start->state, own->start->size);
}

pbf_status pbf_batch_reset(pbf_batch *batch, const uint8_t *mask) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch,
                         pbf_batch_for_worlds(batch, mask, PBF_BY_THREADS, reset_world, NULL));
}
