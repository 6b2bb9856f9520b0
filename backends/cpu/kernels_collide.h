/* Particles and colliders. */
#ifndef PBF_CPU_KERNELS_COLLIDE_H
#define PBF_CPU_KERNELS_COLLIDE_H

#include "cpu/kernels.h"
#include "cpu/near_solids.h"

/* Large, and in the stage and in the iterations: here once. */
static __attribute__((noinline)) pbf_vec resolve(const pbf_obstacles *o, int carried, pbf_vec from,
                                                 pbf_vec x) {
  return pbf_resolve(&o->walls, pbf_solid_count(o), o->solids, carried, from, x);
}

#endif
