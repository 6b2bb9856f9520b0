/* The `reference` backend's table for one variant: particles in and out, statistics, plan. */
#include "common/host_only.h"
#include "common/report.h"
#include "common/rows.h"
#include "common/without.h"
#include "common/views.h"
#include "physics/overfull.h"
#include "reference/arrays.h"
#include "reference/plugin.h"
#include "reference/step.h"

static pbf_status out_of_memory(const solver *s, const char *what) {
  char text[160];
  snprintf(text, sizeof text, "no memory for %s of %u particles; a smaller capacity would do", what,
           s->capacity);
  s->host->set_error(text);
  return PBF_ERROR_OUT_OF_MEMORY;
}

static pbf_schedule schedule_of(const solver *s, const pbf_params *params, uint32_t colliders,
                                const pbf_collider *list, int overlaps) {
  return pbf_schedule_of(params, colliders, list, s->planned, s->capacity, overlaps);
}

/* Sleep is in the parameters, which may have changed, and may have been in those before. */
static void allow_sleep(solver *s, int changes, int before) {
  s->sleep = pbf_sleep_of(&s->params);
  s->moving_obstacles = pbf_moving_obstacles_of(&s->params, s->collider_count, s->colliders);
  if (!before) init_new(s, 0);
  if (changes) wake_all(s);
}

/* Takes what a schedule needs before anything else changes: it may fail. */
static pbf_status take_schedule(solver *s, const pbf_schedule *schedule, const pbf_params *params) {
  if (!keep_arrays(s, *schedule, *params)) {
    keep_arrays(s, s->schedule, s->params);
    return out_of_memory(s, "the arrays of an optional stage");
  }
  return PBF_OK;
}

static pbf_status set_params(solver *s, const pbf_params *params) {
  pbf_status status = pbf_refuse_without(s->host, pbf_features_wanted(params, s->collider_count));
  if (status != PBF_OK) return status;
  pbf_schedule schedule = schedule_of(s, params, s->collider_count, s->colliders, s->overlaps);
  status = take_schedule(s, &schedule, params);
  if (status != PBF_OK) return status;
  int slept = s->schedule.runs[PBF_STAGE_SLEEP] != 0;
  int changes = !pbf_only_time_step_differs(&s->params, params);
  pbf_update_constants(&s->constants, &s->derived, &s->params, params);
  s->params = *params;
  s->schedule = schedule;
  if (!schedule.accelerated) s->pressure_scale = 0;
  if (schedule.runs[PBF_STAGE_SLEEP]) allow_sleep(s, changes, slept);
  return PBF_OK;
}

static void destroy(solver *s) {
  pbf_allocator allocator = s->memory.allocator;
  pbf_memory_free_all(&s->memory);
  allocator.release(allocator.user, s, sizeof *s, PBF_ALIGNMENT);
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **out, const pbf_backend_api **api) {
  if (pbf_status status = pbf_refuse_stream(desc)) return status;
  solver *s = (solver *)desc->allocator.allocate(desc->allocator.user, sizeof *s, PBF_ALIGNMENT);
  if (!s) {
    desc->host->set_error("no memory for a reference solver");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  memset(s, 0, sizeof *s);
  s->memory.allocator = desc->allocator;
  s->host = desc->host;
  s->capacity = desc->capacity;
  pbf_status status = take_arrays(s) ? set_params(s, params) : out_of_memory(s, "the arrays");
  if (status != PBF_OK) {
    destroy(s);
    return status;
  }
  *out = s;
  *api = &PBF_VARIANT_API;
  return PBF_OK;
}

static pbf_status set_colliders(solver *s, uint32_t count, const pbf_collider *colliders,
                                double time) {
  pbf_status status = pbf_refuse_without(s->host, pbf_features_wanted(&s->params, count));
  if (status != PBF_OK) return status;
  pbf_schedule schedule = schedule_of(s, &s->params, count, colliders, s->overlaps);
  status = take_schedule(s, &schedule, &s->params);
  if (status != PBF_OK) return status;
  pbf_moving_obstacles changed =
      pbf_changed_surfaces(s->collider_count, s->colliders, count, colliders);
  changed.surfaces |= s->moving_obstacles.surfaces;
  wake_near_moving(s, changed, s->now);
  if (count) memcpy(s->colliders, colliders, count * sizeof *colliders);
  s->collider_count = count;
  s->collider_time = s->now = time;
  s->schedule = schedule;
  s->moving_obstacles = pbf_moving_obstacles_of(&s->params, count, s->colliders);
  wake_near_moving(s, changed, time);
  return PBF_OK;
}

static void bounded_step(solver *s, double begin, double end) {
  const pbf_constants usual = s->constants;
  pbf_set_target_density(&s->constants, &usual, &s->params, s->count, &s->schedule, end);
  solver_step(s, begin, end);
  s->constants = usual;
}

static pbf_status step(solver *s, double time, uint64_t before, uint32_t steps, uint32_t *done) {
  const pbf_step_times times = {time, before, s->params.time_step};
  s->now = pbf_time_after(&times, 0);
  for (*done = 0; *done < steps; ++*done) {
    double begin = s->now, end = pbf_time_after(&times, *done + 1);
    if (s->count) bounded_step(s, begin, end);
    s->found.struct_size = 0;
    s->pressure_scale = s->constants.pressure;
    s->now = end;
  }
  return PBF_OK;
}

/* A step of no time, without what only steps need. */
static pbf_status project(solver *s, double time, uint32_t iterations) {
  const solver now = *s;
  wake_all(s);
  s->params = pbf_projection_of(&now.params, iterations);
  s->schedule = schedule_of(s, &s->params, s->collider_count, s->colliders, 0);
  s->constants = pbf_constants_of(&s->params);
  s->residual_density = NULL;
  bounded_step(s, time, time);
  s->params = now.params;
  s->schedule = now.schedule;
  s->constants = now.constants;
  s->residual_density = now.residual_density;
  s->iterations = now.iterations;
  s->pressure_scale = 0;
  s->now = time;
  return PBF_OK;
}

static pbf_status set_overlap(solver *s, const pbf_overlap *overlap) {
  pbf_schedule schedule =
      schedule_of(s, &s->params, s->collider_count, s->colliders, overlap != NULL);
  pbf_status status = take_schedule(s, &schedule, &s->params);
  if (status != PBF_OK) return status;
  s->schedule = schedule;
  s->overlaps = overlap != NULL;
  if (overlap) s->found = *overlap;
  return PBF_OK;
}

/* The arrays are there. */
static pbf_status plan_for(solver *s, uint32_t count) {
  s->planned = count;
  s->schedule = schedule_of(s, &s->params, s->collider_count, s->colliders, s->overlaps);
  return PBF_OK;
}

static pbf_status synchronize(solver *s) {
  (void)s;
  return PBF_OK;
}

static pbf_status add_particles(solver *s, const pbf_particles *p) {
  size_t bytes = p->count * sizeof *s->x;
  memcpy(s->x + s->count, p->positions, bytes);
  memcpy(s->ids + s->count, p->ids, p->count * sizeof *s->ids);
  memset(s->lambda + s->count, 0, p->count * sizeof *s->lambda);
  if (p->velocities)
    memcpy(s->v + s->count, p->velocities, bytes);
  else
    memset(s->v + s->count, 0, bytes);
  if (s->overlap) memset(s->overlap + s->count, 0, p->count * sizeof *s->overlap);
  s->count += p->count;
  init_new(s, s->count - p->count);
  return PBF_OK;
}

static pbf_status remove_particles(solver *s, uint32_t count, const uint32_t *ids) {
  uint32_t kept = 0, next = 0;
  wake_all(s);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (next < count && ids[next] == s->ids[i]) {
      ++next;
      continue;
    }
    s->x[kept] = s->x[i];
    s->v[kept] = s->v[i];
    s->lambda[kept] = s->lambda[i];
    if (sleeps(s)) s->activity[kept] = s->activity[i];
    if (s->overlap) s->overlap[kept] = s->overlap[i];
    s->ids[kept++] = s->ids[i];
  }
  s->count = kept;
  return PBF_OK;
}

static pbf_status remove_all(solver *s) {
  s->count = 0;
  return PBF_OK;
}

static void sort_present(solver *s) {
  if (s->count) grid_build(&s->grid, &s->params, grid_cell_limit(s->count), s->count, s->x);
}

static void read_densities(solver *s, const pbf_rows *rows, pbf_real *out) {
  uint32_t neighbors = 0;
  pbf_obstacles obstacles = obstacles_at(s, s->now);
  sort_present(s);
  for (uint32_t k = 0; k < rows->count; ++k)
    out[k] = solver_density(s, &obstacles, rows->first + k, &neighbors);
}

static pbf_status read_field(solver *s, uint32_t field, const pbf_rows *rows, void *out) {
  if (field == PBF_FIELD_DENSITY && !(PBF_BUILT & PBF_FEATURE_STATS))
    return pbf_refuse_without(s->host, PBF_FEATURE_STATS);
  if (field == PBF_BACKEND_FIELD_REST)
    read_rest(s, rows, (pbf_real *)out);
  else if (field == PBF_BACKEND_FIELD_OVERLAP)
    memcpy(out, s->overlap + rows->first, rows->count * sizeof *s->overlap);
  else if (field == PBF_FIELD_DENSITY)
    read_densities(s, rows, (pbf_real *)out);
  else
    memcpy(out, (field == PBF_FIELD_POSITION ? s->x : s->v) + rows->first,
           rows->count * sizeof *s->x);
  return PBF_OK;
}

static pbf_status write_field(solver *s, uint32_t field, const pbf_rows *rows, const void *in) {
  if (field == PBF_BACKEND_FIELD_REST) {
    write_rest(s, rows, (const pbf_real *)in);
    return PBF_OK;
  }
  if (field == PBF_BACKEND_FIELD_OVERLAP) {
    memcpy(s->overlap + rows->first, in, rows->count * sizeof *s->overlap);
    return PBF_OK;
  }
  wake_all(s);
  memcpy((field == PBF_FIELD_POSITION ? s->x : s->v) + rows->first, in, rows->count * sizeof *s->x);
  return PBF_OK;
}

static pbf_status map(solver *s, uint32_t field, pbf_view *view) {
  int is_id = field == PBF_FIELD_ID;
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = is_id ? (uint32_t)PBF_TYPE_UINT32 : (uint32_t)sizeof(pbf_real);
  view->components = is_id ? 1 : PBF_DIM;
  view->particle_stride = is_id ? sizeof *s->ids : sizeof *s->x;
  view->component_stride = is_id ? sizeof *s->ids : sizeof(pbf_real);
  view->count = s->count;
  view->ids = s->ids;
  view->data = is_id ? (const void *)s->ids : field == PBF_FIELD_POSITION ? s->x : s->v;
  return PBF_OK;
}

static pbf_status read_pressures(solver *s, const pbf_rows *rows, void *out) {
  pbf_real *pressures = (pbf_real *)out;
  sort_present(s);
  for (uint32_t k = 0; k < rows->count; ++k)
    pressures[k] = pbf_pressure(s->pressure_scale, fitted_lambda(s, rows->first + k));
  return PBF_OK;
}

static pbf_status map_pressures(solver *s, pbf_view *view) {
  if (!pbf_memory_keep(&s->memory, true, "pressure", s->capacity, 0, &s->pressure))
    return out_of_memory(s, "a view of the pressures");
  sort_present(s);
  for (uint32_t i = 0; i < s->count; ++i)
    s->pressure[i] = pbf_pressure(s->pressure_scale, fitted_lambda(s, i));
  pbf_view_numbers(view, s->count, s->ids, s->pressure);
  return PBF_OK;
}

static void add_to_stats(pbf_stats *stats, const solver *s, const pbf_obstacles *o, uint32_t i) {
  uint32_t neighbors = 0;
  double density = (double)solver_density(s, o, i, &neighbors);
  pbf_stats_add(stats, i == 0, s->x[i], s->v[i], density, neighbors);
  stats->squeezed += pbf_is_squeezed_by(*o, s->x[i]);
}

static pbf_status get_stats(solver *s, pbf_stats *stats) {
  if (!(PBF_BUILT & PBF_FEATURE_STATS)) return pbf_refuse_without(s->host, PBF_FEATURE_STATS);
  stats->count = s->count;
  stats->iterations = s->schedule.checks_convergence ? s->iterations : s->params.iterations;
  stats->asleep = sleepers(s);
  if (!s->count) return PBF_OK;
  sort_present(s);
  pbf_obstacles obstacles = obstacles_at(s, s->now);
  for (uint32_t i = 0; i < s->count; ++i) add_to_stats(stats, s, &obstacles, i);
  pbf_stats_finish(stats);
  return PBF_OK;
}

static pbf_status max_speed(solver *s, double *speed) {
  double most2 = 0;
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_vec v = s->v[i];
    double v2 = 0;
    for (int k = 0; k < PBF_DIM; ++k) v2 += (double)v.c[k] * (double)v.c[k];
    most2 = v2 > most2 ? v2 : most2;
  }
  *speed = sqrt(most2);
  return PBF_OK;
}

static pbf_status get_plan(solver *s, pbf_plan *plan) {
  pbf_plan_stages(&s->schedule, plan);
  pbf_variant_name(plan->variant, sizeof plan->variant, s->schedule.features, PBF_DIM,
                   sizeof(pbf_real));
  pbf_memory_plan(&s->memory, s->capacity, plan);
  plan->bytes += sizeof *s;
  return PBF_OK;
}

static pbf_status describe(solver *s, pbf_backend_state *state) {
  (void)s;
  state->threads = 1;
  state->device_type = PBF_DEVICE_CPU;
  snprintf(state->device_name, sizeof state->device_name, "one CPU thread");
  return PBF_OK;
}

extern "C" const pbf_backend_api PBF_VARIANT_API;

const pbf_backend_api PBF_VARIANT_API = {
    .struct_size = sizeof(pbf_backend_api),
    .probe = reference_probe,
    .create = create,
    .destroy = destroy,
    .set_params = set_params,
    .set_colliders = set_colliders,
    .step = step,
    .synchronize = synchronize,
    .add_particles = add_particles,
    .remove_particles = remove_particles,
    .remove_all = remove_all,
    .read = read_field,
    .write = write_field,
    .map = map,
    .get_stats = get_stats,
    .get_plan = get_plan,
    .describe = describe,
    .read_pressures = read_pressures,
    .map_pressures = map_pressures,
    .project = PBF_BUILT & PBF_FEATURE_STATS ? project : NULL,
    .set_overlap = PBF_BUILT & PBF_FEATURE_CHEBYSHEV ? set_overlap : NULL,
    .plan_for = plan_for,
    .max_speed = max_speed,
};
