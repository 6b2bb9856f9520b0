/* Removing particles by their ids. */
#include "check.h"
#include "error.h"
#include "row_set.h"
#include "solver/handles.h"
#include "solver/ids.h"

static pbf_status mark(const pbf_solver *solver, uint32_t count, const uint32_t *ids,
                       pbf_row_set *removed) {
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t row;
    if (!pbf_ids_find(solver, ids[i], &row)) {
      return pbf_fail(PBF_ERROR_NOT_FOUND, "ids[%u] is %u; no particle has this id", i, ids[i]);
    }
    if (pbf_row_set_has(removed, row)) {
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "ids[%u] is %u, which stands twice", i, ids[i]);
    }
    pbf_row_set_add(removed, row);
  }
  return PBF_OK;
}

static pbf_status remove_particles(pbf_solver *solver, uint32_t count, const uint32_t *ids) {
  pbf_row_set removed;
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer("ids", ids, sizeof *ids);
  if (status != PBF_OK) return status;
  if (count > solver->count) {
    return pbf_fail(PBF_ERROR_NOT_FOUND, "count is %u; the solver holds %u particles", count,
                    solver->count);
  }
  status = pbf_row_set_allocate(solver, &removed);
  if (status != PBF_OK) return status;
  status = mark(solver, count, ids, &removed);
  if (status == PBF_OK) status = pbf_row_set_remove(solver, &removed);
  pbf_row_set_free(solver, &removed);
  return status;
}

pbf_status pbf_remove_particles(pbf_solver *solver, uint32_t count, const uint32_t *ids) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, remove_particles(solver, count, ids));
}
