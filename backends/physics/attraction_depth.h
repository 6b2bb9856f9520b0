/* How much fluid that an attraction weighs presses on itself: around a solid as the air around a
 * planet, or, where it is pushed away, within a container as in a centrifuge. Host only, float64
 * but for poses. */
#ifndef PBF_PHYSICS_ATTRACTION_DEPTH_H
#define PBF_PHYSICS_ATTRACTION_DEPTH_H

#include "physics/containers.h"
#include "physics/elementary.h"

/* The radius of the ball with so much more volume than one of that radius; 0: there is none. */
static inline double pbf_radius_with(double radius, double more) {
  const double unit = PBF_DIM == 3 ? 4 * PBF_PI / 3 : PBF_PI;
  const double volume = pbf_whole_power(radius, PBF_DIM) + more / unit;
  return volume > 0 ? pbf_side_of(volume, PBF_DIM) : 0;
}

/* How deep it is, and what it weighs at the deepest, over density. */
typedef struct pbf_attracted {
  double depth, head;
} pbf_attracted;

/* Of so much fluid, as if the colliders that hold it were balls around the attraction's centre: of
 * the one that bears most. None where no collider holds the centre: fluid that gathers to a ball by
 * itself is a free body, the momentum of which a grid keeps less well. */
static inline pbf_attracted pbf_attracted_of(const pbf_params *params, uint32_t count,
                                             const pbf_collider *colliders, double fluid) {
  const int gathers = params->attraction > 0;
  pbf_attracted most = {0, 0};
  if (params->attraction == 0) return most;
  for (uint32_t k = 0; k < count; ++k) {
    if (!(gathers ? pbf_is_solid(&colliders[k]) : pbf_is_container(&colliders[k]))) continue;
    const pbf_surface s = pbf_surface_as_set(&colliders[k]);
    pbf_vec center, normal;
    for (int i = 0; i < PBF_DIM; ++i) center.c[i] = (pbf_real)params->attraction_center[i];
    const double distance = (double)pbf_surface_distance(&s, center, &normal);
    if (gathers ? !(distance < 0) : !(distance > 0)) continue;
    const double floor = fabs(distance), level = pbf_radius_with(floor, gathers ? fluid : -fluid);
    const double head = 0.5 * fabs(params->attraction * (level * level - floor * floor));
    if (head > most.head) most = pbf_attracted{fabs(level - floor), head};
  }
  return most;
}

#endif
