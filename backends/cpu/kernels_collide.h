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

#endif
