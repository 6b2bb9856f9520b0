/* What happened and what runs: statistics, times, plan, info. */
#include <stdio.h>
#include <string.h>

#include "backend_call.h"
#include "worker.h"
#include "colliders.h"
#include "diffuse/diffuse.h"
#include "error.h"
#include "handles.h"
#include "ids.h"
#include "particles/accelerations.h"
#include "plan.h"
#include "previous.h"
#include "snapshot_memory.h"
#include "solver_time.h"
#include "step_limit.h"
#include "structs.h"
#include "text.h"

static void end_text(char *text, size_t size) { text[size - 1] = 0; }

static void add_step_limit(pbf_solver *solver, pbf_stats *stats) {
  const pbf_step_limits limits = pbf_step_limits_of(solver, stats->speed_max);
  stats->step_limit = pbf_shortest_limit(&limits, &stats->limited_by);
  stats->substeps = solver->substeps;
  pbf_warn_of_long_steps(solver, &limits, 1u << PBF_LIMIT_PARTICLES);
}

static pbf_status get_stats(pbf_solver *solver, pbf_stats *theirs) {
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_status status = pbf_struct_check_out(&pbf_kind_stats, theirs);
  if (status == PBF_OK && solver->count > 0) {
    status = solver->api.get_stats(solver->backend, &stats);
    status = pbf_backend_result(solver, status, "get_stats");
  }
  if (status != PBF_OK) return status;
  if (stats.count != solver->count) {
    return pbf_fail(PBF_ERROR_PLUGIN,
                    "the backend \"%s\" gave statistics of %u particles out of %u",
                    solver->plugin->name, stats.count, solver->count);
  }
  add_step_limit(solver, &stats);
  pbf_struct_out(&pbf_kind_stats, &stats, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_stats(pbf_solver *solver, pbf_stats *stats) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_stats(solver, stats));
}

static pbf_status check_timing(const pbf_solver *solver) {
  if (solver->api.set_timing) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNSUPPORTED, "the backend \"%s\" takes no times", solver->plugin->name);
}

static pbf_status set_timing(pbf_solver *solver, uint32_t enabled) {
  if (enabled > 1)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "enabled is %u; it must be 0 or 1", enabled);
  pbf_status status = check_timing(solver);
  if (status != PBF_OK) return status;
  status = solver->api.set_timing(solver->backend, enabled);
  return pbf_backend_result(solver, status, "set_timing");
}

pbf_status pbf_set_timing(pbf_solver *solver, uint32_t enabled) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_timing(solver, enabled));
}

static pbf_status check_length(const pbf_solver *solver, const char *what, uint32_t count,
                               uint32_t max) {
  if (count <= max) return PBF_OK;
  return pbf_fail(PBF_ERROR_PLUGIN,
                  "the backend \"%s\" says it has %u %s, above the %u there can be",
                  solver->plugin->name, count, what, max);
}

static pbf_status get_timings(pbf_solver *solver, pbf_timings *theirs) {
  pbf_timings timings = {.struct_size = sizeof timings};
  pbf_status status = pbf_struct_check_out(&pbf_kind_timings, theirs);
  if (status == PBF_OK) status = check_timing(solver);
  if (status != PBF_OK) return status;
  status = solver->api.get_timings(solver->backend, &timings);
  status = pbf_backend_result(solver, status, "get_timings");
  if (status == PBF_OK)
    status = check_length(solver, "stages", timings.stage_count, PBF_MAX_STAGES);
  if (status != PBF_OK) return status;
  for (int i = 0; i < PBF_MAX_STAGES; ++i) end_text(timings.stages[i].name, PBF_NAME_SIZE);
  pbf_struct_out(&pbf_kind_timings, &timings, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_timings(pbf_solver *solver, pbf_timings *timings) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_timings(solver, timings));
}

/* The backend does not count what the host holds. */
static void add_array(pbf_plan *plan, const char *name, double bytes_per_particle, uint64_t bytes) {
  plan->bytes += bytes;
  plan->bytes_per_particle += bytes_per_particle;
  if (plan->array_count == PBF_MAX_ARRAYS) return;
  pbf_plan_array *array = &plan->arrays[plan->array_count++];
  *array = (pbf_plan_array){.bytes_per_particle = bytes_per_particle, .bytes = bytes};
  snprintf(array->name, sizeof array->name, "%s", name);
}

static void add_own_memory(const pbf_solver *solver, pbf_plan *plan) {
  plan->bytes += sizeof *solver + pbf_colliders_bytes(solver, solver->collider_count);
  plan->bytes += pbf_worker_bytes(solver);
  if (solver->ids) add_array(plan, "ids (host)", sizeof *solver->ids, pbf_ids_bytes(solver));
  if (solver->previous)
    add_array(plan, "previous position (host)", (double)pbf_point_bytes(solver),
              pbf_previous_bytes(solver));
  if (solver->accelerations)
    add_array(plan, "accelerations (host)", (double)pbf_point_bytes(solver),
              pbf_accelerations_bytes(solver));
  if (solver->snapshots)
    add_array(plan, "snapshots (host)",
              (double)pbf_snapshots_bytes(solver, solver->snapshots) / solver->capacity,
              pbf_snapshots_bytes(solver, solver->snapshots));
  if (solver->diffuse)
    add_array(plan, "diffuse particles (host)",
              (double)pbf_diffuse_bytes(solver->diffuse) / solver->capacity,
              pbf_diffuse_bytes(solver->diffuse));
}

static void end_plan_texts(pbf_plan *plan) {
  end_text(plan->variant, sizeof plan->variant);
  for (int i = 0; i < PBF_MAX_STAGES; ++i) end_text(plan->stages[i].name, PBF_NAME_SIZE);
  for (int i = 0; i < PBF_MAX_ARRAYS; ++i) end_text(plan->arrays[i].name, PBF_NAME_SIZE);
}

static pbf_status get_plan(pbf_solver *solver, pbf_plan *theirs) {
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_status status = pbf_struct_check_out(&pbf_kind_plan, theirs);
  if (status != PBF_OK) return status;
  status = pbf_plan_now(solver);
  if (status != PBF_OK) return status;
  status = solver->api.get_plan(solver->backend, &plan);
  status = pbf_backend_result(solver, status, "get_plan");
  if (status == PBF_OK) status = check_length(solver, "stages", plan.stage_count, PBF_MAX_STAGES);
  if (status == PBF_OK) status = check_length(solver, "arrays", plan.array_count, PBF_MAX_ARRAYS);
  if (status != PBF_OK) return status;
  add_own_memory(solver, &plan);
  end_plan_texts(&plan);
  pbf_struct_out(&pbf_kind_plan, &plan, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_plan(pbf_solver *solver, pbf_plan *plan) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_plan(solver, plan));
}

static void fill_info(const pbf_solver *solver, const pbf_backend_state *state, pbf_info *info) {
  *info = (pbf_info){
      .dimension = solver->kind.dimension,
      .precision = solver->kind.precision,
      .capacity = solver->capacity,
      .threads = state->threads,
      .device = solver->device,
      .device_type = state->device_type,
      .fell_back = solver->fell_back,
      .step = solver->step,
      .time = pbf_solver_time(solver),
  };
  memcpy(info->backend, solver->plugin->name, sizeof info->backend);
  memcpy(info->device_name, state->device_name, sizeof info->device_name);
  memcpy(info->build_id, solver->plugin->build_id, sizeof info->build_id);
  memcpy(info->path, solver->plugin->path, sizeof info->path);
  pbf_text_end_whole(info->path);
  memcpy(info->fallback_reason, solver->fallback_reason, sizeof info->fallback_reason);
  pbf_text_make_line(info->fallback_reason);
}

static pbf_status get_info(pbf_solver *solver, pbf_info *theirs) {
  pbf_backend_state state = {.struct_size = sizeof state};
  pbf_info info;
  pbf_status status = pbf_struct_check_out(&pbf_kind_info, theirs);
  if (status != PBF_OK) return status;
  status = solver->api.describe(solver->backend, &state);
  status = pbf_backend_result(solver, status, "describe");
  if (status != PBF_OK) return status;
  end_text(state.device_name, sizeof state.device_name);
  fill_info(solver, &state, &info);
  pbf_struct_out(&pbf_kind_info, &info, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_info(pbf_solver *solver, pbf_info *info) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_info(solver, info));
}
