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

/* ---- Walls and colliders that move --------------------------------------------------------- */

/* A bit each. */
typedef struct pbf_movers {
  uint32_t walls;
  uint64_t solids;
} pbf_movers;

static inline pbf_movers pbf_movers_of(const pbf_params *params, uint32_t count,
                                       const pbf_collider *colliders) {
  pbf_movers m = {0, 0};
  for (int w = 0; w < 2 * PBF_DIM; ++w)
    if (params->wall_velocity[w] != 0 ||
        (params->wall_amplitude[w] != 0 && params->wall_frequency[w] != 0))
      m.walls |= 1u << w;
  if (!(PBF_BUILT & PBF_FEATURE_COLLIDERS)) return m;
  for (uint32_t k = 0; k < count; ++k)
    for (int a = 0; a < 3; ++a)
      if (colliders[k].velocity[a] != 0 || colliders[k].angular_velocity[a] != 0)
        m.solids |= UINT64_C(1) << k;
  return m;
}

static inline int pbf_any_moves(pbf_movers m) { return m.walls || m.solids; }

/* Of the colliders `now` and `next`: those that are not the same in both, or move, and so may stand
 * elsewhere. */
static inline pbf_movers pbf_changed(uint32_t count, const pbf_collider *now, uint32_t next_count,
                                     const pbf_collider *next) {
  static const pbf_collider none[1] = {{0}};
  pbf_movers m = {0, 0};
  for (uint32_t k = 0; k < count || k < next_count; ++k) {
    const pbf_collider *a = k < count ? &now[k] : none, *b = k < next_count ? &next[k] : none;
    if (memcmp(a, b, sizeof *a) != 0) m.solids |= UINT64_C(1) << k;
  }
  return m;
}

/* Whether one of them is within `reach` of x. */
PBF_FN int pbf_moves_near(pbf_movers m, const pbf_walls *walls, int count, const pbf_solid *solids,
                          pbf_real reach, pbf_vec x) {
  for (int k = 0; k < PBF_DIM && m.walls; ++k)
    if ((m.walls >> 2 * k & 1 && x.c[k] - walls->lower.c[k] < reach) ||
        (m.walls >> 2 * k & 2 && walls->upper.c[k] - x.c[k] < reach))
      return 1;
  for (int k = 0; k < count && m.solids; ++k) {
    pbf_vec normal;
    if (!(m.solids >> k & 1) || pbf_solid_beyond(&solids[k], x, reach)) continue;
    if (pbf_solid_distance(&solids[k], x, &normal) < reach) return 1;
  }
  return 0;
}

#endif
