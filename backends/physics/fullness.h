/* Whether a fluid fills the room that walls and containers leave it. Host only, float64. */
#ifndef PBF_PHYSICS_FULLNESS_H
#define PBF_PHYSICS_FULLNESS_H

#include "physics/containers.h"
#include "physics/motion.h"

/* Density, over that at rest, with which the fluid fills all room between the walls, or
 * `min_volume`, that of the smallest container; 1 where there is more. 1.5 % more: no disordered
 * fluid is as even as a lattice, and the mean density of a stirred one is 1.1 to 1.4 % above that
 * of the room. In full tanks, where that pressed all against all, flow was lost to it in no time,
 * or gained a hundred times its energy; with 0.5 % eddies in short steps still stopped. */
static inline double pbf_density_in_volume(const pbf_params *params, uint32_t count,
                                           double min_volume, double time) {
  const double unevenness = 0.015;
  double between = 1, volume = 1, spacing = pbf_derive_spacing(params);
  for (int k = 0; k < PBF_DIM; ++k) {
    double beyond = pbf_is_periodic(params, k) ? 0 : pbf_reach_beyond_walls(params);
    double lower = pbf_motion_wall(params, 2 * k, time) - beyond;
    double upper = pbf_motion_wall(params, 2 * k + 1, time) + beyond;
    between *= fmax(upper - lower, 0);
    volume *= spacing;
  }
  if (params->particle_volume > 0) volume = params->particle_volume;
  double density = (1 + unevenness) * count * volume / fmin(between, min_volume);
  return fmin(fmax(density, 1), 1e6);
}

/* Whether walls and containers, where they have been set, press so many particles on all sides. */
static inline int pbf_is_full(const pbf_params *params, uint32_t colliders,
                              const pbf_collider *list, uint32_t count) {
  const double volume = pbf_containers_volume(params, colliders, list);
  return pbf_density_in_volume(params, count, volume, 0) > 1;
}

#endif
