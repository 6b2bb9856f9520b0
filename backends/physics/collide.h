/* Collision response (Algorithm 1, line 14): a particle whose way leads into a solid stays on the
 * side it came from. Shapes are prepared once a step in float64 and applied in the particles'
 * precision. */
#ifndef PBF_PHYSICS_COLLIDE_H
#define PBF_PHYSICS_COLLIDE_H

#include "physics/mirrors.h"
#include "physics/motion.h"

static inline pbf_walls pbf_walls_at(const pbf_params *params, double time) {
  pbf_walls walls;
  int bounces = params->solver == PBF_SOLVER_CHEBYSHEV;
  walls.near = bounces ? (pbf_real)(0.5 * params->smoothing_radius) : 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    walls.lower.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k, time);
    walls.upper.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k + 1, time);
  }
  walls.reach = pbf_mirror_reach(params, walls.lower, walls.upper);
  return walls;
}

/* How far before a wall comes back what has landed `depth` behind it: half of that, of more than
 * half an h a hundredth. It so keeps apart from what else does: laid onto the wall itself, or
 * always to a small part of the depth, what a crowd presses into a corner ends in one point of it,
 * where a pair has no direction to part in. And what has fallen from far is not lifted far. */
PBF_FN pbf_real pbf_bounce(const pbf_walls *walls, pbf_real depth) {
  pbf_real near = pbf_real_min(depth, walls->near);
  return walls->near > 0 ? (pbf_real)0.01 * depth + (pbf_real)0.49 * near : 0;
}

/* Walls that have crossed leave particles at the lower one. */
PBF_FN pbf_vec pbf_clamp(const pbf_walls *walls, pbf_vec x) {
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real lower = walls->lower.c[k], upper = walls->upper.c[k];
    pbf_real at = pbf_real_max(x.c[k], lower + pbf_bounce(walls, lower - x.c[k]));
    at = pbf_real_min(at, upper - pbf_bounce(walls, at - upper));
    x.c[k] = pbf_real_max(pbf_real_min(at, upper), lower);
  }
  return x;
}

/* A collider at the end of a step, and where it was at its start. Rows of `frame` are directions in
 * space: a box's own axes, otherwise the normal or capsule axis and perpendiculars to it. */
typedef struct pbf_solid {
  int shape;
  pbf_real sign; /* 1: the fluid stays outside, -1: inside */
  pbf_vec center;
  pbf_vec frame[PBF_DIM];
  pbf_vec half_extents;
  pbf_real radius, half_length;
  pbf_real bound; /* nothing of it is farther from the centre */
  pbf_vec start_center, start_frame[PBF_DIM];
} pbf_solid;

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

static inline void pbf_place_solid(const pbf_collider *at_set, double elapsed, pbf_vec *center,
                                   pbf_vec frame[PBF_DIM]) {
  pbf_collider now;
  double own[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  pbf_motion_collider(at_set, elapsed, &now);
  if (now.shape != PBF_COLLIDER_BOX) pbf_axis_frame(now.axis, own);
  for (int row = 0; row < PBF_DIM; ++row) {
    double turned[3];
    pbf_rotate(now.orientation, own[row], turned);
    for (int k = 0; k < PBF_DIM; ++k) frame[row].c[k] = (pbf_real)turned[k];
    center->c[row] = (pbf_real)now.position[row];
  }
}

/* As it stood at the start of the step. */
PBF_FN pbf_solid pbf_solid_before(const pbf_solid *solid) {
  pbf_solid before = *solid;
  before.center = solid->start_center;
  for (int k = 0; k < PBF_DIM; ++k) before.frame[k] = solid->start_frame[k];
  return before;
}

/* At the end of a step, `elapsed` after the collider was set. */
static inline pbf_solid pbf_solid_at(const pbf_collider *at_set, double elapsed, double time_step) {
  double extent2 = 0;
  pbf_solid s = {0};
  s.shape = (int)at_set->shape;
  s.sign = at_set->inverted ? (pbf_real)-1 : (pbf_real)1;
  s.radius = (pbf_real)at_set->radius;
  s.half_length = (pbf_real)at_set->half_length;
  for (int k = 0; k < PBF_DIM; ++k) {
    s.half_extents.c[k] = (pbf_real)at_set->half_extents[k];
    extent2 += at_set->half_extents[k] * at_set->half_extents[k];
  }
  double bound = s.shape == PBF_COLLIDER_BOX       ? sqrt(extent2)
                 : s.shape == PBF_COLLIDER_CAPSULE ? at_set->radius + at_set->half_length
                                                   : at_set->radius;
  s.bound = s.shape == PBF_COLLIDER_PLANE || at_set->inverted ? (pbf_real)INFINITY
                                                              : (pbf_real)(1.0001 * bound);
  pbf_place_solid(at_set, elapsed, &s.center, s.frame);
  pbf_place_solid(at_set, elapsed - time_step, &s.start_center, s.start_frame);
  return s;
}

/* Signed distance to the surface of a sphere around `center` (negative inside), with the outward
 * normal; from the very centre, out along `fallback`. */
PBF_FN pbf_real pbf_sphere_distance(pbf_vec from_center, pbf_real radius, pbf_vec fallback,
                                    pbf_vec *normal) {
  pbf_real r = pbf_real_sqrt(pbf_dot(from_center, from_center));
  *normal = fallback;
  if (r > 0)
    for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = from_center.c[k] / r;
  return r - radius;
}

/* The same for a box, in its own frame: outside, the nearest point of it; inside, its nearest face.
 */
PBF_FN pbf_real pbf_box_distance(pbf_vec p, pbf_vec half, pbf_vec *normal) {
  pbf_real inside = 0, outside2 = 0;
  int face = 0;
  pbf_vec out;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real d = (p.c[k] < 0 ? -p.c[k] : p.c[k]) - half.c[k];
    if (k == 0 || d > inside) inside = d, face = k;
    out.c[k] = d > 0 ? (p.c[k] < 0 ? -d : d) : 0;
    outside2 += out.c[k] * out.c[k];
    normal->c[k] = 0;
  }
  if (outside2 > 0) {
    pbf_real distance = pbf_real_sqrt(outside2);
    for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = out.c[k] / distance;
    return distance;
  }
  normal->c[face] = p.c[face] < 0 ? (pbf_real)-1 : (pbf_real)1;
  return inside;
}

/* Distance of x from the solid, negative where the fluid must not be; *normal points to the fluid.
 */
PBF_FN_APART pbf_real pbf_solid_distance(const pbf_solid *s, pbf_vec x, pbf_vec *normal) {
  pbf_vec p = pbf_sub(x, s->center), n = s->frame[0];
  pbf_real distance;
  if (s->shape == PBF_COLLIDER_PLANE) {
    distance = pbf_dot(p, n);
  } else if (s->shape == PBF_COLLIDER_BOX) {
    pbf_vec local, local_normal;
    for (int k = 0; k < PBF_DIM; ++k) local.c[k] = pbf_dot(p, s->frame[k]);
    distance = pbf_box_distance(local, s->half_extents, &local_normal);
    for (int k = 0; k < PBF_DIM; ++k) {
      n.c[k] = 0;
      for (int row = 0; row < PBF_DIM; ++row) n.c[k] += s->frame[row].c[k] * local_normal.c[row];
    }
  } else {
    if (s->shape == PBF_COLLIDER_CAPSULE) {
      pbf_real along = pbf_dot(p, s->frame[0]);
      along = pbf_real_max(pbf_real_min(along, s->half_length), -s->half_length);
      p = pbf_add_scaled(p, -along, s->frame[0]);
    }
    distance = pbf_sphere_distance(p, s->radius, s->frame[1], &n);
  }
  for (int k = 0; k < PBF_DIM; ++k) normal->c[k] = s->sign * n.c[k];
  return s->sign * distance;
}

/* Whether x is farther than `reach` from anything of the solid, cheaply. */
PBF_FN int pbf_solid_beyond(const pbf_solid *s, pbf_vec x, pbf_real reach) {
  pbf_vec p = pbf_sub(x, s->center);
  pbf_real far = s->bound + reach;
  return pbf_dot(p, p) > far * far;
}

/* Where a point that the solid carries along is at the end of the step. */
PBF_FN pbf_vec pbf_carried(const pbf_solid *s, pbf_vec x) {
  pbf_vec p = pbf_sub(x, s->start_center), moved = s->center;
  for (int row = 0; row < PBF_DIM; ++row)
    moved = pbf_add_scaled(moved, pbf_dot(p, s->start_frame[row]), s->frame[row]);
  return moved;
}

/* Moves x out of the solid along the shortest way. */
PBF_FN pbf_vec pbf_collide(const pbf_solid *s, pbf_vec x) {
  pbf_vec normal;
  pbf_real distance = pbf_solid_distance(s, x, &normal);
  return distance < 0 ? pbf_add_scaled(x, -distance, normal) : x;
}

/* Where the way of length `length` from `from` to x, `distance` before the solid, first meets it,
 * found by stepping on by the distance from it (sphere tracing); *normal is that of its surface
 * there. A way that grazes the solid for long comes to no end and counts as one that meets it at
 * the nearest point: solids are convex, so none of it is before that point's tangent plane. Returns
 * 0 where it does not meet it. */
PBF_FN int pbf_meet(const pbf_solid *s, pbf_vec from, pbf_vec x, pbf_real length, pbf_real distance,
                    pbf_real close, pbf_vec *at, pbf_vec *normal) {
  enum { STEPS = 48 };
  pbf_real way = distance;
  for (int k = 0; k < STEPS && way < length; ++k) {
    *at = pbf_add_scaled(from, way / length, pbf_sub(x, from));
    distance = pbf_solid_distance(s, *at, normal);
    way += distance;
    if (distance < close) break;
  }
  if (!(way < length) && !(distance < close)) return 0;
  *at = pbf_add_scaled(*at, -distance, *normal);
  return 1;
}

/* A particle on its way from `from`, which the solid carries along, to x: where the way enters the
 * solid it slides on along the tangent plane, so that nothing goes through however thin the solid
 * and however fast the particle. What starts inside leaves by the face that is nearest to the
 * start. */
PBF_FN pbf_vec pbf_collide_on_way(const pbf_solid *s, pbf_vec from, pbf_vec x) {
  pbf_vec way = pbf_sub(x, from), at = from, normal;
  pbf_real length = pbf_real_sqrt(pbf_dot(way, way));
  if (pbf_solid_beyond(s, from, length)) return x;
  pbf_real distance = pbf_solid_distance(s, from, &normal);
  if (!(distance < length)) return x;
  pbf_real close = (pbf_real)1e-6 * (s->bound + length + pbf_real_sqrt(pbf_dot(from, from)));
  if (distance > close) {
    if (!pbf_meet(s, from, x, length, distance, close, &at, &normal)) return pbf_collide(s, x);
  } else {
    at = pbf_add_scaled(from, -distance, normal);
  }
  pbf_real depth = pbf_dot(pbf_sub(at, x), normal);
  if (depth > 0) x = pbf_add_scaled(x, depth, normal);
  return pbf_collide(s, x);
}

/* Walls and colliders of one step. */
typedef struct pbf_obstacles {
  pbf_walls walls;
  int count;
  pbf_solid solids[PBF_MAX_COLLIDERS];
} pbf_obstacles;

/* A build without colliders has no code for them. */
PBF_FN int pbf_solid_count(const pbf_obstacles *o) {
  return PBF_BUILT & PBF_FEATURE_COLLIDERS ? o->count : 0;
}

/* What has no other side holds particles as walls do: planes, too, make corners. */
PBF_FN pbf_vec pbf_hold(const pbf_walls *walls, const pbf_solid *s, pbf_vec x) {
  pbf_vec normal;
  pbf_real distance = pbf_solid_distance(s, x, &normal);
  if (!(distance < 0)) return x;
  return pbf_add_scaled(x, pbf_bounce(walls, -distance) - distance, normal);
}

/* The way of a particle from `from` to x past one collider; with `carried` it has moved since the
 * particle was there, in the prediction, and otherwise not. */
PBF_FN pbf_vec pbf_resolve_one(const pbf_walls *walls, const pbf_solid *s, int carried,
                               pbf_vec from, pbf_vec x) {
  if (s->bound == (pbf_real)INFINITY) return pbf_hold(walls, s, x);
  return pbf_collide_on_way(s, carried ? pbf_carried(s, from) : from, x);
}

/* The same past all obstacles. Walls last: whatever a collider does, the domain holds. */
PBF_FN pbf_vec pbf_resolve(const pbf_walls *walls, int count, const pbf_solid *solids, int carried,
                           pbf_vec from, pbf_vec x) {
  for (int k = 0; k < count; ++k) x = pbf_resolve_one(walls, &solids[k], carried, from, x);
  return pbf_clamp(walls, x);
}

#endif
