/* Particles of a rank's own share. */
#include <stddef.h>

#include "check.h"
#include "error.h"
#include "particles.h"
#include "row_set.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/ids.h"

/* Null: without ranks, or of a plugin that can't tell. */
static const pbf_backend_ranks_tell *tell_of(const pbf_solver *solver) {
  const size_t needed =
      offsetof(pbf_backend_ranks_tell, read_own) + sizeof(((pbf_backend_ranks_tell *)0)->read_own);
  if (!solver->ranks.count) return NULL;
  const pbf_backend_ranks_tell *tell = solver->api.get_extension(PBF_BACKEND_RANKS_TELL);
  return tell && tell->struct_size >= needed ? tell : NULL;
}

static pbf_status count_own(pbf_solver *solver, uint32_t *count) {
  *count = solver->count;
  if (!solver->ranks.count) return PBF_OK;
  const pbf_backend_ranks_tell *tell = tell_of(solver);
  if (!tell)
    return pbf_fail(PBF_ERROR_UNSUPPORTED, "the backend \"%s\" does not tell a rank's share",
                    solver->plugin->name);
  return pbf_backend_result(solver, tell->own_ids(solver->backend, count, NULL), "own_ids");
}

static pbf_status check(uint32_t field, uint32_t room, uint32_t own) {
  if (field != PBF_FIELD_POSITION && field != PBF_FIELD_VELOCITY)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "field is %u; it must be PBF_FIELD_POSITION or PBF_FIELD_VELOCITY", field);
  if (room < own)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "room is %u; the share has %u particles", room,
                    own);
  return PBF_OK;
}

/* As the backend has stored them, and then ascending, by the rows that they have among all. */
static pbf_status read_ids(pbf_solver *solver, uint32_t count, uint32_t *ids) {
  pbf_row_set rows;
  uint32_t row = 0;
  pbf_status status = tell_of(solver)->own_ids(solver->backend, &count, ids);
  if (status != PBF_OK) return pbf_backend_result(solver, status, "own_ids");
  status = pbf_row_set_allocate(solver, &rows);
  if (status != PBF_OK) return status;
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_ids_find(solver, ids[k], &row)) pbf_row_set_add(&rows, row);
  pbf_row_set_ids(solver, &rows, count, ids);
  pbf_row_set_free(solver, &rows);
  return PBF_OK;
}

static pbf_status read_share(pbf_solver *solver, uint32_t field, uint32_t count, uint32_t *ids,
                             void *values) {
  if (!solver->ranks.count) {
    for (uint32_t row = 0; row < count; ++row) ids[row] = pbf_ids_of_row(solver, row);
    return values ? pbf_read_all(solver, field, values) : PBF_OK;
  }
  const pbf_status status = read_ids(solver, count, ids);
  const pbf_rows rows = {sizeof rows, 0, count, count, ids};
  if (status != PBF_OK || !values) return status;
  return pbf_backend_result(
      solver, tell_of(solver)->read_own(solver->backend, field, &rows, values), "read_own");
}

static pbf_status get(pbf_solver *solver, uint32_t field, uint32_t room, uint32_t *count,
                      uint32_t *ids, void *values) {
  uint32_t own = 0;
  pbf_status status = pbf_check_pointer("count", count, sizeof *count);
  if (status == PBF_OK) status = count_own(solver, &own);
  if (status == PBF_OK && (ids || values)) status = check(field, room, own);
  if (status == PBF_OK && values && !ids)
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "ids is null and values is not; without ids nothing tells which is which");
  if (status == PBF_OK && ids && own > 0) status = read_share(solver, field, own, ids, values);
  if (status == PBF_OK) *count = own;
  return status;
}

pbf_status pbf_get_share(pbf_solver *solver, uint32_t field, uint32_t room, uint32_t *count,
                         uint32_t *ids, void *values) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get(solver, field, room, count, ids, values));
}
