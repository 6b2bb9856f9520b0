/* Collision response (Algorithm 1, line 14): a particle whose way leads into a solid stays on the
 * side it came from. */
#ifndef PBF_PHYSICS_COLLIDE_H
#define PBF_PHYSICS_COLLIDE_H

#include "physics/surfaces/obstacles.h"

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
  if (pbf_solid_is_endless(s)) return pbf_hold(walls, s, x);
  return pbf_collide_on_way(s, carried ? pbf_carried(s, from) : from, x);
}

namespace {

/* The same past all obstacles. Walls last: whatever a collider does, the domain holds. */
template <class Obstacles>
PBF_FN pbf_vec pbf_resolve(const Obstacles &o, int carried, pbf_vec from, pbf_vec x) {
  for (int k = 0; k < pbf_solid_count(o); ++k)
    x = pbf_resolve_one(&o.walls, &o.solids[k], carried, from, x);
  return pbf_clamp(&o.walls, x);
}

}  // namespace

#endif
