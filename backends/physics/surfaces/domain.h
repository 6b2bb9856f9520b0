/* The domain's surface: walls across each axis, with the fluid between them. Each wall moves by
 * itself. */
#ifndef PBF_PHYSICS_SURFACES_DOMAIN_H
#define PBF_PHYSICS_SURFACES_DOMAIN_H

#include "physics/derive.h"
#include "physics/motion.h"
#include "physics/real.h"

typedef struct pbf_walls {
  pbf_vec lower, upper;
  pbf_real near;  /* half of h, or 0 where walls give nothing back: see pbf_bounce */
  pbf_real reach; /* how far from them there are images: h, or 0 where they mirror nothing */
} pbf_walls;

/* ---- Where walls mirror the fluid ---------------------------------------------------------- */

/* From here on walls mirror the fluid; in spacings. Up to 2.5 tanks rest by the law, too, in half
 * the time. */
#define PBF_WIDE_KERNEL 2.55

static inline int pbf_may_mirror(const pbf_params *params) {
  return (PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && params->wall_density > 0 &&
         params->smoothing_radius >= PBF_WIDE_KERNEL * pbf_derive_spacing(params);
}

/* How far from walls that stand like this there are images: h, or 0. */
static inline pbf_real pbf_mirror_reach(const pbf_params *params, pbf_vec lower, pbf_vec upper) {
  pbf_real h = (pbf_real)params->smoothing_radius;
  int mirror = pbf_may_mirror(params);
  for (int k = 0; k < PBF_DIM; ++k) mirror = mirror && upper.c[k] - lower.c[k] >= h;
  return mirror ? h : 0;
}

/* ---- Where they are ------------------------------------------------------------------------ */

static inline pbf_walls pbf_walls_at(const pbf_params *params, double time) {
  pbf_walls walls;
  int bounces = params->solver == PBF_SOLVER_CHEBYSHEV;
  walls.near = bounces ? (pbf_real)(0.5 * params->smoothing_radius) : 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    walls.lower.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k, time);
    walls.upper.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k + 1, time);
  }
  walls.reach = pbf_mirror_reach(params, walls.lower, walls.upper);
  return walls;
}

/* ---- How far they are ---------------------------------------------------------------------- */

/* Distance of x from a wall: the lower one across axis k is number 2 k, the upper one 2 k + 1. */
PBF_FN pbf_real pbf_wall_distance(const pbf_walls *walls, int wall, pbf_vec x) {
  const int k = wall / 2;
  return wall % 2 ? walls->upper.c[k] - x.c[k] : x.c[k] - walls->lower.c[k];
}

/* From the nearest of them. */
PBF_FN pbf_real pbf_domain_distance(const pbf_walls *walls, pbf_vec x) {
  pbf_real nearest = pbf_wall_distance(walls, 0, x);
  for (int wall = 1; wall < 2 * PBF_DIM; ++wall)
    nearest = pbf_real_min(nearest, pbf_wall_distance(walls, wall, x));
  return nearest;
}

/* ---- What they hold ------------------------------------------------------------------------ */

/* How far before a wall comes back what has landed `depth` behind it: half of that, of more than
 * half an h a hundredth. It so keeps apart from what else does: laid onto the wall itself, or
 * always to a small part of the depth, what a crowd presses into a corner ends in one point of it,
 * where a pair has no direction to part in. And what has fallen from far is not lifted far. */
PBF_FN pbf_real pbf_bounce(const pbf_walls *walls, pbf_real depth) {
  pbf_real near = pbf_real_min(depth, walls->near);
  return walls->near > 0 ? (pbf_real)0.01 * depth + (pbf_real)0.49 * near : 0;
}

/* Walls that have crossed leave particles at the lower one. */
PBF_FN pbf_vec pbf_clamp(const pbf_walls *walls, pbf_vec x) {
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real lower = walls->lower.c[k], upper = walls->upper.c[k];
    pbf_real at = pbf_real_max(x.c[k], lower + pbf_bounce(walls, lower - x.c[k]));
    at = pbf_real_min(at, upper - pbf_bounce(walls, at - upper));
    x.c[k] = pbf_real_max(pbf_real_min(at, upper), lower);
  }
  return x;
}

#endif
