/* How much fluid that an attraction weighs presses on itself: around a solid as the air around a
 * planet, or, where it is pushed away, within a container as in a centrifuge. Host only, float64
 * but for poses. */
#ifndef PBF_PHYSICS_ATTRACTION_DEPTH_H
#define PBF_PHYSICS_ATTRACTION_DEPTH_H

#include "physics/containers.h"

/* The radius of the ball with so much more volume than one of that radius; 0: there is none. */
static inline double pbf_radius_with(double radius, double more) {
  const double unit = PBF_DIM == 3 ? 4 * PBF_PI / 3 : PBF_PI;
  const double volume = pow(radius, PBF_DIM) + more / unit;
  return volume > 0 ? pow(volume, 1.0 / PBF_DIM) : 0;
}

/* What so much fluid weighs at the deepest, over density, as if the colliders that hold it were
 * balls around the attraction's centre. 0 where none of them holds the centre: fluid that gathers
 * to a ball by itself is a free body, the momentum of which a grid keeps less well. */
static inline double pbf_attraction_head(const pbf_params *params, uint32_t count,
                                         const pbf_collider *colliders, double fluid) {
  const int gathers = params->attraction > 0;
  double head = 0;
  if (params->attraction == 0) return 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!(gathers ? pbf_is_solid(&colliders[k]) : pbf_is_container(&colliders[k]))) continue;
    const pbf_surface s = pbf_surface_as_set(&colliders[k]);
    pbf_vec center, normal;
    for (int i = 0; i < PBF_DIM; ++i) center.c[i] = (pbf_real)params->attraction_center[i];
    const double distance = (double)pbf_surface_distance(&s, center, &normal);
    if (gathers ? !(distance < 0) : !(distance > 0)) continue;
    const double floor = fabs(distance), level = pbf_radius_with(floor, gathers ? fluid : -fluid);
    head = fmax(head, 0.5 * fabs(params->attraction * (level * level - floor * floor)));
  }
  return head;
}

#endif
