/* Collision response (Algorithm 1, line 14): a particle whose way leads through a surface stays
 * on the side it came from. */
#ifndef PBF_PHYSICS_COLLIDE_H
#define PBF_PHYSICS_COLLIDE_H

#include "physics/surfaces/obstacles.h"

/* Moves x out of the surface along the shortest way. */
PBF_FN pbf_vec pbf_collide(const pbf_surface *s, pbf_vec x) {
  pbf_vec normal;
  pbf_real distance = pbf_surface_distance(s, x, &normal);
  return distance < 0 ? pbf_add_scaled(x, -distance, normal) : x;
}

/* Where the way of length `length` from `from` to x, `distance` before the surface, first meets it,
 * found by stepping on by the distance from it (sphere tracing); *normal is that of the surface
 * there. A way that grazes it for long comes to no end and counts as one that meets it at
 * the nearest point: shapes are convex, so none of it is before that point's tangent plane. Returns
 * 0 where it does not meet it. */
PBF_FN int pbf_meet(const pbf_surface *s, pbf_vec from, pbf_vec x, pbf_real length,
                    pbf_real distance, pbf_real close, pbf_vec *at, pbf_vec *normal) {
  enum { STEPS = 48 };
  pbf_real way = distance;
  for (int k = 0; k < STEPS && way < length; ++k) {
    *at = pbf_add_scaled(from, way / length, pbf_sub(x, from));
    distance = pbf_surface_distance(s, *at, normal);
    way += distance;
    if (distance < close) break;
  }
  if (!(way < length) && !(distance < close)) return 0;
  *at = pbf_add_scaled(*at, -distance, *normal);
  return 1;
}

/* A particle on its way from `from`, which the surface carries along, to x: where the way enters
 * it, it slides on along the tangent plane, so that nothing goes through however thin the shape
 * and however fast the particle. What starts inside leaves by the face that is nearest to the
 * start. */
PBF_FN pbf_vec pbf_collide_on_way(const pbf_surface *s, pbf_vec from, pbf_vec x) {
  pbf_vec way = pbf_sub(x, from), at = from, normal;
  pbf_real length = pbf_real_sqrt(pbf_dot(way, way));
  if (pbf_surface_is_beyond(s, from, length)) return x;
  pbf_real distance = pbf_surface_distance(s, from, &normal);
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

/* What has no other side holds particles as walls do: planes, too, make corners. */
PBF_FN pbf_vec pbf_keep_out(const pbf_domain *domain, const pbf_surface *s, pbf_vec x) {
  pbf_vec normal;
  pbf_real distance = pbf_surface_distance(s, x, &normal);
  if (!(distance < 0)) return x;
  return pbf_add_scaled(x, pbf_bounce(domain, -distance) - distance, normal);
}

/* The way of a particle from `from` to x past one collider; `with_obstacle_motion` it has moved
 * since the particle was there, in the prediction, and otherwise not. */
PBF_FN pbf_vec pbf_resolve_collision(const pbf_domain *domain, const pbf_surface *s,
                                     int with_obstacle_motion, pbf_vec from, pbf_vec x) {
  if (pbf_surface_is_unbounded(s)) return pbf_keep_out(domain, s, x);
  return pbf_collide_on_way(s, with_obstacle_motion ? pbf_surface_carries(s, from) : from, x);
}

namespace {

/* The same past all obstacles. Walls last: whatever a collider does, the domain holds. */
template <class Obstacles>
PBF_FN pbf_vec pbf_resolve_collisions(const Obstacles &o, int with_obstacle_motion, pbf_vec from,
                                      pbf_vec x) {
  for (int k = 0; k < pbf_surface_count(o); ++k)
    x = pbf_resolve_collision(&o.domain, &o.surfaces[k], with_obstacle_motion, from, x);
  return pbf_keep_in_domain(&o.domain, x);
}

}  // namespace

#endif
