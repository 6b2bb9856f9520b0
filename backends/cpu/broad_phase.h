/* Which colliders a few particles that lie together can meet. One particle after another would ask
 * all of them in each pass; the others leave it as it is, to the bit. */
#ifndef PBF_CPU_BROAD_PHASE_H
#define PBF_CPU_BROAD_PHASE_H

#include "physics/bounds.h"

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
    return way_pushed_by_all(&o->domain, surface_array_of(o->count, o->surfaces), of,
                             with_obstacle_motion);
  });
}

/* Without those that can't be the first to meet one of them, which are many fewer where colliders
 * are many: each would push them on to others. */
static inline __attribute__((noinline)) int first_candidates(const pbf_obstacles *all,
                                                             const group_bounds *of,
                                                             int with_obstacle_motion,
                                                             pbf_obstacles *candidates) {
  return closed_candidates(all, of, with_obstacle_motion, candidates, [&](const pbf_obstacles *o) {
    return way_kept_before(&o->domain, surface_array_of(o->count, o->surfaces), of,
                           with_obstacle_motion);
  });
}

/* Without those that are farther from them all than that, by the balls around both, if there is
 * one.
 */
static inline int obstacles_around_group(const pbf_obstacles *all, const group_bounds *of,
                                         pbf_real reach, pbf_obstacles *near) {
  *near = *all;
  collect_surfaces(
      pbf_obstacles_around(*all, of->lower, of->upper, reach), all->room,
      [&](const pbf_surface *s) {
        return pbf_surface_is_unbounded(s)
                   ? bounds_are_within(of, s, reach)
                   : !pbf_surface_is_beyond(s, of->center, of->radius + reach);
      },
      near);
  return near->count;
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
