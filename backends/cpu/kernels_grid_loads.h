/* Part of kernels.cpp: what the pressure of a pressure grid does to solids (physics/grid_loads.h),
 * a point in each lane. The loops over lanes are left to the compiler's vectoriser. */
#ifndef PBF_CPU_KERNELS_GRID_LOADS_H
#define PBF_CPU_KERNELS_GRID_LOADS_H

#include "cpu/kernels_loads.h"
#include "cpu/kernels_pressure_grid.h"
#include "physics/grid_loads.h"

namespace {

/* As many as share_grid_pressure has room for. */
enum { LOAD_SOLIDS = PBF_LOAD_PLANES };

/* A solid that some points are near, and psi of it at both ends of their cubes along each axis,
 * times the weights of all solids there. */
struct load_solid {
  lane_planes planes;
  alignas(64) pbf_real bears[WIDTH]; /* 1: fluid is at it; 0 */
  alignas(64) double psi[PBF_DIM][2][WIDTH];
};

struct load_points {
  lane_values x, at; /* at: out of the nearest solid */
  int count;
  load_solid of[LOAD_SOLIDS];
  alignas(64) double free[WIDTH], across[PBF_DIM][WIDTH];
  alignas(64) double weights[PBF_DIM][2][WIDTH];
};

/* grid_load_pressure in each lane. */
struct load_pressures {
  alignas(64) double p[WIDTH], slope[PBF_DIM][WIDTH];
  alignas(64) double one[WIDTH], open_slope[PBF_DIM][WIDTH];
};

/* By how much psi of a solid rises over cubes along each axis, and twice its mean. */
struct load_rises {
  alignas(64) double rise[PBF_DIM][WIDTH], sum[PBF_DIM][WIDTH];
};

}  // namespace

/* ---- Which solids are near ------------------------------------------------------------------ */

/* Of the lanes that are wanted. */
static __attribute__((noinline)) void find_field(const pbf_surface *s, const lane_values *x,
                                                 const pbf_real wanted[WIDTH], pbf_real reach,
                                                 lane_planes *restrict planes) {
  alignas(64) pbf_real in_ball[WIDTH], enough[WIDTH];
  lane_looks looks;
  for (uint32_t l = 0; l < WIDTH; ++l) {
    enough[l] = s->sign < 0 ? (pbf_real)INFINITY : reach;
    in_ball[l] = pbf_surface_is_beyond(s, lane_value(x, l), reach) ? 0 : wanted[l];
  }
  find_looks(s, x, enough, in_ball, &looks);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    planes->distance[l] = looks.distance[l];
    planes->near[l] = looks.distance[l] < reach ? in_ball[l] : 0;
    for (int k = 0; k < PBF_DIM; ++k) planes->normal.c[k][l] = looks.normal.c[k][l];
  }
}

/* How far a solid is from places, and the lanes that are within reach of it. */
static void find_solid(const grid_load_pass *p, int solid, const lane_values *x,
                       const pbf_real wanted[WIDTH], lane_planes *planes) {
  const pbf_real reach = (pbf_real)pbf_grid_load_reach(p->scales->spacing);
  if (solid < PBF_WALLS) {
    find_wall(&p->obstacles->domain, solid, x, reach, planes);
    return;
  }
  const pbf_surface *s = &p->obstacles->surfaces[solid - PBF_WALLS];
  if (!ask_closed(s, [&](auto shape) { find_planes(shape, s, x, reach, planes); }))
    find_field(s, x, wanted, reach, planes);
}

/* Keeps a solid that is near some of the lanes. */
PBF_FN void meet_solid(const grid_load_pass *p, int solid, const pbf_real are_points[WIDTH],
                       load_points *points) {
  load_solid *to = &points->of[points->count];
  find_solid(p, solid, &points->x, are_points, &to->planes);
  for (uint32_t l = 0; l < WIDTH; ++l)
    to->planes.near[l] = are_points[l] > 0 ? to->planes.near[l] : 0;
  to->planes.solid = solid;
  points->count += any_lane(to->planes.near);
}

/* Walls, and some colliders; false: there is no room for all of them, or one has too many nodes. */
static bool meet_solids(const grid_load_pass *p, const uint16_t *near, int count, uint32_t lanes,
                        load_points *points) {
  alignas(64) pbf_real are_points[WIDTH];
  for (uint32_t l = 0; l < WIDTH; ++l) are_points[l] = l < lanes ? 1 : 0;
  points->count = 0;
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall) meet_solid(p, wall, are_points, points);
  for (int k = 0; k < count; ++k) {
    const pbf_surface *s = &p->obstacles->surfaces[near[k]];
    if (!is_near_any(s, &points->x, (pbf_real)pbf_grid_load_reach(p->scales->spacing))) continue;
    if (points->count == LOAD_SOLIDS) return false;
    if (pbf_surface_is_field(s) && !fits_lanes(s->field)) return false;
    meet_solid(p, PBF_WALLS + near[k], are_points, points);
  }
  return true;
}

/* ---- What they leave of cubes, and which of them fluid is at --------------------------------- */

/* Takes what one is in out of cubes; `nearest`, and `out` of it, are so far those of others. */
static __attribute__((noinline)) void cut_cubes(double cube, const lane_planes *planes,
                                                load_points *restrict points,
                                                double *restrict nearest,
                                                lane_values *restrict out) {
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const double distance = (double)planes->distance[l];
    const pbf_vec normal = lane_value(&planes->normal, l);
    grid_load_free free;
    free.all = points->free[l];
    for (int k = 0; k < PBF_DIM; ++k) free.across[k] = points->across[k][l];
    free.cut(planes->near[l] > 0 ? grid_load_part(distance, cube) : 1, normal);
    points->free[l] = free.all;
    for (int k = 0; k < PBF_DIM; ++k) points->across[k][l] = free.across[k];
    const double before = nearest[l], here = planes->near[l] > 0 ? distance : before;
    nearest[l] = here < before ? here : before;
    for (int k = 0; k < PBF_DIM; ++k) out->c[k][l] = here < before ? normal.c[k] : out->c[k][l];
  }
}

/* What of the cubes around points is free of solids, and where these move them; points of which
 * nothing is are near none. */
static __attribute__((noinline)) void find_free_parts(double width, load_points *points) {
  alignas(64) double nearest[WIDTH];
  lane_values out;
  memset(&out, 0, sizeof out);
  for (uint32_t l = 0; l < WIDTH; ++l) nearest[l] = 0.25 * width;
  for (uint32_t l = 0; l < WIDTH; ++l) points->free[l] = 1;
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) points->across[k][l] = 1;
  for (int i = 0; i < points->count; ++i)
    cut_cubes(width, &points->of[i].planes, points, nearest, &out);
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l)
      points->at.c[k][l] = points->x.c[k][l] + (pbf_real)(0.25 * width - nearest[l]) * out.c[k][l];
  for (int i = 0; i < points->count; ++i)
    for (uint32_t l = 0; l < WIDTH; ++l) {
      pbf_real *near = points->of[i].planes.near;
      near[l] = points->free[l] > 0 ? near[l] : 0;
    }
}

/* Those of which another one of them hides what is just before them: is_hidden. */
static __attribute__((noinline)) void hide_solids(const grid_load_pass *p, load_points *points) {
  const double spacing = p->scales->spacing;
  for (int i = 0; i < points->count; ++i) {
    const lane_planes *planes = &points->of[i].planes;
    pbf_real *bears = points->of[i].bears;
    lane_values before;
    memcpy(bears, planes->near, sizeof planes->near);
    for (int k = 0; k < PBF_DIM; ++k)
      for (uint32_t l = 0; l < WIDTH; ++l)
        before.c[k][l] = points->x.c[k][l] +
                         ((pbf_real)(spacing / 4) - planes->distance[l]) * planes->normal.c[k][l];
    for (int other = 0; other < points->count; ++other) {
      alignas(64) pbf_real both[WIDTH];
      lane_planes there;
      if (other == i) continue;
      for (uint32_t l = 0; l < WIDTH; ++l)
        both[l] = planes->near[l] * points->of[other].planes.near[l];
      if (!any_lane(both)) continue;
      find_solid(p, points->of[other].planes.solid, &before, both, &there);
      for (uint32_t l = 0; l < WIDTH; ++l) {
        const pbf_real hidden = grid_load_hides((double)there.distance[l], spacing) ? both[l] : 0;
        bears[l] = hidden > 0 ? 0 : bears[l];
      }
    }
  }
}

/* ---- What each bears ------------------------------------------------------------------------ */

/* Along an axis, at one end of the cubes, which is so far from their middles. */
static __attribute__((noinline)) void weigh_solid(double spacing, double cube, int axis,
                                                  double along, const load_solid *of,
                                                  double *restrict psi, double *restrict weights) {
  const pbf_real *normal = of->planes.normal.c[axis];
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const double distance = (double)of->planes.distance[l] + along * (double)normal[l];
    const double fall = of->bears[l] > 0 ? grid_load_fall(spacing, cube, distance) : 0;
    const double weight = grid_load_weight(spacing, fall, distance);
    psi[l] = fall * weight;
    weights[l] += weight;
  }
}

static void weigh_solids(const grid_load_pass *p, load_points *points) {
  const double cube = p->cubes.width;
  memset(points->weights, 0, sizeof points->weights);
  for (int i = 0; i < points->count; ++i)
    for (int k = 0; k < PBF_DIM; ++k)
      for (int end = 0; end < 2 && is_across(points->of[i].planes.solid, k); ++end)
        weigh_solid(p->scales->spacing, cube, k, (end ? 0.5 : -0.5) * cube, &points->of[i],
                    points->of[i].psi[k][end], points->weights[k][end]);
}

static __attribute__((noinline)) void find_rises(const load_points *points, int i, int axis,
                                                 double *restrict rise, double *restrict sum) {
  const double *before = points->of[i].psi[axis][0], *after = points->of[i].psi[axis][1];
  const double *all_before = points->weights[axis][0], *all_after = points->weights[axis][1];
  for (uint32_t l = 0; l < WIDTH; ++l) {
    const double a = all_before[l] > 0 ? before[l] / all_before[l] : 0;
    const double b = all_after[l] > 0 ? after[l] / all_after[l] : 0;
    rise[l] = b - a;
    sum[l] = b + a;
  }
}

/* Lambda at the corners of the cells that points with a solid are in; 0: of others. */
static __attribute__((noinline)) void fetch_corners_at(const pbf_pressure_grid_storage *storage,
                                                       load_points *points,
                                                       pressure_grid_places *places,
                                                       pressure_grid_corners *corners) {
  alignas(64) pbf_real bear[WIDTH] = {0};
  field at;
  for (int k = 0; k < PBF_DIM; ++k) at.c[k] = points->at.c[k];
  find_places(&storage->grid, &at, 0, WIDTH, places);
  for (int i = 0; i < points->count; ++i)
    for (uint32_t l = 0; l < WIDTH; ++l) bear[l] += points->of[i].bears[l];
  for (uint32_t l = 0; l < WIDTH; ++l) {
    if (!(bear[l] > 0))
      places->cells[l] = PBF_NO_INDEX;
    else if (storage->topology.surface_count)
      find_compartment(storage, &at, 0, l, places);
  }
  fetch_corners(storage, places->cells, WIDTH, corners);
}

/* The grid's pressure around points. */
static __attribute__((noinline)) void find_pressures(const grid_load_pass *p,
                                                     const pressure_grid_corners *corners,
                                                     const pressure_grid_places *places,
                                                     load_pressures *restrict pressures) {
  const pbf_pressure_grid c = p->storage->grid;
  const pbf_load_scales s = *p->scales;
  const pbf_grid_load_cubes cubes = p->cubes;
  const double scale = -p->storage->carried / (s.time_step * s.time_step);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    double values[PBF_CORNERS], place[PBF_DIM];
    grid_load_pressure here;
    for (int a = 0; a < PBF_CORNERS; ++a) values[a] = corners->lambda[a][l];
    for (int k = 0; k < PBF_DIM; ++k) place[k] = places->at[k][l];
    here.p =
        scale * pbf_pressure_grid_lambda_sloped_from(&c, values, place, cubes.part, here.slope);
    for (int k = 0; k < PBF_DIM; ++k) here.slope[k] *= scale;
    here.one = open_pressure(here.p, here.slope, s.spacing, cubes.width, here.open_slope);
    pressures->p[l] = here.p;
    pressures->one[l] = here.one;
    for (int k = 0; k < PBF_DIM; ++k) pressures->slope[k][l] = here.slope[k];
    for (int k = 0; k < PBF_DIM; ++k) pressures->open_slope[k][l] = here.open_slope[k];
  }
}

/* What one solid gets, to the sums that it can have. */
static __attribute__((noinline)) void press_on_solid(const grid_load_pass *p,
                                                     const load_points *points,
                                                     const load_pressures *pressures,
                                                     const load_solid *of, const load_rises *rises,
                                                     const load_slot *slot) {
  const pbf_load_scales s = *p->scales;
  const pbf_load_measure m = *slot->measure;
  const pbf_grid_load_cubes cubes = p->cubes;
  alignas(64) double numbers[PBF_LOAD_SUMS][WIDTH]; /* its own: no other can be behind a pointer */
  for (uint32_t l = 0; l < WIDTH; ++l) {
    grid_load_pressure here;
    grid_load_free free;
    load_share share = {{0}, {0}, {0}};
    here.p = pressures->p[l];
    here.one = pressures->one[l];
    free.all = points->free[l];
    for (int k = 0; k < PBF_DIM; ++k) {
      here.slope[k] = pressures->slope[k][l];
      here.open_slope[k] = pressures->open_slope[k][l];
      free.across[k] = points->across[k][l];
      share_along(&s, here, free, k, rises->rise[k][l], rises->sum[k][l], cubes.width,
                  cubes.particles, &share);
    }
    const load_numbers one = load_numbers_of(
        &s, m, lane_value(&points->at, l),
        {0, of->planes.distance[l], 0, 1, lane_value(&of->planes.normal, l)}, share);
    for (int k = 0; k < 3; ++k) {
      numbers[PBF_LOAD_CHANGE + k][l] = of->bears[l] > 0 ? one.of[PBF_LOAD_CHANGE + k] : 0;
      numbers[PBF_LOAD_TURN + k][l] = of->bears[l] > 0 ? one.of[PBF_LOAD_TURN + k] : 0;
      numbers[PBF_LOAD_OPEN + k][l] = of->bears[l] > 0 ? one.of[PBF_LOAD_OPEN + k] : 0;
    }
  }
  for (int k = 0; k < PBF_LOAD_SUMS; ++k)
    if ((k < PBF_LOAD_WET || k >= PBF_LOAD_OPEN) && has_sum(of->planes.solid, k))
      pbf_wide_add(&slot->sums->of[k], sum_of_numbers(numbers[k], m.units[k]));
}

static void press_on_solids(const grid_load_pass *p, load_points *points) {
  pressure_grid_places places;
  pressure_grid_corners corners;
  load_pressures pressures;
  fetch_corners_at(p->storage, points, &places, &corners);
  find_pressures(p, &corners, &places, &pressures);
  for (int i = 0; i < points->count; ++i) {
    const load_solid *of = &points->of[i];
    load_rises rises;
    if (!any_lane(of->bears)) continue;
    memset(&rises, 0, sizeof rises);
    for (int k = 0; k < PBF_DIM; ++k)
      if (is_across(of->planes.solid, k)) find_rises(points, i, k, rises.rise[k], rises.sum[k]);
    const load_slot slot = p->slot_of(p->recent, of->planes.solid);
    press_on_solid(p, points, &pressures, of, &rises, &slot);
  }
}

static int grid_loads(const grid_load_pass *p, const uint16_t *near, int count, field x,
                      uint32_t lanes) {
  load_points points;
  points.x = load_some_lanes(&x, 0, lanes);
  if (!meet_solids(p, near, count, lanes, &points)) return 0;
  if (!points.count) return 1;
  find_free_parts(p->cubes.width, &points);
  hide_solids(p, &points);
  weigh_solids(p, &points);
  press_on_solids(p, &points);
  return 1;
}

#endif
