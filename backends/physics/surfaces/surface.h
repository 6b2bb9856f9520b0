/* The surfaces of colliders, of whatever shape: signed distance, the planes that they contribute
 * density by, how they move in a step. A new shape is a file beside this one, and a name in the
 * list. */
#ifndef PBF_PHYSICS_SURFACES_SURFACE_H
#define PBF_PHYSICS_SURFACES_SURFACE_H

#include "physics/motion.h"
#include "physics/surfaces/box.h"
#include "physics/surfaces/capsule.h"
#include "physics/surfaces/field.h"
#include "physics/surfaces/plane.h"
#include "physics/surfaces/sphere.h"

namespace {

/* Calls ask(shape) with the one of these whose ID it is; with the last where it is none of the
 * others'. */
template <class Shape, class... Others>
struct shape_list {
  template <class Ask>
  static PBF_IN auto ask(int id, Ask question) {
    if constexpr (sizeof...(Others) > 0)
      if (id != Shape::ID) return shape_list<Others...>::ask(id, question);
    return question(Shape{});
  }
};

using shapes = shape_list<plane_shape, box_shape, capsule_shape, field_shape, sphere_shape>;
using closed_shapes = shape_list<plane_shape, box_shape, capsule_shape, sphere_shape>;

/* Those that a surface of such a type may have. */
template <class Ask>
PBF_FN auto ask_shape(const pbf_surface *s, Ask question) {
  return shapes::ask(s->shape, question);
}

template <class Ask>
PBF_FN auto ask_shape(const pbf_closed_surface *s, Ask question) {
  return closed_shapes::ask(s->shape, question);
}

/* Whether surfaces of such a type may be fields. */
template <class Surface>
struct may_be_field {
  static constexpr bool value = false;
};
template <>
struct may_be_field<pbf_surface> {
  static constexpr bool value = true;
};

}  // namespace

/* ---- Where it is --------------------------------------------------------------------------- */

static inline void pbf_rotate(const double q[4], const double v[3], double out[3]) {
  double p[4] = {v[0], v[1], v[2], 0}, conjugate[4] = {-q[0], -q[1], -q[2], q[3]}, qp[4], r[4];
  pbf_motion_quaternion_product(q, p, qp);
  pbf_motion_quaternion_product(qp, conjugate, r);
  for (int k = 0; k < 3; ++k) out[k] = r[k];
}

/* Unit `axis`, and a unit vector across it: away from the coordinate axis it is farthest from. */
static inline void pbf_axis_frame(const double axis[3], double frame[3][3]) {
  double length2 = 0, across2 = 0;
  int far = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    length2 += axis[k] * axis[k];
    if (fabs(axis[k]) < fabs(axis[far])) far = k;
  }
  for (int k = 0; k < 3; ++k) frame[0][k] = k < PBF_DIM ? axis[k] / sqrt(length2) : 0;
  for (int k = 0; k < 3; ++k) {
    frame[1][k] = (k == far) - frame[0][far] * frame[0][k];
    across2 += frame[1][k] * frame[1][k];
  }
  for (int k = 0; k < 3; ++k) frame[1][k] /= sqrt(across2);
  for (int k = 0; k < 3; ++k) {
    int l = (k + 1) % 3, m = (k + 2) % 3;
    frame[2][k] = frame[0][l] * frame[1][m] - frame[0][m] * frame[1][l];
  }
}

PBF_FN int pbf_has_axis(const pbf_collider *collider) {
  return shapes::ask((int)collider->shape, [](auto shape) -> int { return shape.HAS_AXIS; });
}

static inline void pbf_place_surface(const pbf_collider *now, pbf_vec *center,
                                     pbf_vec frame[PBF_DIM]) {
  double own[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (pbf_has_axis(now)) pbf_axis_frame(now->axis, own);
  for (int row = 0; row < PBF_DIM; ++row) {
    double turned[3];
    pbf_rotate(now->orientation, own[row], turned);
    for (int k = 0; k < PBF_DIM; ++k) frame[row].c[k] = (pbf_real)turned[k];
    center->c[row] = (pbf_real)now->position[row];
  }
}

/* How much longer it is than before along a row of its frame. */
static inline double pbf_growth(const pbf_collider *before, const pbf_collider *now, int row) {
  double from = before->radius, to = now->radius;
  if (now->shape == PBF_COLLIDER_PLANE) return 1;
  if (now->shape == PBF_COLLIDER_SHAPE) from = before->scale, to = now->scale;
  if (now->shape == PBF_COLLIDER_BOX) from = before->half_extents[row], to = now->half_extents[row];
  if (now->shape == PBF_COLLIDER_CAPSULE && row == 0)
    from += before->half_length, to += now->half_length;
  return from > 0 && from != to ? to / from : 1;
}

PBF_FN double pbf_bound(const pbf_collider *collider) {
  return shapes::ask((int)collider->shape, [&](auto shape) { return shape.bound(collider); });
}

/* How far it moves in the step. */
static inline void pbf_set_ways(pbf_surface *s) {
  const pbf_vec step = pbf_sub(s->center, s->start_center);
  pbf_real turn2 = 0;
  for (int row = 0; row < PBF_DIM; ++row) {
    const pbf_vec turned = pbf_sub(s->frame[row], s->start_frame[row]);
    turn2 += pbf_dot(turned, turned);
  }
  s->step = pbf_real_sqrt(pbf_dot(step, step));
  s->turn = pbf_real_sqrt(turn2);
}

static inline void pbf_set_field(pbf_surface *s, const pbf_collider *collider) {
  s->steepest = 1;
  if (collider->shape != PBF_COLLIDER_SHAPE) return;
  s->field = collider->geometry;
  s->field_id = collider->geometry->id;
  s->scale = (pbf_real)collider->scale;
  s->steepest = (pbf_real)collider->geometry->steepest;
}

/* What of a surface does not go by how it moves. */
static inline pbf_surface pbf_surface_of(const pbf_collider *now, double bound) {
  pbf_surface s = {0};
  s.shape = (int)now->shape;
  s.sign = now->inverted ? (pbf_real)-1 : (pbf_real)1;
  s.radius = (pbf_real)now->radius;
  s.half_length = (pbf_real)now->half_length;
  for (int k = 0; k < PBF_DIM; ++k) s.half_extents.c[k] = (pbf_real)now->half_extents[k];
  pbf_set_field(&s, now);
  s.bound = (pbf_real)(now->inverted ? INFINITY : 1.0001 * bound);
  pbf_place_surface(now, &s.center, s.frame);
  return s;
}

/* As a collider has been set, without a motion. */
static inline pbf_surface pbf_surface_as_set(const pbf_collider *collider) {
  pbf_surface s = pbf_surface_of(collider, pbf_bound(collider));
  s.start_center = s.center;
  for (int row = 0; row < PBF_DIM; ++row) s.start_frame[row] = s.frame[row];
  return s;
}

/* At the end of a step, in which a collider has come from `before` to `now`. What grows stretches
 * space: along with it go those before it. */
static inline pbf_surface pbf_surface_between(const pbf_collider *before, const pbf_collider *now) {
  pbf_surface s = pbf_surface_of(now, fmax(pbf_bound(before), pbf_bound(now)));
  pbf_place_surface(before, &s.start_center, s.start_frame);
  for (int row = 0; row < PBF_DIM; ++row) {
    const pbf_real growth = (pbf_real)pbf_growth(before, now, row);
    for (int k = 0; k < PBF_DIM; ++k) s.start_frame[row].c[k] *= growth;
  }
  pbf_set_ways(&s);
  return s;
}

static inline void pbf_set_gain(pbf_surface *s, const pbf_collider *at_set, double elapsed,
                                double time_step) {
  double way[3], turn[3];
  pbf_motion_gain(at_set, elapsed, time_step, way, turn);
  for (int k = 0; k < PBF_DIM; ++k) s->gain.c[k] = (pbf_real)way[k];
  for (int k = 0; k < 3; ++k) {
    s->turn_gain[k] = (pbf_real)turn[k];
    s->gains |= (k < PBF_DIM && way[k] != 0) || turn[k] != 0;
  }
}

/* Of a point of it. */
PBF_FN pbf_vec pbf_surface_gain_at(const pbf_surface *s, pbf_vec x) {
  const pbf_vec p = pbf_sub(x, s->center);
  const pbf_real *w = s->turn_gain;
  pbf_vec gain = s->gain;
  gain.c[0] -= w[2] * p.c[1];
  gain.c[1] += w[2] * p.c[0];
#if PBF_DIM == 3
  gain.c[0] += w[1] * p.c[2];
  gain.c[1] -= w[0] * p.c[2];
  gain.c[2] += w[0] * p.c[1] - w[1] * p.c[0];
#endif
  return gain;
}

/* At the end of a step, `elapsed` after the collider was set. */
static inline pbf_surface pbf_surface_at(const pbf_collider *at_set, double elapsed,
                                         double time_step) {
  pbf_collider now, before;
  pbf_motion_collider(at_set, elapsed, &now);
  pbf_motion_collider(at_set, elapsed - time_step, &before);
  pbf_surface s = pbf_surface_between(&before, &now);
  if (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) pbf_set_gain(&s, at_set, elapsed, time_step);
  return s;
}

/* As it stood at the start of the step. */
template <class Surface>
PBF_FN Surface pbf_surface_before(const Surface *surface) {
  Surface before = *surface;
  before.center = surface->start_center;
  for (int k = 0; k < PBF_DIM; ++k) before.frame[k] = surface->start_frame[k];
  return before;
}

/* Where a point that the surface carries along is at the end of the step. */
PBF_FN pbf_vec pbf_surface_carries(const pbf_surface *s, pbf_vec x) {
  pbf_vec p = pbf_sub(x, s->start_center), moved = s->center;
  for (int row = 0; row < PBF_DIM; ++row)
    moved = pbf_add_scaled(moved, pbf_dot(p, s->start_frame[row]), s->frame[row]);
  return moved;
}

/* ---- How far it is ------------------------------------------------------------------------- */

/* What of a surface is nearest to a place: a flat face, an edge or a corner between some, or what
 * is curved. Of fields nothing is known. */
typedef enum pbf_nearest_part {
  PBF_NEAREST_FACE,
  PBF_NEAREST_EDGE,
  PBF_NEAREST_CURVED
} pbf_nearest_part;

/* Of p, which counts from the center of a surface of this shape; and how many axes of a box's frame
 * it is beyond the faces of. */
template <class Shape, class Surface>
PBF_FN pbf_real pbf_shape_distance(Shape shape, const Surface *s, pbf_vec p, pbf_vec *normal,
                                   int *sides) {
  *sides = 0;
  if constexpr ((int)Shape::ID == PBF_COLLIDER_BOX)
    return shape.distance_and_sides(s, p, normal, sides);
  else
    return shape.distance(s, p, normal);
}

/* Distance of x from the surface, negative where the fluid must not be; *normal points to the
 * fluid, and *part is what of it is nearest. */
template <class Surface>
PBF_FN_HOST_NOINLINE pbf_real pbf_surface_nearest(const Surface *s, pbf_vec x, pbf_vec *normal,
                                                  pbf_nearest_part *part) {
  const pbf_vec p = pbf_sub(x, s->center);
  pbf_vec n;
  int sides;
  const pbf_real distance =
      ask_shape(s, [&](auto shape) { return pbf_shape_distance(shape, s, p, &n, &sides); });
  const bool is_flat = s->shape == PBF_COLLIDER_PLANE || s->shape == PBF_COLLIDER_BOX;
  *part = !is_flat                   ? PBF_NEAREST_CURVED
          : s->sign > 0 && sides > 1 ? PBF_NEAREST_EDGE
                                     : PBF_NEAREST_FACE;
  for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = s->sign * n.c[k];
  return s->sign * distance;
}

template <class Surface>
PBF_FN pbf_real pbf_surface_distance(const Surface *s, pbf_vec x, pbf_vec *normal) {
  pbf_nearest_part part;
  return pbf_surface_nearest(s, x, normal, &part);
}

/* Whether x is farther than `reach` from anything of it, cheaply. */
PBF_FN int pbf_surface_is_beyond(const pbf_surface *s, pbf_vec x, pbf_real reach) {
  pbf_vec p = pbf_sub(x, s->center);
  pbf_real far = s->bound + reach;
  return pbf_dot(p, p) > far * far;
}

/* What need not be convex: beyond its tangent plane there may be more of it. */
PBF_FN int pbf_surface_is_field(const pbf_surface *s) { return s->shape == PBF_COLLIDER_SHAPE; }
PBF_FN int pbf_surface_is_field(const pbf_closed_surface *) { return 0; }

/* What has no other side: a plane, and all that fluid is inside of. */
PBF_FN int pbf_surface_is_unbounded(const pbf_surface *s) { return s->bound == (pbf_real)INFINITY; }

/* How far it reaches from its centre along an axis. */
PBF_FN double pbf_surface_extent(const pbf_surface *s, int axis) {
  return shapes::ask(s->shape, [&](auto shape) { return shape.extent(s, axis); });
}

/* How thin it is, from face to face. */
PBF_FN double pbf_surface_width(const pbf_surface *s) {
  return shapes::ask(s->shape, [&](auto shape) { return shape.width(s); });
}

/* Whether the straight way between two points in the fluid leads through it. Where fluid is inside,
 * or before a plane, it does not. */
template <class Surface>
PBF_FN int pbf_surface_blocks(const Surface *s, pbf_vec from, pbf_vec to) {
  if (pbf_surface_is_unbounded(s)) return 0;
  const pbf_vec p = pbf_sub(from, s->center), way = pbf_sub(to, from);
  return ask_shape(s, [&](auto shape) -> int { return shape.blocks(s, p, way); });
}

/* ---- Planes that it contributes density by ------------------------------------------------- */

/* An inside with faces contributes by all of these, as the domain does, everything else by its
 * nearest plane. */
template <class Surface>
PBF_FN int pbf_surface_planes(const Surface *s) {
  const int faces = ask_shape(s, [](auto shape) -> int { return shape.FACES; });
  return faces > 0 && s->sign < 0 ? faces : 1;
}

template <class Surface>
PBF_FN pbf_real pbf_surface_plane_distance(const Surface *s, int plane, int planes, pbf_vec x,
                                           pbf_vec *normal, pbf_nearest_part *part) {
  if (planes == 1) return pbf_surface_nearest(s, x, normal, part);
  *part = PBF_NEAREST_FACE;
  const pbf_vec p = pbf_sub(x, s->center);
  return ask_shape(s, [&](auto shape) -> pbf_real {
    if constexpr (decltype(shape)::FACES > 0)
      return shape.face(s, plane, p, normal);
    else
      return 0;
  });
}

#endif
