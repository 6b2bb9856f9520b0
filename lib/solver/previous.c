#include "previous.h"

#include <string.h>

#include "backend_call.h"
#include "error.h"
#include "handles.h"
#include "ids.h"
#include "memory.h"
#include "rank_settings.h"

static char *place(const pbf_solver *solver, uint32_t row) {
  return (char *)solver->previous + row * pbf_point_bytes(solver);
}

pbf_status pbf_previous_note(pbf_solver *solver) {
  const pbf_rows rows = pbf_ids_rows(solver, 0, solver->count);
  if (solver->count == 0) return PBF_OK;
  pbf_status status =
      solver->api.read(solver->backend, PBF_FIELD_POSITION, &rows, solver->previous);
  if (status == PBF_OK) solver->previous_count = solver->count;
  return pbf_backend_result(solver, status, "read");
}

void pbf_previous_set(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions) {
  if (first >= solver->previous_count) return;
  if (count > solver->previous_count - first) count = solver->previous_count - first;
  memcpy(place(solver, first), positions, count * pbf_point_bytes(solver));
}

static pbf_status keep_previous(pbf_solver *solver, uint32_t enabled) {
  if (enabled > 1)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "enabled is %u; it must be 0 or 1", enabled);
  pbf_status status = PBF_OK;
  if (enabled && !solver->previous)
    status = pbf_memory_allocate(&solver->allocator, pbf_previous_bytes(solver),
                                 "the positions before a step", &solver->previous);
  if (!enabled) {
    pbf_memory_free(&solver->allocator, solver->previous, pbf_previous_bytes(solver));
    solver->previous = NULL;
    pbf_previous_forget(solver);
  }
  if (status == PBF_OK) pbf_rank_settings_tell(solver);
  return status;
}

pbf_status pbf_keep_previous(pbf_solver *solver, uint32_t enabled) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, keep_previous(solver, enabled));
}
