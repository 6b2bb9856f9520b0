/* Which colliders a few particles that lie together can meet. One particle after another would ask
 * all of them in each pass; the others leave it as it is, to the bit. */
#ifndef PBF_CPU_BROAD_PHASE_H
#define PBF_CPU_BROAD_PHASE_H

#include "physics/collide.h"

/* A ball with all of some particles in it, and a box, with room for what rounding takes from their
 * distances. */
typedef struct group_bounds {
  pbf_vec center, lower, upper;
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
  const pbf_real rounding = bounds_rounding * (b.radius + away);
  b.radius += rounding;
  for (int k = 0; k < PBF_DIM; ++k) {
    b.lower.c[k] = lower.c[k] - rounding;
    b.upper.c[k] = upper.c[k] + rounding;
  }
  return b;
}

/* A distance changes by no more than `steepest` times the way between two places, whatever the
 * shape. */
static __attribute__((noinline)) int bounds_are_within(const group_bounds *of, const pbf_surface *s,
                                                       pbf_real reach) {
  const pbf_vec arm = pbf_sub(of->center, s->center);
  const pbf_real arm2 = pbf_dot(arm, arm), far = s->bound + of->radius + reach;
  pbf_vec normal;
  if (arm2 > far * far) return 0;
  pbf_real rounding = bounds_rounding * pbf_real_sqrt(arm2);
  return !(pbf_surface_distance(s, of->center, &normal) >
           s->steepest * (of->radius + reach) + rounding);
}

/* How far a surface takes one of them along in a step, at most. */
PBF_FN pbf_real way_of_carried(const group_bounds *of, const pbf_surface *s) {
  if (!(s->turn > 0)) return s->step;
  const pbf_vec arm = pbf_sub(of->center, s->start_center);
  return s->step + s->turn * (pbf_real_sqrt(pbf_dot(arm, arm)) + of->radius);
}

/* How far a surface may push one of them that it finds inside. */
PBF_FN pbf_real way_pushed(const group_bounds *of, const pbf_surface *s, pbf_real push) {
  pbf_vec normal;
  if (!(push > 0)) return 0;
  const pbf_real depth = s->steepest * of->radius - pbf_surface_distance(s, of->center, &normal);
  return depth > 0 ? pbf_real_min(push, depth + s->skin) : 0;
}

/* How far the domain may push one of them that is outside. */
PBF_FN pbf_real way_into_domain(const group_bounds *of, const pbf_domain *domain) {
  pbf_real way2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real below = domain->lower.c[k] - (of->center.c[k] - of->radius);
    const pbf_real above = of->center.c[k] + of->radius - domain->upper.c[k];
    const pbf_real way = pbf_real_max(pbf_real_max(below, above), 0);
    way2 += way * way;
  }
  return pbf_real_sqrt(way2);
}

/* Of a surface that carries them along, `reach` being how far they get by themselves. */
PBF_FN int bounds_may_meet_moving(const group_bounds *of, const pbf_surface *s, pbf_real reach) {
  const pbf_vec arm = pbf_sub(of->center, s->start_center);
  const pbf_real far = s->bound + of->radius + reach + way_of_carried(of, s);
  return !(pbf_dot(arm, arm) > far * far);
}

/* Whether pbf_resolve_collisions may do anything to them by this surface, or ask about it: at twice
 * the skin it asks what particles are between. */
PBF_FN int bounds_may_meet(const group_bounds *of, const pbf_surface *s, int with_obstacle_motion,
                           pbf_real pushed) {
  const pbf_real reach = of->way + 2 * s->skin + pushed;
  if (with_obstacle_motion && !pbf_surface_is_unbounded(s))
    return bounds_may_meet_moving(of, s, reach);
  return bounds_are_within(of, s, reach);
}

namespace {

/* Those of some obstacles of which is_met(surface) is true, in the room for them. */
template <class IsMet>
PBF_FN void collect_surfaces(const pbf_obstacles &from, uint16_t *room, IsMet is_met,
                             pbf_obstacles *found) {
  found->count = 0;
  found->surfaces = {from.surfaces.all, room};
  for (int k = 0; k < pbf_surface_count(from); ++k)
    if (is_met(&from.surfaces[k])) room[found->count++] = (uint16_t)from.surfaces.number(k);
}

}  // namespace

static inline void collect_candidates(const pbf_obstacles *all, const group_bounds *of,
                                      int with_obstacle_motion, pbf_real pushed,
                                      pbf_obstacles *candidates) {
  const pbf_real stretch = all->grid ? (pbf_real)all->grid->stretch : 1;
  const pbf_obstacles around =
      pbf_obstacles_around(*all, of->lower, of->upper, stretch * (of->way + pushed));
  collect_surfaces(
      around, all->room,
      [&](const pbf_surface *s) { return bounds_may_meet(of, s, with_obstacle_motion, pushed); },
      candidates);
}

/* How far what has no other side, and the domain, push one of them before others are asked. */
PBF_FN pbf_real way_kept_before(const pbf_obstacles *o, const group_bounds *of,
                                int with_obstacle_motion) {
  pbf_real pushed = way_into_domain(of, &o->domain);
  for (int k = 0; k < o->count; ++k) {
    const pbf_surface *s = &o->surfaces[k];
    if (!pbf_surface_is_unbounded(s)) continue;
    pushed += way_pushed(of, s, INFINITY) + (with_obstacle_motion ? way_of_carried(of, s) : 0);
  }
  return pushed;
}

/* How far these and the domain push one of them: where it goes first, one after another; and then
 * from each other, by twice the longest of these ways (pbf_resolve_contacts). */
PBF_FN pbf_real way_pushed_by_all(const pbf_obstacles *o, const group_bounds *of,
                                  int with_obstacle_motion) {
  pbf_real pushed = way_into_domain(of, &o->domain), longest = pushed;
  for (int k = 0; k < o->count; ++k) {
    const pbf_surface *s = &o->surfaces[k];
    const pbf_real way = way_pushed(of, s, pbf_push_of(s, with_obstacle_motion)) +
                         (with_obstacle_motion ? way_of_carried(of, s) : 0);
    pushed += way;
    longest = pbf_real_max(longest, way);
  }
  return pushed + 2 * longest;
}

namespace {

/* The surfaces that they meet where those that they meet push them as far as way(candidates) says;
 * the number. */
template <class Way>
PBF_FN int closed_candidates(const pbf_obstacles *all, const group_bounds *of,
                             int with_obstacle_motion, pbf_obstacles *candidates, Way way) {
  pbf_real pushed = 0;
  *candidates = *all;
  for (int found = -1; pushed < INFINITY;) {
    collect_candidates(all, of, with_obstacle_motion, pushed, candidates);
    if (candidates->count == found || candidates->count == pbf_surface_count(*all)) break;
    found = candidates->count;
    pushed = way(candidates);
    if (!(pushed > 0)) break;
  }
  return candidates->count;
}

}  // namespace

/* These obstacles without the surfaces that they don't meet; the number of those that are left.
 * What a surface does not find inside, and does not carry along, it leaves no farther from where
 * its way begins than the way is long. Others may be met where such a push takes a particle, and
 * push in turn. */
static inline __attribute__((noinline)) int collision_candidates(const pbf_obstacles *all,
                                                                 const group_bounds *of,
                                                                 int with_obstacle_motion,
                                                                 pbf_obstacles *candidates) {
  return closed_candidates(all, of, with_obstacle_motion, candidates, [&](const pbf_obstacles *o) {
    return way_pushed_by_all(o, of, with_obstacle_motion);
  });
}

/* Without those that can't be the first to meet one of them, which are many fewer where colliders
 * are many: each would push them on to others. */
static inline __attribute__((noinline)) int first_candidates(const pbf_obstacles *all,
                                                             const group_bounds *of,
                                                             int with_obstacle_motion,
                                                             pbf_obstacles *candidates) {
  return closed_candidates(all, of, with_obstacle_motion, candidates, [&](const pbf_obstacles *o) {
    return way_kept_before(o, of, with_obstacle_motion);
  });
}

PBF_FN group_bounds bounds_of_way(pbf_vec from, pbf_vec x) {
  pbf_vec lower = x, upper = x;
  const pbf_vec way = pbf_sub(x, from);
  for (int k = 0; k < PBF_DIM; ++k) {
    lower.c[k] = pbf_real_min(x.c[k], from.c[k]);
    upper.c[k] = pbf_real_max(x.c[k], from.c[k]);
  }
  return bounds_between(lower, upper, pbf_real_sqrt(pbf_dot(way, way)));
}

/* … or to which they are not as near as that. */
static inline int obstacles_within(const pbf_obstacles *all, const group_bounds *of, pbf_real reach,
                                   pbf_obstacles *near) {
  *near = *all;
  collect_surfaces(
      pbf_obstacles_around(*all, of->lower, of->upper, reach), all->room,
      [&](const pbf_surface *s) { return bounds_are_within(of, s, reach); }, near);
  return near->count;
}

#endif
