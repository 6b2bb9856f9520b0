/* A box. */
#ifndef PBF_PHYSICS_SURFACES_BOX_H
#define PBF_PHYSICS_SURFACES_BOX_H

#include "physics/surfaces/shape.h"

namespace {

struct box_shape {
  enum { ID = PBF_COLLIDER_BOX, HAS_AXIS = 0, FACES = 2 * PBF_DIM };

  static PBF_IN double bound(const pbf_collider *c) {
    double diagonal2 = 0;
    for (int k = 0; k < PBF_DIM; ++k) diagonal2 += c->half_extents[k] * c->half_extents[k];
    return sqrt(diagonal2);
  }
  static PBF_IN double volume(const pbf_collider *c, double beyond) {
    double volume = 1;
    for (int k = 0; k < PBF_DIM; ++k) volume *= 2 * (c->half_extents[k] + beyond);
    return volume;
  }
  static PBF_IN double extent(const pbf_surface *s, int axis) {
    double extent = 0;
    for (int row = 0; row < PBF_DIM; ++row)
      extent += (double)s->half_extents.c[row] * fabs((double)s->frame[row].c[axis]);
    return extent;
  }

  static PBF_IN double width(const pbf_surface *s) {
    double width = INFINITY;
    for (int k = 0; k < PBF_DIM; ++k) width = fmin(width, 2 * (double)s->half_extents.c[k]);
    return width;
  }

  static PBF_IN pbf_real distance(const pbf_surface *s, pbf_vec p, pbf_vec *normal) {
    int sides;
    return distance_and_sides(s, p, normal, &sides);
  }

  /* And how many axes of its frame p is beyond the faces of: from 2 on an edge is nearest. */
  static PBF_IN pbf_real distance_and_sides(const pbf_surface *s, pbf_vec p, pbf_vec *normal,
                                            int *sides) {
    pbf_vec local, local_normal;
    for (int k = 0; k < PBF_DIM; ++k) local.c[k] = pbf_dot(p, s->frame[k]);
    const pbf_real distance = local_distance(local, s->half_extents, &local_normal, sides);
    for (int k = 0; k < PBF_DIM; ++k) {
      normal->c[k] = 0;
      for (int row = 0; row < PBF_DIM; ++row)
        normal->c[k] += s->frame[row].c[k] * local_normal.c[row];
    }
    return distance;
  }

  /* What of the way is between each two faces, one after the other. */
  static PBF_IN int blocks(const pbf_surface *s, pbf_vec p, pbf_vec way) {
    pbf_real first = 0, last = 1;
    for (int k = 0; k < PBF_DIM; ++k) {
      const pbf_real from = pbf_dot(p, s->frame[k]), by = pbf_dot(way, s->frame[k]);
      const pbf_real half = s->half_extents.c[k];
      if (!(by > 0 || by < 0)) {
        if (from > half || from < -half) return 0;
        continue;
      }
      const pbf_real a = (-half - from) / by, b = (half - from) / by;
      first = pbf_real_max(first, pbf_real_min(a, b));
      last = pbf_real_min(last, pbf_real_max(a, b));
    }
    return first <= last;
  }

  static PBF_IN pbf_real face(const pbf_surface *s, int k, pbf_vec p, pbf_vec *normal) {
    const int row = k / 2;
    const pbf_real sign = k % 2 ? (pbf_real)-1 : (pbf_real)1;
    for (int a = 0; a < PBF_DIM; ++a) normal->c[a] = sign * s->frame[row].c[a];
    return s->half_extents.c[row] + pbf_dot(p, *normal);
  }

 private:
  /* In its own frame: outside, from the nearest point of it; inside, from its nearest face. */
  static PBF_IN pbf_real local_distance(pbf_vec p, pbf_vec half, pbf_vec *normal, int *sides) {
    pbf_real inside = 0, outside2 = 0;
    int face = 0;
    *sides = 0;
    pbf_vec out;
    for (int k = 0; k < PBF_DIM; ++k) {
      const pbf_real d = pbf_real_max(p.c[k], -p.c[k]) - half.c[k], beyond = pbf_real_max(d, 0);
      face = k == 0 || d > inside ? k : face; /* no branches: they would be hard to predict */
      inside = k == 0 ? d : pbf_real_max(d, inside);
      out.c[k] = p.c[k] < 0 ? -beyond : beyond;
      *sides += d > 0;
      outside2 += out.c[k] * out.c[k];
    }
    const pbf_real distance = pbf_real_sqrt(outside2 > 0 ? outside2 : 1);
    for (int k = 0; k < PBF_DIM; ++k) { /* of constant indices alone: registers have no others */
      const pbf_real side = p.c[k] < 0 ? (pbf_real)-1 : (pbf_real)1;
      normal->c[k] = outside2 > 0 ? out.c[k] / distance : k != face ? 0 : side;
    }
    return outside2 > 0 ? distance : inside;
  }
};

}  // namespace

#endif
