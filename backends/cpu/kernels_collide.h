/* Particles and colliders. */
#ifndef PBF_CPU_KERNELS_COLLIDE_H
#define PBF_CPU_KERNELS_COLLIDE_H

#include "cpu/broad_phase.h"

/* Whether a particle meets no collider, where it stands, between `from` and where the domain keeps
 * it: by the balls around those near where it begins. So it is for most, and then none need be
 * asked. */
static inline __attribute__((noinline)) bool is_clear_way(const pbf_obstacles *o, pbf_vec from,
                                                          pbf_vec kept) {
  const pbf_real way = way_along_axes(from, kept);
  const pbf_real stretch = o->grid ? (pbf_real)o->grid->stretch : 1;
  const pbf_obstacles near = pbf_obstacles_near(*o, from, stretch * way);
  const auto on_way = surfaces_on_way_of(near.surfaces, 0, from, way);
  for (int k = 0; k < pbf_surface_count(near); ++k)
    if (on_way.may_meet(near.surfaces[k])) return false;
  return true;
}

/* Large, and in the stage and in the iterations: here once. */
static inline __attribute__((noinline)) pbf_vec resolve_collisions(const pbf_obstacles *o,
                                                                   int with_obstacle_motion,
                                                                   pbf_vec from, pbf_vec x) {
  return pbf_resolve_collisions(*o, with_obstacle_motion, from, x);
}

/* The same between all of many, of which `first` are those that it may meet first. Most particles
 * meet none; for one that does those are looked for to which it may be pushed. */
static inline __attribute__((noinline)) pbf_vec resolve_among_many(const pbf_obstacles *all,
                                                                   const pbf_obstacles *first,
                                                                   int with_obstacle_motion,
                                                                   pbf_vec from, pbf_vec x) {
  const auto surfaces = surface_array_of(first->count, first->surfaces);
  const pbf_vec kept = pbf_keep_before(&all->domain, surfaces, with_obstacle_motion, from, x);
  const auto near =
      surfaces_on_way_of(surfaces, with_obstacle_motion, from, way_along_axes(from, kept));
  if (!pbf_touches_any(near, with_obstacle_motion, from, kept)) return kept;
  pbf_obstacles rest = *all, candidates;
  const group_bounds alone = bounds_of_way(from, x);
  rest.room += all->count; /* `first` lies before it */
  collision_candidates(&rest, &alone, with_obstacle_motion, &candidates);
  return resolve_collisions(&candidates, with_obstacle_motion, from, x);
}

/* Whether these are spread over so many cells that each particle had better look by itself: in the
 * order in which they have been added, or in two rows. */
static inline bool is_spread(const pbf_surface_grid *of, const group_bounds *these) {
  enum { MOST_CELLS = 48 };
  double lower[PBF_DIM], upper[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    lower[k] = (double)these->lower.c[k];
    upper[k] = (double)these->upper.c[k];
  }
  const pbf_cell_range range = pbf_cells_between(of, lower, upper, 0);
  return pbf_cells_in(&range) > MOST_CELLS;
}

static inline __attribute__((noinline)) pbf_vec resolve_alone(const pbf_obstacles *all,
                                                              int with_obstacle_motion,
                                                              pbf_vec from, pbf_vec x) {
  pbf_obstacles candidates;
  const group_bounds alone = bounds_of_way(from, x);
  if (!first_candidates(all, &alone, with_obstacle_motion, &candidates))
    return pbf_keep_in_domain(&all->domain, x);
  return resolve_among_many(all, &candidates, with_obstacle_motion, from, x);
}

namespace {

/* The ways of a group's particles: each_way(resolve) is to call resolve(from, x), which tells where
 * x ends, for one after another. 0: they meet nothing but the domain. */
template <class EachWay>
PBF_FN int resolve_ways(const pbf_obstacles *o, const group_bounds *these, int with_obstacle_motion,
                        EachWay each_way) {
  pbf_obstacles candidates;
  if (o->grid && is_spread(o->grid, these)) {
    each_way(
        [&](pbf_vec from, pbf_vec x) { return resolve_alone(o, with_obstacle_motion, from, x); });
    return 1;
  }
  if (o->grid) {
    if (!first_candidates(o, these, with_obstacle_motion, &candidates)) return 0;
    each_way([&](pbf_vec from, pbf_vec x) {
      return resolve_among_many(o, &candidates, with_obstacle_motion, from, x);
    });
    return 1;
  }
  if (!collision_candidates(o, these, with_obstacle_motion, &candidates)) return 0;
  each_way([&](pbf_vec from, pbf_vec x) {
    return resolve_collisions(&candidates, with_obstacle_motion, from, x);
  });
  return 1;
}

}  // namespace

#endif
