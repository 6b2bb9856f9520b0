/* A sphere; in 2D a disc. */
#ifndef PBF_PHYSICS_SURFACES_SPHERE_H
#define PBF_PHYSICS_SURFACES_SPHERE_H

#include "physics/derive.h"
#include "physics/surfaces/shape.h"

namespace {

struct sphere_shape {
  enum { ID = PBF_COLLIDER_SPHERE, HAS_AXIS = 1, FACES = 0 };

  static PBF_IN double bound(const pbf_collider *c) { return c->radius; }
  static PBF_IN double volume(const pbf_collider *c, double beyond) {
    const double r = c->radius + beyond, disc = PBF_PI * r * r;
    return PBF_DIM == 3 ? 4.0 / 3 * disc * r : disc;
  }
  static PBF_IN double extent(const pbf_surface *s, int) { return (double)s->radius; }

  static PBF_IN double width(const pbf_surface *s) { return 2 * (double)s->radius; }

  /* From the very center, out along an axis of the frame. */
  static PBF_IN pbf_real distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
    const pbf_real r = pbf_real_sqrt(pbf_dot(p, p));
    for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = r > 0 ? p.c[k] / r : s->frame[1].c[k];
    return r - s->radius;
  }

  static PBF_IN int blocks(const pbf_surface *s, pbf_vec p, pbf_vec way) {
    const pbf_real length2 = pbf_dot(way, way);
    pbf_real t = length2 > 0 ? -pbf_dot(p, way) / length2 : 0;
    t = pbf_real_max(pbf_real_min(t, 1), 0);
    const pbf_vec nearest = pbf_add_scaled(p, t, way);
    return pbf_dot(nearest, nearest) < s->radius * s->radius;
  }
};

}  // namespace

#endif
