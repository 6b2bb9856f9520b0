/* What inverted colliders leave to the fluid, which is inside each of them. Host only, float64 but
 * for poses. */
#ifndef PBF_PHYSICS_CONTAINERS_H
#define PBF_PHYSICS_CONTAINERS_H

#include "physics/collide.h"
#include "physics/derive.h"

/* Of what is inside a collider and up to `beyond` out of it; infinite where it has no end. */
PBF_FN double pbf_container_volume(const pbf_collider *collider, double beyond) {
  return shapes::ask((int)collider->shape,
                     [&](auto shape) { return shape.volume(collider, beyond); });
}

static inline int pbf_is_container(const pbf_collider *collider) {
  return collider->inverted && pbf_container_volume(collider, 0) < INFINITY;
}

/* Whether fluid can be on two sides of it. */
static inline int pbf_is_solid(const pbf_collider *collider) {
  return !collider->inverted && pbf_container_volume(collider, 0) < INFINITY;
}

/* Solids that take such a part of a level or more leave so little room that fluid around them is
 * looked for as between others: it stands deeper than their volume spread over the domain would. */
#define PBF_SOLIDS_TAKE 0.25

/* The part of a level between walls that lies within such bounds but for a gap that these are wider
 * by, where they reach the floor that gravity along the axis has. */
static inline double pbf_part_of_floor(const pbf_params *params, int axis, double gap,
                                       const double walls_lower[PBF_DIM],
                                       const double walls_upper[PBF_DIM],
                                       const double lower[PBF_DIM], const double upper[PBF_DIM]) {
  const int stands = params->gravity[axis] < 0 ? lower[axis] <= walls_lower[axis]
                                               : upper[axis] >= walls_upper[axis];
  double part = stands;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double within =
        fmin(upper[k] - gap, walls_upper[k]) - fmax(lower[k] + gap, walls_lower[k]);
    if (k != axis) part *= fmax(within, 0) / (walls_upper[k] - walls_lower[k]);
  }
  return part;
}

/* How far beyond the centres that touch a wall fluid reaches: walls that contribute no density let
 * them come so near. */
static inline double pbf_reach_beyond_walls(const pbf_params *params) {
  return 0.5 * (1 - params->wall_density) * pbf_derive_spacing(params);
}

/* Of the smallest; infinite where there is none. */
static inline double pbf_containers_volume(const pbf_params *params, uint32_t count,
                                           const pbf_collider *colliders) {
  const double beyond = pbf_reach_beyond_walls(params);
  double smallest = HUGE_VAL;
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_is_container(&colliders[k]))
      smallest = fmin(smallest, pbf_container_volume(&colliders[k], beyond));
  return smallest;
}

/* The walls, moved farther in to where a container ends, unless it has left the domain. */
static inline pbf_domain pbf_domain_within(pbf_domain domain, const pbf_surface *s) {
  if (s->sign > 0) return domain;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real reach = (pbf_real)pbf_surface_extent(s, k);
    pbf_real lower = pbf_real_max(domain.lower.c[k], s->center.c[k] - reach);
    pbf_real upper = pbf_real_min(domain.upper.c[k], s->center.c[k] + reach);
    if (!(lower < upper)) continue;
    domain.lower.c[k] = lower;
    domain.upper.c[k] = upper;
  }
  return domain;
}

/* The largest depth along an axis of so much fluid at rest in one of the containers, as deep as a
 * prism of the same height and room would have it. */
static inline double pbf_containers_depth(uint32_t count, const pbf_collider *colliders, int axis,
                                          double fluid) {
  double depth = 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!pbf_is_container(&colliders[k])) continue;
    pbf_surface s = pbf_surface_as_set(&colliders[k]);
    double part = fmin(fluid / pbf_container_volume(&colliders[k], 0), 1);
    depth = fmax(depth, 2 * pbf_surface_extent(&s, axis) * part);
  }
  return depth;
}

#endif
