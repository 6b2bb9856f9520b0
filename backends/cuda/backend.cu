/* The `cuda` backend's table for one variant: life, parameters, steps, views, reports. */
#include "common/extensions.h"

#include "cuda/create.h"
#include "cuda/device_calls.h"
#include "cuda/find_in_boxes.h"
#include "cuda/report.h"
#include "cuda/scene.h"
#include "physics/settled_error.h"

static void destroy(pbf_backend_solver *handle) {
  entered(handle)->put_off.steps = 0;
  destroy_solver(of(handle));
}

/* Of some ranks, which are told, to where the call ends. */
static pbf_status end_call(solver *s, pbf_status status) {
  return has_ranks(s) ? end_call_on_ranks(s, status) : status;
}

static pbf_status set_params(pbf_backend_solver *handle, const pbf_params *params) {
  pbf_cuda_scope scope(of(handle)->context);
  return apply_params(of(handle), params, of(handle)->collider_count, of(handle)->colliders);
}

static pbf_status set_colliders(pbf_backend_solver *handle, uint32_t count,
                                const pbf_collider *colliders, double time) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (pbf_status status =
          pbf_refuse_without(pbf_cuda_host, pbf_features_wanted(&s->params, count, colliders)))
    return status;
  pbf_status status = make_room_for(s, count);
  if (status == PBF_OK) status = replace_colliders(s, count, colliders, time);
  const pbf_status left = leave_room_of_many(s);
  return status == PBF_OK ? left : status;
}

static pbf_status run_steps(solver *s, const pbf_step_times &times, uint32_t steps,
                            uint32_t *done) {
  const uint32_t count = particles_of_all(s);
  *done = 0;
  if (has_ranks(s) && !agree_on_step(s, times, steps)) return end_on_ranks(s);
  if (pbf_status status = wake_ranks(s)) return end_call(s, status);
  s->time = pbf_time_after(&times, count ? 0 : steps);
  *done = count ? 0 : steps;
  while (*done < steps) {
    if (all_asleep(s, pbf_time_after(&times, *done))) {
      s->time = pbf_time_after(&times, steps);
      s->pressure_scale = s->constants.pressure;
      if (pbf_status status = repeat_loads(s, steps - *done)) return status;
      *done = steps;
      break;
    }
    uint32_t ahead = steps - *done < steps_ahead(s) ? steps - *done : steps_ahead(s);
    const pbf_step_times left = {times.time, times.before + *done, times.time_step};
    if (pbf_status status = place_surfaces(s, left, ahead)) return end_call(s, status);
    if (small_serves(s)) {
      ahead = pbf_steps_alike(&s->params, s->count, s->schedule.min_volume, &left, ahead);
      if (pbf_status status = small_steps(s, left, ahead)) return status;
      *done += ahead;
      s->pressure_scale = s->constants.pressure;
      continue;
    }
    for (uint32_t k = 0; k < ahead && !all_asleep(s, pbf_time_after(&times, *done)); ++k, ++*done) {
      if (pbf_status status = step_once(s, pbf_time_after(&left, k + 1),
                                        pbf_nth_after(&left, k + 1), surfaces_of_step(s, k)))
        return end_call(s, status);
      s->pressure_scale = s->constants.pressure;
      s->found.struct_size = 0;
    }
  }
  s->found.struct_size = 0;
  return PBF_OK;
}

static pbf_status step(pbf_backend_solver *handle, double time, uint64_t before, uint32_t steps,
                       uint32_t *done) {
  solver *s = entered(handle);
  const pbf_step_times times = {time, before, s->params.time_step};
  if (put_off(s, times, steps)) {
    *done = steps;
    return PBF_OK;
  }
  settle(s);
  *done = 0;
  if (pbf_status status = tell_late_failure(s)) return status;
  pbf_cuda_scope scope(s->context);
  const pbf_cuda_range range("pbf_step");
  return run_steps(s, times, steps, done);
}

/* A step of no time, without what only steps need. */
static pbf_status project(pbf_backend_solver *handle, double time, uint32_t iterations) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (pbf_status status = wake_all(s)) return status;
  if (has_ranks(s) && !agree_on_call(s, "a projection", &time, sizeof time)) return end_on_ranks(s);
  s->ranks.careful_once = true;
  const pbf_params params = s->params;
  const pbf_schedule schedule = s->schedule;
  const pbf_constants constants = s->constants;
  s->params = pbf_projection_of(&params, iterations);
  pbf_derived derived = s->derived;
  derive_tables(&s->params, &derived, &s->constants);
  s->constants.phases = constants.phases;
  s->schedule =
      pbf_schedule_of(&s->params, &derived, &s->basins, s->collider_count, s->colliders, s->planned,
                      s->scene_capacity, s->most_left, 0, &s->phases, s->accelerations);
  note_standing(s);
  pbf_status status = place_surfaces(s, time);
  if (status == PBF_OK) status = step_once(s, time, 1, surfaces_of_step(s, 0));
  s->params = params;
  s->schedule = schedule;
  s->constants = constants;
  note_standing(s);
  s->pressure_scale = 0;
  s->time = time;
  return end_call(s, status);
}

static pbf_status set_overlap(pbf_backend_solver *handle, const pbf_overlap *overlap) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  const int before = s->overlaps;
  s->overlaps = overlap != nullptr;
  pbf_status status = apply_params(s, &s->params, s->collider_count, s->colliders);
  if (status != PBF_OK) s->overlaps = before;
  if (status != PBF_OK || !overlap) return status;
  s->found = *overlap;
  s->entering = pbf_entering_of(overlap);
  return upload_placed(s);
}

static pbf_status set_phases(pbf_backend_solver *handle, const pbf_phase_table *table) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  const pbf_phase_table before = s->phases, none = {};
  const bool had = s->phase != nullptr;
  s->phases = table ? *table : none;
  pbf_status status = apply_params(s, &s->params, s->collider_count, s->colliders);
  if (status != PBF_OK) s->phases = before;
  if (status == PBF_OK && s->phase && !had)
    status =
        pbf_cuda_check(cudaMemsetAsync(s->phase, 0, s->capacity, s->stream), "cudaMemsetAsync");
  return status == PBF_OK ? wake_all(s) : status;
}

static pbf_status set_accelerations(pbf_backend_solver *handle, uint32_t on) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  const uint32_t before = s->accelerations;
  const bool had = s->acceleration != nullptr;
  s->accelerations = on;
  pbf_status status = apply_params(s, &s->params, s->collider_count, s->colliders);
  if (status != PBF_OK) s->accelerations = before;
  if (status == PBF_OK && s->acceleration && !had)
    status = pbf_cuda_check(
        cudaMemsetAsync(s->acceleration, 0, s->capacity * sizeof *s->acceleration, s->stream),
        "cudaMemsetAsync");
  return status == PBF_OK ? wake_all(s) : status;
}

/* The arrays are there. */
static pbf_status plan_for(pbf_backend_solver *handle, uint32_t count) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  const pbf_schedule schedule =
      pbf_schedule_of(&s->params, &s->derived, &s->basins, s->collider_count, s->colliders, count,
                      s->scene_capacity, s->most_left, s->overlaps, &s->phases, s->accelerations);
  if (!schedule.runs[PBF_STAGE_GRID])
    if (pbf_status status = add_weight(s)) return status;
  s->planned = count;
  s->schedule = schedule;
  return PBF_OK;
}

/* That may take memory where the steps are shorter than those before. */
static pbf_status plan_steps(pbf_backend_solver *handle, double most) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  const double before = s->most_left;
  s->most_left = most;
  const pbf_status status = apply_params(s, &s->params, s->collider_count, s->colliders);
  if (status != PBF_OK) s->most_left = before;
  return status;
}

static double steps_leave(pbf_backend_solver *handle, double error, double most) {
  solver *s = of(handle);
  return pbf_settled_error(&s->params, &s->basins, s->collider_count, s->colliders, s->planned,
                           &s->phases, error, most);
}

static pbf_status synchronize(pbf_backend_solver *handle) {
  solver *s = entered(handle);
  pbf_cuda_scope scope(s->context);
  if (s->put_off.steps) settle(s);
  /* Of a world that has done nothing else since, one event of its team tells. */
  pbf_status status =
      s->works_together
          ? pbf_cuda_check(cudaEventSynchronize(s->team->done), "cudaEventSynchronize")
          : pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize");
  if (status != PBF_OK) return status;
  s->works_together = s->works_alone = false;
  if (has_ranks(s) && s->ranks.report->lost) {
    lose_ranks(s, PBF_ERROR_UNAVAILABLE, "the device of another rank has not answered");
    return end_on_ranks(s);
  }
  return tell_late_failure(s);
}

static pbf_status add_particles(pbf_backend_solver *handle, const pbf_particles *particles) {
  pbf_cuda_scope scope(of(handle)->context);
  return has_ranks(of(handle)) ? add_on_ranks(of(handle), particles)
                               : population_add(of(handle), particles);
}

static pbf_status remove_particles(pbf_backend_solver *handle, uint32_t count,
                                   const uint32_t *ids) {
  pbf_cuda_scope scope(of(handle)->context);
  return has_ranks(of(handle)) ? remove_on_ranks(of(handle), count, ids)
                               : population_remove(of(handle), count, ids);
}

static pbf_status remove_all(pbf_backend_solver *handle) {
  of(handle)->count = of(handle)->first = of(handle)->ranks.total = 0;
  of(handle)->ordered = true;
  return PBF_OK;
}

static pbf_status read(pbf_backend_solver *handle, uint32_t field, const pbf_rows *rows,
                       void *out) {
  if (field == PBF_FIELD_DENSITY && !(PBF_BUILT & PBF_FEATURE_STATS))
    return pbf_refuse_without(of(handle)->host, PBF_FEATURE_STATS);
  pbf_cuda_scope scope(of(handle)->context);
  return has_ranks(of(handle)) ? read_on_ranks(of(handle), field, rows, out)
                               : population_read(of(handle), field, rows, out);
}

static pbf_status find_in_boxes(pbf_backend_solver *handle, uint32_t count,
                                const pbf_backend_box *boxes, pbf_backend_found *found) {
  pbf_cuda_scope scope(of(handle)->context);
  if (has_ranks(of(handle))) return refuse_call_on_ranks(of(handle), "a search in boxes");
  return population_find(of(handle), count, boxes, found);
}

static pbf_status take_array(pbf_backend_solver *handle, uint64_t bytes, pbf_backend_array *array) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (pbf_status status = pbf_cuda_check(cudaMalloc(&array->data, bytes), "cudaMalloc"))
    return status;
  array->device_type = PBF_DEVICE_CUDA;
  array->device_id = s->device;
  array->owner = s->context;
  return PBF_OK;
}

static void release_array(const pbf_backend_array *array) {
  pbf_cuda_scope scope(static_cast<pbf_cuda_context>(array->owner));
  cudaFree(array->data);
}

static pbf_status read_array(pbf_backend_solver *handle, uint32_t field, const pbf_rows *rows,
                             uint32_t room, void *data) {
  pbf_cuda_scope scope(of(handle)->context);
  if (has_ranks(of(handle))) return refuse_call_on_ranks(of(handle), "an array on the device");
  return population_read_array(of(handle), field, rows, room, static_cast<pbf_vec *>(data));
}

static pbf_status write(pbf_backend_solver *handle, uint32_t field, const pbf_rows *rows,
                        const void *in) {
  pbf_cuda_scope scope(of(handle)->context);
  return has_ranks(of(handle)) ? write_on_ranks(of(handle), field, rows, in)
                               : population_write(of(handle), field, rows, in);
}

static pbf_status map(pbf_backend_solver *handle, uint32_t field, pbf_view *view) {
  const solver *s = of(handle);
  if (has_ranks(s)) return refuse_call_on_ranks(s, "a view");
  bool is_id = field == PBF_FIELD_ID, is_position = field == PBF_FIELD_POSITION;
  view->device_type = PBF_DEVICE_CUDA;
  view->device_id = s->device;
  view->element_type = is_id ? (uint32_t)PBF_TYPE_UINT32 : (uint32_t)sizeof(pbf_real);
  view->components = is_id ? 1 : PBF_DIM;
  view->particle_stride = is_id ? sizeof *s->ids : is_position ? sizeof(point) : sizeof(pbf_vec);
  view->component_stride = is_id ? sizeof *s->ids : sizeof(pbf_real);
  view->count = s->count;
  view->ids = s->ids;
  view->data = s->velocities;
  if (is_id) view->data = s->ids;
  if (is_position) view->data = s->points;
  return PBF_OK;
}

static pbf_status read_pressures(pbf_backend_solver *handle, const pbf_rows *rows, void *out) {
  pbf_cuda_scope scope(of(handle)->context);
  if (has_ranks(of(handle))) return refuse_call_on_ranks(of(handle), "a pressure");
  return population_read_pressures(of(handle), rows, static_cast<pbf_real *>(out));
}

static pbf_status map_pressures(pbf_backend_solver *handle, pbf_view *view) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (has_ranks(s)) return refuse_call_on_ranks(s, "a view");
  if (pbf_status status = population_pressures(s)) return status;
  view->device_type = PBF_DEVICE_CUDA;
  view->device_id = s->device;
  view->element_type = sizeof(pbf_real);
  view->particle_stride = view->component_stride = sizeof(pbf_real);
  view->components = 1;
  view->count = s->count;
  view->ids = s->ids;
  view->data = s->pressures;
  return PBF_OK;
}

static pbf_status get_loads(pbf_backend_solver *handle, uint32_t first, uint32_t count,
                            pbf_collider_load *loads) {
  pbf_cuda_scope scope(of(handle)->context);
  return read_loads(of(handle), first, count, loads);
}

static pbf_status get_stats(pbf_backend_solver *handle, pbf_stats *stats) {
  if (!(PBF_BUILT & PBF_FEATURE_STATS))
    return pbf_refuse_without(of(handle)->host, PBF_FEATURE_STATS);
  pbf_cuda_scope scope(of(handle)->context);
  if (has_ranks(of(handle)) && !agree_on_call(of(handle), "pbf_get_stats", nullptr, 0))
    return end_on_ranks(of(handle));
  return end_call(of(handle), report_stats(of(handle), stats));
}

static pbf_status max_speed(pbf_backend_solver *handle, double *speed) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (!has_ranks(s)) return report_max_speed(s, speed);
  if (!agree_on_call(s, "a look at the fastest particle", nullptr, 0)) return end_on_ranks(s);
  pbf_status status = settle_state(s);
  if (status == PBF_OK) status = report_max_speed(s, speed);
  return status == PBF_OK ? max_on_ranks(s, speed) : end_call(s, status);
}

static pbf_status get_plan(pbf_backend_solver *handle, pbf_plan *plan) {
  report_plan(of(handle), plan);
  return PBF_OK;
}

static pbf_status describe(pbf_backend_solver *handle, pbf_backend_state *state) {
  state->threads = 0;
  state->device_type = PBF_DEVICE_CUDA;
  snprintf(state->device_name, sizeof state->device_name, "%s", of(handle)->device_name);
  return PBF_OK;
}

static pbf_status set_timing(pbf_backend_solver *handle, uint32_t enabled) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (!enabled) {
    clock_stop(&s->clock);
    return PBF_OK;
  }
  clock_stop(&s->clock);
  return clock_start(&s->clock);
}

static pbf_status get_timings(pbf_backend_solver *handle, pbf_timings *timings) {
  report_timings(of(handle), timings);
  return PBF_OK;
}

static pbf_status any_of_ranks(pbf_backend_solver *handle, uint32_t mine, uint32_t *any) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (!agree_on_call(s, "pbf_step", nullptr, 0)) return end_on_ranks(s);
  *any = !on_all_ranks(s, !mine);
  return end_on_ranks(s);
}

static void note_settings(pbf_backend_solver *handle, uint64_t settings) {
  of(handle)->ranks.settings = settings;
}

static pbf_status own_ids(pbf_backend_solver *handle, uint32_t *count, uint32_t *ids) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  *count = s->count;
  if (!ids || !s->count) return PBF_OK;
  return copy_out(s, ids, s->ids + s->first, s->count * sizeof *ids);
}

static pbf_status read_own(pbf_backend_solver *handle, uint32_t field, const pbf_rows *rows,
                           void *out) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (pbf_status status = settle_state(s)) return status;
  return population_read(s, field, rows, out);
}

/* That it works on ranks, with phases: pbf_backend_desc.ranks; how worlds of a batch step together;
 * the caller's memory on the device; and how many colliders it takes. */
static const void *get_extension(const char *name) {
  static const uint32_t works = 2;
  static const pbf_backend_worlds worlds = {sizeof(pbf_backend_worlds), 0, let_put_off, run_worlds};
  static const pbf_backend_ranks_tell tell = {
      sizeof(pbf_backend_ranks_tell), 0, any_of_ranks, note_settings, own_ids, read_own};
  if ((PBF_BUILT & PBF_FEATURE_RANKS) && strcmp(name, PBF_BACKEND_RANKS) == 0) return &works;
  if ((PBF_BUILT & PBF_FEATURE_RANKS) && strcmp(name, PBF_BACKEND_RANKS_TELL) == 0) return &tell;
  if (strcmp(name, PBF_BACKEND_DEVICE_ROWS) == 0) return &device_calls;
  return strcmp(name, PBF_BACKEND_WORLDS) == 0 ? &worlds : pbf_common_extension(name);
}

extern "C" const pbf_backend_api PBF_VARIANT_API = {
    sizeof(pbf_backend_api),
    0,
    pbf_cuda_probe,
    create,
    destroy,
    set_params,
    set_colliders,
    step,
    synchronize,
    add_particles,
    remove_particles,
    remove_all,
    read,
    write,
    map,
    get_stats,
    get_plan,
    describe,
    PBF_BUILT &PBF_FEATURE_TIMING ? set_timing : nullptr,
    PBF_BUILT &PBF_FEATURE_TIMING ? get_timings : nullptr,
    get_extension,
    read_pressures,
    map_pressures,
    PBF_BUILT &PBF_FEATURE_STATS ? project : nullptr,
    PBF_BUILT &PBF_FEATURE_CHEBYSHEV ? set_overlap : nullptr,
    plan_for,
    max_speed,
    take_array,
    release_array,
    read_array,
    get_loads,
    set_phases,
    plan_steps,
    steps_leave,
    set_accelerations,
    find_in_boxes,
};
