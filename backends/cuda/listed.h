/* Part of obstacles.h: walls and colliders of a step; and, where there are more than a set has bits
 * for, which are near a place. Behind those lies the grid that CPUs ask, too, and that the host has
 * built (physics/surfaces/near.h). */
#ifndef PBF_CUDA_LISTED_H
#define PBF_CUDA_LISTED_H

#include "pbf/pbf.h"
#include "physics/boundary.h"
#include "physics/listed.h"

/* Walls and colliders of one step; `surfaces` is on the device, and so is what lies behind them if
 * they are many. */
struct step_obstacles {
  pbf_domain domain;
  int count;
  const pbf_surface *surfaces;
};

/* Some of them, by their numbers. */
struct listed_obstacles {
  const pbf_domain &domain;
  int count;
  pbf_surface_list surfaces;
};

static __device__ __forceinline__ const pbf_surface_grid *grid_behind(const step_obstacles &o) {
  return reinterpret_cast<const pbf_surface_grid *>(o.surfaces + o.count);
}

/* Those that may be within `reach` of x: all, where the grid's lists do not reach so far. */
static __device__ __forceinline__ listed_obstacles listed_near(const step_obstacles &o, pbf_vec x,
                                                               double reach) {
  const pbf_surface_grid *grid = grid_behind(o);
  if (reach > grid->reach) return {o.domain, o.count, {o.surfaces, nullptr}};
  const uint16_t *numbers;
  const int count = (int)pbf_surfaces_at(grid, x, &numbers);
  return {o.domain, count, {o.surfaces, numbers}};
}

#endif
