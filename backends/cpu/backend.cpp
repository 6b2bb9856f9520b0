/* The CPU backends' table for one variant: life, parameters, particles, reports. */
#include "common/extensions.h"
#include "common/host_only.h"
#include "common/number.h"
#include "common/scene.h"
#include "common/views.h"
#include "cpu/arrays.h"
#include "cpu/core.h"
#include "cpu/particles.h"
#include "cpu/step.h"
#include "cpu/diagnostics.h"
#include "pbf_build.h"

#define PASTE(isa, dim, bits) cpu_##isa##_##dim##d_f##bits
#define KERNELS_OF(isa, dim, bits) PASTE(isa, dim, bits)
#define KERNELS(isa) KERNELS_OF(isa, PBF_DIM, PBF_BITS)

#define DECLARE(isa, ISA) extern "C" const kernels KERNELS(isa);
PBF_EACH_ISA(DECLARE)

/* Of a set that the loops were built for. */
static const kernels *kernels_for(cpu_isa which) {
#define DO_OF_ISA(isa, ISA) \
  if (which == CPU_##ISA) return &KERNELS(isa);
  PBF_EACH_ISA(DO_OF_ISA)
  return NULL;
}

#if PBF_BITS == 32
#define DECLARE_FUSED(isa, ISA) extern "C" const fused_kernels KERNELS(fused_##isa);
PBF_EACH_FUSED_ISA(DECLARE_FUSED)
#endif

/* Null: built without. */
static const fused_kernels *fused_kernels_for(cpu_isa which) {
  (void)which;
#if PBF_BITS == 32
#define FUSED_OF_ISA(isa, ISA) \
  if (which == CPU_##ISA) return &KERNELS(fused_##isa);
  PBF_EACH_FUSED_ISA(FUSED_OF_ISA)
#endif
  return NULL;
}

static void choose_kernels(solver *s, cpu_isa isa, uint32_t determinism) {
  const fused_kernels *fused =
      determinism == PBF_DETERMINISM_PER_MACHINE ? fused_kernels_for(isa) : NULL;
  s->isa = isa;
  s->kernels = kernels_for(isa);
  s->is_fused = fused != NULL;
  if (!fused) return;
  s->with_fused = *s->kernels;
  s->with_fused.lambda = fused->lambda;
  s->with_fused.move = fused->move;
  s->kernels = &s->with_fused;
}

/* Of the loops, as plans and reports say it. */
static const char *suffix_of(const solver *s) { return s->is_fused ? "-fused" : ""; }

static pbf_status no_memory_for_neighbors(const solver *s) {
  char text[160], radius[PBF_NUMBER_SIZE];
  snprintf(text, sizeof text,
           "no memory for the neighbours of %u particles; fewer particles or a smaller "
           "smoothing_radius (now %s) would do",
           s->count, pbf_number_text(radius, s->params.smoothing_radius));
  s->host->set_error(text);
  return PBF_ERROR_OUT_OF_MEMORY;
}

/* ---- Life ---------------------------------------------------------------------------------- */

static void settle_pressures(solver *s) { add_weight(s); }

/* The grid of the last step asks for the distances of its solids. Shapes that none of the new
 * colliders has may be gone once these are set. */
static void settle_for(solver *s, uint32_t count, const pbf_collider *colliders) {
  if (s->grid_pressure_pending && pbf_topology_loses_shape(&s->pressure_grid, count, colliders))
    add_weight(s);
}
static const char *refusal_of(const solver *, const pbf_params *, const pbf_schedule *) {
  return NULL;
}
static pbf_vec velocity_of(const solver *s, uint32_t i) { return field_at(&s->buffers.v, i); }
static uint32_t threads_of(const solver *s) { return s->threads; }

/* On ranks of others' failures, too. */
static pbf_status fail_to_find_neighbors(solver *s) {
  return s->ranks.failed ? end_on_ranks(s) : no_memory_for_neighbors(s);
}

static bool step_of_no_time(solver *s, double time) {
  step_job job = {.s = s, .times = {time, 0, 0}, .steps = 1};
  run_job(&job);
  return job.done == 1;
}

static void destroy(solver *s) {
  s->team_api->end();
  release(s);
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **out, const pbf_backend_api **api) {
  const team_api *teams = reinterpret_cast<const cpu_desc *>(desc)->team_api;
  cpu_isa isa;
  char error[160];
  if (pbf_status status = pbf_refuse_stream(desc)) return status;
  if (desc->ranks && (teams->size(desc->threads) > 1 || desc->enqueue_task)) {
    desc->host->set_error("a rank has one thread: desc.threads 1, or the backend \"serial\"");
    return PBF_ERROR_UNSUPPORTED;
  }
  if (!cpu_isa_choose(desc->isa, &isa, error, sizeof error)) {
    desc->host->set_error(error);
    return PBF_ERROR_UNSUPPORTED;
  }
  solver *s = (solver *)desc->allocator.allocate(desc->allocator.user, sizeof *s, PBF_ALIGNMENT);
  if (!s) {
    desc->host->set_error("no memory for a solver");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  memset(s, 0, sizeof *s);
  s->memory.allocator = desc->allocator;
  s->host = desc->host;
  s->capacity = s->local_capacity = desc->capacity;
  describe_ranks(s, desc->ranks);
  s->team_api = teams;
  s->threads = teams->size(desc->threads);
  s->threads_by_choice = !desc->threads && teams->resizes;
  s->tasks = {desc->enqueue_task, desc->finish_task, desc->task_user};
  choose_kernels(s, isa, desc->determinism);
  teams->begin();
  if (!take_arrays(s) || (has_ranks(s) && !take_rank_tables(s))) {
    pbf_status status = out_of_memory(s, "the arrays");
    destroy(s);
    return status;
  }
  teams->run(&s->tasks, s->team, s->threads, clear_arrays, s);
  if (has_ranks(s)) begin_portions(s);
  ++s->cell_end; /* cell_end[-1] is the begin of cell 0 */
  pbf_status status = set_params(s, params);
  if (status != PBF_OK) {
    destroy(s);
    return status;
  }
  *out = s;
  *api = &PBF_VARIANT_API;
  return PBF_OK;
}

static pbf_status step(solver *s, double time, uint64_t before, uint32_t steps, uint32_t *done) {
  const pbf_step_times times = {time, before, s->params.time_step};
  const uint32_t count = particles_of_all(s);
  step_job job = {.s = s, .times = times, .steps = steps, .done = count ? 0 : steps};
  if (has_ranks(s) && !agree_on_step(s, &times, steps)) return end_on_ranks(s);
  if (count)
    run_job(&job);
  else
    s->now = pbf_time_after(&times, steps);
  *done = job.done;
  if (job.done) s->found.struct_size = 0;
  if (s->ranks.failed) return end_on_ranks(s);
  return job.done == steps ? PBF_OK : no_memory_for_neighbors(s);
}

static pbf_status project(solver *s, double time, uint32_t iterations) {
  if (has_ranks(s) && !agree_on_call(s, "a projection", &time, sizeof time)) return end_on_ranks(s);
  return project_at(s, time, iterations) ? PBF_OK : fail_to_find_neighbors(s);
}

/* ---- Particles ----------------------------------------------------------------------------- */

static pbf_status add_particles(solver *s, const pbf_particles *particles) {
  pbf_particles share = *particles;
  if (has_ranks(s) &&
      !share_of_added(s, static_cast<uint32_t *>(s->ranks.gathered), s->local_capacity, &share))
    return end_on_ranks(s);
  append(s, &share);
  init_new(s, s->count - share.count);
  if (particles->wakes_all) wake_all(s);
  return PBF_OK;
}

static pbf_status remove_particles(solver *s, uint32_t count, const uint32_t *ids) {
  wake_all(s);
  if (has_ranks(s)) note_removed(s, count, ids);
  remove_by_id(s, count, ids);
  return PBF_OK;
}

static pbf_status remove_all(solver *s) {
  s->count = s->asleep = s->ranks.total = s->grid_pressure_pending = 0;
  return PBF_OK;
}

static pbf_status read_own(solver *s, uint32_t which, const pbf_rows *rows, void *out) {
  if (which == PBF_BACKEND_FIELD_REST) {
    read_rest(s, rows, (pbf_real *)out);
  } else if (which == PBF_BACKEND_FIELD_OVERLAP) {
    read_reals(s, s->buffers.overlap, rows, (pbf_real *)out);
  } else if (which == PBF_BACKEND_FIELD_LAST_PRESSURE) {
    read_reals(s, s->last_pressure, rows, (pbf_real *)out);
  } else if (which == PBF_FIELD_DENSITY) {
    if (!(PBF_BUILT & PBF_FEATURE_STATS)) return pbf_refuse_without(s->host, PBF_FEATURE_STATS);
    if (!diagnose(s, diagnose_densities)) return fail_to_find_neighbors(s);
    read_densities(s, rows, (pbf_real *)out);
  } else if (which == PBF_FIELD_PRESSURE) {
    add_weight(s);
    if (!diagnose(s, diagnose_pressures)) return fail_to_find_neighbors(s);
    read_pressure_rows(s, rows, (pbf_real *)out);
  } else {
    read_vectors(s, which == PBF_FIELD_POSITION ? &s->buffers.x : &s->buffers.v, rows,
                 (pbf_real *)out);
  }
  return PBF_OK;
}

/* What each rank has read of its particles, all get. */
static pbf_status read_on_ranks(solver *s, uint32_t which, const pbf_rows *rows, void *out) {
  const uint32_t asked[3] = {which, rows->first, rows->count};
  const uint32_t *ids = s->buffers.ids;
  uint32_t count = s->count;
  if (!agree_on_call(s, "a reading of particles", asked, sizeof asked)) return end_on_ranks(s);
  if (which == PBF_BACKEND_FIELD_REST) wake_ranks(s);
  pbf_status status = read_own(s, which, rows, out);
  if (status != PBF_OK) return status;
  if (which == PBF_FIELD_DENSITY || which == PBF_FIELD_PRESSURE) {
    ids = s->buffers.sorted_ids + own_places(s).first;
    count = own_places(s).last - own_places(s).first;
  }
  share_rows(s, rows, ids, count, out, row_bytes_of(which));
  return end_on_ranks(s);
}

static pbf_status read_field(solver *s, uint32_t which, const pbf_rows *rows, void *out) {
  return has_ranks(s) ? read_on_ranks(s, which, rows, out) : read_own(s, which, rows, out);
}

static pbf_status write_field(solver *s, uint32_t which, const pbf_rows *rows, const void *in) {
  if (which == PBF_FIELD_POSITION || which == PBF_BACKEND_FIELD_REST) add_weight(s);
  if (has_ranks(s)) note_written(s, which, rows, in);
  if (which == PBF_BACKEND_FIELD_REST) {
    write_rest(s, rows, (const pbf_real *)in);
    return PBF_OK;
  }
  if (which == PBF_BACKEND_FIELD_OVERLAP) {
    write_reals(s, s->buffers.overlap, rows, (const pbf_real *)in);
    return PBF_OK;
  }
  if (which == PBF_BACKEND_FIELD_LAST_PRESSURE) {
    write_reals(s, s->last_pressure, rows, (const pbf_real *)in);
    return PBF_OK;
  }
  wake_all(s);
  if (which == PBF_BACKEND_FIELD_PHASE) {
    write_phases(s, rows, (const uint8_t *)in);
    return PBF_OK;
  }
  const field *to = which == PBF_BACKEND_FIELD_ACCELERATION ? &s->buffers.acceleration
                    : which == PBF_FIELD_POSITION           ? &s->buffers.x
                                                            : &s->buffers.v;
  write_vectors(s, to, rows, (const pbf_real *)in);
  return PBF_OK;
}

static pbf_status map(solver *s, uint32_t which, pbf_view *view) {
  int is_id = which == PBF_FIELD_ID;
  const field *f = which == PBF_FIELD_POSITION ? &s->buffers.x : &s->buffers.v;
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = is_id ? (uint32_t)PBF_TYPE_UINT32 : (uint32_t)sizeof(pbf_real);
  view->components = is_id ? 1 : PBF_DIM;
  view->particle_stride = is_id ? sizeof(uint32_t) : sizeof(pbf_real);
  view->component_stride =
      is_id ? (int64_t)sizeof(uint32_t) : (int64_t)(padded(s->local_capacity) * sizeof(pbf_real));
  view->count = s->count;
  view->ids = s->buffers.ids;
  view->data = is_id ? (const void *)s->buffers.ids : f->c[0];
  return PBF_OK;
}

static pbf_status read_pressures(solver *s, const pbf_rows *rows, void *out) {
  return read_field(s, PBF_FIELD_PRESSURE, rows, out);
}

static pbf_status map_pressures(solver *s, pbf_view *view) {
  if (!pbf_memory_keep(&s->memory, true, "pressure", padded(s->local_capacity), 0, &s->pressure))
    return out_of_memory(s, "a view of the pressures");
  add_weight(s);
  if (!diagnose(s, diagnose_pressures)) return no_memory_for_neighbors(s);
  for (uint32_t k = 0; k < s->count; ++k)
    s->pressure[s->order[k]] = pbf_pressure(s->pressure_scale, s->buffers.fitted_lambda()[k]);
  pbf_view_numbers(view, s->count, s->buffers.ids, s->pressure);
  return PBF_OK;
}

static pbf_status max_speed_of_all(solver *s, double *speed) {
  if (!has_ranks(s)) return max_speed(s, speed);
  if (!agree_on_call(s, "a look at the fastest particle", NULL, 0)) return end_on_ranks(s);
  max_speed(s, speed);
  *speed = max_of_ranks(s, *speed);
  return end_on_ranks(s);
}

/* ---- Reports ------------------------------------------------------------------------------- */

static pbf_status get_stats(solver *s, pbf_stats *stats) {
  if (!(PBF_BUILT & PBF_FEATURE_STATS)) return pbf_refuse_without(s->host, PBF_FEATURE_STATS);
  if (has_ranks(s) && !agree_on_call(s, "pbf_get_stats", NULL, 0)) return end_on_ranks(s);
  if (!diagnose(s, diagnose_densities)) return fail_to_find_neighbors(s);
  stats->count = particles_of_all(s);
  stats->iterations = s->schedule.checks_convergence ? s->iterations : s->params.iterations;
  if (has_ranks(s)) count_sleepers_of_ranks(s);
  stats->asleep = s->asleep;
  if (!has_ranks(s)) {
    sum_stats(s, stats);
    return PBF_OK;
  }
  sum_stats_of_ranks(s, stats);
  return end_on_ranks(s);
}

static pbf_status get_plan(solver *s, pbf_plan *plan) {
  char variant[sizeof plan->variant - 8];
  pbf_plan_stages(&s->schedule, plan);
  pbf_variant_name(variant, sizeof variant, s->schedule.features, PBF_DIM, sizeof(pbf_real));
  snprintf(plan->variant, sizeof plan->variant, "%s-%s%s", variant, cpu_isa_name(s->isa),
           suffix_of(s));
  pbf_memory_plan(&s->memory, s->local_capacity, plan);
  plan->bytes += sizeof *s;
  return PBF_OK;
}

static pbf_status describe(solver *s, pbf_backend_state *state) {
  char brand[64];
  cpu_brand(brand, sizeof brand);
  state->threads = s->team_api->threads(s->threads);
  state->device_type = PBF_DEVICE_CPU;
  snprintf(state->device_name, sizeof state->device_name, "%s (%s%s)", brand, cpu_isa_name(s->isa),
           suffix_of(s));
  return PBF_OK;
}

static pbf_status set_timing(solver *s, uint32_t enabled) {
  s->timing = enabled != 0;
  memset(s->seconds, 0, sizeof s->seconds);
  memset(s->runs, 0, sizeof s->runs);
  s->skipped = 0;
  return PBF_OK;
}

static pbf_status get_timings(solver *s, pbf_timings *timings) {
  for (int k = 0; k < PBF_STAGE_COUNT; ++k) {
    if (!s->schedule.runs[k]) continue;
    const uint64_t skipped = k == PBF_STAGE_LAMBDA || k == PBF_STAGE_MOVE ? s->skipped : 0;
    pbf_timings_add(timings, k, 1000 * s->seconds[k], s->runs[k] - skipped);
  }
  return PBF_OK;
}

static pbf_status any_of_ranks(solver *s, uint32_t mine, uint32_t *any) {
  if (!agree_on_call(s, "pbf_step", NULL, 0)) return end_on_ranks(s);
  *any = max_of_ranks(s, mine) > 0;
  return end_on_ranks(s);
}

static void note_settings(solver *s, uint64_t settings) { s->ranks.settings = settings; }

static pbf_status own_ids(solver *s, uint32_t *count, uint32_t *ids) {
  *count = s->count;
  if (ids && s->count) memcpy(ids, s->buffers.ids, s->count * sizeof *ids);
  return PBF_OK;
}

/* That it works on ranks, with phases: pbf_backend_desc.ranks. And how many colliders it takes. */
static const void *get_extension(const char *name) {
  static const uint32_t works = 2;
  static const pbf_backend_ranks_tell tell = {sizeof tell,   0,       any_of_ranks,
                                              note_settings, own_ids, read_own};
  if (!(PBF_BUILT & PBF_FEATURE_RANKS)) return pbf_common_extension(name);
  if (strcmp(name, PBF_BACKEND_RANKS_TELL) == 0) return &tell;
  return strcmp(name, PBF_BACKEND_RANKS) == 0 ? &works : pbf_common_extension(name);
}

extern "C" const pbf_backend_api PBF_VARIANT_API;

const pbf_backend_api PBF_VARIANT_API = {
    .struct_size = sizeof(pbf_backend_api),
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
    .set_timing = PBF_BUILT & PBF_FEATURE_TIMING ? set_timing : NULL,
    .get_timings = PBF_BUILT & PBF_FEATURE_TIMING ? get_timings : NULL,
    .get_extension = get_extension,
    .read_pressures = read_pressures,
    .map_pressures = map_pressures,
    .project = PBF_BUILT & PBF_FEATURE_STATS ? project : NULL,
    .set_overlap = PBF_BUILT & PBF_FEATURE_CHEBYSHEV ? set_overlap<solver> : NULL,
    .plan_for = plan_for,
    .max_speed = max_speed_of_all,
    .get_loads = PBF_BUILT & PBF_FEATURE_LOADS ? get_loads<solver> : NULL,
    .set_phases = set_phases<solver>,
    .plan_steps = plan_steps<solver>,
    .steps_leave = steps_leave<solver>,
    .set_accelerations = set_accelerations<solver>,
};
