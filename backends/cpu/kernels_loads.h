/* Part of kernels.cpp: what solids take of particles (physics/load_shares.h), in all lanes, but of
 * those that are near what has no closed form, or near several of which not all are walls. The
 * loops over lanes ask nothing of one lane alone, and are left to the compiler's vectoriser. */
#ifndef PBF_CPU_KERNELS_LOADS_H
#define PBF_CPU_KERNELS_LOADS_H

#include "cpu/boundary.h"
#include "cpu/kernels.h"
#include "physics/load_parts.h"

namespace {

/* Particles and the planes near them; 1 or 0 in each lane. */
struct lanes_at_solids {
  lane_values x, push;
  alignas(64) pbf_real lambda[WIDTH];
  met_solids met;
  alignas(64) pbf_real slope[MET_PLANES][WIDTH];
  alignas(64) pbf_real alone[WIDTH], among_walls[WIDTH]; /* one is near it; several walls are */
  alignas(64) pbf_real among_others[WIDTH];              /* what lanes leave */
};

/* What one plane takes. */
struct lane_shares {
  alignas(64) double change[PBF_DIM][WIDTH], along[PBF_DIM][WIDTH];
};

/* load_system in each lane. */
struct lane_systems {
  alignas(64) double matrix[PBF_DIM][PBF_DIM][WIDTH], right[PBF_DIM][WIDTH];
};

}  // namespace

PBF_FN bool any_lane(const pbf_real marks[WIDTH]) {
  return lane_any_below(ops<lane>::set(0), lane_load(marks));
}

/* What is no number counts as none. */
PBF_FN pbf_wide_sum sum_of_numbers(const double *numbers, double units) {
  int64_t high = 0, low = 0;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_wide_sum one = pbf_wide_of((is_none(numbers[l]) ? 0 : numbers[l]) * units);
    high += one.high;
    low += one.low;
  }
  return {high, low};
}

/* Whether a solid can have this sum: a wall has what it gets along its normal, turns about the
 * other axes, and so on. */
PBF_FN bool has_sum(int solid, int which) {
  const int axis = solid / 2;
  if (solid >= PBF_WALLS) return which < PBF_LOAD_ALONG || which >= PBF_LOAD_OPEN;
  if (which < PBF_LOAD_TURN) return which - PBF_LOAD_CHANGE == axis;
  if (which < PBF_LOAD_WET) return which - PBF_LOAD_TURN != axis;
  if (which < PBF_LOAD_ALONG) return true;
  return which < PBF_LOAD_OPEN ? which - PBF_LOAD_ALONG != axis : which - PBF_LOAD_OPEN == axis;
}

/* ---- All velocities -------------------------------------------------------------------------- */

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

/* ---- Which solids are near ------------------------------------------------------------------- */

static __attribute__((noinline)) void find_wall(const pbf_domain *domain, int wall,
                                                const lane_values *x, pbf_real reach,
                                                lane_planes *restrict planes) {
  const pbf_real *along = x->c[wall / 2], lower = domain->lower.c[wall / 2],
                 upper = domain->upper.c[wall / 2];
  planes->is_unbounded = true;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    planes->distance[l] = wall % 2 ? upper - along[l] : along[l] - lower;
    planes->near[l] = planes->distance[l] < reach ? 1 : 0;
  }
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real side = wall % 2 ? (pbf_real)-1 : (pbf_real)1, normal = k == wall / 2 ? side : 0;
    for (uint32_t l = 0; l < WIDTH; ++l) planes->normal.c[k][l] = normal;
  }
}

/* Marks particles that may be near what has no closed form. */
static __attribute__((noinline)) void mark_near(const pbf_surface *s, const lane_values *x,
                                                pbf_real reach, pbf_real marks[WIDTH]) {
  for (uint32_t l = 0; l < WIDTH; ++l)
    marks[l] = pbf_surface_is_beyond(s, lane_value(x, l), reach) ? marks[l] : 1;
}

/* The planes of a collider; false: there is no room for them. */
static bool meet_collider(const load_pass *p, int collider, lanes_at_solids *of) {
  const pbf_surface *s = &p->obstacles->surfaces[collider];
  const pbf_real reach = (pbf_real)p->scales->reach;
  const int planes = pbf_surface_planes(s);
  if (pbf_surface_is_field(s)) {
    mark_near(s, &of->x, reach, of->among_others);
    return true;
  }
  for (int plane = 0; plane < planes; ++plane) {
    if (of->met.count < MET_PLANES) of->met.of[of->met.count].solid = PBF_WALLS + collider;
    if (!meet_plane(s, plane, planes, &of->x, reach, &of->met)) return false;
  }
  return true;
}

/* Walls, and some colliders; false: there is no room for all their planes. */
static bool meet_all(const load_pass *p, const uint16_t *near, int count, lanes_at_solids *of) {
  memset(of->among_others, 0, sizeof of->among_others);
  of->met.count = 0;
  for (int wall = 0; wall < 2 * PBF_DIM && near; ++wall) {
    lane_planes *to = &of->met.of[of->met.count];
    to->solid = wall;
    find_wall(&p->obstacles->domain, wall, &of->x, (pbf_real)p->scales->reach, to);
    of->met.count += any_lane(to->near);
  }
  for (int k = 0; k < count; ++k)
    if (!meet_collider(p, near[k], of)) return false;
  return true;
}

/* As pbf_face_density has them. */
static __attribute__((noinline)) void find_slopes(const pbf_constants *c, const lane_planes *planes,
                                                  pbf_real *restrict slope) {
  const pbf_real deepest = planes->is_unbounded ? -(pbf_real)INFINITY : -c->wall_offset;
  lane_walls contributed = {{0}, {0}};
  add_wall_lanes(c, planes->distance, 1, &contributed);
  for (uint32_t l = 0; l < WIDTH; ++l)
    slope[l] = planes->distance[l] < deepest ? 0 : contributed.slope[l];
}

/* Sorts lanes by how many planes are near; those behind the last particle are near none. */
static __attribute__((noinline)) void sort_lanes(uint32_t lanes, lanes_at_solids *of) {
  alignas(64) pbf_real all[WIDTH] = {0}, walls[WIDTH] = {0};
  for (uint32_t i = 0; i < of->met.count; ++i) {
    pbf_real *near = of->met.of[i].near;
    const pbf_real is_wall = of->met.of[i].solid < PBF_WALLS ? 1 : 0;
    for (uint32_t l = 0; l < WIDTH; ++l) {
      near[l] = l < lanes ? near[l] : 0;
      all[l] += near[l];
      walls[l] += is_wall * near[l];
    }
  }
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real others = l < lanes ? of->among_others[l] : 0;
    const pbf_real single = all[l] == 1 ? 1 : 0, several = all[l] > 1 ? 1 : 0;
    const pbf_real of_walls = all[l] == walls[l] ? several : 0;
    of->alone[l] = others > 0 ? 0 : single;
    of->among_walls[l] = others > 0 ? 0 : of_walls;
    of->among_others[l] = others > 0 ? 1 : several - of_walls;
  }
}

/* ---- What they take -------------------------------------------------------------------------- */

PBF_FN pbf_load_plane plane_of_lane(const lane_planes *planes, const pbf_real *slope, uint32_t l) {
  return {planes->solid, planes->distance[l], slope[l], 1, lane_value(&planes->normal, l)};
}

/* Of particles that it is near alone. */
static __attribute__((noinline)) void share_with_one(const load_pass *p, const lanes_at_solids *of,
                                                     uint32_t i, lane_shares *restrict shares) {
  const pbf_load_scales s = *p->scales;
  const lane_planes *planes = &of->met.of[i];
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_load_plane plane = plane_of_lane(planes, of->slope[i], l);
    const double by_lambda = s.by_lambda * (double)of->lambda[l];
    double push[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k)
      push[k] =
          (double)of->push.c[k][l] - by_lambda * (double)plane.slope * (double)plane.normal.c[k];
    const load_share one = load_share_of_one(plane, by_lambda * (double)plane.slope, push);
    for (int k = 0; k < PBF_DIM; ++k) shares->change[k][l] = one.change[k];
    for (int k = 0; k < PBF_DIM; ++k) shares->along[k][l] = one.along[k];
  }
}

static __attribute__((noinline)) void add_to_systems(const load_pass *p, const lanes_at_solids *of,
                                                     uint32_t i, lane_systems *restrict systems) {
  const pbf_load_scales s = *p->scales;
  const lane_planes *planes = &of->met.of[i];
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_load_plane plane = plane_of_lane(planes, of->slope[i], l);
    const double own = planes->near[l] > 0 ? s.by_lambda * (double)of->lambda[l] : 0;
    const double weight = planes->near[l] > 0 ? load_weight(&s, plane) : 0;
    load_system system;
    for (int k = 0; k < PBF_DIM; ++k)
      for (int j = 0; j < PBF_DIM; ++j) system.matrix[k][j] = systems->matrix[k][j][l];
    for (int k = 0; k < PBF_DIM; ++k)
      systems->right[k][l] -= own * (double)plane.slope * (double)plane.normal.c[k];
    add_to_system(&system, weight, plane.normal);
    for (int k = 0; k < PBF_DIM; ++k)
      for (int j = 0; j < PBF_DIM; ++j) systems->matrix[k][j][l] = system.matrix[k][j];
  }
}

/* What is to be shared out by several walls. */
static __attribute__((noinline)) void solve_systems(const load_pass *p, const lanes_at_solids *of,
                                                    lane_systems *restrict systems) {
  memset(systems->matrix, 0, sizeof systems->matrix);
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) systems->right[k][l] = (double)of->push.c[k][l];
  for (uint32_t i = 0; i < of->met.count; ++i)
    if (of->met.of[i].solid < PBF_WALLS) add_to_systems(p, of, i, systems);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    load_system system;
    for (int k = 0; k < PBF_DIM; ++k) {
      system.right[k] = systems->right[k][l];
      for (int j = 0; j < PBF_DIM; ++j) system.matrix[k][j] = systems->matrix[k][j][l];
    }
    solve_system(&system);
    for (int k = 0; k < PBF_DIM; ++k) systems->right[k][l] = system.right[k];
  }
}

/* Of particles that other walls are near, too. */
static __attribute__((noinline)) void share_with_others(const load_pass *p,
                                                        const lanes_at_solids *of, uint32_t i,
                                                        const lane_systems *systems,
                                                        lane_shares *restrict shares) {
  const pbf_load_scales s = *p->scales;
  const lane_planes *planes = &of->met.of[i];
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_load_plane plane = plane_of_lane(planes, of->slope[i], l);
    const double by_lambda = s.by_lambda * (double)of->lambda[l] * (double)plane.slope;
    double left[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k) left[k] = systems->right[k][l];
    const load_share one = load_share_of_plane(plane, load_weight(&s, plane), by_lambda, left);
    for (int k = 0; k < PBF_DIM; ++k) shares->change[k][l] = one.change[k];
    for (int k = 0; k < PBF_DIM; ++k) shares->along[k][l] = one.along[k];
  }
}

/* Adds the shares of the particles near a plane that are marked to the sums of its solid. */
static __attribute__((noinline)) void add_shares(const load_pass *p, const lanes_at_solids *of,
                                                 uint32_t i, const pbf_real marks[WIDTH],
                                                 const lane_shares *shares) {
  const pbf_load_scales s = *p->scales;
  const lane_planes *planes = &of->met.of[i];
  const load_slot slot = p->slot_of(p->recent, planes->solid);
  const pbf_load_measure m = *slot.measure;
  /* Their own: none of the others can be behind a pointer to them. */
  alignas(64) double numbers[PBF_LOAD_OPEN][WIDTH];
  alignas(64) uint64_t depths[WIDTH];
  alignas(64) int touches[WIDTH];
  uint64_t depth = 0;
  int contacts = 0;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_real is = marks[l] * planes->near[l];
    load_share share = {{0}, {0}, {0}};
    for (int k = 0; k < PBF_DIM; ++k) share.change[k] = shares->change[k][l];
    for (int k = 0; k < PBF_DIM; ++k) share.along[k] = shares->along[k][l];
    const load_numbers one = load_numbers_of(&s, m, lane_value(&of->x, l),
                                             plane_of_lane(planes, of->slope[i], l), share);
    for (int k = 0; k < 3; ++k) {
      numbers[PBF_LOAD_CHANGE + k][l] = is > 0 ? one.of[PBF_LOAD_CHANGE + k] : 0;
      numbers[PBF_LOAD_TURN + k][l] = is > 0 ? one.of[PBF_LOAD_TURN + k] : 0;
      numbers[PBF_LOAD_PLACE + k][l] = is > 0 ? one.of[PBF_LOAD_PLACE + k] : 0;
      numbers[PBF_LOAD_ALONG + k][l] = is > 0 ? one.of[PBF_LOAD_ALONG + k] : 0;
    }
    numbers[PBF_LOAD_WET][l] = is > 0 ? one.of[PBF_LOAD_WET] : 0;
    depths[l] = is > 0 ? pbf_depth_bits(one.depth) : 0;
    touches[l] = (double)planes->distance[l] < s.spacing ? (int)is : 0;
  }
  for (int k = 0; k < PBF_LOAD_OPEN; ++k)
    if (has_sum(planes->solid, k))
      pbf_wide_add(&slot.sums->of[k], sum_of_numbers(numbers[k], m.units[k]));
  for (uint32_t l = 0; l < WIDTH; ++l) depth = depth > depths[l] ? depth : depths[l];
  for (uint32_t l = 0; l < WIDTH; ++l) contacts += touches[l];
  slot.sums->contacts += (uint64_t)contacts;
  pbf_deepen(slot.sums, depth);
}

static void share_lanes(const load_pass *p, const lanes_at_solids *of) {
  const bool are_walls = any_lane(of->among_walls);
  lane_systems systems;
  lane_shares shares;
  if (are_walls) solve_systems(p, of, &systems);
  for (uint32_t i = 0; i < of->met.count; ++i) {
    alignas(64) pbf_real alone[WIDTH];
    const lane_planes *planes = &of->met.of[i];
    for (uint32_t l = 0; l < WIDTH; ++l) alone[l] = of->alone[l] * planes->near[l];
    if (any_lane(alone)) {
      share_with_one(p, of, i, &shares);
      add_shares(p, of, i, of->alone, &shares);
    }
    if (are_walls && planes->solid < PBF_WALLS) {
      share_with_others(p, of, i, &systems, &shares);
      add_shares(p, of, i, of->among_walls, &shares);
    }
  }
}

/* ---- A range of particles -------------------------------------------------------------------- */

/* From particle `first` on. */
static void fetch_lanes(const load_pass *p, uint32_t first, uint32_t lanes, lanes_at_solids *of) {
  of->x = load_some_lanes(&p->x, first, lanes);
  of->push = load_lanes(&p->push, first, lanes);
  memset(of->lambda, 0, sizeof of->lambda);
  memcpy(of->lambda, p->lambda + first, lanes * sizeof(pbf_real));
  for (int k = 0; k < PBF_DIM && p->mobility; ++k)
    for (uint32_t l = 0; l < lanes; ++l) of->push.c[k][l] /= p->mobility[first + l];
}

/* A bit each: those that are left, and those that something pushes though nothing is near. */
static uint32_t lanes_left(const lanes_at_solids *of) {
  alignas(64) pbf_real is[WIDTH];
  uint32_t left = 0;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const pbf_vec push = lane_value(&of->push, l);
    const pbf_real pushed = pbf_dot(push, push) > 0 ? 1 : 0;
    is[l] = of->alone[l] + of->among_walls[l] > 0 ? 0 : pushed;
    is[l] += of->among_others[l];
  }
  for (uint32_t l = 0; l < WIDTH && any_lane(is); ++l) left |= is[l] > 0 ? (uint32_t)1 << l : 0;
  return left;
}

static uint32_t loads(const load_pass *p, const uint16_t *near, int count, uint32_t first,
                      uint32_t last, pbf_wide_sum change[PBF_DIM]) {
  uint32_t left = 0;
  sum_changes(p, first, last, change);
  for (uint32_t i = first; i < last; i += WIDTH) {
    lanes_at_solids of;
    const uint32_t lanes = last - i < WIDTH ? last - i : (uint32_t)WIDTH;
    fetch_lanes(p, i, lanes, &of);
    if (!meet_all(p, near, count, &of)) {
      left |= (((uint32_t)1 << lanes) - 1) << (i - first);
      continue;
    }
    for (uint32_t k = 0; k < of.met.count; ++k)
      find_slopes(p->constants, &of.met.of[k], of.slope[k]);
    sort_lanes(lanes, &of);
    if (of.met.count) share_lanes(p, &of);
    left |= lanes_left(&of) << (i - first);
  }
  return left;
}

#endif
