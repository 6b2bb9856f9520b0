/* The references that colliders have of shapes. */
#include <stdio.h>

#include "colliders.h"
#include "shape/registry.h"

pbf_status pbf_collider_hold(const pbf_collider *collider, const char *label) {
  char geometry[48]; /* labels have up to 32 */
  if (!collider->geometry) return PBF_OK;
  snprintf(geometry, sizeof geometry, "%s.geometry", label);
  return pbf_shape_hold(collider->geometry, geometry);
}

void pbf_colliders_let_go(uint32_t count, const pbf_collider *colliders) {
  for (uint32_t i = 0; i < count; ++i)
    if (colliders[i].geometry) pbf_shape_let_go(colliders[i].geometry);
}
