/* What walls and colliders lend to the densities of a group, a particle in each lane. */
#ifndef PBF_CPU_KERNELS_WALLS_H
#define PBF_CPU_KERNELS_WALLS_H

#include "cpu/kernels_collide.h"
#include "cpu/lane_vec.h"
#include "physics/boundary.h"

/* Distance of each particle from the nearest wall; the smallest of them. Most groups are far from
 * all. */
PBF_FN pbf_real wall_distances(const pbf_obstacles *o, const lane_values *x,
                               pbf_real distances[WIDTH]) {
  pbf_real least = 0;
  for (uint32_t l = 0; l < WIDTH; ++l)
    distances[l] = pbf_domain_distance(&o->walls, lane_value(x, l));
  for (uint32_t l = 0; l < WIDTH; ++l)
    least = l == 0 ? distances[0] : pbf_real_min(least, distances[l]);
  return least;
}

/* Beyond this distance no wall lends density; with room for rounding. */
PBF_FN pbf_real wall_reach(const pbf_constants *c) {
  return (pbf_real)1.001 * (c->h - c->wall_offset);
}

/* Somebody may be; of colliders nothing is known. */
PBF_FN int near_obstacles(const pbf_constants *c, const pbf_obstacles *o, const lane_values *x,
                          pbf_real distances[WIDTH]) {
  return pbf_solid_count(*o) || wall_distances(o, x, distances) < wall_reach(c);
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

/* What the walls of an axis lend, in all lanes. */
typedef struct lane_walls {
  _Alignas(64) pbf_real value[WIDTH], slope[WIDTH];
} lane_walls;

/* Adds what the wall at these distances lends, whose normal has this sign; 0: the sentinel is near.
 */
static int add_wall_lanes(const pbf_constants *c, const pbf_real distances[WIDTH], pbf_real sign,
                          lane_walls *walls) {
  _Alignas(64) pbf_real s[WIDTH], lends[WIDTH], push[WIDTH], v0[WIDTH], v1[WIDTH], g0[WIDTH],
      g1[WIDTH];
  _Alignas(64) int nodes[WIDTH];
  const pbf_real last = PBF_WALL_LAST;
  if (!lane_any_below(lane_load(distances), lane_set(wall_reach(c)))) return 0;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real t = pbf_wall_place(c, distances[l]), within = pbf_real_max(t, 0);
    lends[l] = t < last ? 1 : 0;
    s[l] = pbf_real_min(within, last);
    push[l] = pbf_wall_push(c, s[l]);
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
    pbf_real slope, value = pbf_wall_between(s[l], v0[l], v1[l], g0[l], g1[l], &slope);
    walls->value[l] += lends[l] * value;
    walls->slope[l] += sign * lends[l] * (push[l] * slope);
  }
  return 1;
}

/* Adds what the walls of an axis lend for themselves, and leaves what they share. */
PBF_FN void keep_own_part(const pbf_constants *c, lane_walls *walls, pbf_real own[WIDTH],
                          pbf_real own_slopes[WIDTH]) {
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real rate, share = pbf_wall_share(c, walls->value[l], &rate);
    own[l] += walls->value[l] - share;
    own_slopes[l] += (1 - rate) * walls->slope[l];
    walls->value[l] = share;
    walls->slope[l] *= rate;
  }
}

/* What walls and colliders lend the particles of a group. */
typedef struct lane_lent {
  _Alignas(64) pbf_real density[WIDTH], resting[WIDTH];
  lane_values gradient;
} lane_lent;

/* pbf_lent_by_walls in all lanes, and what pbf_lent_at makes where there are no colliders to the
 * bit: whether a group asks colliders must not be seen in its densities, as lanes that the sentinel
 * has have a say in it. */
static __attribute__((noinline)) void lent_by_walls(const pbf_constants *c, const pbf_walls *walls,
                                                    const lane_values *x, lane_lent *lent) {
  if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && walls->reach > 0) return;
  _Alignas(64) pbf_real shared[WIDTH] = {0}, own[WIDTH] = {0};
  lane_values slopes = {{{0}}}, own_slopes = {{{0}}};
  for (int k = 0; k < PBF_DIM; ++k) {
    _Alignas(64) pbf_real below[WIDTH], above[WIDTH];
    lane_walls along = {{0}, {0}};
    for (uint32_t l = 0; l < WIDTH; ++l) below[l] = x->c[k][l] - walls->lower.c[k];
    for (uint32_t l = 0; l < WIDTH; ++l) above[l] = walls->upper.c[k] - x->c[k][l];
    int near = add_wall_lanes(c, below, 1, &along);
    near |= add_wall_lanes(c, above, -1, &along);
    if (near) keep_own_part(c, &along, own, own_slopes.c[k]);
    for (int j = 0; j < PBF_DIM && near; ++j)
      for (uint32_t l = 0; l < WIDTH; ++l)
        slopes.c[j][l] =
            pbf_join_slope(along.value[l], j == k ? along.slope[l] : 0, shared[l], slopes.c[j][l]);
    for (uint32_t l = 0; l < WIDTH && near; ++l) {
      shared[l] = pbf_join_value(along.value[l], shared[l]);
      lent->resting[l] =
          pbf_join_value(pbf_real_min(along.value[l], c->wall_rest), lent->resting[l]);
    }
  }
  for (uint32_t l = 0; l < WIDTH; ++l) lent->density[l] = shared[l] + own[l];
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l)
      lent->gradient.c[k][l] = slopes.c[k][l] + own_slopes.c[k][l];
}

/* Of a group's particles, on their way from `from`. */
static __attribute__((noinline)) swarm swarm_of_group(const lane_values *from,
                                                      const lane_values *x) {
  pbf_vec lower = lane_value(x, 0), upper = lower;
  pbf_real way2 = 0;
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) {
      lower.c[k] = pbf_real_min(lower.c[k], pbf_real_min(x->c[k][l], from->c[k][l]));
      upper.c[k] = pbf_real_max(upper.c[k], pbf_real_max(x->c[k][l], from->c[k][l]));
    }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec way = pbf_sub(lane_value(x, l), lane_value(from, l));
    way2 = pbf_real_max(way2, pbf_dot(way, way));
  }
  return swarm_between(lower, upper, pbf_real_sqrt(way2));
}

PBF_FN int solids_lend(const pbf_constants *c, const pbf_obstacles *o, pbf_vec x) {
  pbf_vec normal;
  for (int k = 0; k < o->count; ++k)
    if (!(pbf_solid_distance(&o->solids[k], x, &normal) > wall_reach(c))) return 1;
  return 0;
}

/* pbf_lent_at in all lanes. */
static __attribute__((noinline)) void lent_to_group(const pbf_constants *c, const pbf_obstacles *o,
                                                    const lane_values *x, lane_lent *lent) {
  memset(lent, 0, sizeof *lent);
  if (!pbf_solid_count(*o)) {
    lent_by_walls(c, &o->walls, x, lent);
    return;
  }
  pbf_obstacles near;
  const swarm these = swarm_of_group(x, x);
  pbf_real distances[WIDTH];
  if (!obstacles_within(o, &these, wall_reach(c), &near)) {
    if (wall_distances(&near, x, distances) < wall_reach(c)) lent_by_walls(c, &o->walls, x, lent);
    return;
  }
  wall_distances(&near, x, distances);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    if (!(distances[l] < wall_reach(c)) && !solids_lend(c, &near, lane_value(x, l))) continue;
    pbf_vec gradient = {{0}};
    pbf_lent by_all = pbf_lent_at(c, near, lane_value(x, l));
    pbf_add_lent(&by_all, &lent->density[l], &gradient);
    lent->resting[l] = by_all.resting;
    set_lane(&lent->gradient, l, gradient);
  }
}

#endif
