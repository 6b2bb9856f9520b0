/* A plane, with all that is behind it. */
#ifndef PBF_PHYSICS_SURFACES_PLANE_H
#define PBF_PHYSICS_SURFACES_PLANE_H

#include "physics/surfaces/shape.h"

namespace {

struct plane_shape {
  enum { ID = PBF_COLLIDER_PLANE, HAS_AXIS = 1, FACES = 0 };

  static PBF_IN double bound(const pbf_collider *) { return INFINITY; }
  static PBF_IN double volume(const pbf_collider *, double) { return INFINITY; }
  static PBF_IN double extent(const pbf_surface *, int) { return INFINITY; }

  static PBF_IN double width(const pbf_surface *) { return INFINITY; }

  static PBF_IN pbf_real distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
    *normal = s->frame[0];
    return pbf_dot(p, *normal);
  }

  static PBF_IN int blocks(const pbf_surface *s, pbf_vec p, pbf_vec way) {
    return pbf_dot(pbf_add_scaled(p, 1, way), s->frame[0]) < 0;
  }
};

}  // namespace

#endif
