/* Which colliders a few particles that lie together can meet. One particle after another would ask
 * all of them in each pass; the others leave it as it is, to the bit. */
#ifndef PBF_CPU_NEAR_SOLIDS_H
#define PBF_CPU_NEAR_SOLIDS_H

#include "physics/collide.h"

/* A ball with all of some particles in it, with room for what rounding takes from their distances.
 */
typedef struct swarm {
  pbf_vec center;
  pbf_real radius;
  pbf_real way; /* the longest that one of them is on */
} swarm;

static const pbf_real swarm_rounding = (pbf_real)1e-5;

PBF_FN swarm swarm_between(pbf_vec lower, pbf_vec upper, pbf_real way) {
  swarm s = {.way = (1 + swarm_rounding) * way};
  pbf_real diagonal2 = 0, away = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real size = upper.c[k] - lower.c[k];
    s.center.c[k] = lower.c[k] + (pbf_real)0.5 * size;
    away += s.center.c[k] < 0 ? -s.center.c[k] : s.center.c[k];
    diagonal2 += size * size;
  }
  s.radius = (pbf_real)0.5 * pbf_real_sqrt(diagonal2);
  s.radius += swarm_rounding * (s.radius + away);
  return s;
}

/* A distance changes by no more than the way between two places, whatever the shape. */
static __attribute__((noinline)) int swarm_is_within(const swarm *of, const pbf_solid *s,
                                                     pbf_real reach) {
  const pbf_vec arm = pbf_sub(of->center, s->center);
  const pbf_real arm2 = pbf_dot(arm, arm), far = s->bound + of->radius + reach;
  pbf_vec normal;
  if (arm2 > far * far) return 0;
  pbf_real rounding = swarm_rounding * pbf_real_sqrt(arm2);
  return !(pbf_solid_distance(s, of->center, &normal) > of->radius + reach + rounding);
}

/* How a solid moves in a step. */
typedef struct solid_motion {
  pbf_real step; /* way of its centre */
  pbf_real turn; /* way of a point over its distance from there, at most */
} solid_motion;

static inline void solid_motions(const pbf_obstacles *o, solid_motion motions[PBF_MAX_COLLIDERS]) {
  for (int k = 0; k < pbf_solid_count(*o); ++k) {
    const pbf_solid *s = &o->solids[k];
    pbf_vec step = pbf_sub(s->center, s->start_center);
    pbf_real turn2 = 0;
    for (int row = 0; row < PBF_DIM; ++row) {
      pbf_vec turned = pbf_sub(s->frame[row], s->start_frame[row]);
      turn2 += pbf_dot(turned, turned);
    }
    motions[k].step = pbf_real_sqrt(pbf_dot(step, step));
    motions[k].turn = pbf_real_sqrt(turn2);
  }
}

/* Of a solid that carries them along. */
PBF_FN int swarm_meets_moving(const swarm *of, const pbf_solid *s, const solid_motion *motion) {
  pbf_vec arm = pbf_sub(of->center, s->start_center);
  pbf_real carried = motion->step;
  if (motion->turn > 0) carried += motion->turn * (pbf_real_sqrt(pbf_dot(arm, arm)) + of->radius);
  pbf_real far = s->bound + of->radius + of->way + carried;
  return !(pbf_dot(arm, arm) > far * far);
}

/* Whether pbf_resolve may do anything to them: those without another side look at where particles
 * are, the others at their ways. `motion` null: nothing has moved since these began. */
PBF_FN int swarm_meets(const swarm *of, const pbf_solid *s, const solid_motion *motion) {
  if (s->bound == (pbf_real)INFINITY) return swarm_is_within(of, s, 0);
  return motion ? swarm_meets_moving(of, s, motion) : swarm_is_within(of, s, of->way);
}

/* These obstacles without the solids that they don't meet; the number of those that are left. */
static inline int obstacles_on_way(const pbf_obstacles *all, const swarm *of,
                                   const solid_motion *motions, pbf_obstacles *met) {
  met->walls = all->walls;
  met->count = 0;
  for (int k = 0; k < pbf_solid_count(*all); ++k)
    if (swarm_meets(of, &all->solids[k], motions ? &motions[k] : NULL))
      met->solids[met->count++] = all->solids[k];
  return met->count;
}

/* … or to which they are not as near as that. */
static inline int obstacles_within(const pbf_obstacles *all, const swarm *of, pbf_real reach,
                                   pbf_obstacles *near) {
  near->walls = all->walls;
  near->count = 0;
  for (int k = 0; k < pbf_solid_count(*all); ++k)
    if (swarm_is_within(of, &all->solids[k], reach)) near->solids[near->count++] = all->solids[k];
  return near->count;
}

#endif
