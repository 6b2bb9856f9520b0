/* What surfaces contribute to the densities of a group, a particle in each lane. The domain has a
 * path of its own, for all lanes at once: most groups are near no collider. */
#ifndef PBF_CPU_BOUNDARY_H
#define PBF_CPU_BOUNDARY_H

#include "cpu/clear_lanes.h"
#include "physics/boundary.h"

/* Distance of each particle from the nearest wall; the smallest of them. Most groups are far from
 * all. */
PBF_FN pbf_real domain_distances(const pbf_obstacles *o, const lane_values *x,
                                 pbf_real distances[WIDTH]) {
  pbf_real nearest = 0;
  for (uint32_t l = 0; l < WIDTH; ++l)
    distances[l] = pbf_domain_distance(&o->domain, lane_value(x, l));
  for (uint32_t l = 0; l < WIDTH; ++l)
    nearest = l == 0 ? distances[0] : pbf_real_min(nearest, distances[l]);
  return nearest;
}

/* Beyond this distance no surface contributes; with a margin for rounding. */
PBF_FN pbf_real contribution_reach(const pbf_constants *c) {
  return (pbf_real)1.001 * (c->h - c->wall_offset);
}

/* Whether the nearest of domain_distances is below this. */
PBF_FN int any_near_domain(const pbf_domain *domain, const lane_vector<lane> &x, pbf_real reach) {
  lane beyond = ops<lane>::set(-reach); /* a wall; negative inside */
  for (int k = 0; k < PBF_DIM; ++k) {
    beyond = ops<lane>::max(beyond, ops<lane>::set(domain->lower.c[k]) - x.c[k]);
    beyond = ops<lane>::max(beyond, x.c[k] - ops<lane>::set(domain->upper.c[k]));
  }
  return lane_any_below(ops<lane>::set(-reach), beyond);
}

/* Some may be; of colliders nothing is known. */
PBF_FN int near_obstacles(const pbf_constants *c, const pbf_obstacles *o,
                          const lane_vector<lane> &x) {
  return pbf_surface_count(*o) || any_near_domain(&o->domain, x, contribution_reach(c));
}

/* What an array has at the nodes 0 … PBF_WALL_LAST - 1, one for each lane. */
PBF_FN void at_nodes(const pbf_real *array, const int nodes[WIDTH], pbf_real values[WIDTH]) {
#ifdef LANES_LOOK_UP
  _Static_assert(PBF_WALL_LAST == 32, "as many as lanes_look_up can tell apart");
  lane_store(values, lanes_look_up(array, nodes));
#else
  for (uint32_t l = 0; l < WIDTH; ++l) values[l] = array[nodes[l]];
#endif
}

/* What the walls of an axis contribute, in all lanes. */
typedef struct lane_walls {
  _Alignas(64) pbf_real value[WIDTH], slope[WIDTH];
} lane_walls;

/* Adds what the wall at these distances contributes, whose normal has this sign; 0: none of them is
 * near. */
static int add_wall_lanes(const pbf_constants *c, const pbf_real distances[WIDTH], pbf_real sign,
                          lane_walls *walls) {
  _Alignas(64) pbf_real s[WIDTH], within[WIDTH], push[WIDTH], v0[WIDTH], v1[WIDTH], g0[WIDTH],
      g1[WIDTH];
  _Alignas(64) int nodes[WIDTH];
  const pbf_real last = PBF_WALL_LAST;
  if (!lane_any_below(lane_load(distances), ops<lane>::set(contribution_reach(c)))) return 0;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real t = pbf_wall_node(c, distances[l]), inside = pbf_real_max(t, 0);
    within[l] = t < last ? 1 : 0;
    s[l] = pbf_real_min(inside, last);
    push[l] = pbf_boundary_gradient_scale(c, s[l]);
  }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    int node = (int)s[l];
    nodes[l] = node < PBF_WALL_LAST ? node : PBF_WALL_LAST - 1;
    s[l] -= (pbf_real)nodes[l];
  }
  at_nodes(c->wall_value, nodes, v0);
  at_nodes(c->wall_value + 1, nodes, v1);
  at_nodes(c->wall_slope, nodes, g0);
  at_nodes(c->wall_slope + 1, nodes, g1);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real slope, value = pbf_wall_interpolated(s[l], v0[l], v1[l], g0[l], g1[l], &slope);
    walls->value[l] += within[l] * value;
    walls->slope[l] += sign * within[l] * (push[l] * slope);
  }
  return 1;
}

/* What those of an axis contribute; 0: none is near a particle. */
PBF_FN int add_walls_of_axis(const pbf_constants *c, const pbf_domain *domain, int axis,
                             const lane_values *x, lane_walls *walls) {
  _Alignas(64) pbf_real below[WIDTH], above[WIDTH];
  for (uint32_t l = 0; l < WIDTH; ++l) below[l] = x->c[axis][l] - domain->lower.c[axis];
  for (uint32_t l = 0; l < WIDTH; ++l) above[l] = domain->upper.c[axis] - x->c[axis][l];
  const int near = add_wall_lanes(c, below, 1, walls);
  return near | add_wall_lanes(c, above, -1, walls);
}

/* Takes the additive part out of what the walls of an axis contribute. */
PBF_FN void keep_additive_part(const pbf_constants *c, lane_walls *walls, pbf_real additive[WIDTH],
                               pbf_real additive_slopes[WIDTH]) {
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real rate, part = pbf_overlapping_part(c, walls->value[l], &rate);
    additive[l] += walls->value[l] - part;
    additive_slopes[l] += (1 - rate) * walls->slope[l];
    walls->value[l] = part;
    walls->slope[l] *= rate;
  }
}

/* What surfaces contribute to the particles of a group. */
typedef struct lane_boundary {
  _Alignas(64) pbf_real density[WIDTH], rest[WIDTH];
  lane_values gradient;
} lane_boundary;

/* pbf_boundary_of_domain in all lanes, the same as pbf_boundary_at without colliders to the bit:
 * whether a group asks colliders must not show in its densities, as lanes without a particle have a
 * say in it. */
static __attribute__((noinline)) void boundary_of_domain(const pbf_constants *c,
                                                         const pbf_domain *domain,
                                                         const lane_values *x,
                                                         lane_boundary *boundary) {
  if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && domain->ghost_reach > 0) return;
  _Alignas(64) pbf_real overlapping[WIDTH] = {0}, additive[WIDTH] = {0};
  lane_values slopes = {{{0}}}, additive_slopes = {{{0}}};
  for (int k = 0; k < PBF_DIM; ++k) {
    lane_walls along = {{0}, {0}};
    const int near = add_walls_of_axis(c, domain, k, x, &along);
    if (near) keep_additive_part(c, &along, additive, additive_slopes.c[k]);
    for (int j = 0; j < PBF_DIM && near; ++j)
      for (uint32_t l = 0; l < WIDTH; ++l)
        slopes.c[j][l] = pbf_union_slope(along.value[l], j == k ? along.slope[l] : 0,
                                         overlapping[l], slopes.c[j][l]);
    for (uint32_t l = 0; l < WIDTH && near; ++l) {
      overlapping[l] = pbf_union_value(along.value[l], overlapping[l]);
      boundary->rest[l] = pbf_union_value(pbf_real_min(along.value[l], c->boundary_rest_density),
                                          boundary->rest[l]);
    }
  }
  for (uint32_t l = 0; l < WIDTH; ++l) boundary->density[l] = overlapping[l] + additive[l];
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l)
      boundary->gradient.c[k][l] = slopes.c[k][l] + additive_slopes.c[k][l];
}

/* pbf_boundary_at a particle beside some surfaces; 0: none of them is near it. Walls at least
 * contribution_reach away contribute nothing, and are not asked then. */
static __attribute__((noinline)) int boundary_by_surfaces(const pbf_constants *c,
                                                          const pbf_obstacles *near, pbf_vec x,
                                                          pbf_real to_wall,
                                                          pbf_boundary *boundary) {
  int met = 0;
  for (int k = 0; k < near->count && !met; ++k)
    met = pbf_may_be_within(&near->surfaces[k], x, contribution_reach(c));
  if (!met) return 0;
  *boundary = (pbf_boundary){0, 0, 0, {{0}}, {{0}}};
  if (to_wall < contribution_reach(c)) *boundary = pbf_boundary_of_domain(c, &near->domain, x);
  pbf_accumulate_colliders(c, *near, x, boundary);
  return 1;
}

/* How far particles may get in a step's iterations before whether colliders are near them is asked
 * anew. */
PBF_FN pbf_real clear_way(const pbf_constants *c) { return c->h / 8; }

PBF_FN pbf_real clear_reach(const pbf_constants *c) { return contribution_reach(c) + clear_way(c); }

/* Lanes with particles that may be near colliders. */
typedef struct lanes_asked {
  int any;
  uint8_t is[WIDTH];
} lanes_asked;

/* How far what is at x may go until it can be at one of some colliders, at most clear_reach: as in
 * bounds_are_within, distances change by no more than `steepest` times the way. */
static __attribute__((noinline)) pbf_real clear_way_from(const pbf_constants *c,
                                                         const pbf_obstacles *near, pbf_vec x) {
  pbf_real way = clear_reach(c);
  pbf_vec normal;
  for (int k = 0; k < near->count; ++k) {
    const pbf_surface *s = &near->surfaces[k];
    if (16 * s->skin > clear_way(c)) return 0;
    if (pbf_surface_is_beyond(s, x, way)) continue;
    const pbf_real distance = pbf_surface_distance(s, x, &normal) - 2 * s->skin - 16 * s->rounding;
    if (!(distance > 0)) return 0; /* what is no number, too */
    way = pbf_real_min(way, distance / s->steepest);
  }
  return way;
}

#include "cpu/boundary_solids.h"

/* clear_way_from in all lanes; false: one of these has too many nodes, or too thick a skin. */
PBF_FN bool clear_ways_from(const pbf_constants *c, const pbf_obstacles *near, const lane_values *x,
                            pbf_real *ways) {
  for (int k = 0; k < near->count; ++k)
    if (16 * near->surfaces[k].skin > clear_way(c)) return false;
  alignas(64) pbf_real longest[WIDTH];
  for (uint32_t l = 0; l < WIDTH; ++l) ways[l] = longest[l] = clear_reach(c);
  return shorten_ways_by(near, x, longest, ways);
}

/* Notes how far each may go, from x. */
static __attribute__((noinline)) void find_clear(const pbf_constants *c, const pbf_obstacles *o,
                                                 const lane_values *x, pbf_real *ways) {
  pbf_obstacles near;
  const group_bounds these = bounds_of_group(x, x);
  if (!BUILT_FOR_SIZE) obstacles_around_group(o, &these, clear_reach(c), &near);
  if (!BUILT_FOR_SIZE && clear_ways_from(c, &near, x, ways)) return;
  const int met = obstacles_within(o, &these, clear_reach(c), &near);
  for (uint32_t l = 0; l < WIDTH; ++l)
    ways[l] = met ? clear_way_from(c, &near, lane_value(x, l)) : clear_reach(c);
}

/* Those that have gone as far as these ways, or farther; a way of 0 is none. */
static __attribute__((noinline)) lanes_asked lanes_beyond(const pbf_real ways[WIDTH],
                                                          const lane_values *from,
                                                          const lane_values *x) {
  lanes_asked asked = {0, {0}};
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_vec gone = pbf_sub(lane_value(x, l), lane_value(from, l));
    asked.is[l] = !(pbf_dot(gone, gone) < ways[l] * ways[l]);
    asked.any |= asked.is[l];
  }
  return asked;
}

/* pbf_boundary_at those of a group that are asked, one by one: of what lanes leave. */
static __attribute__((noinline)) void boundary_one_by_one(
    const pbf_constants *c, const pbf_obstacles *o, const group_bounds *these, const lane_values *x,
    const pbf_real to_wall[WIDTH], const lanes_asked *asked, lane_boundary *boundary) {
  /* Where few are asked each looks for its own. */
  const bool each_alone = !BUILT_FOR_SIZE && o->grid && asked;
  pbf_obstacles near;
  if (!each_alone && !obstacles_within(o, these, contribution_reach(c), &near)) return;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_boundary by_all;
    pbf_vec gradient = {{0}};
    if (asked && !asked->is[l]) continue;
    if (each_alone) near = pbf_obstacles_near(*o, lane_value(x, l), c->h);
    if (!boundary_by_surfaces(c, &near, lane_value(x, l), to_wall[l], &by_all)) continue;
    boundary->density[l] = 0;
    pbf_add_boundary(&by_all, &boundary->density[l], &gradient);
    boundary->rest[l] = by_all.rest;
    set_lane(&boundary->gradient, l, gradient);
  }
}

/* pbf_boundary_at in all lanes; of lanes that are not asked no collider is near. */
static __attribute__((noinline)) void boundary_of_group(const pbf_constants *c,
                                                        const pbf_obstacles *o,
                                                        const lane_values *x,
                                                        const lanes_asked *asked,
                                                        lane_boundary *boundary) {
  memset(boundary, 0, sizeof *boundary);
  if (!pbf_surface_count(*o)) {
    boundary_of_domain(c, &o->domain, x, boundary);
    return;
  }
  alignas(64) pbf_real to_wall[WIDTH];
  if (domain_distances(o, x, to_wall) < contribution_reach(c))
    boundary_of_domain(c, &o->domain, x, boundary);
  if (asked && !asked->any) return;
  pbf_obstacles near;
  met_solids solids;
  alignas(64) pbf_real are_asked[WIDTH];
  const group_bounds these = bounds_of_group(x, x);
  if (!BUILT_FOR_SIZE && !obstacles_around_group(o, &these, contribution_reach(c), &near)) return;
  for (uint32_t l = 0; l < WIDTH; ++l) are_asked[l] = asked && !asked->is[l] ? 0 : 1;
  if (BUILT_FOR_SIZE || !meet_solids(c, &near, x, are_asked, &solids)) {
    boundary_one_by_one(c, o, &these, x, to_wall, asked, boundary);
    return;
  }
  boundary_of_solids(c, &o->domain, x, to_wall, &solids, boundary);
  if (!lane_any_below(ops<lane>::set(0), lane_load(solids.left))) return;
  lanes_asked left = {1, {0}};
  for (uint32_t l = 0; l < WIDTH; ++l) left.is[l] = solids.left[l] > 0;
  boundary_one_by_one(c, o, &these, x, to_wall, &left, boundary);
}

#endif
