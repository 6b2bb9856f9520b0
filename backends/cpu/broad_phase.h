/* Which colliders a few particles that lie together can meet. One particle after another would ask
 * all of them in each pass; the others leave it as it is, to the bit. */
#ifndef PBF_CPU_BROAD_PHASE_H
#define PBF_CPU_BROAD_PHASE_H

#include "physics/collide.h"

/* A ball with all of some particles in it, with room for what rounding takes from their distances.
 */
typedef struct group_bounds {
  pbf_vec center;
  pbf_real radius;
  pbf_real way; /* the longest that one of them is on */
} group_bounds;

static const pbf_real bounds_rounding = (pbf_real)1e-5;

PBF_FN group_bounds bounds_between(pbf_vec lower, pbf_vec upper, pbf_real way) {
  group_bounds b = {.way = (1 + bounds_rounding) * way};
  pbf_real diagonal2 = 0, away = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real size = upper.c[k] - lower.c[k];
    b.center.c[k] = lower.c[k] + (pbf_real)0.5 * size;
    away += b.center.c[k] < 0 ? -b.center.c[k] : b.center.c[k];
    diagonal2 += size * size;
  }
  b.radius = (pbf_real)0.5 * pbf_real_sqrt(diagonal2);
  b.radius += bounds_rounding * (b.radius + away);
  return b;
}

/* A distance changes by no more than the way between two places, whatever the shape. */
static __attribute__((noinline)) int bounds_are_within(const group_bounds *of, const pbf_surface *s,
                                                       pbf_real reach) {
  const pbf_vec arm = pbf_sub(of->center, s->center);
  const pbf_real arm2 = pbf_dot(arm, arm), far = s->bound + of->radius + reach;
  pbf_vec normal;
  if (arm2 > far * far) return 0;
  pbf_real rounding = bounds_rounding * pbf_real_sqrt(arm2);
  return !(pbf_surface_distance(s, of->center, &normal) > of->radius + reach + rounding);
}

/* How a surface moves in a step. */
typedef struct surface_motion {
  pbf_real step; /* way of its centre */
  pbf_real turn; /* way of a point over its distance from there, at most */
} surface_motion;

static inline void surface_motions(const pbf_obstacles *o,
                                   surface_motion motions[PBF_MAX_COLLIDERS]) {
  for (int k = 0; k < pbf_surface_count(*o); ++k) {
    const pbf_surface *s = &o->surfaces[k];
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

/* Of a surface that carries them along. */
PBF_FN int bounds_may_meet_moving(const group_bounds *of, const pbf_surface *s,
                                  const surface_motion *motion) {
  pbf_vec arm = pbf_sub(of->center, s->start_center);
  pbf_real moved = motion->step;
  if (motion->turn > 0) moved += motion->turn * (pbf_real_sqrt(pbf_dot(arm, arm)) + of->radius);
  pbf_real far = s->bound + of->radius + of->way + moved;
  return !(pbf_dot(arm, arm) > far * far);
}

/* Whether pbf_resolve_collisions may do anything to them: those without another side look at where
 * particles are, the others at their ways. `motion` null: nothing has moved since these began. */
PBF_FN int bounds_may_meet(const group_bounds *of, const pbf_surface *s,
                           const surface_motion *motion) {
  if (pbf_surface_is_unbounded(s)) return bounds_are_within(of, s, 0);
  return motion ? bounds_may_meet_moving(of, s, motion) : bounds_are_within(of, s, of->way);
}

/* These obstacles without the surfaces that they don't meet; the number of those that are left. */
static inline int collision_candidates(const pbf_obstacles *all, const group_bounds *of,
                                       const surface_motion *motions, pbf_obstacles *candidates) {
  candidates->domain = all->domain;
  candidates->count = 0;
  for (int k = 0; k < pbf_surface_count(*all); ++k)
    if (bounds_may_meet(of, &all->surfaces[k], motions ? &motions[k] : NULL))
      candidates->surfaces[candidates->count++] = all->surfaces[k];
  return candidates->count;
}

/* … or to which they are not as near as that. */
static inline int obstacles_within(const pbf_obstacles *all, const group_bounds *of, pbf_real reach,
                                   pbf_obstacles *near) {
  near->domain = all->domain;
  near->count = 0;
  for (int k = 0; k < pbf_surface_count(*all); ++k)
    if (bounds_are_within(of, &all->surfaces[k], reach))
      near->surfaces[near->count++] = all->surfaces[k];
  return near->count;
}

#endif
