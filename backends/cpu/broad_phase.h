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

/* How far a surface takes one of them along in a step, at most. */
PBF_FN pbf_real way_of_carried(const group_bounds *of, const pbf_surface *s) {
  if (!(s->turn > 0)) return s->step;
  const pbf_vec arm = pbf_sub(of->center, s->start_center);
  return s->step + s->turn * (pbf_real_sqrt(pbf_dot(arm, arm)) + of->radius);
}

/* Of a surface that carries them along, one that is `pushed` so far by others before. */
PBF_FN int bounds_may_meet_moving(const group_bounds *of, const pbf_surface *s, pbf_real pushed) {
  const pbf_vec arm = pbf_sub(of->center, s->start_center);
  const pbf_real far = s->bound + of->radius + of->way + s->skin + way_of_carried(of, s) + pushed;
  return !(pbf_dot(arm, arm) > far * far);
}

/* Whether pbf_resolve_collisions may do anything to them by this surface. Where nothing moves no
 * surface takes a particle farther from where its way begins than the way is long, for there it is
 * before all of them; so none but those as near can push it. */
PBF_FN int bounds_may_meet(const group_bounds *of, const pbf_surface *s, int with_obstacle_motion,
                           pbf_real pushed) {
  if (with_obstacle_motion && !pbf_surface_is_unbounded(s))
    return bounds_may_meet_moving(of, s, pushed);
  return bounds_are_within(of, s, of->way + s->skin + pushed);
}

static inline void collect_candidates(const pbf_obstacles *all, const group_bounds *of,
                                      int with_obstacle_motion, pbf_real pushed,
                                      pbf_obstacles *candidates) {
  candidates->count = 0;
  for (int k = 0; k < pbf_surface_count(*all); ++k)
    if (bounds_may_meet(of, &all->surfaces[k], with_obstacle_motion, pushed))
      candidates->surfaces[candidates->count++] = all->surfaces[k];
}

/* These obstacles without the surfaces that they don't meet; the number of those that are left.
 * What moves pushes by as much, and the particles that it pushes may meet others. */
static inline int collision_candidates(const pbf_obstacles *all, const group_bounds *of,
                                       int with_obstacle_motion, pbf_obstacles *candidates) {
  pbf_real pushed = 0;
  candidates->domain = all->domain;
  collect_candidates(all, of, with_obstacle_motion, 0, candidates);
  for (int k = 0; k < candidates->count && with_obstacle_motion; ++k)
    pushed = pbf_real_max(pushed, way_of_carried(of, &candidates->surfaces[k]));
  if (pushed > 0) collect_candidates(all, of, with_obstacle_motion, pushed, candidates);
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
