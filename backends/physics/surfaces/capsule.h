/* A capsule: all that is within a radius of a line; in 2D a stadium. */
#ifndef PBF_PHYSICS_SURFACES_CAPSULE_H
#define PBF_PHYSICS_SURFACES_CAPSULE_H

#include "physics/surfaces/sphere.h"

namespace {

struct capsule_shape {
  enum { ID = PBF_COLLIDER_CAPSULE, HAS_AXIS = 1, FACES = 0 };

  static PBF_IN double bound(const pbf_collider *c) { return c->radius + c->half_length; }
  static PBF_IN double volume(const pbf_collider *c, double beyond) {
    const double r = c->radius + beyond, disc = PBF_PI * r * r;
    return sphere_shape::volume(c, beyond) + 2 * c->half_length * (PBF_DIM == 3 ? disc : 2 * r);
  }
  static PBF_IN double extent(const pbf_surface *s, int axis) {
    return (double)s->radius + (double)s->half_length * fabs((double)s->frame[0].c[axis]);
  }

  /* That of a sphere around the nearest point of the line. */
  static PBF_IN pbf_real distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
    pbf_real along = pbf_dot(p, s->frame[0]);
    along = pbf_real_max(pbf_real_min(along, s->half_length), -s->half_length);
    return sphere_shape::distance(s, pbf_add_scaled(p, -along, s->frame[0]), normal);
  }
};

}  // namespace

#endif
