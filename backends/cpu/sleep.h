/* Which particles fall asleep and which wake (physics/sleep.h): at the end of a step, at the start
 * of one where something moves, and between steps where the caller changes something. */
#ifndef PBF_CPU_SLEEP_H
#define PBF_CPU_SLEEP_H

#include "cpu/lists.h"

/* ---- At the end of a step ------------------------------------------------------------------ */

static void activity_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  const field &around = w->b.mean_velocity();
  range all = task_sorted(w, task);
  uint32_t near_sleep_count = 0;
  memset(awakened(s) + all.first, 0, (all.last - all.first) * sizeof(uint32_t));
  smooth_velocities(w, task, 1, around);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i) {
      pbf_vec v = field_at(&around, i);
      w->activity[i] = pbf_activity(&s->sleep, w->activity[i], v);
      w->b.wakes()[i] = pbf_wakes_neighbors(&s->sleep, w->activity[i], v);
    }
  for (uint32_t i = all.first; i < all.last; ++i) {
    if (!(w->activity[i] < s->sleep.still2)) continue;
    mark_has_sleepers(s, i, 1);
    ++near_sleep_count;
  }
  atomic_fetch_add_explicit(&s->near_sleep_count, near_sleep_count, memory_order_relaxed);
}

/* Where no particle sleeps or is about to, none has to be told of what wakes its neighbours. */
static void wake_neighbors_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range groups = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(s));
  if (atomic_load_explicit(&s->near_sleep_count, memory_order_relaxed) == 0) return;
  for (range g = awake_groups(w, groups.first, groups.last); g.first < g.last;
       g = awake_groups(w, g.last, groups.last))
    s->kernels->wake_neighbors(&pairs, w->b.wakes(), s->has_sleepers, awakened(s), g.first, g.last);
}

static void update_sleep_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = task_sorted(w, task);
  uint32_t sleepers = 0;
  for (uint32_t i = all.first; i < all.last; ++i) {
    w->activity[i] = pbf_update_sleep(&s->sleep, w->activity[i], awakened(s)[i] != 0);
    sleepers += (uint32_t)pbf_is_asleep(w->activity[i]);
    if (i % ACTIVITY_CHUNK == 0 || i == all.first) mark_has_sleepers(s, i, 0);
  }
  zero_sleeping(w, all, w->b.v.c, PBF_DIM);
  atomic_fetch_add_explicit(&s->sleepers, sleepers, memory_order_relaxed);
}

static void end_settling(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  s->asleep = atomic_exchange_explicit(&s->sleepers, 0, memory_order_relaxed);
  if (has_ranks(s)) s->asleep = (uint32_t)sum_of_ranks(s, s->asleep);
  atomic_store_explicit(&s->near_sleep_count, 0, memory_order_relaxed);
  if (s->asleep < particles_of_all(s)) return;
  s->all_asleep_at = w->step;
  atomic_store_explicit(&s->all_asleep, 1, memory_order_release);
}

static void note_still(const worker *w, range others) {
  solver *s = w->s;
  for (uint32_t i = others.first; i < others.last; ++i) {
    awakened(s)[i] = 0;
    if (w->activity[i] < s->sleep.still2) mark_has_sleepers(s, i, 1);
  }
}

/* On ranks: which of the other ranks' particles are still, and whether any particle is. */
static void exchange_still(worker *w) {
  solver *s = w->s;
  const range own = own_places(s), held = held_places(s);
  const uint32_t near_sleep_count =
      atomic_load_explicit(&s->near_sleep_count, memory_order_relaxed);
  s->ranks.sends.count = s->ranks.receives.count = 0;
  add_array(s, w->activity);
  exchange_on_ranks(s);
  note_still(w, (range){held.first, own.first});
  note_still(w, (range){own.last, held.last});
  atomic_store_explicit(&s->near_sleep_count, sum_of_ranks(s, near_sleep_count) > 0,
                        memory_order_relaxed);
}

/* 1 when now all sleep. */
static int update_sleep(worker *w) {
  parallel_for(w->self, pair_task_count(w), activity_task, NULL, w);
  if (has_ranks(w->s)) exchange_still(w);
  parallel_for(w->self, pair_task_count(w), wake_neighbors_task, NULL, w);
  if (has_ranks(w->s)) exchange_marks(w->s, awakened(w->s));
  parallel_for(w->self, pair_task_count(w), update_sleep_task, end_settling, w);
  stage_end(w, PBF_STAGE_SLEEP);
  return atomic_load_explicit(&w->s->all_asleep, memory_order_acquire) &&
         w->s->all_asleep_at == w->step;
}

/* ---- At its start -------------------------------------------------------------------------- */

static bool is_near_moving(const solver *s, const pbf_moving_obstacles &moving,
                           const pbf_obstacles &o, pbf_vec x) {
  const pbf_real h = s->constants.h;
  return pbf_near_moving_obstacle(moving, pbf_obstacles_near(o, x, h), h, x) != 0;
}

static void wake_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = task_particles(w, task);
  for (range r = sleeping_particles(w, all.first, all.last); r.first < r.last;
       r = sleeping_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i)
      if (is_near_moving(s, w->moving_obstacles, w->obstacles, field_at(&w->b.x, i)))
        w->activity[i] = pbf_woken_activity(&s->sleep);
}

/* ---- Between steps ------------------------------------------------------------------------- */

static int sleeps(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_SLEEP) && s->buffers.activity;
}

/* Particles first … count - 1 are new. */
static void init_new(solver *s, uint32_t first) {
  if (!sleeps(s)) return;
  for (uint32_t i = first; i < s->count; ++i) {
    s->buffers.activity[i] = pbf_new_activity(&s->sleep);
    s->buffers.sleeping_lambda[i] = 0;
  }
}

static void wake_all(solver *s) {
  if (!sleeps(s) || !s->asleep) return;
  pbf_real *activity = s->buffers.activity;
  for (uint32_t i = 0; i < s->count; ++i)
    if (pbf_is_asleep(activity[i])) activity[i] = pbf_woken_activity(&s->sleep);
  s->asleep = 0;
}

/* Wakes particles near these colliders as they stand at a time; 1 where there are any. */
static int wake_near_moving(solver *s, pbf_moving_obstacles moving_obstacles, double time) {
  pbf_obstacles obstacles;
  uint32_t before = s->asleep;
  if (!sleeps(s) || !s->asleep || !pbf_any_obstacle_moves(moving_obstacles)) return 0;
  place_obstacles(s, time, &obstacles);
  for (uint32_t i = 0; i < s->count; ++i) {
    pbf_real *activity = &s->buffers.activity[i];
    if (!pbf_is_asleep(*activity) ||
        !is_near_moving(s, moving_obstacles, obstacles, field_at(&s->buffers.x, i)))
      continue;
    *activity = pbf_woken_activity(&s->sleep);
    --s->asleep;
  }
  return s->asleep < before;
}

/* What is awake near these colliders as they stand at a time. */
static void keep_awake_near(solver *s, pbf_moving_obstacles arriving, double time) {
  pbf_obstacles obstacles;
  if (!sleeps(s) || !pbf_any_obstacle_moves(arriving)) return;
  place_obstacles(s, time, &obstacles);
  for (uint32_t i = 0; i < s->count; ++i) {
    pbf_real *activity = &s->buffers.activity[i];
    const pbf_real least = pbf_disturbed_activity(&s->sleep);
    if (pbf_is_asleep(*activity) || *activity >= least ||
        !is_near_moving(s, arriving, obstacles, field_at(&s->buffers.x, i)))
      continue;
    *activity = least;
  }
}

/* Wakes all where any particle sleeps near these colliders as they stand at a time. Other ranks
 * learn of it as soon as all are asked. */
static void wake_all_if_near(solver *s, pbf_moving_obstacles departing, double time) {
  if (!wake_near_moving(s, departing, time)) return;
  if (has_ranks(s))
    s->wakes_ranks = 1;
  else
    wake_all(s);
}

static void wake_ranks(solver *s) {
  if (!sleeps(s)) return;
  if (!on_all_ranks(s, !s->wakes_ranks)) wake_all(s);
  s->wakes_ranks = 0;
}

/* Of all particles, on ranks: where each rank has woken its own. */
static void count_sleepers_of_ranks(solver *s) {
  uint32_t own = 0;
  if (!sleeps(s)) return;
  wake_ranks(s);
  for (uint32_t i = 0; i < s->count; ++i) own += (uint32_t)pbf_is_asleep(s->buffers.activity[i]);
  s->asleep = (uint32_t)sum_of_ranks(s, own);
}

/* Whether it is so on any rank, which then all know. */
static bool wakes_any_near_moving(solver *s, const pbf_moving_obstacles &moving, double time) {
  const bool woken = wake_near_moving(s, moving, time) != 0;
  if (!has_ranks(s)) return woken;
  const uint32_t before = s->asleep + woken;
  count_sleepers_of_ranks(s);
  return s->asleep < before || !on_all_ranks(s, !woken);
}

/* How many of `steps` steps after the first `done` pass with no particle awake, when all sleep. */
static uint32_t steps_asleep(solver *s, const pbf_step_times *times, uint32_t done,
                             uint32_t steps) {
  if (!sleeps(s) || s->asleep < particles_of_all(s)) return 0;
  for (uint32_t k = done; k < done + steps; ++k) {
    const pbf_moving_obstacles moving = moving_obstacles_at(s, pbf_time_after(times, k));
    note_still_moving(s, pbf_time_after(times, k));
    if (!pbf_any_obstacle_moves(moving)) break;
    if (wakes_any_near_moving(s, moving, pbf_time_after(times, k + 1))) return k - done;
  }
  return steps;
}

#endif
