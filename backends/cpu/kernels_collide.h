/* Particles and colliders. */
#ifndef PBF_CPU_KERNELS_COLLIDE_H
#define PBF_CPU_KERNELS_COLLIDE_H

#include "cpu/kernels.h"
#include "cpu/near_solids.h"

/* Large, and in the stage and in the iterations: here once. */
static __attribute__((noinline)) pbf_vec resolve(const pbf_obstacles *o, int carried, pbf_vec from,
                                                 pbf_vec x) {
  return pbf_resolve(*o, carried, from, x);
}

/* `met` are those of `all` that its group can meet on its way. Whom one of them pushes off it may
 * meet others. */
PBF_FN pbf_vec resolve_met(const pbf_obstacles *all, const pbf_obstacles *met, int carried,
                           pbf_vec from, pbf_vec x) {
  pbf_vec after = resolve(met, carried, from, x), kept = pbf_clamp(&all->walls, x);
  int pushed = 0;
  for (int k = 0; k < PBF_DIM; ++k) pushed |= after.c[k] != kept.c[k];
  return pushed && met->count < all->count ? resolve(all, carried, from, x) : after;
}

#endif
