/* The references that colliders have of shapes. */
#include <stdio.h>

#include "colliders.h"
#include "shape/registry.h"

pbf_status pbf_collider_hold(const pbf_collider *collider, const char *name, uint32_t index) {
  char label[48];
  if (!collider->geometry) return PBF_OK;
  snprintf(label, sizeof label, "%s[%u].geometry", name, index);
  return pbf_shape_hold(collider->geometry, label);
}

void pbf_colliders_let_go(uint32_t count, const pbf_collider *colliders) {
  for (uint32_t i = 0; i < count; ++i)
    if (colliders[i].geometry) pbf_shape_let_go(colliders[i].geometry);
}
