/* The surface of the domain: a wall at either end of each axis, with the fluid between them. Each
 * wall moves by itself. */
#ifndef PBF_PHYSICS_SURFACES_DOMAIN_H
#define PBF_PHYSICS_SURFACES_DOMAIN_H

#include "physics/derive.h"
#include "physics/motion.h"
#include "physics/periodic.h"

typedef struct pbf_domain {
  pbf_vec lower, upper;  /* walls; of a periodic axis out of all reach */
  pbf_real bounce_depth; /* half of h, or 0 where walls give nothing back: see pbf_bounce */
  pbf_real ghost_reach;  /* particles this near to a wall have ghosts in it (ghosts.h): h, or 0 */
  pbf_real rounding;     /* what rounding may take from distances in it */
} pbf_domain;

/* ---- Whether its walls have ghosts ---------------------------------------------------------- */

/* From here on they have; in spacings. Up to 2.5 tanks rest without them, too, in half the time. */
#define PBF_WIDE_KERNEL 2.55

static inline int pbf_is_wide_kernel(const pbf_params *params) {
  return params->smoothing_radius >= PBF_WIDE_KERNEL * pbf_derive_spacing(params);
}

/* And where phases are close (phases.h), whatever the width: what a wall contributes by the
 * distance alone holds a first layer that is denser along the wall than the fluid is, and does not
 * shear off it. Light fluid in it then stays on the floor when heavier fluid has come down. */
static inline int pbf_may_have_ghosts(const pbf_params *params, int close_phases = 0) {
  return (PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && params->wall_density > 0 &&
         (close_phases || pbf_is_wide_kernel(params));
}

static inline pbf_real pbf_ghost_reach(const pbf_params *params, int close_phases, pbf_vec lower,
                                       pbf_vec upper) {
  pbf_real h = (pbf_real)params->smoothing_radius;
  int have = pbf_may_have_ghosts(params, close_phases);
  for (int k = 0; k < PBF_DIM; ++k) have = have && upper.c[k] - lower.c[k] >= h;
  return have ? h : 0;
}

/* ---- Where it is ---------------------------------------------------------------------------- */

/* Of distances between places that are no farther from the origin. */
static inline double pbf_rounding_within(double extent) {
  return 2 * extent * (sizeof(pbf_real) == sizeof(float) ? 0x1p-23 : 0x1p-52);
}

static inline double pbf_domain_rounding(const pbf_domain *domain) {
  double extent = 0;
  for (int k = 0; k < PBF_DIM; ++k)
    extent = fmax(extent, fmax(fabs((double)domain->lower.c[k]), fabs((double)domain->upper.c[k])));
  return pbf_rounding_within(extent);
}

static inline pbf_domain pbf_domain_at(const pbf_params *params, double time,
                                       int close_phases = 0) {
  pbf_domain domain;
  int bounces = params->solver == PBF_SOLVER_CHEBYSHEV;
  domain.bounce_depth = bounces ? (pbf_real)(0.5 * params->smoothing_radius) : 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    domain.lower.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k, time);
    domain.upper.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k + 1, time);
  }
  domain.ghost_reach = pbf_ghost_reach(params, close_phases, domain.lower, domain.upper);
  domain.rounding = (pbf_real)pbf_domain_rounding(&domain);
  for (int k = 0; k < PBF_DIM; ++k)
    if (pbf_is_periodic(params, k)) {
      domain.lower.c[k] = -(pbf_real)INFINITY;
      domain.upper.c[k] = (pbf_real)INFINITY;
    }
  return domain;
}

/* ---- How far it is -------------------------------------------------------------------------- */

/* Signed distance of x from a wall: number 2 k is at the lower end of axis k, 2 k + 1 at the upper
 * one. */
PBF_FN pbf_real pbf_wall_distance(const pbf_domain *domain, int wall, pbf_vec x) {
  const int k = wall / 2;
  return wall % 2 ? domain->upper.c[k] - x.c[k] : x.c[k] - domain->lower.c[k];
}

/* From the nearest wall. */
PBF_FN pbf_real pbf_domain_distance(const pbf_domain *domain, pbf_vec x) {
  pbf_real nearest = pbf_wall_distance(domain, 0, x);
  for (int wall = 1; wall < 2 * PBF_DIM; ++wall)
    nearest = pbf_real_min(nearest, pbf_wall_distance(domain, wall, x));
  return nearest;
}

/* ---- What it holds -------------------------------------------------------------------------- */

/* How far before a wall comes back what has landed `depth` behind it: half of that, of more than
 * half an h a hundredth. Particles so stay apart: laid onto the wall itself, or always to a small
 * part of the depth, what a crowd presses into a corner ends in one point of it, where a pair has
 * no direction to part in. And what has fallen from far is not lifted far. */
PBF_FN pbf_real pbf_bounce(const pbf_domain *domain, pbf_real depth) {
  pbf_real near = pbf_real_min(depth, domain->bounce_depth);
  return domain->bounce_depth > 0 ? (pbf_real)0.01 * depth + (pbf_real)0.49 * near : 0;
}

/* Walls that have crossed leave particles at the lower one. */
PBF_FN pbf_vec pbf_keep_in_domain(const pbf_domain *domain, pbf_vec x) {
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real lower = domain->lower.c[k], upper = domain->upper.c[k];
    pbf_real at = pbf_real_max(x.c[k], lower + pbf_bounce(domain, lower - x.c[k]));
    at = pbf_real_min(at, upper - pbf_bounce(domain, at - upper));
    x.c[k] = pbf_real_max(pbf_real_min(at, upper), lower);
  }
  return x;
}

#endif
