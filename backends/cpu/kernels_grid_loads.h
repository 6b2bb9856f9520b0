/* Part of kernels.cpp: what the pressure of a pressure grid does to walls in cells that no other
 * solid is near (physics/grid_loads.h), a point in each lane. The loops are left to the compiler's
 * vectoriser. */
#ifndef PBF_CPU_KERNELS_GRID_LOADS_H
#define PBF_CPU_KERNELS_GRID_LOADS_H

#include "cpu/kernels_loads.h"
#include "cpu/kernels_pressure_grid.h"
#include "physics/grid_loads.h"

namespace {

enum { LOAD_POINTS = PRESSURE_GRID_CHUNK, NO_WALL = -1 };

/* Along an axis of a cell, at each place of its points: the wall that is near it, how much of a
 * cube there is free of that, and how its psi rises over the cube and adds up at its ends. */
struct load_points_along {
  pbf_real place[PBF_GRID_LOAD_POINTS], distance[PBF_GRID_LOAD_POINTS];
  int wall[PBF_GRID_LOAD_POINTS];
  double part[PBF_GRID_LOAD_POINTS], rise[PBF_GRID_LOAD_POINTS], sum[PBF_GRID_LOAD_POINTS];
  bool any, outside; /* walls are near some; some are behind them */
};

/* Points that walls are near. */
struct load_points {
  uint32_t count;
  pbf_real x[PBF_DIM][LOAD_POINTS], distance[PBF_DIM][LOAD_POINTS];
  pbf_real at[PBF_DIM][LOAD_POINTS]; /* out of the nearest */
  int wall[PBF_DIM][LOAD_POINTS];
  double part[PBF_DIM][LOAD_POINTS];
  double rise[PBF_DIM][LOAD_POINTS], sum[PBF_DIM][LOAD_POINTS];
  double free[LOAD_POINTS], across[PBF_DIM][LOAD_POINTS];
};

/* grid_load_pressure in each lane. */
struct load_pressures {
  double p[LOAD_POINTS], slope[PBF_DIM][LOAD_POINTS];
  double one[LOAD_POINTS], open_slope[PBF_DIM][LOAD_POINTS];
};

struct point_numbers {
  double of[PBF_LOAD_SUMS][LOAD_POINTS];
};

}  // namespace

/* Of the cells that are the i-th along an axis. */
static __attribute__((noinline)) void find_points_along(const grid_load_pass *p, int axis, int i,
                                                        load_points_along *along) {
  const double spacing = p->scales->spacing, width = p->cubes.width;
  const pbf_real reach = (pbf_real)pbf_grid_load_reach(spacing);
  along->any = along->outside = false;
  for (int n = 0; n < p->cubes.points; ++n) {
    pbf_vec x = {{0}};
    x.c[axis] = along->place[n] = grid_load_place(&p->storage->grid, p->cubes.points, axis, i, n);
    along->wall[n] = NO_WALL;
    along->part[n] = 1;
    along->rise[n] = along->sum[n] = 0;
    for (int wall = 2 * axis; wall <= 2 * axis + 1; ++wall) {
      const pbf_real distance = pbf_wall_distance(p->domain, wall, x);
      if (!(distance < reach)) continue;
      const pbf_load_plane plane = {wall, distance, 0, 1, normal_of_wall(wall)};
      double before[PBF_LOAD_PLANES], after[PBF_LOAD_PLANES];
      grid_load_psi_at(&plane, 1, spacing, width, axis, -0.5 * width, before);
      grid_load_psi_at(&plane, 1, spacing, width, axis, 0.5 * width, after);
      along->wall[n] = wall;
      along->distance[n] = distance;
      along->part[n] = grid_load_part((double)distance, width);
      along->rise[n] = after[0] - before[0];
      along->sum[n] = after[0] + before[0];
      along->any = true;
      along->outside = along->outside || grid_load_hides((double)distance, spacing);
    }
  }
}

/* Whether one wall alone may be near a place along each axis, and none hides another. */
static bool are_walls_apart(const grid_load_pass *p, const load_points_along along[PBF_DIM]) {
  int near = 0, outside = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double across = (double)p->domain->upper.c[k] - (double)p->domain->lower.c[k];
    if (!(across > 2.01 * pbf_grid_load_reach(p->scales->spacing))) return false;
    near += along[k].any;
    outside += along[k].outside;
  }
  return near < 2 || outside == 0;
}

/* What of the cubes around points is free of walls, and where these move them. */
static __attribute__((noinline)) void find_free_parts(const grid_load_pass *p,
                                                      load_points *restrict points) {
  const double width = p->cubes.width;
  for (uint32_t l = 0; l < points->count; ++l) {
    grid_load_free free = grid_load_all_free();
    double nearest = 0.25 * width;
    pbf_vec out = {{0}}, x;
    for (int k = 0; k < PBF_DIM; ++k) {
      const int wall = points->wall[k][l];
      const double distance = (double)points->distance[k][l];
      const bool nearer = wall != NO_WALL && distance < nearest;
      pbf_vec normal = {{0}};
      normal.c[k] = wall % 2 ? (pbf_real)-1 : (pbf_real)1;
      free.cut(points->part[k][l], normal);
      nearest = nearer ? distance : nearest;
      for (int j = 0; j < PBF_DIM; ++j) out.c[j] = nearer ? normal.c[j] : out.c[j];
      x.c[k] = points->x[k][l];
    }
    x = pbf_add_scaled(x, (pbf_real)(0.25 * width - nearest), out);
    points->free[l] = free.all;
    for (int k = 0; k < PBF_DIM; ++k) points->across[k][l] = free.across[k];
    for (int k = 0; k < PBF_DIM; ++k) points->at[k][l] = x.c[k];
  }
}

/* The grid's pressure around points. */
static __attribute__((noinline)) void find_pressures(const grid_load_pass *p,
                                                     const pressure_grid_corners *corners,
                                                     const pressure_grid_places *places,
                                                     uint32_t count,
                                                     load_pressures *restrict pressures) {
  const pbf_pressure_grid c = p->storage->grid;
  const pbf_load_scales s = *p->scales;
  const pbf_grid_load_cubes cubes = p->cubes;
  const double scale = -p->storage->carried / (s.time_step * s.time_step);
  for (uint32_t l = 0; l < count; ++l) {
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

/* What one wall gets. */
static __attribute__((noinline)) void press_on_wall(const grid_load_pass *p,
                                                    const load_points *points,
                                                    const load_pressures *pressures, int wall,
                                                    point_numbers *restrict numbers) {
  const pbf_load_scales s = *p->scales;
  const pbf_load_measure m = *p->walls;
  const pbf_grid_load_cubes cubes = p->cubes;
  const int axis = wall / 2;
  const pbf_vec normal = normal_of_wall(wall);
  for (uint32_t l = 0; l < points->count; ++l) {
    grid_load_pressure here;
    grid_load_free free;
    load_share share = {{0}, {0}, {0}};
    pbf_vec at;
    const bool is = points->wall[axis][l] == wall;
    const double rise = points->rise[axis][l], sum = points->sum[axis][l];
    here.p = pressures->p[l];
    here.one = pressures->one[l];
    free.all = points->free[l];
    for (int k = 0; k < PBF_DIM; ++k) {
      here.slope[k] = pressures->slope[k][l];
      here.open_slope[k] = pressures->open_slope[k][l];
      free.across[k] = points->across[k][l];
      at.c[k] = points->at[k][l];
    }
    for (int k = 0; k < PBF_DIM; ++k)
      share_along(&s, here, free, k, k == axis ? rise : 0, k == axis ? sum : 0, cubes.width,
                  cubes.particles, &share);
    const load_numbers one =
        load_numbers_of(&s, m, at, {wall, points->distance[axis][l], 0, 1, normal}, share);
    for (int k = 0; k < 3; ++k) {
      numbers->of[PBF_LOAD_CHANGE + k][l] = is ? one.of[PBF_LOAD_CHANGE + k] : 0;
      numbers->of[PBF_LOAD_TURN + k][l] = is ? one.of[PBF_LOAD_TURN + k] : 0;
      numbers->of[PBF_LOAD_OPEN + k][l] = is ? one.of[PBF_LOAD_OPEN + k] : 0;
    }
  }
}

static void add_points(const grid_load_pass *p, load_points *points,
                       const load_points_along along[PBF_DIM], pbf_load_sums walls[2 * PBF_DIM]) {
  pressure_grid_places places;
  pressure_grid_corners corners;
  alignas(64) load_pressures pressures;
  alignas(64) point_numbers numbers;
  field at;
  if (!points->count) return;
  find_free_parts(p, points);
  for (int k = 0; k < PBF_DIM; ++k) at.c[k] = points->at[k];
  find_places(&p->storage->grid, &at, 0, points->count, &places);
  if (p->storage->topology.surface_count)
    find_compartments(p->storage, &at, 0, points->count, &places);
  fetch_corners(p->storage, places.cells, points->count, &corners);
  find_pressures(p, &corners, &places, points->count, &pressures);
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall) {
    bool any = false;
    for (int n = 0; n < p->cubes.points; ++n) any = any || along[wall / 2].wall[n] == wall;
    if (!any) continue;
    press_on_wall(p, points, &pressures, wall, &numbers);
    for (int k = 0; k < PBF_LOAD_SUMS; ++k)
      if ((k < PBF_LOAD_WET || k >= PBF_LOAD_OPEN) && wall_has_sum(wall / 2, k))
        pbf_wide_add(&walls[wall].of[k],
                     sum_of_numbers(numbers.of[k], points->count, p->walls->units[k]));
  }
  points->count = 0;
}

/* Those at the n-th place along each axis, unless it is far from walls or all of it is in them. */
static void put_point(const load_points_along along[PBF_DIM], const int n[PBF_DIM],
                      load_points *points) {
  double free = 1;
  bool any = false;
  for (int k = 0; k < PBF_DIM; ++k) {
    free *= along[k].part[n[k]];
    any = any || along[k].wall[n[k]] != NO_WALL;
  }
  if (!any || !(free > 0)) return;
  for (int k = 0; k < PBF_DIM; ++k) {
    points->x[k][points->count] = along[k].place[n[k]];
    points->distance[k][points->count] = along[k].distance[n[k]];
    points->wall[k][points->count] = along[k].wall[n[k]];
    points->part[k][points->count] = along[k].part[n[k]];
    points->rise[k][points->count] = along[k].rise[n[k]];
    points->sum[k][points->count] = along[k].sum[n[k]];
  }
  points->count += 1;
}

static int wall_grid_loads(const grid_load_pass *p, const int i[PBF_DIM], uint64_t others,
                           pbf_load_sums walls[2 * PBF_DIM]) {
  load_points_along along[PBF_DIM];
  alignas(64) load_points points;
  int n[PBF_DIM] = {0}, k = 0;
  for (int axis = 0; axis < PBF_DIM; ++axis) find_points_along(p, axis, i[axis], &along[axis]);
  if (!are_walls_apart(p, along)) return 0;
  points.count = 0;
  while (k < PBF_DIM) {
    if (!(others & 1)) put_point(along, n, &points);
    others >>= 1;
    if (points.count == LOAD_POINTS) add_points(p, &points, along, walls);
    for (k = 0; k < PBF_DIM && ++n[k] == p->cubes.points; ++k) n[k] = 0;
  }
  add_points(p, &points, along, walls);
  return 1;
}

#endif
