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

  static PBF_IN double width(const pbf_surface *s) { return 2 * (double)s->radius; }

  /* That of a sphere around the nearest point of the line. */
  static PBF_IN pbf_real distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
    pbf_real along = pbf_dot(p, s->frame[0]);
    along = pbf_real_max(pbf_real_min(along, s->half_length), -s->half_length);
    return sphere_shape::distance(s, pbf_add_scaled(p, -along, s->frame[0]), normal);
  }

  /* By the nearest points of the way and the line: those of the straight lines that both are on, or
   * where one of them ends. */
  static PBF_IN int blocks(const pbf_surface *s, pbf_vec p, pbf_vec way) {
    const pbf_real length2 = pbf_dot(way, way), slant = pbf_dot(way, s->frame[0]);
    const pbf_real from = pbf_dot(p, s->frame[0]), ahead = pbf_dot(p, way);
    const pbf_real across2 = length2 - slant * slant; /* of the way, squared */
    pbf_real t = across2 > 0 ? (from * slant - ahead) / across2 : 0;
    t = pbf_real_max(pbf_real_min(t, 1), 0);
    pbf_real along = pbf_real_max(pbf_real_min(from + t * slant, s->half_length), -s->half_length);
    t = length2 > 0 ? (along * slant - ahead) / length2 : 0;
    t = pbf_real_max(pbf_real_min(t, 1), 0);
    along = pbf_real_max(pbf_real_min(from + t * slant, s->half_length), -s->half_length);
    const pbf_vec nearest = pbf_add_scaled(pbf_add_scaled(p, t, way), -along, s->frame[0]);
    return pbf_dot(nearest, nearest) < s->radius * s->radius;
  }
};

}  // namespace

#endif
