/* Fluid at rest that sleeps. A fluid that is solved by iteration trembles at rest, so no particle's
 * own speed tells whether the fluid flows. What tells is its unrest: the square of the velocity
 * around it, averaged over the neighbours as by XSPH, and then over time. The mean of a square does
 * not pass through 0 where a wave turns back, as a velocity does. */
#ifndef PBF_PHYSICS_SLEEP_H
#define PBF_PHYSICS_SLEEP_H

#include "physics/collide.h"

typedef struct pbf_sleep {
  pbf_real share;  /* of one step in the mean over time */
  pbf_real still2; /* below this unrest a particle falls asleep */
  pbf_real stir2;  /* fluid above it wakes who is near */
} pbf_sleep;

static inline pbf_sleep pbf_sleep_of(const pbf_params *params) {
  const double stir =
      3; /* times as fast as what falls asleep: nobody wakes of trembling near him */
  double still2 = params->sleep_speed * params->sleep_speed;
  pbf_sleep s;
  s.share = (pbf_real)fmin(1, params->time_step / params->sleep_time);
  s.still2 = (pbf_real)still2;
  s.stir2 = (pbf_real)(stir * stir * still2);
  return s;
}

/* What stands for sleep in place of an unrest. Sleepers within h of somebody awake are the shore of
 * the sleeping fluid: they do not move, yet go on solving for their density, so that the awake find
 * pressure where they come too near to them. The solve begins anew in each step, and so does who is
 * the shore: from the search of its neighbours until all settle. */
enum { PBF_ASLEEP = -1 };

PBF_FN pbf_real pbf_shore(void) { return (pbf_real)-0.5; }

PBF_FN int pbf_is_asleep(pbf_real unrest) { return unrest < 0; }

/* Who sleeps out of reach of the awake. */
PBF_FN int pbf_is_idle(pbf_real unrest) { return unrest < pbf_shore(); }

/* Of a particle that wakes: it has to come to rest anew, yet does not wake others by itself. */
PBF_FN pbf_real pbf_woken(const pbf_sleep *s) { return s->stir2; }

/* That is so until its first step is over. In this the solver makes up for what the places of all
 * that slept lack by its own lights: what it moves them must not become velocity. */
PBF_FN int pbf_just_woke(const pbf_sleep *s, pbf_real unrest) { return unrest == s->stir2; }

/* Of a particle that comes into being: it also wakes those around it. */
PBF_FN pbf_real pbf_newcomer(const pbf_sleep *s) { return 2 * s->stir2; }

/* At the end of a step, `around` being the velocity around the particle. */
PBF_FN pbf_real pbf_unrest(const pbf_sleep *s, pbf_real unrest, pbf_vec around) {
  return unrest + s->share * (pbf_dot(around, around) - unrest);
}

/* Whether it wakes those around it. */
PBF_FN int pbf_stirs(const pbf_sleep *s, pbf_real unrest, pbf_vec around) {
  return pbf_real_max(unrest, pbf_dot(around, around)) > s->stir2;
}

/* What is `stirred`, something near it stirs, wakes or stays awake; what is still falls asleep: the
 * unrest of nobody awake is below still2. */
PBF_FN pbf_real pbf_settle(const pbf_sleep *s, pbf_real unrest, int stirred) {
  if (stirred) return pbf_is_asleep(unrest) ? pbf_woken(s) : pbf_real_max(unrest, s->still2);
  return unrest < s->still2 ? (pbf_real)PBF_ASLEEP : unrest;
}

#endif
