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

/* What a container leaves to the fluid within the walls: its bounds there, and the volume. */
typedef struct pbf_container_room {
  double lower[PBF_DIM], upper[PBF_DIM];
  double volume;
} pbf_container_room;

/* The part of such bounds that lies up to `beyond` out of a container or in it, by points of an
 * additive recurrence (Roberts 2018), the steps of which are powers of the inverse of x, where
 * x^(PBF_DIM + 1) = x + 1. */
static inline double pbf_container_part(const pbf_collider *collider, double beyond,
                                        const pbf_container_room *bounds) {
  enum { POINTS = 4096 };
  const double step = PBF_DIM == 3 ? 0.8191725133961645 : 0.7548776662466927;
  const pbf_surface s = pbf_surface_as_set(collider);
  double at[PBF_DIM];
  int inside = 0;
  for (int k = 0; k < PBF_DIM; ++k) at[k] = 0.5;
  for (int point = 0; point < POINTS; ++point) {
    pbf_vec x, normal;
    double by = step;
    for (int k = 0; k < PBF_DIM; ++k, by *= step) {
      at[k] += by;
      if (!(at[k] < 1)) at[k] -= 1;
      x.c[k] = (pbf_real)(bounds->lower[k] + at[k] * (bounds->upper[k] - bounds->lower[k]));
    }
    inside += (double)pbf_surface_distance(&s, x, &normal) > -beyond;
  }
  return (double)inside / POINTS;
}

/* Of a container and what is up to `beyond` out of it: all, unless it reaches out of the walls and
 * what is as far beyond them. One that has left the domain counts as if it were in it. */
static inline pbf_container_room pbf_container_within(const pbf_params *params,
                                                      const pbf_collider *collider, double beyond) {
  const double rounding = 1e-6 * pbf_derive_spacing(params);
  const pbf_surface s = pbf_surface_as_set(collider);
  pbf_container_room all, cut;
  int reaches_out = 0, is_empty = 0;
  all.volume = pbf_container_volume(collider, beyond);
  cut.volume = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double beyond_walls = pbf_is_periodic(params, k) ? 0 : beyond;
    const double reach = pbf_surface_extent(&s, k) + beyond;
    all.lower[k] = (double)s.center.c[k] - reach;
    all.upper[k] = (double)s.center.c[k] + reach;
    cut.lower[k] = fmax(all.lower[k], params->domain_min[k] - beyond_walls);
    cut.upper[k] = fmin(all.upper[k], params->domain_max[k] + beyond_walls);
    cut.volume *= cut.upper[k] - cut.lower[k];
    reaches_out |= fmax(cut.lower[k] - all.lower[k], all.upper[k] - cut.upper[k]) > rounding;
    is_empty |= !(cut.lower[k] < cut.upper[k]);
  }
  if (!reaches_out || is_empty) return all;
  cut.volume *= pbf_container_part(collider, beyond, &cut);
  return cut.volume > 0 ? cut : all;
}

/* Of the smallest; infinite where there is none. */
static inline double pbf_containers_volume(const pbf_params *params, uint32_t count,
                                           const pbf_collider *colliders) {
  const double beyond = pbf_reach_beyond_walls(params);
  double smallest = HUGE_VAL;
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_is_container(&colliders[k]))
      smallest = fmin(smallest, pbf_container_within(params, &colliders[k], beyond).volume);
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
static inline double pbf_containers_depth(const pbf_params *params, uint32_t count,
                                          const pbf_collider *colliders, int axis, double fluid) {
  double depth = 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!pbf_is_container(&colliders[k])) continue;
    const pbf_container_room room = pbf_container_within(params, &colliders[k], 0);
    const double part = fmin(fluid / room.volume, 1);
    depth = fmax(depth, (room.upper[axis] - room.lower[axis]) * part);
  }
  return depth;
}

#endif
