/* The `cuda` backend's table for one variant: life, parameters, steps, views, reports. */
#include "common/derived_tables.h"
#include "common/extensions.h"
#include "common/without.h"
#include "cuda/plugin.h"

#include "cuda/arrays.h"
#include "cuda/collider_room.h"
#include "cuda/device_calls.h"
#include "cuda/executor.h"
#include "cuda/population.h"
#include "cuda/rank_calls.h"
#include "cuda/report.h"
#include "cuda/small/host.h"
#include "cuda/small/put_off.h"
#include "physics/left_under_all.h"

static void destroy_solver(solver *s) {
  {
    pbf_cuda_scope scope(s->context);
    clock_stop(&s->clock);
    if (s->stream) cudaStreamSynchronize(s->stream);
    drop_team(s);
    if (s->reached) cudaEventDestroy(s->reached);
    free_ranks(s);
    free_shape_table(s->allocator, s->shapes);
    free_many_host(s);
    pbf_cuda_free_all(&s->memory);
    free_all_asleep(s);
    free_refusals(s);
    if (s->owns_stream) cudaStreamDestroy(s->stream);
    cudaGetLastError();
  }
  s->allocator.release(s->allocator.user, s, sizeof *s, alignof(solver));
}

static void destroy(pbf_backend_solver *handle) {
  entered(handle)->put_off.steps = 0;
  destroy_solver(of(handle));
}

/* Of some ranks, which are told, to where the call ends. */
static pbf_status end_call(solver *s, pbf_status status) {
  return has_ranks(s) ? end_call_on_ranks(s, status) : status;
}

/* Neighbours of a particle of the rest lattice, half as many again, and a few. */
static uint32_t list_chunks(const pbf_params *params) {
  double q = params->smoothing_radius / pbf_derive_spacing(params);
  double expected = PBF_DIM == 3 ? 4.0 / 3 * PBF_PI * q * q * q : PBF_PI * q * q;
  double room = fmin(PBF_MAX_LISTED, 1.5 * expected + 4);
  return (uint32_t)ceil(room / PBF_CHUNK);
}

/* Room for lists, before them the sort's scratch, or for what a small scene has, or ranks get, or
 * statistics take. */
static uint64_t list_storage_bytes(const solver *s, const pbf_params *params, uint32_t chunks,
                                   bool small) {
  uint64_t padded = ((uint64_t)s->capacity + 31) / 32 * 32,
           largest = padded * chunks * sizeof(uint4);
  for (uint64_t other :
       {3ull * s->capacity * sizeof(uint32_t), 0ull + stats_bytes(padded),
        small ? (unsigned long long)small_parts_of(s).bytes : 0ull,
        small ? (unsigned long long)world_list_room(s, params) : 0ull,
        has_ranks(s)
            ? (unsigned long long)(rank_inbox_bytes(s->capacity, {true, true, true, true}) +
                                   rank_scratch_bytes(s->capacity))
            : 0ull})
    largest = other > largest ? other : largest;
  return largest;
}

static pbf_status take_lists(solver *s, const pbf_params *params, uint32_t chunks, bool small) {
  uint64_t bytes = list_storage_bytes(s, params, chunks, small);
  void *room = s->list_storage;
  if (bytes != s->list_bytes) {
    if (pbf_status status = pbf_cuda_take(&s->memory, "neighbor list", bytes, &room)) return status;
    pbf_cuda_free(&s->memory, s->list_storage);
    s->ranks.changed = true;
  }
  s->list_storage = room;
  s->list_bytes = bytes;
  s->lists.entries = static_cast<uint4 *>(room);
  s->lists.chunks = chunks;
  return PBF_OK;
}

static pbf_status take_for_scene(solver *s, const pbf_schedule &has, const pbf_params &params,
                                 bool small) {
  if (pbf_status status = take_for_small(s, small)) return status;
  if (pbf_status status = keep_arrays(s, has, params)) return status;
  if (pbf_status status = keep_rank_sums(s)) return status;
  return keep_many_loads(s, has.runs[PBF_STAGE_LOADS] != 0);
}

/* Sleep is in the parameters, which may have changed, and may have been in those before. */
static pbf_status allow_sleep(solver *s, bool changes, bool before) {
  s->sleep = pbf_sleep_of(&s->params);
  s->moving_obstacles =
      pbf_moving_obstacles_of(&s->params, s->collider_count, s->colliders, s->many.table.moving);
  if (!before) return init_new(s, 0, s->count);
  return changes ? wake_all(s) : PBF_OK;
}

static pbf_status apply_params(solver *s, const pbf_params *params, uint32_t count,
                               const pbf_collider *colliders) {
  if (pbf_status status =
          pbf_refuse_without(pbf_cuda_host, pbf_features_wanted(params, count, colliders)))
    return status;
  pbf_derived derived = s->derived;
  pbf_constants constants = s->constants;
  derive_tables(params, &derived, &constants);
  constants.phases = pbf_phase_constants_of(&s->phases);
  pbf_schedule schedule =
      pbf_schedule_of(params, &derived, &s->basins, count, colliders, s->planned, s->scene_capacity,
                      s->most_left, s->overlaps, &s->phases);
  uint32_t chunks = list_chunks(params);
  /* What may fail comes first; what is no longer wanted goes only when nothing can fail. */
  bool small = !has_ranks(s) && small_wanted(params, schedule),
       was_small = s->small_upload != nullptr;
  if (!schedule.runs[PBF_STAGE_GRID] || (s->topology_memory && !schedule.solids))
    if (pbf_status status = add_weight(s)) return status;
  if (pbf_status status = take_lists(s, params, chunks, small || was_small)) return status;
  if (pbf_status status = take_for_scene(s, schedule, *params, small)) {
    take_for_scene(s, s->schedule, s->params, was_small);
    return status;
  }
  if (was_small && !small)
    take_lists(s, params, chunks, false); /* if that fails, it has more than it needs */
  if (s->topology.memory != s->topology_memory) s->topology.memory = nullptr;
  bool slept = s->schedule.runs[PBF_STAGE_SLEEP] != 0;
  bool changes = !pbf_only_time_step_differs(&s->params, params);
  if (changes || memcmp(&s->schedule, &schedule, sizeof schedule) != 0)
    s->ranks.careful_steps = STEPS_OF_NEW;
  s->constants = constants;
  s->derived = derived;
  s->params = *params;
  s->schedule = schedule;
  note_standing(s);
  if (!schedule.accelerated) s->pressure_scale = 0;
  return schedule.runs[PBF_STAGE_SLEEP] ? allow_sleep(s, changes, slept) : PBF_OK;
}

static pbf_status set_params(pbf_backend_solver *handle, const pbf_params *params) {
  pbf_cuda_scope scope(of(handle)->context);
  return apply_params(of(handle), params, of(handle)->collider_count, of(handle)->colliders);
}

static pbf_status take_arrays(solver *s) {
  uint64_t n = s->capacity, warps = (n + 31) / 32;
  if (pbf_status status =
          pbf_cuda_scan_scratch(grid_cell_limit(s->scene_capacity) + 2, &s->scan_bytes))
    return status;
  const struct {
    const char *name;
    uint64_t bytes;
    void *to;
  } wanted[] = {
      {"position", (n + PBF_SPARE_POINTS) * sizeof(point), &s->points},
      {"velocity", n * sizeof(pbf_vec), &s->velocities},
      {"id", n * sizeof(uint32_t), &s->ids},
      {"moved position", (n + PBF_SPARE_POINTS) * sizeof(point), &s->other},
      {"predicted velocity", n * sizeof(pbf_vec), &s->other_velocities},
      {"sorted id", n * sizeof(uint32_t), &s->other_ids},
      {"sorted cell", n * sizeof(uint32_t), &s->cells},
      {"scan scratch", s->scan_bytes, &s->scan_scratch},
      {"list size", n * sizeof(uint8_t), &s->lists.sizes},
      {"list base", warps * PBF_ROWS * sizeof(uint32_t), &s->lists.bases},
  };
  for (const auto &array : wanted)
    if (pbf_status status =
            pbf_cuda_take(&s->memory, array.name, array.bytes, static_cast<void **>(array.to)))
      return status;
  if (has_ranks(s)) return take_ranks(s); /* with cells once they are known */
  return pbf_cuda_take(&s->memory, "cell start",
                       (grid_cell_limit(s->capacity) + 1ull) * sizeof(uint32_t),
                       reinterpret_cast<void **>(&s->cell_start));
}

/* The particle that fills up lists: so far away that every pair term with it is 0, near enough
 * that no distance overflows. */
static pbf_status place_nowhere(solver *s) {
  point sentinel_position = {};
  for (int k = 0; k < PBF_DIM; ++k) sentinel_position.c[k] = (pbf_real)1e18;
  s->lists.sentinel_index = s->capacity;
  for (point *points : {s->points, s->other})
    if (pbf_status status = pbf_cuda_check(
            cudaMemcpyAsync(points + s->capacity, &sentinel_position, sizeof sentinel_position,
                            cudaMemcpyHostToDevice, s->stream),
            "cudaMemcpyAsync"))
      return status;
  return PBF_OK;
}

static pbf_status open_stream(solver *s, void *stream) {
  if (stream) {
    s->stream = static_cast<cudaStream_t>(stream);
  } else {
    if (pbf_status status = pbf_cuda_check(
            cudaStreamCreateWithFlags(&s->stream, cudaStreamNonBlocking), "cudaStreamCreate"))
      return status;
    s->owns_stream = true;
  }
  s->memory.stream = s->stream;
  return PBF_OK;
}

/* Lists grow in more shared memory than a kernel may have unasked. */
template <searchers WHICH>
static pbf_status allow_lists() {
  for (auto kernel : {list_kernel<WHICH, false>, list_kernel<WHICH, true>})
    if (pbf_status status =
            pbf_cuda_check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                                (int)list_shared(PBF_MAX_LISTED / PBF_CHUNK)),
                           "cudaFuncSetAttribute"))
      return status;
  return PBF_OK;
}

static pbf_status fill(solver *s, const pbf_backend_desc *desc, const pbf_params *params) {
  cudaDeviceProp properties;
  if (pbf_status status = pbf_cuda_check(cudaGetDevice(&s->device), "cudaGetDevice")) return status;
  if (pbf_status status = pbf_cuda_check(cudaGetDeviceProperties(&properties, s->device),
                                         "cudaGetDeviceProperties"))
    return status;
  snprintf(s->device_name, sizeof s->device_name, "%.95s", properties.name);
  s->multiprocessors = (uint32_t)properties.multiProcessorCount;
  s->block_shared = properties.sharedMemPerBlockOptin;
  s->launches_early = properties.major >= 9;
  s->ordered = true;
  if (pbf_status status = open_stream(s, desc->stream)) return status;
  if (pbf_status status = take_arrays(s)) return status;
  if (pbf_status status = place_nowhere(s)) return status;
  if (pbf_status status = allow_lists<SEARCH_ALL>()) return status;
  if constexpr (PBF_SLEEP) {
    if (pbf_status status = allow_lists<SEARCH_AWAKE>()) return status;
    if (pbf_status status = allow_lists<SEARCH_SLEEPING_BOUNDARY>()) return status;
  }
  if constexpr (PBF_HAS_PRESSURE_GRID)
    if (pbf_status status = allow_pressure_grid(s)) return status;
  if (pbf_status status = apply_params(s, params, 0, nullptr)) return status;
  return pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize");
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **out, const pbf_backend_api **api) {
  const pbf_allocator &allocator = desc->allocator;
  pbf_cuda_host = desc->host;
  solver *s =
      static_cast<solver *>(allocator.allocate(allocator.user, sizeof(solver), alignof(solver)));
  if (!s) {
    pbf_cuda_host->set_error("no host memory for a cuda solver");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  memset(static_cast<void *>(s), 0, sizeof *s);
  s->allocator = allocator;
  s->host = desc->host;
  s->capacity = desc->capacity;
  s->worlds = desc->worlds;
  s->colliders = s->few_colliders;
  pbf_place_few_basins(&s->basins, &s->basins_memory);
  pbf_status status = describe_ranks(s, desc->ranks);
  if (status == PBF_OK) status = pbf_cuda_context_find(desc->device, desc->stream, &s->context);
  if (status == PBF_OK) {
    pbf_cuda_scope scope(s->context);
    status = fill(s, desc, params);
  }
  if (status != PBF_OK) {
    destroy_solver(s);
    return status;
  }
  *out = reinterpret_cast<pbf_backend_solver *>(s);
  *api = &PBF_VARIANT_API;
  return PBF_OK;
}

/* Once no kernel that reads those before is to come. */
static void keep_shapes(solver *s, const device_shapes &next) {
  if (s->shapes.memory != next.memory) {
    pbf_cuda_free(&s->memory, s->shapes.memory);
    free_shape_table(s->allocator, s->shapes);
  }
  s->shapes = next;
}

static void drop_shapes(solver *s, const device_shapes &next) {
  if (s->shapes.memory == next.memory) return;
  pbf_cuda_free(&s->memory, next.memory);
  free_shape_table(s->allocator, next);
}

/* Once there is room for them. */
static pbf_status replace_colliders(solver *s, uint32_t count, const pbf_collider *colliders,
                                    double time) {
  /* Room for those before, too: fluid near them wakes. */
  uint32_t room = count ? count : s->collider_count;
  const pbf_collider *first = count ? colliders : s->colliders;
  const pbf_moving_obstacles changed =
      pbf_changed_surfaces(s->collider_count, s->colliders, count, colliders, s->moving_obstacles,
                           s->many.table.changed);
  device_shapes shapes;
  pbf_status status = take_shapes(s->allocator, &s->memory, s->shapes, count, colliders, &shapes);
  if (status) return status;
  status = apply_params(s, &s->params, room, first);
  /* What the grid of the last step adds to pressures goes by its shapes. */
  if (!status && s->shapes.memory != shapes.memory && s->topology_memory) status = add_weight(s);
  if (!status) status = wake_near_colliders(s, changed, s->time);
  if (!status) status = forget_loads(s, count < s->collider_count ? count : s->collider_count);
  if (status) {
    drop_shapes(s, shapes);
    return status;
  }
  keep_shapes(s, shapes);
  s->ranks.careful_steps = STEPS_OF_NEW;
  s->topology.memory = nullptr;
  if (count) memcpy(s->colliders, colliders, count * sizeof *colliders);
  s->collider_count = count;
  s->collider_time = s->time = time;
  if (room != count)
    if ((status = apply_params(s, &s->params, count, s->colliders))) return status;
  s->moving_obstacles =
      pbf_moving_obstacles_of(&s->params, count, s->colliders, s->many.table.moving);
  note_standing(s);
  return wake_near_colliders(s, changed, time);
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
  s->schedule = pbf_schedule_of(&s->params, &derived, &s->basins, s->collider_count, s->colliders,
                                s->planned, s->scene_capacity, s->most_left, 0, &s->phases);
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

/* The arrays are there. */
static pbf_status plan_for(pbf_backend_solver *handle, uint32_t count) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  const pbf_schedule schedule =
      pbf_schedule_of(&s->params, &s->derived, &s->basins, s->collider_count, s->colliders, count,
                      s->scene_capacity, s->most_left, s->overlaps, &s->phases);
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
  if (s->schedule.phases) return -1; /* of fluids that differ it is not known */
  return pbf_left_under_all(&s->params, &s->basins, s->collider_count, s->colliders, s->planned,
                            error, most);
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

/* That it works on ranks, with phases: pbf_backend_desc.ranks; how worlds of a batch step together;
 * the caller's memory on the device; and how many colliders it takes. */
static const void *get_extension(const char *name) {
  static const uint32_t works = 2;
  static const pbf_backend_worlds worlds = {sizeof(pbf_backend_worlds), 0, let_put_off, run_worlds};
  static const pbf_backend_ranks_tell tell = {sizeof(pbf_backend_ranks_tell), 0, any_of_ranks};
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
};
