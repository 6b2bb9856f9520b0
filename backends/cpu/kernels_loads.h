/* Part of kernels.cpp: what walls take of particles that are near no other solid, in all lanes
 * (physics/load_shares.h). The loops over lanes ask nothing of one lane alone, and are left to the
 * compiler's vectoriser. */
#ifndef PBF_CPU_KERNELS_LOADS_H
#define PBF_CPU_KERNELS_LOADS_H

#include "cpu/boundary.h"
#include "cpu/kernels.h"
#include "physics/load_parts.h"

namespace {

enum { DOMAIN_WALLS = 2 * PBF_DIM };

/* Numbers of lanes that are to be added to a solid's sums. */
struct lane_parts {
  double of[PBF_LOAD_SUMS][WIDTH];
  uint64_t depth[WIDTH];
  int touches[WIDTH];
};

/* Particles, and how many walls are near each. A wall is near some alone, and near others beside
 * others: 1 in their lanes, and 0 in the rest. */
struct lanes_at_walls {
  pbf_real x[PBF_DIM][WIDTH], push[PBF_DIM][WIDTH], lambda[WIDTH];
  pbf_real distance[DOMAIN_WALLS][WIDTH], slope[DOMAIN_WALLS][WIDTH];
  int count[WIDTH], alone[DOMAIN_WALLS][WIDTH], beside[DOMAIN_WALLS][WIDTH];
  int any_alone[DOMAIN_WALLS], any_beside[DOMAIN_WALLS];
};

/* What planes that share a push take of it: load_system. */
struct lane_shares {
  double weight[DOMAIN_WALLS][WIDTH], left[PBF_DIM][WIDTH];
};

}  // namespace

PBF_FN pbf_vec normal_of_wall(int wall) {
  pbf_vec normal;
  for (int k = 0; k < PBF_DIM; ++k)
    normal.c[k] = k != wall / 2 ? (pbf_real)0 : wall % 2 ? (pbf_real)-1 : (pbf_real)1;
  return normal;
}

PBF_FN pbf_vec place_of_lane(const lanes_at_walls *of, uint32_t l) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) x.c[k] = of->x[k][l];
  return x;
}

/* What is no number counts as none. */
PBF_FN pbf_wide_sum sum_of_numbers(const double *numbers, uint32_t count, double units) {
  int64_t high = 0, low = 0;
  for (uint32_t l = 0; l < count; ++l) {
    const pbf_wide_sum one = pbf_wide_of((is_none(numbers[l]) ? 0 : numbers[l]) * units);
    high += one.high;
    low += one.low;
  }
  return {high, low};
}

/* Pushes are what forces alone would have made of velocities, and become what is beside that. */
static void note_pushes(double units, field v, field push, const pbf_real *mobility, uint32_t first,
                        uint32_t last, pbf_wide_sum change[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    int64_t high = 0, low = 0;
    for (uint32_t i = first; i < last; ++i) {
      const pbf_real forced = push.c[k][i];
      const pbf_wide_sum one =
          pbf_wide_of(units * (double)(mobility ? forced * (1 / mobility[i]) : forced));
      high += one.high;
      low += one.low;
    }
    for (uint32_t i = first; i < last; ++i) push.c[k][i] = v.c[k][i] - push.c[k][i];
    pbf_wide_add(&change[k], {high, low});
  }
}

static __attribute__((noinline)) void sum_changes(const load_pass *p, uint32_t first, uint32_t last,
                                                  pbf_wide_sum change[PBF_DIM]) {
  const double units = p->scales->velocity;
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real *v = p->v.c[k], *mobility = p->mobility;
    int64_t high = 0, low = 0;
    for (uint32_t i = first; i < last; ++i) {
      const pbf_wide_sum one = pbf_wide_of(units * (double)(mobility ? v[i] / mobility[i] : v[i]));
      high += one.high;
      low += one.low;
    }
    pbf_wide_add(&change[k], {high, low});
  }
}

/* From particle `first` on. */
static void fetch_lanes(const load_pass *p, uint32_t first, lanes_at_walls *of) {
  for (int k = 0; k < PBF_DIM; ++k) {
    for (uint32_t l = 0; l < WIDTH; ++l) of->x[k][l] = p->x.c[k][first + l];
    for (uint32_t l = 0; l < WIDTH; ++l) of->push[k][l] = p->push.c[k][first + l];
    for (uint32_t l = 0; l < WIDTH && p->mobility; ++l) of->push[k][l] /= p->mobility[first + l];
  }
  for (uint32_t l = 0; l < WIDTH; ++l) of->lambda[l] = p->lambda[first + l];
  for (uint32_t l = 0; l < WIDTH; ++l) of->count[l] = 0;
}

/* Lanes behind the last are near nothing, and others, a bit each, count as if they were. Most walls
 * near one of them. */
static __attribute__((noinline)) int find_walls(const load_pass *p, uint32_t lanes, uint32_t others,
                                                lanes_at_walls *of) {
  const pbf_domain domain = *p->domain;
  const pbf_real reach = (pbf_real)p->scales->reach;
  int most = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    for (uint32_t l = 0; l < WIDTH; ++l) of->distance[2 * k][l] = of->x[k][l] - domain.lower.c[k];
    for (uint32_t l = 0; l < WIDTH; ++l)
      of->distance[2 * k + 1][l] = domain.upper.c[k] - of->x[k][l];
  }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    of->count[l] = 0;
    for (int wall = 0; wall < DOMAIN_WALLS; ++wall)
      of->count[l] += of->distance[wall][l] < reach ? 1 : 0;
  }
  for (uint32_t l = lanes; l < WIDTH; ++l) of->count[l] = 0;
  for (uint32_t l = 0; l < lanes && others; ++l, others >>= 1)
    if (others & 1) of->count[l] = 0;
  for (uint32_t l = 0; l < WIDTH; ++l) most = most > of->count[l] ? most : of->count[l];
  for (int wall = 0; wall < DOMAIN_WALLS && most > 0; ++wall) {
    int alone = 0, beside = 0;
    for (uint32_t l = 0; l < WIDTH; ++l) {
      const int is = of->distance[wall][l] < reach ? 1 : 0;
      of->alone[wall][l] = is & (of->count[l] == 1 ? 1 : 0);
      of->beside[wall][l] = is & (of->count[l] > 1 ? 1 : 0);
      alone |= of->alone[wall][l];
      beside |= of->beside[wall][l];
    }
    of->any_alone[wall] = alone;
    of->any_beside[wall] = beside;
    lane_walls contributed = {{0}, {0}};
    if (alone | beside) add_wall_lanes(p->constants, of->distance[wall], 1, &contributed);
    memcpy(of->slope[wall], contributed.slope, sizeof contributed.slope);
  }
  return most;
}

PBF_FN pbf_load_plane plane_of_lane(const lanes_at_walls *of, int wall, pbf_vec normal,
                                    uint32_t l) {
  return {wall, of->distance[wall][l], of->slope[wall][l], 1, normal};
}

/* 0 where it is not wanted. */
PBF_FN void put_numbers(const load_numbers &one, bool is, uint32_t l, lane_parts *numbers) {
  for (int k = 0; k < 3; ++k) {
    numbers->of[PBF_LOAD_CHANGE + k][l] = is ? one.of[PBF_LOAD_CHANGE + k] : 0;
    numbers->of[PBF_LOAD_TURN + k][l] = is ? one.of[PBF_LOAD_TURN + k] : 0;
    numbers->of[PBF_LOAD_PLACE + k][l] = is ? one.of[PBF_LOAD_PLACE + k] : 0;
    numbers->of[PBF_LOAD_ALONG + k][l] = is ? one.of[PBF_LOAD_ALONG + k] : 0;
  }
  numbers->of[PBF_LOAD_WET][l] = is ? one.of[PBF_LOAD_WET] : 0;
  numbers->depth[l] = is ? pbf_depth_bits(one.depth) : 0;
  numbers->touches[l] = is && one.touches ? 1 : 0;
}

/* Of lanes that this wall alone is near. */
static __attribute__((noinline)) void share_with_one(const load_pass *p, const lanes_at_walls *of,
                                                     int wall, lane_parts *restrict numbers) {
  const pbf_load_scales s = *p->scales;
  const pbf_load_measure m = *p->walls;
  const pbf_vec normal = normal_of_wall(wall);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_load_plane plane = plane_of_lane(of, wall, normal, l);
    const double by_lambda = s.by_lambda * (double)of->lambda[l] * (double)plane.slope;
    double push[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k)
      push[k] = (double)of->push[k][l] - by_lambda * (double)plane.normal.c[k];
    put_numbers(load_numbers_of(&s, m, place_of_lane(of, l), plane,
                                load_share_of_one(plane, by_lambda, push)),
                of->alone[wall][l] > 0, l, numbers);
  }
}

/* What is to be shared out by more than one. */
static __attribute__((noinline)) void solve_lanes(const load_pass *p, const lanes_at_walls *of,
                                                  lane_shares *restrict shares) {
  const pbf_load_scales s = *p->scales;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    load_system system = {{{0}}, {0}};
    for (int k = 0; k < PBF_DIM; ++k) system.right[k] = (double)of->push[k][l];
    pbf_unrolled<DOMAIN_WALLS>([&](int wall) {
      const pbf_load_plane plane = plane_of_lane(of, wall, normal_of_wall(wall), l);
      const double own = of->beside[wall][l] > 0 ? s.by_lambda * (double)of->lambda[l] : 0;
      const double weight = of->beside[wall][l] > 0 ? load_weight(&s, plane) : 0;
      for (int k = 0; k < PBF_DIM; ++k)
        system.right[k] -= own * (double)plane.slope * (double)plane.normal.c[k];
      add_to_system(&system, weight, plane.normal);
      shares->weight[wall][l] = weight;
    });
    solve_system(&system);
    for (int k = 0; k < PBF_DIM; ++k) shares->left[k][l] = system.right[k];
  }
}

/* Of lanes that others are near, too. */
static __attribute__((noinline)) void share_with_others(const load_pass *p,
                                                        const lanes_at_walls *of,
                                                        const lane_shares *shares, int wall,
                                                        lane_parts *restrict numbers) {
  const pbf_load_scales s = *p->scales;
  const pbf_load_measure m = *p->walls;
  const pbf_vec normal = normal_of_wall(wall);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_load_plane plane = plane_of_lane(of, wall, normal, l);
    const double by_lambda = s.by_lambda * (double)of->lambda[l] * (double)plane.slope;
    double left[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k) left[k] = shares->left[k][l];
    put_numbers(
        load_numbers_of(&s, m, place_of_lane(of, l), plane,
                        load_share_of_plane(plane, shares->weight[wall][l], by_lambda, left)),
        of->beside[wall][l] > 0, l, numbers);
  }
}

/* Whether a wall across an axis can have this sum, of what it gets of the push of particles or of
 * a pressure: what it gets along its normal turns about the other axes, and so on. */
PBF_FN bool wall_has_sum(int axis, int which) {
  if (which < PBF_LOAD_TURN) return which - PBF_LOAD_CHANGE == axis;
  if (which < PBF_LOAD_WET) return which - PBF_LOAD_TURN != axis;
  if (which < PBF_LOAD_ALONG) return true;
  return which < PBF_LOAD_OPEN ? which - PBF_LOAD_ALONG != axis : which - PBF_LOAD_OPEN == axis;
}

/* To the sums of the wall across an axis. */
static __attribute__((noinline)) void add_numbers_of_lanes(const load_pass *p,
                                                           const lane_parts *numbers, int axis,
                                                           pbf_load_sums *to) {
  uint64_t depth = 0;
  int touches = 0;
  for (int k = 0; k < PBF_LOAD_OPEN; ++k)
    if (wall_has_sum(axis, k))
      pbf_wide_add(&to->of[k], sum_of_numbers(numbers->of[k], WIDTH, p->walls->units[k]));
  for (uint32_t l = 0; l < WIDTH; ++l) touches += numbers->touches[l];
  for (uint32_t l = 0; l < WIDTH; ++l)
    depth = depth > numbers->depth[l] ? depth : numbers->depth[l];
  to->contacts += (uint64_t)touches;
  pbf_deepen(to, depth);
}

/* Those that something pushes though no wall is near. */
static uint32_t lanes_left(const lanes_at_walls *of, uint32_t lanes) {
  int any = 0;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_vec push;
    for (int k = 0; k < PBF_DIM; ++k) push.c[k] = of->push[k][l];
    any |= of->count[l] == 0 && pbf_dot(push, push) > 0 ? 1 : 0;
  }
  uint32_t left = 0;
  for (uint32_t l = 0; l < lanes && any; ++l) {
    pbf_vec push;
    for (int k = 0; k < PBF_DIM; ++k) push.c[k] = of->push[k][l];
    left |= of->count[l] == 0 && pbf_dot(push, push) > 0 ? (uint32_t)1 << l : 0;
  }
  return left;
}

static uint32_t wall_loads(const load_pass *p, uint32_t first, uint32_t last, uint32_t others,
                           pbf_wide_sum change[PBF_DIM], pbf_load_sums walls[2 * PBF_DIM]) {
  uint32_t left = others;
  sum_changes(p, first, last, change);
  for (uint32_t i = first; i < last; i += WIDTH) {
    alignas(64) lanes_at_walls of;
    alignas(64) lane_parts numbers;
    alignas(64) lane_shares shares;
    const uint32_t lanes = last - i < WIDTH ? last - i : (uint32_t)WIDTH;
    fetch_lanes(p, i, &of);
    const int most = walls ? find_walls(p, lanes, others >> (i - first), &of) : 0;
    left |= lanes_left(&of, lanes) << (i - first);
    if (most > 1) solve_lanes(p, &of, &shares);
    for (int wall = 0; wall < DOMAIN_WALLS && most > 0; ++wall) {
      if (of.any_alone[wall]) {
        share_with_one(p, &of, wall, &numbers);
        add_numbers_of_lanes(p, &numbers, wall / 2, &walls[wall]);
      }
      if (of.any_beside[wall]) {
        share_with_others(p, &of, &shares, wall, &numbers);
        add_numbers_of_lanes(p, &numbers, wall / 2, &walls[wall]);
      }
    }
  }
  return left;
}

#endif
