/* Emitters and drains as they are set. */
#include "emission.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "emitter.h"
#include "error.h"
#include "memory.h"
#include "particles/phases.h"
#include "query/volume.h"
#include "solver/handles.h"
#include "solver/rank_settings.h"
#include "structs.h"

/* ---- Memory ---------------------------------------------------------------------------------- */

pbf_status pbf_emission_need(pbf_solver *solver, pbf_emission **emission) {
  void *memory;
  if (!solver->emission) {
    pbf_status status =
        pbf_memory_allocate(&solver->allocator, sizeof **emission, "emitters and drains", &memory);
    if (status != PBF_OK) return status;
    memset(memory, 0, sizeof **emission);
    solver->emission = memory;
    solver->emission->work = &pbf_emission_in_steps;
  }
  *emission = solver->emission;
  return PBF_OK;
}

/* ---- Emitters -------------------------------------------------------------------------------- */

static pbf_status copy_in(const pbf_solver *solver, uint32_t count, const pbf_emitter *theirs,
                          pbf_emitter *ours) {
  if (count > PBF_MAX_EMITTERS)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; it must be at most %u", count,
                    PBF_MAX_EMITTERS);
  if (count > 0 && !theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "emitters is null");
  const uint32_t first = count > 0 ? pbf_struct_size(theirs) : 0;
  for (uint32_t i = 0; i < count; ++i) {
    pbf_status status =
        pbf_struct_in_array(&pbf_kind_emitter, "emitters", theirs, first, i, &ours[i]);
    if (status == PBF_OK) status = pbf_emitter_check(&ours[i], i, solver->kind);
    if (status == PBF_OK) status = pbf_emitter_check_place(&ours[i], i, solver);
    if (status == PBF_OK && ours[i].phase >= pbf_phases_count(solver->phases))
      status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                        "emitters[%u].phase is %u; it must be below the number of phases, %u", i,
                        ours[i].phase, pbf_phases_count(solver->phases));
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

/* There is no stream any more. */
static void let_go(pbf_emission *e, uint32_t source) {
  uint32_t kept = 0;
  for (uint32_t i = 0; i < e->head.guided_count; ++i)
    if (e->guided[i].source != source) e->guided[kept++] = e->guided[i];
  e->head.guided_count = kept;
}

static pbf_status set_emitters(pbf_solver *solver, uint32_t count, const pbf_emitter *theirs) {
  pbf_emitter ours[PBF_MAX_EMITTERS];
  pbf_emission *e;
  pbf_status status = copy_in(solver, count, theirs, ours);
  if (status != PBF_OK || (count == 0 && !solver->emission)) return status;
  status = pbf_emission_need(solver, &e);
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < PBF_MAX_EMITTERS; ++i) {
    if (i >= count) let_go(e, i);
    if (i >= count || i >= e->head.source_count) e->sources[i] = (pbf_source){0};
    if (i < count) e->sources[i].emitter = ours[i];
  }
  e->head.source_count = count;
  for (uint32_t i = 0; i < count; ++i) pbf_emitter_clean(&ours[i], solver->kind.dimension);
  pbf_rank_settings_note(solver, "pbf_set_emitters", ours, count * sizeof *ours);
  pbf_emission_bound_stage(e);
  return PBF_OK;
}

pbf_status pbf_set_emitters(pbf_solver *solver, uint32_t count, const pbf_emitter *emitters) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_emitters(solver, count, emitters));
}

static pbf_status check_index(uint32_t index, uint32_t count, const char *what) {
  if (index < count) return PBF_OK;
  return pbf_fail(PBF_ERROR_NOT_FOUND, "index is %u; the solver has %u %s", index, count, what);
}

static pbf_status get_emitter(const pbf_solver *solver, uint32_t index, pbf_emitter *emitter) {
  const pbf_emission *e = solver->emission;
  pbf_status status = pbf_struct_check_out(&pbf_kind_emitter, emitter);
  if (status == PBF_OK) status = check_index(index, e ? e->head.source_count : 0, "emitters");
  if (status != PBF_OK) return status;
  pbf_struct_out(&pbf_kind_emitter, &e->sources[index].emitter, emitter, emitter->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_emitter(pbf_solver *solver, uint32_t index, pbf_emitter *emitter) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_emitter(solver, index, emitter));
}

/* ---- Drains ---------------------------------------------------------------------------------- */

static pbf_status set_drains(pbf_solver *solver, uint32_t count, const pbf_volume *theirs) {
  pbf_volume ours[PBF_MAX_DRAINS];
  pbf_emission *e;
  if (count > PBF_MAX_DRAINS)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; it must be at most %u", count,
                    PBF_MAX_DRAINS);
  pbf_status status = pbf_volumes_in(solver->kind, "drains", count, theirs, ours);
  if (status != PBF_OK || (count == 0 && !solver->emission)) return status;
  status = pbf_emission_need(solver, &e);
  if (status != PBF_OK) return status;
  memset(e->drains, 0, sizeof e->drains);
  if (count > 0) memcpy(e->drains, ours, count * sizeof *ours);
  e->head.drain_count = count;
  for (uint32_t i = 0; i < count; ++i) pbf_volume_clean(&ours[i], solver->kind.dimension);
  pbf_rank_settings_note(solver, "pbf_set_drains", ours, count * sizeof *ours);
  return PBF_OK;
}

pbf_status pbf_set_drains(pbf_solver *solver, uint32_t count, const pbf_volume *drains) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_drains(solver, count, drains));
}

static pbf_status get_drain(const pbf_solver *solver, uint32_t index, pbf_volume *drain) {
  const pbf_emission *e = solver->emission;
  pbf_status status = pbf_struct_check_out(&pbf_kind_volume, drain);
  if (status == PBF_OK) status = check_index(index, e ? e->head.drain_count : 0, "drains");
  if (status != PBF_OK) return status;
  pbf_struct_out(&pbf_kind_volume, &e->drains[index], drain, drain->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_drain(pbf_solver *solver, uint32_t index, pbf_volume *drain) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_drain(solver, index, drain));
}

/* ---- Counts ---------------------------------------------------------------------------------- */

static pbf_status get_in_out(const pbf_solver *solver, pbf_in_out *theirs) {
  pbf_in_out in_out = {0};
  pbf_status status = pbf_struct_check_out(&pbf_kind_in_out, theirs);
  if (status != PBF_OK) return status;
  if (solver->emission) {
    in_out = solver->emission->head.in_out;
    in_out.emitters = solver->emission->head.source_count;
    in_out.drains = solver->emission->head.drain_count;
  }
  pbf_struct_out(&pbf_kind_in_out, &in_out, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_in_out(pbf_solver *solver, pbf_in_out *in_out) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_in_out(solver, in_out));
}
