/* Phases as they are set, and told to the backend. */
#include "phases.h"

#include <math.h>
#include <string.h>

#include "check.h"
#include "emission/emission.h"
#include "error.h"
#include "memory.h"
#include "particles.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "solver/overlap.h"
#include "structs.h"

/* ---- The backend ----------------------------------------------------------------------------- */

static pbf_status write_rows(pbf_solver *solver, const pbf_rows *rows, const uint8_t *phases) {
  if (rows->count == 0) return PBF_OK;
  pbf_status status = solver->api.write(solver->backend, PBF_BACKEND_FIELD_PHASE, rows, phases);
  return pbf_backend_result(solver, status, "write");
}

static pbf_phase_table table_of(const pbf_phases *phases) {
  pbf_phase_table table = {
      .struct_size = sizeof table, .count = phases->count, .heaviest = 1, .used = phases->used};
  for (uint32_t i = 0; i < phases->count; ++i) {
    const pbf_phase *phase = &phases->of[i];
    table.mobility[i] = 1 / phase->rest_density;
    table.viscosity[i] = phase->viscosity;
    table.thickest = fmax(table.thickest, phase->viscosity * phase->rest_density);
    table.heaviest = fmax(table.heaviest, phase->rest_density);
  }
  for (uint32_t i = 0; i < phases->count && table.thickest > 0; ++i)
    table.thickness[i] = phases->of[i].viscosity * phases->of[i].rest_density / table.thickest;
  return table;
}

static pbf_status write_table(pbf_solver *solver, const pbf_phases *phases) {
  pbf_phase_table table;
  const int differ = phases && phases->differ;
  if (!solver->api.set_phases && !differ) return PBF_OK;
  if (!solver->api.set_phases)
    return pbf_fail(PBF_ERROR_UNSUPPORTED,
                    "the backend \"%s\" has no phases that differ in rest_density or viscosity",
                    solver->plugin->name);
  if (differ) table = table_of(phases);
  return pbf_backend_result(solver, solver->api.set_phases(solver->backend, differ ? &table : NULL),
                            "set_phases");
}

static pbf_status write_all_rows(pbf_solver *solver, const pbf_phases *phases, uint32_t count,
                                 const uint32_t *ids) {
  if (!phases || !phases->differ) return PBF_OK;
  const pbf_rows all = {sizeof all, 0, count, count, ids};
  const pbf_rows own = pbf_ids_rows(solver, 0, count);
  return write_rows(solver, ids ? &all : &own, phases->rows);
}

pbf_status pbf_phases_to_backend(pbf_solver *solver, const pbf_phases *phases, uint32_t count,
                                 const uint32_t *ids) {
  pbf_status status = write_table(solver, phases);
  return status == PBF_OK ? write_all_rows(solver, phases, count, ids) : status;
}

/* ---- Calls ----------------------------------------------------------------------------------- */

pbf_status pbf_phase_init(pbf_phase *phase, uint32_t struct_size) {
  const pbf_phase initial = {.struct_size = struct_size, .rest_density = 1, .viscosity = 1};
  if (!phase) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "phase is null");
  pbf_status status = pbf_struct_check_size(&pbf_kind_phase, struct_size);
  if (status == PBF_OK) pbf_struct_out(&pbf_kind_phase, &initial, phase, struct_size);
  return status;
}

static pbf_status copy_in(uint32_t count, const pbf_phase *theirs, pbf_phases *ours) {
  const uint32_t first = pbf_struct_size(theirs);
  pbf_status status = PBF_OK;
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    status = pbf_struct_in_array(&pbf_kind_phase, "phases", theirs, first, i, &ours->of[i]);
  return status;
}

/* That what has a phase still has one. */
static pbf_status check_in_use(const pbf_solver *solver, uint32_t count) {
  const pbf_emission *e = solver->emission;
  const uint32_t phases = count ? count : 1;
  for (uint32_t row = 0; solver->phases && row < solver->count; ++row)
    if (solver->phases->rows[row] >= phases)
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "count is %u; the particle with the id %u is of phase %u", count,
                      pbf_ids_of_row(solver, row), solver->phases->rows[row]);
  for (uint32_t i = 0; e && i < e->head.source_count; ++i)
    if (e->sources[i].emitter.phase >= phases)
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; emitter %u has phase %u", count, i,
                      e->sources[i].emitter.phase);
  for (uint32_t i = 0; e && i < e->head.reservoir_count; ++i)
    if (e->reservoirs[i].phase >= phases)
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; reservoir %u has phase %u", count,
                      i, e->reservoirs[i].phase);
  return PBF_OK;
}

static int differ(const pbf_phases *phases) { return phases && phases->differ; }

pbf_status pbf_phases_check_ranks(const pbf_phases *phases, const pbf_solver *solver) {
  enum { WITH_PHASES = 2 };
  const pbf_backend_api *api = &solver->plugin->api;
  const uint32_t *ranks = api->get_extension ? api->get_extension(PBF_BACKEND_RANKS) : NULL;
  if (!differ(phases) || !solver->ranks.count || (ranks && *ranks >= WITH_PHASES)) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNSUPPORTED,
                  "the backend \"%s\" has no phases that differ in rest_density or viscosity on "
                  "ranks",
                  solver->plugin->name);
}

/* Of a table that the backend has taken: as it was before, as far as a failing device lets it; its
 * message is kept. */
static pbf_status go_back(pbf_solver *solver, pbf_status status) {
  char why[PBF_MESSAGE_SIZE];
  memcpy(why, pbf_last_error(), sizeof why);
  (void)pbf_phases_to_backend(solver, solver->phases, solver->count, NULL);
  return pbf_fail(status, "%s", why);
}

/* A table that the backend does not take has changed nothing, and woken nothing. */
static pbf_status replace(pbf_solver *solver, pbf_phases *ours) {
  pbf_status status = write_table(solver, ours);
  if (status != PBF_OK) return status;
  status = write_all_rows(solver, ours, solver->count, NULL);
  if (status != PBF_OK) return go_back(solver, status);
  pbf_phases_free(solver, solver->phases);
  solver->phases = ours;
  return PBF_OK;
}

/* Of which particles, emitters or reservoirs are, a bit each. */
static uint32_t find_used(const pbf_solver *solver) {
  const pbf_phases *phases = solver->phases;
  const pbf_emission *e = solver->emission;
  uint32_t used = 0;
  for (uint32_t i = 0; i < phases->count && solver->count > 0; ++i)
    if (memchr(phases->rows, (int)i, solver->count)) used |= UINT32_C(1) << i;
  for (uint32_t i = 0; e && i < e->head.source_count; ++i)
    used |= UINT32_C(1) << e->sources[i].emitter.phase;
  for (uint32_t i = 0; e && i < e->head.reservoir_count; ++i)
    used |= UINT32_C(1) << e->reservoirs[i].phase;
  return used;
}

/* What steps leave may change with it, of what has been stepped. */
static pbf_status tell_used(pbf_solver *solver, uint32_t used) {
  pbf_phases *phases = solver->phases;
  const uint32_t before = phases->used;
  const double left = before ? pbf_overlap_steps_leave(solver) : 0;
  phases->used = used;
  const pbf_status status = write_table(solver, phases);
  if (status != PBF_OK) {
    phases->used = before;
    return status;
  }
  if (before) pbf_overlap_note_grid(solver, left);
  return PBF_OK;
}

pbf_status pbf_phases_tell_used(pbf_solver *solver) {
  pbf_phases *phases = solver->phases;
  if (!differ(phases)) return PBF_OK;
  const uint32_t used = find_used(solver), all = (UINT32_C(1) << phases->count) - 1;
  if (!used || used == phases->used) return PBF_OK;
  if (phases->used || used != all) return tell_used(solver, used);
  phases->used = used;
  return PBF_OK;
}

static pbf_status set_phases(pbf_solver *solver, uint32_t count, const pbf_phase *theirs) {
  pbf_phases *ours = NULL;
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK) return status;
  if (count > PBF_MAX_PHASES)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; it must be at most %u", count,
                    PBF_MAX_PHASES);
  if (count > 0 && !theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "phases is null");
  status = check_in_use(solver, count);
  if (status == PBF_OK && count > 0) status = pbf_phases_allocate(solver, count, &ours);
  if (status != PBF_OK || (!ours && !solver->phases)) return status;
  if (ours && solver->phases) memcpy(ours->rows, solver->phases->rows, solver->count);
  if (ours) status = copy_in(count, theirs, ours);
  if (ours && status == PBF_OK) status = pbf_phases_check(ours, solver->kind);
  if (status == PBF_OK) status = pbf_phases_check_params(ours, &solver->params);
  if (status == PBF_OK) status = pbf_phases_check_ranks(ours, solver);
  if (status == PBF_OK) status = replace(solver, ours);
  if (status != PBF_OK) pbf_phases_free(solver, ours);
  return status;
}

pbf_status pbf_set_phases(pbf_solver *solver, uint32_t count, const pbf_phase *phases) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_phases(solver, count, phases));
}

pbf_status pbf_get_phase_count(pbf_solver *solver, uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_count_out(solver->phases ? solver->phases->count : 0, count));
}

static pbf_status get_phase(const pbf_solver *solver, uint32_t index, pbf_phase *phase) {
  const uint32_t count = solver->phases ? solver->phases->count : 0;
  pbf_status status = pbf_struct_check_out(&pbf_kind_phase, phase);
  if (status != PBF_OK) return status;
  if (index >= count)
    return pbf_fail(PBF_ERROR_NOT_FOUND, "index is %u; the solver has %u phases", index, count);
  pbf_struct_out(&pbf_kind_phase, &solver->phases->of[index], phase, phase->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_phase(pbf_solver *solver, uint32_t index, pbf_phase *phase) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_phase(solver, index, phase));
}

/* Each number is read once: another thread may write there. */
static pbf_status copy_rows(uint32_t count, const uint32_t *in, uint32_t phases, uint8_t *bytes) {
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t phase = ((const volatile uint32_t *)in)[i];
    if (phase >= phases)
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "phases[%u] is %u; it must be below the number of phases, %u", i, phase,
                      phases);
    bytes[i] = (uint8_t)phase;
  }
  return PBF_OK;
}

static pbf_status set_rows(pbf_solver *solver, uint32_t first, uint32_t count, const uint32_t *in) {
  pbf_phases *phases = solver->phases;
  pbf_status status = pbf_check_unmapped(solver);
  if (status == PBF_OK) status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer("phases", in, sizeof *in);
  if (status != PBF_OK) return status;
  if (!phases)
    return pbf_fail(PBF_ERROR_STATE, "the solver has no phases; pbf_set_phases gives it some");
  void *memory;
  status = pbf_memory_allocate(&solver->allocator, count, "phases of particles", &memory);
  if (status != PBF_OK) return status;
  uint8_t *bytes = memory;
  const pbf_rows rows = pbf_ids_rows(solver, first, count);
  status = copy_rows(count, in, phases->count, bytes);
  if (status == PBF_OK && phases->differ) status = write_rows(solver, &rows, bytes);
  if (status == PBF_OK) memcpy(phases->rows + first, bytes, count);
  pbf_memory_free(&solver->allocator, memory, count);
  return status;
}

pbf_status pbf_set_particle_phases(pbf_solver *solver, uint32_t first, uint32_t count,
                                   const uint32_t *phases) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_rows(solver, first, count, phases));
}

static pbf_status get_rows(const pbf_solver *solver, uint32_t first, uint32_t count,
                           uint32_t *out) {
  pbf_status status = pbf_check_rows(solver, first, count);
  if (status != PBF_OK || count == 0) return status;
  status = pbf_check_pointer("phases", out, sizeof *out);
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < count; ++i)
    out[i] = solver->phases ? solver->phases->rows[first + i] : 0;
  return PBF_OK;
}

pbf_status pbf_get_particle_phases(pbf_solver *solver, uint32_t first, uint32_t count,
                                   uint32_t *phases) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_rows(solver, first, count, phases));
}
