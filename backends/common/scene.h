/* What the solvers that run on a CPU do alike with parameters, colliders, overlaps and the time:
 * all that changes the schedule. Part of reference/backend.cpp and cpu/backend.cpp. Their solvers
 * have the same members for it, and these functions:
 *
 *   keep_arrays, wake_all, wake_near_moving, wake_all_if_near, keep_awake_near, init_new
 *                                                   as they declare them
 *   void settle_pressures(Solver *)                 before what pressures come from changes
 *   void settle_for(Solver *, uint32_t count, const pbf_collider *)
 *                                                   before these take the place of the colliders
 *   bool step_of_no_time(Solver *, double time)     whether there was memory for it
 *   pbf_vec velocity_of(const Solver *, uint32_t i)
 *   const char *refusal_of(const Solver *, const pbf_params *, const pbf_schedule *)
 *                                                   what it can't do of these, or null
 *   uint32_t threads_of(const Solver *)             that look at colliders at once */
#ifndef PBF_COMMON_SCENE_H
#define PBF_COMMON_SCENE_H

#include "common/collider_table.h"
#include "common/derived_tables.h"
#include "common/host_only.h"
#include "common/memory.h"
#include "common/without.h"
#include "physics/settled_error.h"
#include "physics/loads.h"
#include "physics/passes/overlap.h"
#include "physics/project.h"
#include "physics/schedule.h"
#include "physics/sleep.h"

template <class Solver>
static pbf_status out_of_memory(const Solver *s, const char *what) {
  char text[160];
  snprintf(text, sizeof text, "no memory for %s of %u particles; a smaller capacity would do", what,
           s->capacity);
  s->host->set_error(text);
  return PBF_ERROR_OUT_OF_MEMORY;
}

template <class Solver>
static pbf_schedule schedule_of(Solver *s, const pbf_params *params, const pbf_derived *derived,
                                uint32_t colliders, const pbf_collider *list, int overlaps) {
  return pbf_schedule_of(params, derived, &s->basins, colliders, list, s->planned, s->capacity,
                         s->most_left, overlaps, &s->phases, s->accelerations);
}

/* ---- Room for colliders ---------------------------------------------------------------------- */

/* Copies what there is to a larger table. */
template <class Solver>
static void move_table(Solver *s, char *block, uint32_t room) {
  const pbf_collider_table before = s->table;
  const uint32_t count = s->collider_count;
  pbf_place_collider_table(&s->table, &s->basins, block, room, threads_of(s));
  if (before.room) {
    memcpy(s->table.list, before.list, count * sizeof *before.list);
    memcpy(s->table.divided, before.divided, before.room * sizeof *before.divided);
    memcpy(s->table.moving, before.moving, pbf_words_of(before.room) * sizeof *before.moving);
    pbf_memory_free(&s->memory, before.list);
  }
  s->moving_obstacles.more = s->table.moving;
  s->pressure_grid.obstacles.surfaces.all = s->pressure_grid.topology.surfaces = s->table.divided;
  s->pressure_grid.topology.grid = NULL;
}

template <class Solver>
static void drop_table(Solver *s) {
  if (s->table.room) pbf_memory_free(&s->memory, s->table.list);
  s->table = {};
  s->basins.known = 0;
  s->moving_obstacles.more = NULL;
  s->pressure_grid.topology.grid = NULL;
}

/* Loads of more solids than before. */
template <class Solver>
static bool grow_load_tally(Solver *s, uint32_t room) {
  pbf_load_tally *before = s->load_tally;
  if (!before || before->solids >= (int)(PBF_WALLS + room)) return true;
  void *memory = pbf_memory_take(&s->memory, "loads", pbf_load_tally_bytes(room), 1);
  if (!memory) return false;
  memset(memory, 0, pbf_load_tally_bytes(room));
  s->load_tally = static_cast<pbf_load_tally *>(memory);
  pbf_place_load_tally(s->load_tally, room);
  memcpy(s->load_tally->loads, before->loads, (size_t)before->solids * sizeof *before->loads);
  pbf_memory_free(&s->memory, before);
  return true;
}

/* Room for so many colliders, and no less than before: what has been is to be had again. */
template <class Solver>
static bool make_room_for(Solver *s, uint32_t count) {
  const uint32_t room = pbf_collider_room(count);
  if (room <= s->table.room) return true;
  const uint64_t bytes = pbf_collider_table_bytes(room, threads_of(s));
  void *block =
      grow_load_tally(s, room) ? pbf_memory_take(&s->memory, "colliders", bytes, 1) : NULL;
  if (!block) return false;
  memset(block, 0, bytes);
  move_table(s, static_cast<char *>(block), room);
  return true;
}

/* ---- Parameters and colliders ---------------------------------------------------------------- */

/* Takes what a schedule needs before anything else changes: it may fail. Pressures are settled
 * where what they come from is not needed any more: they would be wanted for each particle. */
template <class Solver>
static pbf_status take_schedule(Solver *s, const pbf_schedule *schedule, const pbf_params *params) {
  if (const char *sentence = refusal_of(s, params, schedule)) {
    s->host->set_error(sentence);
    return PBF_ERROR_UNSUPPORTED;
  }
  const bool drops_topology = s->schedule.has_topology && !schedule->has_topology;
  if (!schedule->may_have_grid || drops_topology || !schedule->accelerated) settle_pressures(s);
  if (!keep_arrays(s, *schedule, *params)) {
    keep_arrays(s, s->schedule, s->params);
    return out_of_memory(s, "the arrays of an optional stage");
  }
  return PBF_OK;
}

/* Sleep is in the parameters, which may have changed, and may have been in those before. */
template <class Solver>
static void allow_sleep(Solver *s, int changes, int before) {
  s->sleep = pbf_sleep_of(&s->params);
  s->moving_obstacles =
      pbf_moving_obstacles_of(&s->params, s->collider_count, s->table.list, s->table.moving);
  if (!before) init_new(s, 0);
  if (changes) wake_all(s);
}

template <class Solver>
static pbf_status set_params(Solver *s, const pbf_params *params) {
  pbf_status status =
      pbf_refuse_without(s->host, pbf_features_wanted(params, s->collider_count, s->table.list));
  if (status != PBF_OK) return status;
  pbf_derived derived = s->derived;
  pbf_constants constants = s->constants;
  derive_tables(params, &derived, &constants);
  constants.phases = pbf_phase_constants_of(&s->phases);
  pbf_schedule schedule =
      schedule_of(s, params, &derived, s->collider_count, s->table.list, s->overlaps);
  status = take_schedule(s, &schedule, params);
  if (status != PBF_OK) return status;
  int slept = s->schedule.runs[PBF_STAGE_SLEEP] != 0;
  int changes = !pbf_only_time_step_differs(&s->params, params);
  s->constants = constants;
  s->derived = derived;
  s->params = *params;
  s->schedule = schedule;
  if (!schedule.accelerated) s->pressure_scale = 0;
  if (schedule.runs[PBF_STAGE_SLEEP]) allow_sleep(s, changes, slept);
  return PBF_OK;
}

/* By colliders that do not stay as they are: what it held loses its pressure at once. */
template <class Solver>
static void wake_what_was_held(Solver *s, uint32_t count, const pbf_collider *colliders) {
  const pbf_collider_table *t = &s->table;
  const double elapsed = s->now - s->collider_time;
  pbf_note_still_moving(s->moving_obstacles, s->collider_count, t->list, elapsed, t->still_moving);
  const pbf_moving_obstacles moving =
      pbf_still_moving(s->moving_obstacles, s->collider_count, t->list, elapsed, t->still_moving);
  const pbf_moving_obstacles departing =
      pbf_departing_surfaces(s->collider_count, t->list, count, colliders, moving, t->changed);
  wake_all_if_near(s, departing, s->now);
}

/* Once there is room for them. */
template <class Solver>
static pbf_status replace_colliders(Solver *s, uint32_t count, const pbf_collider *colliders,
                                    double time) {
  pbf_collider_table *t = &s->table;
  pbf_schedule schedule = schedule_of(s, &s->params, &s->derived, count, colliders, s->overlaps);
  pbf_status status = take_schedule(s, &schedule, &s->params);
  if (status != PBF_OK) return status;
  const bool may_sleep = (PBF_BUILT & PBF_FEATURE_SLEEP) && s->schedule.runs[PBF_STAGE_SLEEP] != 0;
  if (may_sleep) wake_what_was_held(s, count, colliders);
  pbf_moving_obstacles come = {0, 0, 0, t->changed};
  if (may_sleep) {
    wake_near_moving(s,
                     pbf_leaving_surfaces(s->collider_count, t->list, count, colliders,
                                          s->moving_obstacles, t->still_moving),
                     s->now);
    come = pbf_coming_surfaces(s->collider_count, t->list, count, colliders, s->moving_obstacles,
                               t->changed);
  }
  settle_for(s, count, colliders);
  if (s->load_tally)
    pbf_forget_loads(s->load_tally, count < s->collider_count ? count : s->collider_count);
  if (count) memcpy(t->list, colliders, count * sizeof *colliders);
  s->collider_count = count;
  s->collider_time = s->now = time;
  s->schedule = schedule;
  s->moving_obstacles = pbf_moving_obstacles_of(&s->params, count, t->list, t->moving);
  if (!may_sleep) return PBF_OK;
  wake_near_moving(s, come, time);
  keep_awake_near(s, pbf_arriving_surfaces(count, come, s->moving_obstacles, t->still_moving),
                  time);
  return PBF_OK;
}

template <class Solver>
static pbf_status set_colliders(Solver *s, uint32_t count, const pbf_collider *colliders,
                                double time) {
  pbf_status status =
      pbf_refuse_without(s->host, pbf_features_wanted(&s->params, count, colliders));
  if (status != PBF_OK) return status;
  if (make_room_for(s, count))
    status = replace_colliders(s, count, colliders, time);
  else
    status = out_of_memory(s, "the colliders");
  if (!s->collider_count) drop_table(s);
  return status;
}

template <class Solver>
static pbf_status set_overlap(Solver *s, const pbf_overlap *overlap) {
  pbf_schedule schedule =
      schedule_of(s, &s->params, &s->derived, s->collider_count, s->table.list, overlap != NULL);
  pbf_status status = take_schedule(s, &schedule, &s->params);
  if (status != PBF_OK) return status;
  s->schedule = schedule;
  s->overlaps = overlap != NULL;
  if (!overlap) return PBF_OK;
  s->found = *overlap;
  s->entering = pbf_entering_of(overlap);
  const uint32_t words = pbf_words_of(s->collider_count);
  if (words <= 1) return PBF_OK;
  memset(s->table.placed, 0, (words - 1) * sizeof *s->table.placed);
  if (overlap->more_colliders)
    memcpy(s->table.placed, overlap->more_colliders, (words - 1) * sizeof *s->table.placed);
  return PBF_OK;
}

/* Once what the schedule goes by has changed: with the arrays of the new one. */
template <class Solver>
static pbf_status renew_schedule(Solver *s) {
  const pbf_schedule schedule =
      schedule_of(s, &s->params, &s->derived, s->collider_count, s->table.list, s->overlaps);
  const pbf_status status = take_schedule(s, &schedule, &s->params);
  if (status == PBF_OK) s->schedule = schedule;
  return status;
}

template <class Solver>
static pbf_status set_phases(Solver *s, const pbf_phase_table *table) {
  const pbf_phase_table before = s->phases, none = {};
  s->phases = table ? *table : none;
  const pbf_status status = renew_schedule(s);
  if (status != PBF_OK) {
    s->phases = before;
    return status;
  }
  s->constants.phases = pbf_phase_constants_of(&s->phases);
  wake_all(s);
  return PBF_OK;
}

template <class Solver>
static pbf_status set_accelerations(Solver *s, uint32_t on) {
  const uint32_t before = s->accelerations;
  s->accelerations = on;
  const pbf_status status = renew_schedule(s);
  if (status == PBF_OK)
    wake_all(s);
  else
    s->accelerations = before;
  return status;
}

/* The arrays are there. */
template <class Solver>
static pbf_status plan_for(Solver *s, uint32_t count) {
  s->planned = count;
  s->schedule =
      schedule_of(s, &s->params, &s->derived, s->collider_count, s->table.list, s->overlaps);
  return PBF_OK;
}

/* That may take memory where the steps are shorter than those before. */
template <class Solver>
static pbf_status plan_steps(Solver *s, double most) {
  const double before = s->most_left;
  s->most_left = most;
  const pbf_status status = renew_schedule(s);
  if (status != PBF_OK) s->most_left = before;
  return status;
}

template <class Solver>
static double steps_leave(Solver *s, double error, double most) {
  return pbf_settled_error(&s->params, &s->basins, s->collider_count, s->table.list, s->planned,
                           &s->phases, error, most);
}

/* A step of no time, without what only steps need. */
template <class Solver>
static bool project_at(Solver *s, double time, uint32_t iterations) {
  const pbf_params params = s->params;
  const pbf_schedule schedule = s->schedule;
  const pbf_constants constants = s->constants;
  const uint32_t ended_after = s->iterations;
  pbf_real *residual_density = s->residual_density;
  settle_pressures(s);
  wake_all(s);
  s->params = pbf_projection_of(&params, iterations);
  pbf_derived derived = s->derived;
  derive_tables(&s->params, &derived, &s->constants);
  s->constants.phases = constants.phases;
  s->schedule = schedule_of(s, &s->params, &derived, s->collider_count, s->table.list, 0);
  s->residual_density = NULL;
  const bool done = step_of_no_time(s, time);
  s->params = params;
  s->schedule = schedule;
  s->constants = constants;
  s->iterations = ended_after;
  s->residual_density = residual_density;
  s->pressure_scale = 0;
  return done;
}

template <class Solver>
static pbf_status max_speed(Solver *s, double *speed) {
  double max2 = 0;
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_vec v = velocity_of(s, i);
    double v2 = 0;
    for (int k = 0; k < PBF_DIM; ++k) v2 += (double)v.c[k] * (double)v.c[k];
    max2 = v2 > max2 ? v2 : max2;
  }
  *speed = sqrt(max2);
  return PBF_OK;
}

template <class Solver>
static pbf_status get_loads(Solver *s, uint32_t first, uint32_t count, pbf_collider_load *loads) {
  pbf_read_loads(s->load_tally, first, count, loads);
  return PBF_OK;
}

/* Steps end before their call does. */
template <class Solver>
static pbf_status synchronize(Solver *) {
  return PBF_OK;
}

template <class Solver>
static void release(Solver *s) {
  pbf_allocator allocator = s->memory.allocator;
  pbf_memory_free_all(&s->memory);
  allocator.release(allocator.user, s, sizeof *s, PBF_ALIGNMENT);
}

#endif
