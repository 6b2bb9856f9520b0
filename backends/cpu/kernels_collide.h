/* Particles and colliders. */
#ifndef PBF_CPU_KERNELS_COLLIDE_H
#define PBF_CPU_KERNELS_COLLIDE_H

#include "cpu/kernels.h"
#include "cpu/broad_phase.h"

/* Large, and in the stage and in the iterations: here once. */
static __attribute__((noinline)) pbf_vec resolve_collisions(const pbf_obstacles *o,
                                                            int with_obstacle_motion, pbf_vec from,
                                                            pbf_vec x) {
  return pbf_resolve_collisions(*o, with_obstacle_motion, from, x);
}

/* `met` are those of `all` that its group can meet on its way. A particle that one of them pushes
 * off it may meet others. */
PBF_FN pbf_vec resolve_candidates(const pbf_obstacles *all, const pbf_obstacles *candidates,
                                  int with_obstacle_motion, pbf_vec from, pbf_vec x) {
  pbf_vec after = resolve_collisions(candidates, with_obstacle_motion, from, x),
          kept = pbf_keep_in_domain(&all->domain, x);
  int pushed = 0;
  for (int k = 0; k < PBF_DIM; ++k) pushed |= after.c[k] != kept.c[k];
  return pushed && candidates->count < all->count
             ? resolve_collisions(all, with_obstacle_motion, from, x)
             : after;
}

#endif
