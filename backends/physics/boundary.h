/* What walls and colliders contribute to the density of a particle, and to its move. */
#ifndef PBF_PHYSICS_BOUNDARY_H
#define PBF_PHYSICS_BOUNDARY_H

#include "physics/collide.h"
#include "physics/constants.h"

enum { PBF_WALL_LAST = PBF_WALL_NODES - 1 };

/* Where a distance from a plane wall is among the nodes that say what the wall lends: from
 * PBF_WALL_LAST on it lends nothing. */
PBF_FN pbf_real pbf_wall_place(const pbf_constants *c, pbf_real distance) {
  return (distance + c->wall_offset) * c->inv_h * PBF_WALL_LAST;
}

/* From the slope of what a wall lends to what it pushes with, t among the nodes. */
PBF_FN pbf_real pbf_wall_push(const pbf_constants *c, pbf_real t) {
  pbf_real beyond = pbf_real_min(pbf_real_max(t - c->wall_first, 0), c->wall_layer);
  return c->wall_push + c->wall_push_rise * beyond;
}

/* Density that the wall lends at the part s of the way between two nodes with these values and
 * slopes, and its derivative over this way. */
PBF_FN pbf_real pbf_wall_between(pbf_real s, pbf_real v0, pbf_real v1, pbf_real g0, pbf_real g1,
                                 pbf_real *slope) {
  pbf_real s2 = s * s, rise = v1 - v0;
  *slope = g0 + 6 * s * (1 - s) * rise - (4 * s - 3 * s2) * g0 - (2 * s - 3 * s2) * g1;
  return v0 + s * g0 + s2 * ((3 - 2 * s) * rise - (2 - s) * g0 - (1 - s) * g1);
}

PBF_FN_APART pbf_real pbf_wall(const pbf_constants *c, pbf_real distance, pbf_real *slope) {
  pbf_real t = pbf_wall_place(c, distance);
  *slope = 0;
  if (!(t < PBF_WALL_LAST)) return 0;
  t = pbf_real_max(t, 0);
  int k = (int)t;
  pbf_real value = pbf_wall_between(t - k, c->wall_value[k], c->wall_value[k + 1], c->wall_slope[k],
                                    c->wall_slope[k + 1], slope);
  *slope *= pbf_wall_push(c, t);
  return value;
}

/* The part of what an obstacle lends that it shares with others: all of it up to twice what it
 * lends the first layer of a fluid at rest, then ever less; *rate is the derivative. The rest it
 * lends for itself: deep inside two walls nothing of their slopes may be lost, else their common
 * edge pushes back less than the fluid presses, and holds for good whom an impact has thrown there.
 */
PBF_FN pbf_real pbf_wall_share(const pbf_constants *c, pbf_real value, pbf_real *rate) {
  pbf_real beyond = pbf_real_min(pbf_real_max(value * c->wall_inv_rest - 2, 0), 2);
  *rate = 1 - beyond / 2;
  return pbf_real_min(value, 2 * c->wall_rest) + c->wall_rest * beyond * (1 - beyond / 4);
}

/* Joins the share of one more obstacle, `value` with the gradient `slope` * `normal`, to what
 * others lend. Half-spaces overlap, where walls meet at right angles: what is free of both is about
 * the product of what is free of each, exactly so for a kernel that is a product over the axes. */
PBF_FN pbf_real pbf_join_slope(pbf_real value, pbf_real slope, pbf_real lent, pbf_real gradient) {
  return gradient * (1 - value) + (1 - lent) * slope;
}

PBF_FN pbf_real pbf_join_value(pbf_real value, pbf_real lent) { return lent + (1 - lent) * value; }

/* What obstacles lend: as far as they share it, and each for itself; and of what they share what
 * they would lend at most to a fluid at rest. */
typedef struct pbf_lent {
  pbf_real shared, own, resting;
  pbf_vec shared_gradient, own_gradient;
} pbf_lent;

PBF_FN void pbf_join_wall(const pbf_constants *c, pbf_real value, pbf_real slope, pbf_vec normal,
                          pbf_lent *lent) {
  pbf_real rate, share = pbf_wall_share(c, value, &rate);
  for (int k = 0; k < PBF_DIM; ++k)
    lent->shared_gradient.c[k] =
        pbf_join_slope(share, rate * slope * normal.c[k], lent->shared, lent->shared_gradient.c[k]);
  lent->shared = pbf_join_value(share, lent->shared);
  lent->resting = pbf_join_value(pbf_real_min(share, c->wall_rest), lent->resting);
  lent->own_gradient = pbf_add_scaled(lent->own_gradient, (1 - rate) * slope, normal);
  lent->own += value - share;
}

/* How much the half-space of one more obstacle and what others lend overlap, from 1 where they face
 * the same way, as a floor and a plane laid on it do, by 0 at right angles, to -1 where they face
 * each other. `gradient` is of what the others lend: where they cancel out, no way. */
PBF_FN pbf_real pbf_facing(pbf_vec gradient, pbf_real slope, pbf_vec normal) {
  pbf_real steep2 = pbf_real_max(pbf_dot(gradient, gradient), slope * slope / 16);
  return steep2 > 0 ? -pbf_dot(gradient, normal) / pbf_real_sqrt(steep2) : 0;
}

/* How much of what two lend overlaps, where they face the same way so much and each other so. */
PBF_FN pbf_real pbf_overlap(pbf_real a, pbf_real b, pbf_real same, pbf_real product) {
  return product * a * b + same * pbf_real_min(a, b);
}

/* Joins the share of a collider's plane: like pbf_join_wall at right angles, the larger of both
 * where they face the same way, and their sum where they face each other. */
PBF_FN void pbf_join_plane(const pbf_constants *c, pbf_real value, pbf_real slope, pbf_vec normal,
                           pbf_lent *lent) {
  pbf_real rate, share = pbf_wall_share(c, value, &rate);
  pbf_real facing = pbf_facing(lent->shared_gradient, slope, normal);
  pbf_real same = pbf_real_max(facing, 0), product = 1 - pbf_real_max(facing, -facing);
  pbf_real keep = 1 - product * share - (lent->shared < share ? same : 0);
  pbf_real add = 1 - product * lent->shared - (lent->shared < share ? 0 : same);
  pbf_real resting = pbf_real_min(share, c->wall_rest);
  for (int k = 0; k < PBF_DIM; ++k)
    lent->shared_gradient.c[k] =
        keep * lent->shared_gradient.c[k] + add * rate * slope * normal.c[k];
  lent->shared += share - pbf_overlap(lent->shared, share, same, product);
  lent->resting += resting - pbf_overlap(lent->resting, resting, same, product);
  lent->own_gradient = pbf_add_scaled(lent->own_gradient, (1 - rate) * slope, normal);
  lent->own += value - share;
}

/* Walls that mirror the fluid lend nothing beside. */
PBF_FN pbf_lent pbf_lent_by_walls(const pbf_constants *c, const pbf_walls *walls, pbf_vec x) {
  pbf_lent lent = {0, 0, 0, {{0}}, {{0}}};
  if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && walls->reach > 0) return lent;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_vec axis = {{0}};
    axis.c[k] = 1;
    pbf_real rise, fall, value = pbf_wall(c, pbf_wall_distance(walls, 2 * k, x), &rise);
    value += pbf_wall(c, pbf_wall_distance(walls, 2 * k + 1, x), &fall);
    pbf_join_wall(c, value, rise - fall, axis, &lent);
  }
  return lent;
}

/* From where on obstacles lend nothing. */
PBF_FN pbf_real pbf_lending_reach(const pbf_constants *c) { return c->h - c->wall_offset; }

PBF_FN void pbf_join_solid(const pbf_constants *c, const pbf_solid *s, pbf_vec x, pbf_lent *lent) {
  if (pbf_solid_beyond(s, x, pbf_lending_reach(c))) return;
  int planes = pbf_lending_planes(s);
  for (int plane = 0; plane < planes; ++plane) {
    pbf_vec normal;
    pbf_real slope, distance = pbf_plane_distance(s, plane, planes, x, &normal);
    pbf_real value = pbf_wall(c, distance, &slope);
    pbf_join_plane(c, value, slope, normal, lent);
  }
}

PBF_FN void pbf_add_lent(const pbf_lent *lent, pbf_real *density, pbf_vec *gradient) {
  *density += lent->shared + lent->own;
  *gradient = pbf_add_scaled(*gradient, 1, lent->shared_gradient);
  *gradient = pbf_add_scaled(*gradient, 1, lent->own_gradient);
}

PBF_FN pbf_vec pbf_lent_gradient(const pbf_lent *lent) {
  return pbf_add_scaled(lent->shared_gradient, 1, lent->own_gradient);
}

namespace {

/* What all walls of the domain and all colliders lend. */
template <class Obstacles>
PBF_FN pbf_lent pbf_lent_at(const pbf_constants *c, const Obstacles &o, pbf_vec x) {
  pbf_lent lent = pbf_lent_by_walls(c, &o.walls, x);
  for (int k = 0; k < pbf_solid_count(o); ++k) pbf_join_solid(c, &o.solids[k], x, &lent);
  return lent;
}

/* What obstacles lend: the domain's walls, which don't turn, at x, and colliders at `at`, as they
 * stood `before` the step or after it. */
template <class Obstacles>
PBF_FN_APART pbf_lent pbf_lent_from(const pbf_constants *c, const Obstacles &o, pbf_vec x,
                                    pbf_vec at, int before) {
  pbf_lent lent = pbf_lent_by_walls(c, &o.walls, x);
  for (int k = 0; k < pbf_solid_count(o); ++k) {
    const pbf_solid solid = before ? pbf_solid_before(&o.solids[k]) : o.solids[k];
    pbf_join_solid(c, &solid, at, &lent);
  }
  return lent;
}

template <class Obstacles>
PBF_FN void pbf_add_walls(const pbf_constants *c, const Obstacles &o, pbf_vec x, pbf_real *density,
                          pbf_vec *gradient) {
  pbf_lent lent = pbf_lent_at(c, o, x);
  pbf_add_lent(&lent, density, gradient);
}

}  // namespace

/* The part of a kernel's slope along a wall that lies beyond it is to the whole as the densities
 * are (by parts). Fluid mirrored in the wall would lend that, too; without it a pressure that grows
 * with the depth carries less of the fluid next to walls than of the rest, by a quarter at three
 * spacings, and it sinks, for good. So what its neighbours do along a wall is done more often, but
 * not for closer particles than in a fluid at rest: thin sheets would gain energy. With less than
 * PBF_BESIDE of it the fluid next to walls sinks, with all of it it rises. */
#define PBF_BESIDE 0.75

/* A sum of moves with the walls' part, where these lend something with a gradient, which is
 * `resting` for a fluid at rest. A corner of three walls comes to 0.75 at h = 5 spacings; colliders
 * that face each other in a slot may add up to more than there is. */
PBF_FN pbf_vec pbf_beside_walls(pbf_vec sum, pbf_real lambda, pbf_real resting, pbf_vec gradient) {
  pbf_real walls = pbf_real_min(resting, (pbf_real)0.75);
  pbf_real more = (pbf_real)PBF_BESIDE * walls / (1 - walls);
  pbf_real steep2 = pbf_dot(gradient, gradient);
  pbf_real across = pbf_dot(sum, gradient) / (steep2 > 0 ? steep2 : 1);
  pbf_vec along = pbf_add_scaled(sum, -across, gradient);
  return pbf_add_scaled(pbf_add_scaled(sum, more, along), lambda, gradient);
}

PBF_FN pbf_vec pbf_beside_lent(pbf_vec sum, pbf_real lambda, const pbf_lent *lent) {
  pbf_real density = 0;
  pbf_vec gradient = {{0}};
  pbf_add_lent(lent, &density, &gradient);
  return pbf_beside_walls(sum, lambda, lent->resting, gradient);
}

#endif
