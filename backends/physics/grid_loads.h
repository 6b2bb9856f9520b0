/* Part of loads: what the pressure of a pressure grid does to solids.
 *
 * The grid moves particles by the slope of its pressure p, wherever they are, so that what it does
 * to solids is no sum of pushes of theirs: it is the integral of p n over their surfaces. Where a
 * weight psi is 1 on a solid and 0 on all others, that is by Gauss's theorem the integral of the
 * slope of psi p over the fluid, whatever the solid's shape; and along an axis only those others
 * count which have a face across it.
 *
 * The integral is a sum over points that lie evenly in the grid's cells. A sum over particles would
 * not have what is missing of them below a face that looks down, where water hangs up to a spacing
 * off, and the grid fills cells with its pressure however few they hold. Each stands for a cube,
 * and what psi changes by is told by its faces: these differences add up to 1 from one solid to
 * another however near they are, where slopes in the middle of cubes do not. psi by itself falls
 * from 1 to 0 within two and a half spacings, beginning where cubes end that the solid cuts.
 */
#ifndef PBF_PHYSICS_GRID_LOADS_H
#define PBF_PHYSICS_GRID_LOADS_H

#include "physics/load_shares.h"
#include "physics/pressure_grid/grid.h"

/* Solids farther away have no part in it. */
PBF_FN double pbf_grid_load_reach(double spacing) { return 2.5 * spacing; }

/* What points stand for, which is the same for all of them. */
typedef struct pbf_grid_load_cubes {
  int points;       /* along an axis of a cell */
  double part;      /* of a cell, along an axis */
  double width;     /* along an axis */
  double particles; /* that fill it */
} pbf_grid_load_cubes;

namespace {

/* psi of a solid without others: 1 on it, 0 farther off than the reach. Over the width of a point's
 * cube its mean slope is that of a tent, which begins where cubes end that the solid cuts. */
PBF_FN double grid_load_fall(double spacing, double width, double distance) {
  const double half = 0.5 * pbf_min(width, spacing);
  const double from = 0.5 * spacing + half, to = pbf_grid_load_reach(spacing) - half;
  return pbf_max(pbf_min((to - distance) / (to - from), 1), 0);
}

/* Of such a psi among those of others. */
PBF_FN double grid_load_weight(double spacing, double fall, double distance) {
  return fall > 0 ? fall / pbf_max(distance, 0.01 * spacing) : 0;
}

template <class Obstacles>
PBF_FN pbf_real solid_distance(const Obstacles &o, int solid, double spacing, pbf_vec x,
                               pbf_vec *normal) {
  const pbf_real enough = (pbf_real)pbf_grid_load_reach(spacing);
  if (solid >= PBF_WALLS)
    return pbf_nearest_distance(&o.surfaces[solid - PBF_WALLS], x, enough, normal);
  *normal = {{0}};
  normal->c[solid / 2] = solid % 2 ? (pbf_real)-1 : (pbf_real)1;
  return pbf_wall_distance(&o.domain, solid, x);
}

/* Calls meet(solid, distance, normal) for walls, and for colliders near x. */
template <class Obstacles, class Near, class Meet>
PBF_FN void each_solid_near(const Obstacles &o, const Near &near, double spacing, pbf_vec x,
                            Meet meet) {
  const pbf_real reach = (pbf_real)pbf_grid_load_reach(spacing);
  const auto ask = [&](int solid) {
    pbf_vec normal;
    const pbf_real distance = solid_distance(o, solid, spacing, x, &normal);
    if (distance < reach) meet(solid, distance, normal);
  };
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall) ask(wall);
  near.each(pbf_surface_count(o), [&](int k) {
    if (!pbf_surface_is_beyond(&o.surfaces[k], x, reach)) ask(PBF_WALLS + k);
  });
}

/* What of the cube around a point is free of solids, 0 to 1, and what is free of all but those that
 * are across an axis: along it these are a part of psi, which is 1 inside of them. */
struct grid_load_free {
  double all, across[PBF_DIM];

  /* This part of it is free of a solid with this normal. */
  PBF_IN void cut(double part, pbf_vec normal) {
    all *= part;
    for (int k = 0; k < PBF_DIM; ++k)
      across[k] *= 1 - (1 - part) * (1 - (double)normal.c[k] * (double)normal.c[k]);
  }
};

PBF_FN grid_load_free grid_load_all_free() {
  grid_load_free free;
  free.all = 1;
  for (int k = 0; k < PBF_DIM; ++k) free.across[k] = 1;
  return free;
}

/* What of a cube is free of a solid so far from its middle. */
PBF_FN double grid_load_part(double distance, double width) {
  return pbf_max(pbf_min(0.5 + distance / width, 1), 0);
}

/* The solids within reach of a point, as many as there is room for. */
struct grid_load_solids {
  int count;
  pbf_load_plane of[PBF_LOAD_PLANES];

  PBF_IN void take(int solid, pbf_real distance, pbf_vec normal) {
    if (count < PBF_LOAD_PLANES) of[count++] = {solid, distance, 0, 1, normal};
  }
};

/* Whether a place so far from a solid is in it. */
PBF_FN bool grid_load_hides(double distance, double spacing) { return distance < -0.05 * spacing; }

/* What is just before its nearest place is in another solid, and so no fluid is at it. */
template <class Obstacles>
PBF_FN bool is_hidden(const Obstacles &o, const grid_load_solids &near, int k, double spacing,
                      pbf_vec x) {
  const pbf_load_plane &p = near.of[k];
  const pbf_vec before = pbf_add_scaled(x, (pbf_real)(spacing / 4) - p.distance, p.normal);
  pbf_vec normal;
  for (int i = 0; i < near.count; ++i)
    if (i != k &&
        grid_load_hides((double)solid_distance(o, near.of[i].solid, spacing, before, &normal),
                        spacing))
      return true;
  return false;
}

/* Those of them that fluid is at; their number. */
template <class Obstacles>
PBF_FN_HOST_NOINLINE int find_grid_load_solids(const Obstacles &o, const grid_load_solids &near,
                                               double spacing, pbf_vec x,
                                               pbf_load_plane of[PBF_LOAD_PLANES]) {
  int kept = 0;
  for (int k = 0; k < near.count; ++k)
    if (!is_hidden(o, near, k, spacing, x)) of[kept++] = near.of[k];
  return kept;
}

/* Whether a solid has a face across an axis: walls along it bear nothing that way, and take nothing
 * from those that do where they meet in an edge. */
PBF_FN bool is_across(int solid, int axis) { return solid >= PBF_WALLS || solid / 2 == axis; }

/* psi of each of the solids among those across an axis, so far along it from where they are at
 * their distances. */
PBF_FN void grid_load_psi_at(const pbf_load_plane *of, int count, double spacing, double width,
                             int axis, double along, double psi[PBF_LOAD_PLANES]) {
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    const double distance = (double)of[k].distance + along * (double)of[k].normal.c[axis];
    const double fall = is_across(of[k].solid, axis) ? grid_load_fall(spacing, width, distance) : 0;
    const double weight = grid_load_weight(spacing, fall, distance);
    psi[k] = fall * weight;
    sum += weight;
  }
  for (int k = 0; k < count; ++k) psi[k] = sum > 0 ? psi[k] / sum : 0;
}

/* What of a cube this wide around a place so deep is below the surface. */
PBF_FN double part_below_surface(double depth, double width) {
  return pbf_max(pbf_min(0.5 + depth / width, 1), 0);
}

/* A pressure that is 1 from two spacings below the surface on, where that of the grid is p: means
 * over a cube this wide around the place, as p and its slope are, too. */
PBF_FN double open_pressure(double p, const double slope[PBF_DIM], double spacing, double width,
                            double open_slope[PBF_DIM]) {
  double slope2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) slope2 += slope[k] * slope[k];
  const double size = sqrt(slope2), least = 0.5 * width, whole = 2 * spacing;
  double depth = size > 0 ? p / size : p > 0 ? whole + width : 0;
  if (depth < least) depth += depth - least;
  const double part = part_below_surface(depth, width) - part_below_surface(depth - whole, width);
  for (int k = 0; k < PBF_DIM; ++k) open_slope[k] = size > 0 ? slope[k] / size * (part / whole) : 0;
  return pbf_max(pbf_min(depth / whole, 1), 0);
}

/* The grid's pressure over the reference density, its slope, and those of one that is 1. */
struct grid_load_pressure {
  double p, slope[PBF_DIM], one, open_slope[PBF_DIM];
};

/* Along axis j, where psi of the solid rises by `rise` over a cube, and has twice the mean `sum`.
 */
PBF_FN void share_along(const pbf_load_scales *s, const grid_load_pressure &here,
                        const grid_load_free &free, int j, double rise, double sum, double width,
                        double particles, load_share *share) {
  const double part = particles * free.across[j] * rise / width;
  const double mean = particles * free.all * 0.5 * sum;
  share->change[j] = -s->time_step * (here.p * part + mean * here.slope[j]);
  share->open[j] = -s->spacing * (here.one * part + mean * here.open_slope[j]);
}

/* Calls take(plane, share) for each solid that the grid's pressure at a point x presses on, which
 * stands for so many particles in a cube this wide; pressure(x, slope) is over the reference
 * density. */
template <class Obstacles, class Pressure, class Take>
PBF_FN void share_grid_pressure(const pbf_load_scales *s, const Obstacles &o,
                                const grid_load_solids &near, const grid_load_free &free, pbf_vec x,
                                pbf_vec at, double width, double particles, Pressure pressure,
                                Take take) {
  pbf_load_plane of[PBF_LOAD_PLANES];
  const int count = find_grid_load_solids(o, near, s->spacing, x, of);
  if (!count) return;
  double before[PBF_DIM][PBF_LOAD_PLANES], after[PBF_DIM][PBF_LOAD_PLANES];
  grid_load_pressure here;
  here.p = pressure(at, here.slope);
  here.one = open_pressure(here.p, here.slope, s->spacing, width, here.open_slope);
  for (int j = 0; j < PBF_DIM; ++j) {
    grid_load_psi_at(of, count, s->spacing, width, j, -0.5 * width, before[j]);
    grid_load_psi_at(of, count, s->spacing, width, j, 0.5 * width, after[j]);
  }
  for (int k = 0; k < count; ++k) {
    load_share share = {{0}, {0}, {0}};
    for (int j = 0; j < PBF_DIM; ++j)
      share_along(s, here, free, j, after[j][k] - before[j][k], after[j][k] + before[j][k], width,
                  particles, &share);
    take(of[k], share);
  }
}

enum { PBF_GRID_LOAD_POINTS = 32 };

/* Points along an axis of a cell, at most a spacing apart and in 2D half of one. */
PBF_FN int grid_load_points(const pbf_pressure_grid *c) {
  const double points = (PBF_DIM == 2 ? 2 : 1) * ceil(1 / c->spacing - 1e-6);
  return (int)pbf_max(1, pbf_min(points, PBF_GRID_LOAD_POINTS));
}

PBF_FN pbf_grid_load_cubes grid_load_cubes_of(const pbf_load_scales *s,
                                              const pbf_pressure_grid *c) {
  const int points = grid_load_points(c);
  const double part = 1.0 / points, width = c->width * part;
  return {points, part, width, (PBF_DIM == 3 ? width : 1) * width * width / s->mass};
}

/* What of a cube of this width around x is free of solids, and those that are within reach of it.
 * Moves `at` out of the nearest. */
template <class Obstacles, class Near>
PBF_FN grid_load_free grid_load_free_part(const Obstacles &o, const Near &near, double spacing,
                                          double width, pbf_vec x, pbf_vec *at,
                                          grid_load_solids *found) {
  grid_load_free free = grid_load_all_free();
  double nearest = 0.25 * width;
  pbf_vec out = {{0}};
  found->count = 0;
  *at = x;
  each_solid_near(o, near, spacing, x, [&](int solid, pbf_real from, pbf_vec normal) {
    const double distance = (double)from;
    free.cut(grid_load_part(distance, width), normal);
    found->take(solid, from, normal);
    if (distance >= nearest) return;
    nearest = distance;
    out = normal;
  });
  *at = pbf_add_scaled(x, (pbf_real)(0.25 * width - nearest), out);
  return free;
}

/* Where the n-th point of the i-th cell along an axis is. */
PBF_FN pbf_real grid_load_place(const pbf_pressure_grid *c, int points, int axis, int i, int n) {
  return (pbf_real)(c->lower[axis] + (i - 1 + (n + 0.5) / points) * c->width);
}

/* A point of the cell that is the i-th along each axis. */
PBF_FN pbf_vec grid_load_point(const pbf_pressure_grid *c, int points, const int i[PBF_DIM],
                               int point) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) {
    x.c[k] = grid_load_place(c, points, k, i[k], point % points);
    point /= points;
  }
  return x;
}

/* Calls visit(x) for all of them, in the order of their numbers. */
template <class Visit>
PBF_FN void each_grid_load_point(const pbf_pressure_grid *c, int points, const int i[PBF_DIM],
                                 Visit visit) {
  pbf_real places[PBF_DIM][PBF_GRID_LOAD_POINTS];
  int n[PBF_DIM] = {0}, k = 0;
  for (int axis = 0; axis < PBF_DIM; ++axis)
    for (int at = 0; at < points; ++at)
      places[axis][at] = grid_load_place(c, points, axis, i[axis], at);
  while (k < PBF_DIM) {
    pbf_vec x;
    for (int axis = 0; axis < PBF_DIM; ++axis) x.c[axis] = places[axis][n[axis]];
    visit(x);
    for (k = 0; k < PBF_DIM && ++n[k] == points; ++k) n[k] = 0;
  }
}

/* Calls take(plane, x, share) for each solid that the grid's pressure in the cube around a point
 * presses on, as a particle that stands for it would. */
template <class Obstacles, class Near, class Pressure, class Take>
PBF_FN void share_grid_pressure_around(const pbf_load_scales *s, const pbf_grid_load_cubes &cubes,
                                       const Obstacles &o, const Near &near, pbf_vec x,
                                       Pressure pressure, Take take) {
  grid_load_solids found;
  pbf_vec at;
  const grid_load_free free = grid_load_free_part(o, near, s->spacing, cubes.width, x, &at, &found);
  if (!(free.all > 0) || !found.count) return;
  share_grid_pressure(
      s, o, found, free, x, at, cubes.width, cubes.particles, pressure,
      [&](const pbf_load_plane &plane, const load_share &share) { take(plane, at, share); });
}

}  // namespace

#endif
