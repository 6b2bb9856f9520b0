/* Collision response (Algorithm 1, line 14): a position inside a solid goes to the nearest point of
 * its surface. Shapes are prepared once a step in float64 and applied in the particles' precision.
 */
#ifndef PBF_PHYSICS_COLLIDE_H
#define PBF_PHYSICS_COLLIDE_H

#include "physics/motion.h"
#include "physics/real.h"

typedef struct pbf_walls {
  pbf_vec lower, upper;
} pbf_walls;

static inline pbf_walls pbf_walls_at(const pbf_params *params, double time) {
  pbf_walls walls;
  for (int k = 0; k < PBF_DIM; ++k) {
    walls.lower.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k, time);
    walls.upper.c[k] = (pbf_real)pbf_motion_wall(params, 2 * k + 1, time);
  }
  return walls;
}

/* Walls that have crossed leave particles at the lower one. */
PBF_FN pbf_vec pbf_clamp(const pbf_walls *walls, pbf_vec x) {
  for (int k = 0; k < PBF_DIM; ++k)
    x.c[k] = pbf_real_max(pbf_real_min(x.c[k], walls->upper.c[k]), walls->lower.c[k]);
  return x;
}

/* A collider in one pose. Rows of `frame` are directions in space: a box's own axes, otherwise the
 * normal or capsule axis and one perpendicular to it. */
typedef struct pbf_solid {
  int shape;
  pbf_real sign; /* 1: the fluid stays outside, -1: inside */
  pbf_vec center;
  pbf_vec frame[PBF_DIM];
  pbf_vec half_extents;
  pbf_real radius, half_length;
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
  for (int k = 0; k < 3; ++k) frame[1][k] /= sqrt(across2), frame[2][k] = 0;
}

static inline pbf_solid pbf_solid_at(const pbf_collider *at_set, double elapsed) {
  pbf_collider now;
  double frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  pbf_motion_collider(at_set, elapsed, &now);
  if (now.shape != PBF_COLLIDER_BOX) pbf_axis_frame(now.axis, frame);
  pbf_solid s = {0};
  s.shape = (int)now.shape;
  s.sign = now.inverted ? (pbf_real)-1 : (pbf_real)1;
  s.radius = (pbf_real)now.radius;
  s.half_length = (pbf_real)now.half_length;
  for (int row = 0; row < PBF_DIM; ++row) {
    double turned[3];
    pbf_rotate(now.orientation, frame[row], turned);
    for (int k = 0; k < PBF_DIM; ++k) s.frame[row].c[k] = (pbf_real)turned[k];
    s.center.c[row] = (pbf_real)now.position[row];
    s.half_extents.c[row] = (pbf_real)now.half_extents[row];
  }
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
PBF_FN pbf_real pbf_solid_distance(const pbf_solid *s, pbf_vec x, pbf_vec *normal) {
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

/* Moves x out of the solid along the shortest way. */
PBF_FN pbf_vec pbf_collide(const pbf_solid *s, pbf_vec x) {
  pbf_vec normal;
  pbf_real distance = pbf_solid_distance(s, x, &normal);
  return distance < 0 ? pbf_add_scaled(x, -distance, normal) : x;
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

/* Walls last: whatever a collider does, the domain holds. */
PBF_FN pbf_vec pbf_resolve(const pbf_walls *walls, int count, const pbf_solid *solids, pbf_vec x) {
  for (int k = 0; k < count; ++k) x = pbf_collide(&solids[k], x);
  return pbf_clamp(walls, x);
}

#endif
