/* Which particles fall asleep and which wake: physics/sleep.h. */
#ifndef PBF_REFERENCE_SLEEP_H
#define PBF_REFERENCE_SLEEP_H

#include "physics/passes/viscosity.h"
#include "reference/driver.h"

/* To such a part of the solver's table; every particle asks all of them. */
static inline pbf_obstacles obstacles_at(const solver *s, double time, pbf_surface *surfaces) {
  pbf_obstacles o;
  pbf_place_obstacles(&s->params, s->collider_count, s->table.list, s->collider_time, time,
                      s->schedule.close_phases, surfaces, &o);
  o.room = s->table.numbers;
  return o;
}

static inline pbf_obstacles obstacles_at(const solver *s, double time) {
  return obstacles_at(s, time, s->table.surfaces);
}

static inline int sleeps(const solver *s) { return (PBF_BUILT & PBF_FEATURE_SLEEP) && s->activity; }

static inline int asleep(const solver *s, uint32_t i) {
  return sleeps(s) && pbf_is_asleep(s->activity[i]);
}

static inline int inactive(const solver *s, uint32_t i) {
  return sleeps(s) && pbf_is_inactive(s->activity[i]);
}

static inline int just_woke(const solver *s, uint32_t i) {
  return sleeps(s) && pbf_just_woke(&s->sleep, s->activity[i]);
}

static inline uint32_t sleepers(const solver *s) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < s->count; ++i) count += (uint32_t)asleep(s, i);
  return count;
}

/* Sleepers within h of a particle awake, once all are predicted. */
static inline void find_sleeping_boundary(solver *s) {
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    neighbor n = neighbors_of(&s->grid, i);
    while (next_neighbor(&s->grid, s->moved, s->constants.h2, &n))
      if (asleep(s, n.j)) s->activity[n.j] = pbf_sleeping_boundary();
  }
}

/* v_i and what eq. 17 adds to it. */
static inline pbf_vec smoothed_velocity(const solver *s, pbf_real viscosity, uint32_t i) {
  const viscosity_pass<int> pass = {&s->constants, s->schedule.features};
  return pass.finish(sums_around(s, pass, s->moved, {NULL, s->v}, {lanes_of(s->v[i])}, i),
                     viscosity, s->v[i]);
}

static inline void wake_around(solver *s, uint32_t i) {
  neighbor n = neighbors_of(&s->grid, i);
  while (next_neighbor(&s->grid, s->moved, s->constants.h2, &n)) s->awakened[n.j] = 1;
}

/* At the end of a step. */
static inline void update_sleep(solver *s) {
  memset(s->awakened, 0, s->count);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    pbf_vec around = smoothed_velocity(s, 1, i);
    s->activity[i] = pbf_activity(&s->sleep, s->activity[i], around);
    if (pbf_wakes_neighbors(&s->sleep, s->activity[i], around)) wake_around(s, i);
  }
  for (uint32_t i = 0; i < s->count; ++i) {
    s->activity[i] = pbf_update_sleep(&s->sleep, s->activity[i], s->awakened[i]);
    if (asleep(s, i)) memset(&s->v[i], 0, sizeof s->v[i]);
  }
}

/* Those that move in the step that begins at a time. */
static inline pbf_moving_obstacles moving_obstacles_at(const solver *s, double time) {
  const double elapsed = time - s->collider_time;
  pbf_note_still_moving(s->moving_obstacles, s->collider_count, s->table.list, elapsed,
                        s->table.still_moving);
  return pbf_still_moving(s->moving_obstacles, s->collider_count, s->table.list, elapsed,
                          s->table.still_moving);
}

/* Wakes what is near solids that move, or have been moved, as they stand at a time; whether any
 * particle slept there. */
static inline bool wakes_any_near_moving(solver *s, pbf_moving_obstacles moving_obstacles,
                                         double time) {
  bool any = false;
  if (!sleeps(s) || !pbf_any_obstacle_moves(moving_obstacles)) return false;
  pbf_obstacles obstacles = obstacles_at(s, time);
  for (uint32_t i = 0; i < s->count; ++i)
    if (asleep(s, i) &&
        pbf_near_moving_obstacle(moving_obstacles, obstacles, s->constants.h, s->x[i])) {
      s->activity[i] = pbf_woken_activity(&s->sleep);
      any = true;
    }
  return any;
}

static inline void wake_near_moving(solver *s, pbf_moving_obstacles moving_obstacles, double time) {
  wakes_any_near_moving(s, moving_obstacles, time);
}

/* What is awake near these colliders as they stand at a time. */
static inline void keep_awake_near(solver *s, pbf_moving_obstacles arriving, double time) {
  if (!sleeps(s) || !pbf_any_obstacle_moves(arriving)) return;
  pbf_obstacles obstacles = obstacles_at(s, time);
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i) && pbf_near_moving_obstacle(arriving, obstacles, s->constants.h, s->x[i]))
      s->activity[i] = pbf_real_max(s->activity[i], pbf_disturbed_activity(&s->sleep));
}

/* ---- Between steps ------------------------------------------------------------------------- */

/* Particles first … count - 1 are new. */
static inline void init_new(solver *s, uint32_t first) {
  for (uint32_t i = first; i < s->count && sleeps(s); ++i) {
    s->activity[i] = pbf_new_activity(&s->sleep);
    s->held[i] = 0;
  }
}

static inline void wake_all(solver *s) {
  for (uint32_t i = 0; i < s->count; ++i)
    if (asleep(s, i)) s->activity[i] = pbf_woken_activity(&s->sleep);
}

/* Where any particle sleeps near these colliders as they stand at a time. */
static inline void wake_all_if_near(solver *s, pbf_moving_obstacles departing, double time) {
  if (wakes_any_near_moving(s, departing, time)) wake_all(s);
}

/* The activity and the lambda of each. */
static inline void read_rest(const solver *s, const pbf_rows *rows, pbf_real *out) {
  for (uint32_t k = 0; k < rows->count && sleeps(s); ++k) {
    out[2 * k] = s->activity[rows->first + k];
    out[2 * k + 1] = s->held[rows->first + k];
  }
}

static inline void write_rest(solver *s, const pbf_rows *rows, const pbf_real *in) {
  for (uint32_t k = 0; k < rows->count && sleeps(s); ++k) {
    s->activity[rows->first + k] = in[2 * k];
    s->held[rows->first + k] = s->lambda[rows->first + k] = in[2 * k + 1];
  }
}

#endif
