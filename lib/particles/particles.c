/* Reading and overwriting rows of particles. */
#include "particles.h"

#include <string.h>

#include "check.h"
#include "elsewhere.h"
#include "emission/emission.h"
#include "error.h"
#include "memory.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "shift.h"
#include "solver/prestabilize.h"
#include "solver/previous.h"
#include "structs.h"
#include "values.h"

pbf_status pbf_check_rows(const pbf_solver *solver, uint32_t first, uint32_t count) {
  if (first <= solver->count && count <= solver->count - first) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "first is %u and count %u; the solver holds %u particles", first, count,
                  solver->count);
}

static pbf_status read_backend(pbf_solver *solver, uint32_t field, const pbf_rows *rows,
                               void *out) {
  const pbf_backend_api *api = &solver->api;
  if (field == PBF_FIELD_PRESSURE)
    return pbf_backend_result(solver, api->read_pressures(solver->backend, rows, out),
                              "read_pressures");
  return pbf_backend_result(solver, api->read(solver->backend, field, rows, out), "read");
}

static pbf_status read_rows(pbf_solver *solver, uint32_t field, const char *name, uint32_t first,
                            uint32_t count, void *out) {
  pbf_status status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer(name, out, pbf_element_size(solver));
  if (status != PBF_OK) return status;
  pbf_rows rows = pbf_ids_rows(solver, first, count);
  return read_backend(solver, field, &rows, out);
}

static pbf_status check_written(pbf_solver *solver, uint32_t field, const char *name,
                                uint32_t first, uint32_t count, const void *in) {
  pbf_status status = pbf_check_unmapped(solver);
  if (status == PBF_OK) status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer(name, in, pbf_element_size(solver));
  if (status != PBF_OK) return status;
  return field == PBF_FIELD_POSITION ? pbf_values_check_positions(solver, in, count, first)
                                     : pbf_values_check_finite(solver, name, in, count, first);
}

static pbf_status write_checked(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                                const void *in) {
  if (count == 0) return PBF_OK;
  pbf_rows rows = pbf_ids_rows(solver, first, count);
  pbf_status status = PBF_OK;
  const pbf_emission_work *emission =
      solver->emission && field == PBF_FIELD_POSITION ? solver->emission->work : NULL;
  if (emission) status = emission->keep(solver, first, count);
  if (status != PBF_OK) return status;
  status = solver->api.write(solver->backend, field, &rows, in);
  if (status == PBF_OK) ++solver->generation;
  if (status == PBF_OK && field == PBF_FIELD_POSITION) pbf_previous_set(solver, first, count, in);
  if (status == PBF_OK && emission) emission->move(solver, first, count, in);
  return pbf_backend_result(solver, status, "write");
}

static pbf_status write_velocities(pbf_solver *solver, uint32_t first, uint32_t count,
                                   const void *in) {
  pbf_status status = check_written(solver, PBF_FIELD_VELOCITY, "velocities", first, count, in);
  if (status != PBF_OK) return status;
  return write_checked(solver, PBF_FIELD_VELOCITY, first, count, in);
}

/* Those of all at once may be a shift of the world's origin, or another start; what else goes
 * elsewhere is placed. */
static pbf_status note_written(pbf_solver *solver, pbf_set_rows *rows) {
  const int is_all = rows->count == solver->count;
  double shift[3] = {0, 0, 0};
  if (is_all && !pbf_is_shift(solver, rows->before, rows->positions, shift)) {
    pbf_note_set_anew(solver);
    return PBF_OK;
  }
  memcpy(rows->shift, shift, sizeof shift);
  const pbf_status status = pbf_elsewhere_note(solver, rows);
  if (status == PBF_OK) pbf_note_shift(solver, shift);
  return status;
}

/* Noted before they are written: what is written can't fail but with the device. */
static pbf_status write_noted(pbf_solver *solver, uint32_t first, uint32_t count, const void *in) {
  const uint64_t bytes = count * pbf_point_bytes(solver);
  void *before;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, bytes, "the positions before", &before);
  if (status != PBF_OK) return status;
  pbf_set_rows rows = {first, count, before, in, {0, 0, 0}};
  status = pbf_read_rows(solver, PBF_FIELD_POSITION, first, count, before);
  if (status == PBF_OK) status = note_written(solver, &rows);
  pbf_memory_free(&solver->allocator, before, bytes);
  return status;
}

static pbf_status write_positions(pbf_solver *solver, uint32_t first, uint32_t count,
                                  const void *in) {
  pbf_status status = check_written(solver, PBF_FIELD_POSITION, "positions", first, count, in);
  if (status == PBF_OK && count > 0 && pbf_setting_matters(solver))
    status = write_noted(solver, first, count, in);
  else if (status == PBF_OK)
    pbf_note_set(solver);
  return status == PBF_OK ? write_checked(solver, PBF_FIELD_POSITION, first, count, in) : status;
}

pbf_status pbf_write_field(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                           const void *in) {
  return field == PBF_FIELD_POSITION ? write_positions(solver, first, count, in)
                                     : write_velocities(solver, first, count, in);
}

pbf_status pbf_check_pressures(const pbf_solver *solver) {
  if (!solver->api.read_pressures)
    return pbf_fail(PBF_ERROR_UNSUPPORTED, "the backend \"%s\" keeps no pressures",
                    solver->plugin->name);
  if (solver->params.solver == PBF_SOLVER_CHEBYSHEV) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNSUPPORTED,
                  "params.solver is %u (PBF_SOLVER_JACOBI), which keeps no pressure over its "
                  "iterations; PBF_SOLVER_CHEBYSHEV does",
                  solver->params.solver);
}

pbf_status pbf_read_rows(pbf_solver *solver, uint32_t field, uint32_t first, uint32_t count,
                         void *out) {
  const pbf_rows rows = pbf_ids_rows(solver, first, count);
  return read_backend(solver, field, &rows, out);
}

pbf_status pbf_read_all(pbf_solver *solver, uint32_t field, void *out) {
  return pbf_read_rows(solver, field, 0, solver->count, out);
}

static pbf_status get_rows(pbf_solver *solver, uint32_t field, const char *name, uint32_t first,
                           uint32_t count, void *out) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  if (field == PBF_FIELD_PRESSURE) status = pbf_check_pressures(solver);
  if (status == PBF_OK) status = read_rows(solver, field, name, first, count, out);
  return pbf_leave(solver, status);
}

pbf_status pbf_get_positions(pbf_solver *solver, uint32_t first, uint32_t count, void *positions) {
  return get_rows(solver, PBF_FIELD_POSITION, "positions", first, count, positions);
}

pbf_status pbf_get_velocities(pbf_solver *solver, uint32_t first, uint32_t count,
                              void *velocities) {
  return get_rows(solver, PBF_FIELD_VELOCITY, "velocities", first, count, velocities);
}

pbf_status pbf_get_densities(pbf_solver *solver, uint32_t first, uint32_t count, void *densities) {
  return get_rows(solver, PBF_FIELD_DENSITY, "densities", first, count, densities);
}

pbf_status pbf_get_pressures(pbf_solver *solver, uint32_t first, uint32_t count, void *pressures) {
  return get_rows(solver, PBF_FIELD_PRESSURE, "pressures", first, count, pressures);
}

pbf_status pbf_set_positions(pbf_solver *solver, uint32_t first, uint32_t count,
                             const void *positions) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_write_field(solver, PBF_FIELD_POSITION, first, count, positions));
}

pbf_status pbf_set_velocities(pbf_solver *solver, uint32_t first, uint32_t count,
                              const void *velocities) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_write_field(solver, PBF_FIELD_VELOCITY, first, count, velocities));
}

static pbf_status get_ids(const pbf_solver *solver, uint32_t first, uint32_t count, uint32_t *ids) {
  pbf_status status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer("ids", ids, sizeof *ids);
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < count; ++i) ids[i] = pbf_ids_of_row(solver, first + i);
  return PBF_OK;
}

pbf_status pbf_get_ids(pbf_solver *solver, uint32_t first, uint32_t count, uint32_t *ids) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_ids(solver, first, count, ids));
}

pbf_status pbf_get_count(pbf_solver *solver, uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_count_out(solver->count, count));
}
