/* Part of obstacles.h: walls and colliders of a step; and, where there are more than a set has bits
 * for, which are near a place. Behind those lies the grid that CPUs ask, too, and that the host has
 * built (physics/surfaces/near.h). */
#ifndef PBF_CUDA_LISTED_OBSTACLES_H
#define PBF_CUDA_LISTED_OBSTACLES_H

#include "pbf/pbf.h"
#include "physics/boundary.h"
#include "physics/listed_surfaces.h"

/* Walls and colliders of one step; `surfaces` is on the device, and so is what lies behind them if
 * they are many. */
struct step_obstacles {
  pbf_domain domain;
  int count;
  const pbf_surface *surfaces;
};

/* What lies behind the surfaces: what they are asked by, where a pointer to a kernel's own
 * arguments would have each thread copy these to its stack. */
struct listed_scene {
  pbf_surface_grid grid;
  pbf_domain domain;       /* the step's, and … */
  pbf_constants constants; /* … but for what differs from iteration to iteration, the solver's */
};

/* Some of them, by their numbers. */
struct listed_obstacles {
  const pbf_domain &domain;
  int count;
  pbf_surface_list surfaces;
};

static __device__ __forceinline__ const listed_scene *scene_behind(const step_obstacles &o) {
  return reinterpret_cast<const listed_scene *>(o.surfaces + o.count);
}

/* Those that may be within `reach` of x: all, where the grid's lists do not reach so far. */
static __device__ __forceinline__ listed_obstacles listed_near(const step_obstacles &o, pbf_vec x,
                                                               double reach) {
  const pbf_surface_grid *grid = &scene_behind(o)->grid;
  if (reach > grid->reach) return {o.domain, o.count, {o.surfaces, nullptr}};
  const uint16_t *numbers;
  const int count = (int)pbf_surfaces_at(grid, x, &numbers);
  return {o.domain, count, {o.surfaces, numbers}};
}

/* Adds what some contribute at x. Few particles are near one: a kernel's other threads are to have
 * the registers. */
static __device__ __noinline__ pbf_boundary add_listed(const listed_scene *of,
                                                       const pbf_surface *all,
                                                       const uint16_t *numbers, int count,
                                                       pbf_vec x, pbf_boundary boundary) {
  const each_surface<pbf_surface_list> listed = {{all, numbers}, count, 0};
  pbf_accumulate_surfaces(&of->constants, &of->domain, x, listed, &boundary);
  return boundary;
}

/* What walls and colliders contribute at x. */
static __device__ __forceinline__ pbf_boundary listed_boundary(const pbf_constants *c,
                                                               const step_obstacles &o, pbf_vec x) {
  const listed_scene *of = scene_behind(o);
  const pbf_boundary boundary = pbf_boundary_of_domain(c, &o.domain, x);
  const uint16_t *numbers;
  const int count = (int)pbf_surfaces_at(&of->grid, x, &numbers);
  bool near = false;
  for (int k = 0; k < count; ++k)
    near |= !pbf_surface_is_beyond(&o.surfaces[numbers[k]], x, pbf_boundary_reach(c));
  return near ? add_listed(of, o.surfaces, numbers, count, x, boundary) : boundary;
}

#endif
