/* What surfaces contribute to the density of a particle near them, and to its move: every one as a
 * few planes, each with fluid at rest behind it. */
#ifndef PBF_PHYSICS_BOUNDARY_H
#define PBF_PHYSICS_BOUNDARY_H

#include "physics/collide.h"
#include "physics/constants.h"
#include "physics/near_planes.h"

enum { PBF_WALL_LAST = PBF_WALL_NODES - 1 };

/* Where a distance from a plane is among the nodes that its density is tabulated at: from
 * PBF_WALL_LAST on it contributes nothing. */
PBF_FN pbf_real pbf_wall_node(const pbf_constants *c, pbf_real distance) {
  return (distance + c->wall_offset) * c->inv_h * PBF_WALL_LAST;
}

/* From the slope of a plane's density to the gradient that it pushes with, t among the nodes. */
PBF_FN pbf_real pbf_boundary_gradient_scale(const pbf_constants *c, pbf_real t) {
  pbf_real beyond = pbf_real_min(pbf_real_max(t - c->wall_first, 0), c->wall_layer);
  return pbf_multiply_add(c->wall_gradient_rise, beyond, c->wall_gradient_scale);
}

/* A plane's density at the part s of the way between two nodes with these values and slopes, and
 * its derivative over this way. */
PBF_FN pbf_real pbf_wall_interpolated(pbf_real s, pbf_real v0, pbf_real v1, pbf_real g0,
                                      pbf_real g1, pbf_real *slope) {
  pbf_real s2 = s * s, rise = v1 - v0;
  const pbf_real up = pbf_multiply_add(6 * s * (1 - s), rise, g0);
  *slope = pbf_multiply_add(-(2 * s - 3 * s2), g1, pbf_multiply_add(-(4 * s - 3 * s2), g0, up));
  const pbf_real bend = pbf_multiply_add(-(2 - s), g0, (3 - 2 * s) * rise);
  return pbf_multiply_add(s2, pbf_multiply_add(-(1 - s), g1, bend), pbf_multiply_add(s, g0, v0));
}

/* A plane's density at a distance from it, and *slope, the gradient along the normal. */
PBF_FN_HOST_NOINLINE pbf_real pbf_wall_density(const pbf_constants *c, pbf_real distance,
                                               pbf_real *slope) {
  pbf_real t = pbf_wall_node(c, distance);
  *slope = 0;
  if (!(t < PBF_WALL_LAST)) return 0;
  t = pbf_real_max(t, 0);
  int k = (int)t;
  pbf_real value = pbf_wall_interpolated(t - k, c->wall_value[k], c->wall_value[k + 1],
                                         c->wall_slope[k], c->wall_slope[k + 1], slope);
  *slope *= pbf_boundary_gradient_scale(c, t);
  return value;
}

/* The overlapping part of a plane's density: all of it up to twice that at the first layer of a
 * fluid at rest, then ever less; *rate is the derivative. The rest is additive: deep inside two
 * walls nothing of their slopes may be lost, else their common edge pushes back less than the fluid
 * presses, and holds for good what an impact has thrown there. */
PBF_FN pbf_real pbf_overlapping_part(const pbf_constants *c, pbf_real value, pbf_real *rate) {
  pbf_real beyond = pbf_real_min(pbf_real_max(value * c->inv_boundary_rest_density - 2, 0), 2);
  *rate = 1 - beyond / 2;
  return pbf_real_min(value, 2 * c->boundary_rest_density) +
         c->boundary_rest_density * beyond * (1 - beyond / 4);
}

/* The union of a half-space's part, `value` with the gradient `slope` * normal, with that of others
 * at right angles to it, `other` with `gradient`: what is free of both is about the product of what
 * is free of each, exactly so for a kernel that is a product over the axes. */
PBF_FN pbf_real pbf_union_slope(pbf_real value, pbf_real slope, pbf_real other, pbf_real gradient) {
  return pbf_multiply_add(1 - other, slope, gradient * (1 - value));
}

PBF_FN pbf_real pbf_union_value(pbf_real value, pbf_real other) {
  return pbf_multiply_add(1 - other, value, other);
}

/* What surfaces contribute: the part of it that may overlap with others', and the part that adds
 * up; and of what overlaps what they contribute at most to a fluid at rest. */
typedef struct pbf_boundary {
  pbf_real overlapping, additive, rest;
  pbf_vec overlapping_gradient, additive_gradient;
} pbf_boundary;

/* Adds planes at right angles to all others. */
PBF_FN void pbf_accumulate_wall(const pbf_constants *c, pbf_real value, pbf_real slope,
                                pbf_vec normal, pbf_boundary *boundary) {
  pbf_real rate, part = pbf_overlapping_part(c, value, &rate);
  for (int k = 0; k < PBF_DIM; ++k)
    boundary->overlapping_gradient.c[k] =
        pbf_union_slope(part, rate * slope * normal.c[k], boundary->overlapping,
                        boundary->overlapping_gradient.c[k]);
  boundary->overlapping = pbf_union_value(part, boundary->overlapping);
  boundary->rest = pbf_union_value(pbf_real_min(part, c->boundary_rest_density), boundary->rest);
  boundary->additive_gradient =
      pbf_add_scaled(boundary->additive_gradient, (1 - rate) * slope, normal);
  boundary->additive += value - part;
}

/* How much the half-space of one more plane overlaps with those of others, from 1 where they face
 * the same way, as a floor and a plane laid on it do, by 0 at right angles, to -1 where they face
 * each other. `gradient` is that of the others' density: where they cancel out, none. */
PBF_FN pbf_real pbf_alignment(pbf_vec gradient, pbf_real slope, pbf_vec normal) {
  pbf_real steep2 = pbf_real_max(pbf_dot(gradient, gradient), slope * slope / 16);
  return steep2 > 0 ? -pbf_dot(gradient, normal) / pbf_real_sqrt(steep2) : 0;
}

/* How much of two densities overlaps, where they face the same way by `same`, and are at right
 * angles by `product`. */
PBF_FN pbf_real pbf_shared_part(pbf_real a, pbf_real b, pbf_real same, pbf_real product) {
  return product * a * b + same * pbf_real_min(a, b);
}

/* Adds a plane that may face any way: like pbf_accumulate_wall at right angles, the larger of both
 * where they face the same way, and their sum where they face each other. */
PBF_FN void pbf_accumulate_plane(const pbf_constants *c, pbf_real value, pbf_real slope,
                                 pbf_vec normal, pbf_boundary *boundary) {
  pbf_real rate, part = pbf_overlapping_part(c, value, &rate);
  pbf_real alignment = pbf_alignment(boundary->overlapping_gradient, slope, normal);
  pbf_real same = pbf_real_max(alignment, 0), product = 1 - pbf_real_max(alignment, -alignment);
  pbf_real keep = 1 - product * part - (boundary->overlapping < part ? same : 0);
  pbf_real add = 1 - product * boundary->overlapping - (boundary->overlapping < part ? 0 : same);
  pbf_real rest = pbf_real_min(part, c->boundary_rest_density);
  for (int k = 0; k < PBF_DIM; ++k)
    boundary->overlapping_gradient.c[k] =
        keep * boundary->overlapping_gradient.c[k] + add * rate * slope * normal.c[k];
  boundary->overlapping += part - pbf_shared_part(boundary->overlapping, part, same, product);
  boundary->rest += rest - pbf_shared_part(boundary->rest, rest, same, product);
  boundary->additive_gradient =
      pbf_add_scaled(boundary->additive_gradient, (1 - rate) * slope, normal);
  boundary->additive += value - part;
}

/* The domain, whose walls are at right angles or face each other. Walls that have ghosts contribute
 * nothing beside. */
PBF_FN pbf_boundary pbf_boundary_of_domain(const pbf_constants *c, const pbf_domain *domain,
                                           pbf_vec x) {
  pbf_boundary boundary = {0, 0, 0, {{0}}, {{0}}};
  if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && domain->ghost_reach > 0) return boundary;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_vec axis = {{0}};
    axis.c[k] = 1;
    pbf_real rise, fall, value = pbf_wall_density(c, pbf_wall_distance(domain, 2 * k, x), &rise);
    value += pbf_wall_density(c, pbf_wall_distance(domain, 2 * k + 1, x), &fall);
    pbf_accumulate_wall(c, value, rise - fall, axis, &boundary);
  }
  return boundary;
}

/* From where on surfaces contribute nothing. */
PBF_FN pbf_real pbf_boundary_reach(const pbf_constants *c) { return c->h - c->wall_offset; }

/* The density that a face contributes by itself. Deep inside a surface that has another side it
 * stays what it is at its first node, and so has no slope there: a push that never lowers what it
 * is to undo would go on in every step. */
PBF_FN pbf_real pbf_face_density(const pbf_constants *c, const pbf_near_face &face,
                                 pbf_real *slope) {
  const pbf_real value = pbf_wall_density(c, face.distance, slope);
  if (!face.is_unbounded && face.distance < -c->wall_offset) *slope = 0;
  return value;
}

PBF_FN_HOST_NOINLINE void pbf_accumulate_face(const pbf_constants *c, const pbf_near_face &face,
                                              pbf_real part, pbf_boundary *boundary) {
  /* Whether it is asked must not show, whatever others add up to. */
  if (!(pbf_wall_node(c, face.distance) < PBF_WALL_LAST)) return;
  pbf_real slope;
  const pbf_real value = pbf_face_density(c, face, &slope);
  pbf_accumulate_plane(c, part * value, part * slope, face.normal, boundary);
}

/* Whether a face lies flush with a wall of the domain, or behind it: that wall, or its ghosts, then
 * stand for all that is behind the face. In a corner the sum of the domain's walls leans away from
 * each of them, and would not tell. */
PBF_FN_HOST_NOINLINE int pbf_is_behind_wall(const pbf_constants *c, const pbf_domain *domain,
                                            pbf_vec x, const pbf_near_face &face) {
  const int wall = pbf_wall_along(domain, x, pbf_boundary_reach(c), &face);
  return wall >= 0 && face.distance > pbf_wall_distance(domain, wall, x) - c->h / 128;
}

/* Adds what surfaces contribute at x, within the domain. */
template <class Each>
PBF_FN_HOST_NOINLINE void pbf_accumulate_surfaces(const pbf_constants *c, const pbf_domain *domain,
                                                  pbf_vec x, Each each, pbf_boundary *boundary) {
  pbf_each_near_plane(c, domain, x, pbf_boundary_reach(c), each,
                      [&](const pbf_near_face &face, pbf_real part) {
                        if (!pbf_is_behind_wall(c, domain, x, face))
                          pbf_accumulate_face(c, face, part, boundary);
                      });
}

PBF_FN void pbf_add_boundary(const pbf_boundary *boundary, pbf_real *density, pbf_vec *gradient) {
  *density += boundary->overlapping + boundary->additive;
  *gradient = pbf_add_scaled(*gradient, 1, boundary->overlapping_gradient);
  *gradient = pbf_add_scaled(*gradient, 1, boundary->additive_gradient);
}

PBF_FN pbf_vec pbf_boundary_gradient(const pbf_boundary *boundary) {
  return pbf_add_scaled(boundary->overlapping_gradient, 1, boundary->additive_gradient);
}

namespace {

/* Adds what all colliders contribute at x. */
template <class Obstacles>
PBF_FN void pbf_accumulate_colliders(const pbf_constants *c, const Obstacles &o, pbf_vec x,
                                     pbf_boundary *boundary) {
  if (pbf_surface_count(o) > 0)
    pbf_accumulate_surfaces(c, &o.domain, x, all_surfaces_of(o), boundary);
}

/* What all surfaces contribute at x. */
template <class Obstacles>
PBF_FN pbf_boundary pbf_boundary_at(const pbf_constants *c, const Obstacles &o, pbf_vec x) {
  pbf_boundary boundary = pbf_boundary_of_domain(c, &o.domain, x);
  pbf_accumulate_colliders(c, o, x, &boundary);
  return boundary;
}

/* What they contribute: the domain, whose walls don't rotate, at x, and colliders at `at`, as they
 * stood `before` the step or after it. */
template <class Obstacles>
PBF_FN_HOST_NOINLINE pbf_boundary pbf_boundary_at_time(const pbf_constants *c, const Obstacles &o,
                                                       pbf_vec x, pbf_vec at, int before) {
  pbf_boundary boundary = pbf_boundary_of_domain(c, &o.domain, x);
  const each_surface_at_time<decltype(o.surfaces)> all = {o.surfaces, pbf_surface_count(o), before};
  if (pbf_surface_count(o) > 0) pbf_accumulate_surfaces(c, &o.domain, at, all, &boundary);
  return boundary;
}

template <class Obstacles>
PBF_FN void pbf_add_boundary_at(const pbf_constants *c, const Obstacles &o, pbf_vec x,
                                pbf_real *density, pbf_vec *gradient) {
  pbf_boundary boundary = pbf_boundary_at(c, o, x);
  pbf_add_boundary(&boundary, density, gradient);
}

}  // namespace

/* The part of a kernel's slope along a wall that lies beyond it is to the whole as the densities
 * are (by parts). Fluid behind the wall would contribute that, too; without it a pressure that
 * grows with the depth carries less of the fluid next to walls than of the rest, by a quarter at
 * three spacings, and it sinks, for good. So what its neighbours do along a wall is done more
 * often, but not for closer particles than in a fluid at rest: thin sheets would gain energy. With
 * less than PBF_TANGENTIAL_FRACTION of it the fluid next to walls sinks, with all of it it rises.
 */
#define PBF_TANGENTIAL_FRACTION 0.75

/* By how much more, beside surfaces that contribute `rest` to a fluid at rest. A corner of three
 * walls comes to 0.75 at h = 5 spacings; colliders that face each other in a slot may add up to
 * more than there is. */
PBF_FN pbf_real pbf_tangential_excess(pbf_real rest) {
  pbf_real part = pbf_real_min(rest, (pbf_real)0.75);
  return (pbf_real)PBF_TANGENTIAL_FRACTION * part / (1 - part);
}

/* A sum of moves with the surfaces' part, where these contribute a density with a gradient:
 * `excess` more of what is along them. */
PBF_FN pbf_vec pbf_corrected_beside(pbf_vec sum, pbf_real lambda, pbf_real excess,
                                    pbf_vec gradient) {
  pbf_real steep2 = pbf_dot(gradient, gradient);
  pbf_real across = pbf_dot(sum, gradient) / (steep2 > 0 ? steep2 : 1);
  pbf_vec along = pbf_add_scaled(sum, -across, gradient);
  return pbf_add_scaled(pbf_add_scaled(sum, excess, along), lambda, gradient);
}

PBF_FN pbf_vec pbf_boundary_correction(pbf_vec sum, pbf_real lambda, pbf_real rest,
                                       pbf_vec gradient) {
  return pbf_corrected_beside(sum, lambda, pbf_tangential_excess(rest), gradient);
}

PBF_FN pbf_vec pbf_boundary_correction(pbf_vec sum, pbf_real lambda, const pbf_boundary *boundary) {
  pbf_real density = 0;
  pbf_vec gradient = {{0}};
  pbf_add_boundary(boundary, &density, &gradient);
  return pbf_boundary_correction(sum, lambda, boundary->rest, gradient);
}

#endif
