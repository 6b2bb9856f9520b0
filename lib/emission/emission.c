/* Emitters and drains as they are set. */
#include "emission.h"

#include <math.h>
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
    if (status == PBF_OK)
      status = pbf_phases_check_number(solver->phases, "emitters", i, ours[i].phase);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

/* What tells that an emitter goes on which was one before: it is the same; it is one of its kind
 * that is nearer than h; it has its number. */
typedef enum going_on { AS_THE_SAME, AS_THE_NEAREST, BY_NUMBER, WAYS_TO_GO_ON } going_on;

static const uint32_t none = PBF_MAX_EMITTERS;

static double distance2(const pbf_solver *solver, const pbf_emitter *a, const pbf_emitter *b) {
  double sum = 0;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k)
    sum += (a->position[k] - b->position[k]) * (a->position[k] - b->position[k]);
  return sum;
}

/* How far it is from one before, squared; without end where it is none that goes on as that. */
static double away2(const pbf_solver *solver, going_on how, uint32_t before,
                    const pbf_emitter *emitter) {
  const pbf_emitter *was = &solver->emission->sources[before].emitter;
  const double h = solver->params.smoothing_radius, way2 = distance2(solver, was, emitter);
  if (how == BY_NUMBER) return 0;
  if (how == AS_THE_SAME) return memcmp(was, emitter, sizeof *was) == 0 ? 0 : INFINITY;
  const int is_like_it = was->shape == emitter->shape && was->phase == emitter->phase;
  return is_like_it && way2 < h * h ? way2 : INFINITY;
}

/* The one before that goes on as emitter `number`, first of all that of its number. */
static uint32_t find_before(const pbf_solver *solver, going_on how, uint64_t taken, uint32_t number,
                            const pbf_emitter *emitter) {
  const uint32_t count = solver->emission->head.source_count;
  double least2 = INFINITY;
  uint32_t found = none;
  if (number < count && !(taken >> number & 1) && away2(solver, how, number, emitter) < INFINITY)
    return number;
  for (uint32_t k = 0; k < count && how != BY_NUMBER; ++k) {
    const double this2 = taken >> k & 1 ? INFINITY : away2(solver, how, k, emitter);
    if (!(this2 < least2)) continue;
    least2 = this2;
    found = k;
  }
  return found;
}

/* Which of those before each is, or none: a caller's list may be in another order each time, as
 * where one has been erased. */
static void find_all_before(const pbf_solver *solver, uint32_t count, const pbf_emitter *emitters,
                            uint32_t before[PBF_MAX_EMITTERS]) {
  uint64_t taken = 0;
  for (uint32_t i = 0; i < count; ++i) before[i] = none;
  for (int how = 0; how < WAYS_TO_GO_ON; ++how)
    for (uint32_t i = 0; i < count; ++i) {
      if (before[i] != none) continue;
      before[i] = find_before(solver, (going_on)how, taken, i, &emitters[i]);
      if (before[i] != none) taken |= UINT64_C(1) << before[i];
    }
}

/* What has left an opening goes on with its emitter, and is free where there is none any more. */
static void hand_on_guided(pbf_emission *e, uint32_t count, const uint32_t *before) {
  uint32_t kept = 0, now[PBF_MAX_EMITTERS];
  for (uint32_t i = 0; i < PBF_MAX_EMITTERS; ++i) now[i] = none;
  for (uint32_t i = 0; i < count; ++i)
    if (before[i] != none) now[before[i]] = i;
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    const uint32_t source = now[e->guided[i].source];
    if (source == none) continue;
    e->guided[kept] = e->guided[i];
    e->guided[kept++].source = source;
  }
  e->head.guided_count = kept;
}

static void replace(pbf_solver *solver, uint32_t count, const pbf_emitter *emitters) {
  pbf_emission *e = solver->emission;
  uint32_t before[PBF_MAX_EMITTERS];
  uint64_t numbers[PBF_MAX_EMITTERS];
  double due[PBF_MAX_EMITTERS];
  find_all_before(solver, count, emitters, before);
  hand_on_guided(e, count, before);
  for (uint32_t i = 0; i < count; ++i) {
    due[i] = before[i] == none ? 0 : e->sources[before[i]].due;
    numbers[i] = before[i] == none ? 0 : e->sources[before[i]].number;
  }
  memset(e->sources, 0, sizeof e->sources);
  for (uint32_t i = 0; i < count; ++i) {
    e->sources[i].emitter = emitters[i];
    e->sources[i].due = due[i];
    e->sources[i].number = numbers[i];
  }
  e->head.source_count = count;
}

static pbf_status set_emitters(pbf_solver *solver, uint32_t count, const pbf_emitter *theirs) {
  pbf_emitter ours[PBF_MAX_EMITTERS];
  pbf_emission *e;
  pbf_status status = copy_in(solver, count, theirs, ours);
  if (status != PBF_OK || (count == 0 && !solver->emission)) return status;
  status = pbf_emission_need(solver, &e);
  if (status != PBF_OK) return status;
  replace(solver, count, ours);
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
  if (!drain) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "drain is null");
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
