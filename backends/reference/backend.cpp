/* The `reference` backend's table for one variant: particles in and out, statistics, plan. */
#include "common/extensions.h"
#include "common/host_only.h"
#include "common/report.h"
#include "common/scene.h"
#include "common/views.h"
#include "physics/overfull.h"
#include "reference/arrays.h"
#include "reference/plugin.h"
#include "reference/step.h"

static void settle_pressures(solver *) {} /* a step's end adds the grid's */
static void settle_for(solver *, uint32_t, const pbf_collider *) {}
static const char *refusal_of(const solver *, const pbf_params *, const pbf_schedule *) {
  return NULL;
}
static pbf_vec velocity_of(const solver *s, uint32_t i) { return s->v[i]; }
static uint32_t threads_of(const solver *) { return 1; }

static void bounded_step(solver *s, double begin, double end, uint64_t nth) {
  const pbf_constants usual = s->constants;
  pbf_set_constants_of_step(&s->constants, &usual, &s->params, s->count, &s->schedule, end);
  solver_step(s, begin, end, nth);
  s->constants = usual;
}

static bool step_of_no_time(solver *s, double time) {
  bounded_step(s, time, time, 1);
  s->now = time;
  return true;
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
    release(s);
    return status;
  }
  *out = s;
  *api = &PBF_VARIANT_API;
  return PBF_OK;
}

static pbf_status step(solver *s, double time, uint64_t before, uint32_t steps, uint32_t *done) {
  const pbf_step_times times = {time, before, s->params.time_step};
  s->now = pbf_time_after(&times, 0);
  for (*done = 0; *done < steps; ++*done) {
    double begin = s->now, end = pbf_time_after(&times, *done + 1);
    if (s->count) bounded_step(s, begin, end, pbf_nth_after(&times, *done + 1));
    s->found.struct_size = 0;
    s->pressure_scale = s->constants.pressure;
    s->now = end;
  }
  return PBF_OK;
}

static pbf_status project(solver *s, double time, uint32_t iterations) {
  project_at(s, time, iterations);
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
  if (s->last_pressure) memset(s->last_pressure + s->count, 0, p->count * sizeof *s->lambda);
  if (s->overlap) memset(s->overlap + s->count, 0, p->count * sizeof *s->overlap);
  if (s->acceleration) memset(s->acceleration + s->count, 0, bytes);
  if (s->phase) memset(s->phase + s->count, (int)p->phase, p->count);
  s->count += p->count;
  init_new(s, s->count - p->count);
  if (p->wakes_all) wake_all(s);
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
    if (sleeps(s)) {
      s->activity[kept] = s->activity[i];
      s->held[kept] = s->held[i];
    }
    if (s->last_pressure) s->last_pressure[kept] = s->last_pressure[i];
    if (s->overlap) s->overlap[kept] = s->overlap[i];
    if (s->acceleration) s->acceleration[kept] = s->acceleration[i];
    if (s->phase) s->phase[kept] = s->phase[i];
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
  else if (field == PBF_BACKEND_FIELD_LAST_PRESSURE)
    memcpy(out, s->last_pressure + rows->first, rows->count * sizeof *s->last_pressure);
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
  if (field == PBF_BACKEND_FIELD_LAST_PRESSURE) {
    memcpy(s->last_pressure + rows->first, in, rows->count * sizeof *s->last_pressure);
    return PBF_OK;
  }
  wake_all(s);
  if (field == PBF_BACKEND_FIELD_PHASE) {
    memcpy(s->phase + rows->first, in, rows->count);
    return PBF_OK;
  }
  pbf_vec *to = field == PBF_BACKEND_FIELD_ACCELERATION ? s->acceleration
                : field == PBF_FIELD_POSITION           ? s->x
                                                        : s->v;
  memcpy(to + rows->first, in, rows->count * sizeof *to);
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
    .destroy = release,
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
    .get_extension = pbf_common_extension,
    .read_pressures = read_pressures,
    .map_pressures = map_pressures,
    .project = PBF_BUILT & PBF_FEATURE_STATS ? project : NULL,
    .set_overlap = PBF_BUILT & PBF_FEATURE_CHEBYSHEV ? set_overlap<solver> : NULL,
    .plan_for = plan_for,
    .max_speed = max_speed,
    .get_loads = get_loads,
    .set_phases = set_phases<solver>,
    .plan_steps = plan_steps<solver>,
    .steps_leave = steps_leave<solver>,
    .set_accelerations = set_accelerations<solver>,
};
