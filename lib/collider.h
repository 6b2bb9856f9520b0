/* Checks of a collider, and what its shape uses of its fields. */
#ifndef PBF_LIB_COLLIDER_H
#define PBF_LIB_COLLIDER_H

#include "check.h"

/* `label` is what the message calls it. A geometry must be one that is held. */
pbf_status pbf_collider_check(const pbf_collider *collider, const char *label, pbf_check_kind kind);

/* The same of one on its way, which may have shrunk to nothing. */
pbf_status pbf_collider_check_moving(const pbf_collider *collider, const char *label,
                                     pbf_check_kind kind);

/* Whether its shape goes by `axis`: a plane's normal, a capsule's direction. */
static inline int pbf_collider_has_axis(const pbf_collider *collider) {
  return collider->shape == PBF_COLLIDER_PLANE || collider->shape == PBF_COLLIDER_CAPSULE;
}

/* As a backend gets it: what the dimension ignores becomes zero. */
static inline void pbf_collider_clean(pbf_collider *collider, uint32_t dimension) {
  if (dimension == 3) return;
  collider->position[2] = collider->velocity[2] = collider->axis[2] = 0;
  collider->half_extents[2] = collider->half_extents_rate[2] = 0;
  collider->angular_velocity[0] = collider->angular_velocity[1] = 0;
}

#endif
