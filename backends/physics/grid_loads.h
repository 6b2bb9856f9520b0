/* Part of loads: what the pressure of a pressure grid does to solids.
 *
 * The grid moves particles by the slope of its pressure p, wherever they are, so that what it does
 * to solids is no sum of pushes of theirs: it is the integral of p n over their surfaces. Where a
 * weight psi is 1 on a solid and 0 on all others, that is by Gauss's theorem the integral of the
 * slope of psi p over the fluid, whatever the solid's shape; and along an axis only those others
 * count which have a face across it. psi falls from 1 to 0 between half a
 * spacing and two and a half, so that its slope is that of a tent two spacings wide, which points a
 * spacing apart see as one together, wherever they are.
 *
 * The integral is a sum over points that lie evenly in the grid's cells. A sum over particles would
 * not have what is missing of them below a face that looks down, where water hangs up to a spacing
 * off, and the grid fills cells with its pressure however few they hold.
 */
#ifndef PBF_PHYSICS_GRID_LOADS_H
#define PBF_PHYSICS_GRID_LOADS_H

#include "physics/loads.h"
#include "physics/pressure_grid/grid.h"

/* Solids farther away have no part in it. */
PBF_FN double pbf_grid_load_reach(double spacing) { return 2.5 * spacing; }

namespace {

/* A solid near a particle; slopes are over its distance. */
struct grid_load_solid {
  pbf_load_plane plane;
  double fall, fall_slope;     /* from 1 to 0 with the distance */
  double weight, weight_slope; /* among all that are near */
};

PBF_FN grid_load_solid grid_load_solid_of(double spacing, const pbf_load_plane &plane) {
  grid_load_solid s = {plane, 1, 0, 0, 0};
  const pbf_real distance = plane.distance;
  const double least = 0.1 * spacing, t = ((double)distance / spacing - 0.5) / 2;
  if (t > 0) {
    s.fall = t < 0.5 ? 1 - 2 * t * t : 2 * (1 - t) * (1 - t);
    s.fall_slope = (t < 0.5 ? -4 * t : -4 * (1 - t)) / (2 * spacing);
  }
  const double from = fmax((double)distance, least);
  s.weight = s.fall / from;
  s.weight_slope = s.fall_slope / from;
  if ((double)distance > least) s.weight_slope -= s.fall / (from * from);
  return s;
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
  near.each(o, [&](int k) {
    if (!pbf_surface_is_beyond(&o.surfaces[k], x, reach)) ask(PBF_WALLS + k);
  });
}

/* The solids within reach of a point, as many as there is room for. */
struct grid_load_solids {
  int count;
  pbf_load_plane of[PBF_LOAD_PLANES];

  PBF_IN void take(int solid, pbf_real distance, pbf_vec normal) {
    if (count < PBF_LOAD_PLANES) of[count++] = {solid, distance, 0, 1, normal};
  }
};

/* What is just before its nearest place is in another solid, and so no fluid is at it. */
template <class Obstacles>
PBF_FN bool is_hidden(const Obstacles &o, const grid_load_solids &near, int k, double spacing,
                      pbf_vec x) {
  const pbf_load_plane &p = near.of[k];
  const pbf_vec before = pbf_add_scaled(x, (pbf_real)(spacing / 4) - p.distance, p.normal);
  pbf_vec normal;
  for (int i = 0; i < near.count; ++i)
    if (i != k &&
        (double)solid_distance(o, near.of[i].solid, spacing, before, &normal) < -0.05 * spacing)
      return true;
  return false;
}

/* Those of them that fluid is at; their number. */
template <class Obstacles>
PBF_FN_APART int find_grid_load_solids(const Obstacles &o, const grid_load_solids &near,
                                       double spacing, pbf_vec x,
                                       grid_load_solid of[PBF_LOAD_PLANES]) {
  int kept = 0;
  for (int k = 0; k < near.count; ++k)
    if (!is_hidden(o, near, k, spacing, x)) of[kept++] = grid_load_solid_of(spacing, near.of[k]);
  return kept;
}

/* Whether a solid has a face across an axis: walls along it bear nothing that way, and take nothing
 * from those that do where they meet in an edge. */
PBF_FN bool is_across(const grid_load_solid &of, int axis) {
  return of.plane.solid >= PBF_WALLS || of.plane.solid / 2 == axis;
}

/* The slope of psi along an axis, psi being of the k-th of the solids among those across it, which
 * have this weight together; and psi. */
struct grid_load_psi {
  double slope, value;
};

PBF_FN grid_load_psi grid_load_psi_along(const grid_load_solid *of, int count, int k, int axis,
                                         double sum) {
  grid_load_psi psi = {0, 0};
  if (!is_across(of[k], axis) || !(sum > 0)) return psi;
  const double part = of[k].weight / sum;
  for (int i = 0; i < count; ++i) {
    if (!is_across(of[i], axis)) continue;
    double along = of[k].fall * ((i == k) - part) / sum * of[i].weight_slope;
    if (i == k) along += of[k].fall_slope * part;
    psi.slope += along * (double)of[i].plane.normal.c[axis];
  }
  psi.value = of[k].fall * part;
  return psi;
}

PBF_FN double grid_load_weight_across(const grid_load_solid *of, int count, int axis) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += is_across(of[i], axis) ? of[i].weight : 0;
  return sum;
}

/* What of a cube this wide around a place so deep is below the surface. */
PBF_FN double part_below_surface(double depth, double width) {
  return pbf_greater(pbf_lesser(0.5 + depth / width, 1), 0);
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
  return pbf_greater(pbf_lesser(depth / whole, 1), 0);
}

/* Calls take(plane, share) for each solid that the grid's pressure at a point x presses on, which
 * stands for so many particles in a cube this wide; pressure(x, slope) is over the reference
 * density. */
template <class Obstacles, class Pressure, class Take>
PBF_FN void share_grid_pressure(const pbf_load_scales *s, const Obstacles &o,
                                const grid_load_solids &near, pbf_vec x, double width,
                                double particles, Pressure pressure, Take take) {
  grid_load_solid of[PBF_LOAD_PLANES];
  const int count = find_grid_load_solids(o, near, s->spacing, x, of);
  if (!count) return;
  double slope[PBF_DIM], open_slope[PBF_DIM], sum[PBF_DIM];
  const double p = pressure(x, slope);
  const double one = open_pressure(p, slope, s->spacing, width, open_slope);
  for (int j = 0; j < PBF_DIM; ++j) sum[j] = grid_load_weight_across(of, count, j);
  for (int k = 0; k < count; ++k) {
    load_share share = {{0}, {0}, {0}};
    for (int j = 0; j < PBF_DIM; ++j) {
      const grid_load_psi psi = grid_load_psi_along(of, count, k, j, sum[j]);
      share.change[j] = -s->time_step * particles * (p * psi.slope + psi.value * slope[j]);
      share.open[j] = -s->spacing * particles * (one * psi.slope + psi.value * open_slope[j]);
    }
    take(of[k].plane, share);
  }
}

/* Points along an axis of a cell, at most a spacing apart and in 2D half of one. */
PBF_FN int grid_load_points(const pbf_pressure_grid *c) {
  const double points = (PBF_DIM == 2 ? 2 : 1) * ceil(1 / c->spacing - 1e-6);
  return (int)pbf_greater(1, pbf_lesser(points, 32));
}

/* What a point stands for, in cells. */
PBF_FN double grid_load_cube(const pbf_pressure_grid *c) { return 1.0 / grid_load_points(c); }

/* What of a cube of this width around x is free of solids, 0 to 1. Moves x out of the nearest, and
 * finds those that are within reach of it then. */
template <class Obstacles, class Near>
PBF_FN double grid_load_free_part(const Obstacles &o, const Near &near, double spacing,
                                  double width, pbf_vec *x, grid_load_solids *found) {
  double part = 1, nearest = 0.25 * width;
  pbf_vec out = {{0}};
  bool moves = false;
  found->count = 0;
  each_solid_near(o, near, spacing, *x, [&](int solid, pbf_real at, pbf_vec normal) {
    const double distance = (double)at;
    part *= pbf_greater(pbf_lesser(0.5 + distance / width, 1), 0);
    found->take(solid, at, normal);
    if (distance >= nearest) return;
    nearest = distance;
    out = normal;
    moves = true;
  });
  if (!moves || !(part > 0)) return part;
  *x = pbf_add_scaled(*x, (pbf_real)(0.25 * width - nearest), out);
  found->count = 0;
  each_solid_near(o, near, spacing, *x,
                  [&](int solid, pbf_real at, pbf_vec normal) { found->take(solid, at, normal); });
  return part;
}

/* A point of the cell that is the i-th along each axis. */
PBF_FN pbf_vec grid_load_point(const pbf_pressure_grid *c, const int i[PBF_DIM], int point) {
  const int points = grid_load_points(c);
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double at = (point % points + 0.5) / points;
    x.c[k] = (pbf_real)(c->lower[k] + (i[k] - 1 + at) * c->width);
    point /= points;
  }
  return x;
}

/* Calls take(plane, x, share) for each solid that the grid's pressure in the cube around a point
 * presses on, as a particle that stands for it would. */
template <class Obstacles, class Near, class Pressure, class Take>
PBF_FN void share_grid_pressure_around(const pbf_load_scales *s, const pbf_pressure_grid *c,
                                       const Obstacles &o, const Near &near, pbf_vec x,
                                       Pressure pressure, Take take) {
  const double width = c->width * grid_load_cube(c);
  grid_load_solids found;
  const double part = grid_load_free_part(o, near, s->spacing, width, &x, &found);
  if (!(part > 0) || !found.count) return;
  const double particles = part * (PBF_DIM == 3 ? width : 1) * width * width / s->mass;
  share_grid_pressure(
      s, o, found, x, width, particles, pressure,
      [&](const pbf_load_plane &plane, const load_share &share) { take(plane, x, share); });
}

}  // namespace

#endif
