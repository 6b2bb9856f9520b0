/* What a solver keeps for its scene: of new parameters or colliders all that may fail comes before
 * anything changes. */
#ifndef PBF_CUDA_SCENE_H
#define PBF_CUDA_SCENE_H

#include "common/derived_tables.h"
#include "common/without.h"
#include "cuda/arrays.h"
#include "cuda/collider_room.h"
#include "cuda/executor.h"
#include "cuda/population.h"
#include "cuda/rank_calls.h"
#include "cuda/small/host.h"
#include "cuda/small/deferred_steps.h"

/* Neighbours of a particle of the rest lattice, half as many again, and a few. */
static inline uint32_t list_chunks(const pbf_params *params) {
  double q = params->smoothing_radius / pbf_derive_spacing(params);
  double expected = PBF_DIM == 3 ? 4.0 / 3 * PBF_PI * q * q * q : PBF_PI * q * q;
  double room = fmin(PBF_MAX_LISTED, 1.5 * expected + 4);
  return (uint32_t)ceil(room / PBF_CHUNK);
}

/* Room for lists, before them the sort's scratch, or for what a small scene has, or ranks get, or
 * statistics take. */
static inline uint64_t list_storage_bytes(const solver *s, const pbf_params *params,
                                          uint32_t chunks, bool small) {
  uint64_t padded = ((uint64_t)s->capacity + 31) / 32 * 32,
           largest = padded * chunks * sizeof(uint4);
  for (uint64_t other :
       {3ull * s->capacity * sizeof(uint32_t), 0ull + stats_bytes(padded),
        small ? (unsigned long long)small_parts_of(s).bytes : 0ull,
        small ? (unsigned long long)world_list_room(s, params) : 0ull,
        has_ranks(s) ? (unsigned long long)(rank_inbox_bytes(s->capacity, {true, true, true, true,
                                                                           s->accelerations != 0}) +
                                            rank_scratch_bytes(s->capacity))
                     : 0ull})
    largest = other > largest ? other : largest;
  return largest;
}

static inline pbf_status take_lists(solver *s, const pbf_params *params, uint32_t chunks,
                                    bool small) {
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

/* What is not wanted any more goes only once there is all that is, but for what ranks have between
 * them. */
static inline pbf_status take_for_scene(solver *s, const pbf_schedule &has,
                                        const pbf_params &params, bool small) {
  if (pbf_status status = take_for_small(s, small)) return status;
  if (pbf_status status = keep_arrays(s, has, params, true)) return status;
  if (pbf_status status = keep_many_loads(s, has.runs[PBF_STAGE_LOADS] != 0)) return status;
  if (pbf_status status = keep_arrays(s, has, params, false)) return status;
  return keep_rank_sums(s);
}

/* Sleep is in the parameters, which may have changed, and may have been in those before. */
static inline pbf_status allow_sleep(solver *s, bool changes, bool before) {
  s->sleep = pbf_sleep_of(&s->params);
  s->moving_obstacles =
      pbf_moving_obstacles_of(&s->params, s->collider_count, s->colliders, s->many.table.moving);
  if (!before) return init_new(s, 0, s->count);
  return changes ? wake_all(s) : PBF_OK;
}

static inline pbf_status apply_params(solver *s, const pbf_params *params, uint32_t count,
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
                      s->most_left, s->overlaps, &s->phases, s->accelerations);
  uint32_t chunks = list_chunks(params);
  /* What may fail comes first; what is no longer wanted goes only when nothing can fail. */
  bool small = !has_ranks(s) && small_wanted(params, schedule),
       was_small = s->small_upload != nullptr;
  if (!schedule.runs[PBF_STAGE_GRID] || (s->topology_memory && !schedule.has_topology))
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

/* Once no kernel that reads those before is to come. */
static inline void keep_shapes(solver *s, const device_shapes &next) {
  const device_shapes before = s->shapes;
  s->shapes = next;
  if (before.memory == next.memory) return;
  pbf_cuda_free(&s->memory, before.memory);
  free_shape_table(s->allocator, before); /* last: by a callback that may be left */
}

static inline void drop_shapes(solver *s, const device_shapes &next) {
  if (s->shapes.memory == next.memory) return;
  pbf_cuda_free(&s->memory, next.memory);
  free_shape_table(s->allocator, next);
}

/* By colliders that do not stay as they are: what it held loses its pressure at once. */
static inline pbf_status wake_what_was_held(solver *s, uint32_t count,
                                            const pbf_collider *colliders) {
  if (!PBF_SLEEP || !s->activity) return PBF_OK;
  const pbf_moving_obstacles departing =
      pbf_departing_surfaces(s->collider_count, s->colliders, count, colliders,
                             moving_obstacles_at(s, s->time), s->many.table.changed);
  return wake_all_if_near(s, departing, s->time);
}

/* Once there is room for them. */
static inline pbf_status replace_colliders(solver *s, uint32_t count, const pbf_collider *colliders,
                                           double time) {
  /* Room for those before, too: fluid near them wakes. */
  uint32_t room = count ? count : s->collider_count;
  const pbf_collider *first = count ? colliders : s->colliders;
  device_shapes shapes;
  pbf_status status = take_shapes(s->allocator, &s->memory, s->shapes, count, colliders, &shapes);
  if (status) return status;
  status = apply_params(s, &s->params, room, first);
  /* What the grid of the last step adds to pressures goes by its shapes. */
  if (!status && s->shapes.memory != shapes.memory && s->topology_memory) status = add_weight(s);
  if (!status) status = wake_what_was_held(s, count, colliders);
  const pbf_collider_table &t = s->many.table;
  const bool may_sleep = PBF_SLEEP && s->activity;
  pbf_moving_obstacles come = {0, 0, 0, t.changed};
  if (!status && may_sleep) {
    const pbf_moving_obstacles left = pbf_leaving_surfaces(
        s->collider_count, s->colliders, count, colliders, s->moving_obstacles, t.still_moving);
    status = wake_near_colliders(s, left, s->time);
    come = pbf_coming_surfaces(s->collider_count, s->colliders, count, colliders,
                               s->moving_obstacles, t.changed);
  }
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
  if (!may_sleep || (status = wake_near_colliders(s, come, time))) return status;
  return keep_awake_near(s, pbf_arriving_surfaces(count, come, s->moving_obstacles, t.still_moving),
                         time);
}

#endif
