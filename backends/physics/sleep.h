/* Fluid at rest that sleeps. A fluid that is solved by iteration trembles at rest, so no particle's
 * own speed tells whether the fluid flows. What tells is its activity: the square of the velocity
 * around it, averaged over the neighbours as by XSPH, and then over time. The mean of a square does
 * not pass through 0 where a wave turns back, as a velocity does. */
#ifndef PBF_PHYSICS_SLEEP_H
#define PBF_PHYSICS_SLEEP_H

#include "physics/collide.h"

typedef struct pbf_sleep {
  pbf_real share;           /* of one step in the mean over time */
  pbf_real still2;          /* below this activity a particle falls asleep */
  pbf_real wake_threshold2; /* fluid above it wakes particles near it */
} pbf_sleep;

static inline pbf_sleep pbf_sleep_of(const pbf_params *params) {
  const double wake_neighbors =
      3; /* times as fast as what falls asleep: trembling wakes no neighbour */
  double still2 = params->sleep_speed * params->sleep_speed;
  pbf_sleep s;
  s.share = (pbf_real)fmin(1, params->time_step / params->sleep_time);
  s.still2 = (pbf_real)still2;
  s.wake_threshold2 = (pbf_real)(wake_neighbors * wake_neighbors * still2);
  return s;
}

/* What stands for sleep in place of an activity. Sleepers within h of a particle awake are the
 * boundary of the sleeping fluid: they do not move, yet go on solving for their density,
 * so that the awake find pressure where they come too near to them. The solve begins anew in each
 * step, and so does which particles are the sleeping boundary: from the search of its neighbours
 * until all settle. */
enum { PBF_ASLEEP = -1 };

PBF_FN pbf_real pbf_sleeping_boundary(void) { return (pbf_real)-0.5; }

PBF_FN int pbf_is_asleep(pbf_real activity) { return activity < 0; }

/* Asleep, and out of reach of the awake. */
PBF_FN int pbf_is_inactive(pbf_real activity) { return activity < pbf_sleeping_boundary(); }

/* Of a particle that wakes: it has to come to rest anew, yet does not wake others by itself. */
PBF_FN pbf_real pbf_woken_activity(const pbf_sleep *s) { return s->wake_threshold2; }

/* That is so until its first step is over. In this step the solver corrects the density errors that
 * sleepers have kept: how far it moves them must not become velocity. */
PBF_FN int pbf_just_woke(const pbf_sleep *s, pbf_real activity) {
  return activity == s->wake_threshold2;
}

/* The least of one awake near a collider that has just come to stand. What sleeps near a collider
 * thus says that this has stood for a while, and is not set elsewhere in each step. */
PBF_FN pbf_real pbf_disturbed_activity(const pbf_sleep *s) {
  return (pbf_real)0.875 * s->wake_threshold2;
}

/* Of a particle that comes into being: it also wakes those around it. */
PBF_FN pbf_real pbf_new_activity(const pbf_sleep *s) { return 2 * s->wake_threshold2; }

/* At the end of a step, `around` being the velocity around the particle. */
PBF_FN pbf_real pbf_activity(const pbf_sleep *s, pbf_real activity, pbf_vec around) {
  return activity + s->share * (pbf_dot(around, around) - activity);
}

/* Whether it wakes those around it. */
PBF_FN int pbf_wakes_neighbors(const pbf_sleep *s, pbf_real activity, pbf_vec around) {
  return pbf_real_max(activity, pbf_dot(around, around)) > s->wake_threshold2;
}

/* A particle that is `awakened`, as something near it wakes its neighbours, wakes or stays awake;
 * one that is still falls asleep: no particle awake has an activity below still2 afterwards. */
PBF_FN pbf_real pbf_update_sleep(const pbf_sleep *s, pbf_real activity, int awakened) {
  if (awakened)
    return pbf_is_asleep(activity) ? pbf_woken_activity(s) : pbf_real_max(activity, s->still2);
  return activity < s->still2 ? (pbf_real)PBF_ASLEEP : activity;
}

#endif
