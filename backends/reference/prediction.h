/* Part of step.h: where particles go without the solve, and what they meet on the way. */
#ifndef PBF_REFERENCE_PREDICTION_H
#define PBF_REFERENCE_PREDICTION_H

#include "physics/passes/predict.h"
#include "physics/passes/velocity.h"
#include "reference/loads.h"
#include "reference/sleep.h"

/* Particles on their way from `from` to x*; from before the obstacles moved where
 * `with_obstacle_motion`. */
static inline void collide_all(const solver *s, const pbf_obstacles *o, int with_obstacle_motion,
                               const pbf_vec *from) {
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i))
      s->moved[i] = pbf_resolve_collisions(*o, with_obstacle_motion, from[i], s->moved[i]);
}

/* And once the velocity is that of x*. */
static inline void collide_one(const solver *s, const pbf_obstacles *o, pbf_vec from, uint32_t i) {
  const pbf_vec x = pbf_resolve_collisions(*o, 0, from, s->moved[i]), before = s->v[i];
  s->v[i] = pbf_velocity((pbf_real)pbf_per_time_step(&s->params), before, s->moved[i], x);
  s->moved[i] = x;
  note_push(s, i, pbf_sub(s->v[i], before));
}

static inline void collide_moving(const solver *s, const pbf_obstacles *o) {
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i)) collide_one(s, o, s->predicted[i], i);
}

/* A step that leaves the domain by a face begins an image away. */
static inline void begin_inside(solver *s) {
  const pbf_periods periods = pbf_periods_of(&s->params);
  for (uint32_t i = 0; i < s->count && periods.any; ++i) {
    const pbf_vec left = s->predicted[i];
    s->moved[i] = s->predicted[i] = pbf_image_inside(&periods, left);
    s->x[i] = pbf_add_scaled(s->x[i], 1, pbf_sub(s->predicted[i], left));
  }
}

static inline void accelerate(solver *s, const pbf_forces *forces) {
  for (uint32_t i = 0; i < s->count && s->acceleration; ++i)
    if (!asleep(s, i)) s->v[i] = pbf_add_acceleration(forces, s->v[i], s->acceleration[i]);
}

static inline void predict(solver *s, double time, const pbf_obstacles *o) {
  pbf_forces forces = pbf_forces_of(&s->params, time);
  accelerate(s, &forces);
  for (uint32_t i = 0; i < s->count; ++i)
    s->moved[i] = asleep(s, i) ? s->x[i] : pbf_predict(&forces, s->x[i], s->v[i]);
  if (s->schedule.collide_after_prediction) collide_all(s, o, 1, s->x);
  begin_loads(s);
  for (uint32_t i = 0; i < s->count; ++i) {
    s->predicted[i] = s->moved[i];
    if (asleep(s, i)) continue;
    pbf_vec free = pbf_predict(&forces, s->x[i], s->v[i]);
    const pbf_vec forced = pbf_apply_forces(&forces, s->x[i], s->v[i]);
    s->v[i] = pbf_predicted_velocity(&forces, s->x[i], s->v[i], free, s->predicted[i]);
    begin_push(s, &forces, i, forced);
  }
  begin_inside(s);
}

/* Changes velocities, and moves particles by that. */
static inline void change_velocities(solver *s, const pbf_obstacles *o, const pbf_vec *change) {
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    const pbf_vec from = s->moved[i];
    s->v[i] = pbf_add_scaled(s->v[i], 1, change[i]);
    s->moved[i] = pbf_add_scaled(from, (pbf_real)s->params.time_step, change[i]);
    collide_one(s, o, from, i);
  }
}

#endif
