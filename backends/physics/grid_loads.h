/* Part of loads: what the pressure of a pressure grid does to solids.
 *
 * The grid moves particles by the slope of its pressure p, wherever they are, so that what it does
 * to solids is no sum of pushes of theirs: it is the integral of p n over their surfaces. Where a
 * weight psi is 1 on a solid and 0 on all others, that is by Gauss's theorem the integral of the
 * slope of psi p over the fluid, whatever the solid's shape. psi falls from 1 to 0 between half a
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

PBF_FN grid_load_solid grid_load_solid_of(double spacing, int solid, pbf_real distance,
                                          pbf_vec normal) {
  grid_load_solid s = {{solid, distance, 0, 1, normal}, 1, 0, 0, 0};
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
PBF_FN pbf_real solid_distance(const Obstacles &o, int solid, pbf_vec x, pbf_vec *normal) {
  if (solid >= PBF_WALLS) return pbf_surface_distance(&o.surfaces[solid - PBF_WALLS], x, normal);
  *normal = {{0}};
  normal->c[solid / 2] = solid % 2 ? (pbf_real)-1 : (pbf_real)1;
  return pbf_wall_distance(&o.domain, solid, x);
}

/* What is just before its nearest place is in another solid, and so no fluid is at it. */
template <class Obstacles>
PBF_FN bool is_hidden(const Obstacles &o, const grid_load_solid *of, int count, int k,
                      double spacing, pbf_vec x) {
  const pbf_load_plane &p = of[k].plane;
  const pbf_vec before = pbf_add_scaled(x, (pbf_real)(spacing / 4) - p.distance, p.normal);
  pbf_vec normal;
  for (int i = 0; i < count; ++i)
    if (i != k && (double)solid_distance(o, of[i].plane.solid, before, &normal) < -0.05 * spacing)
      return true;
  return false;
}

/* Those within reach that fluid is at; their number. */
template <class Obstacles, class Near>
PBF_FN_APART int find_grid_load_solids(const Obstacles &o, const Near &near, double spacing,
                                       pbf_vec x, grid_load_solid of[PBF_LOAD_PLANES]) {
  const pbf_real reach = (pbf_real)pbf_grid_load_reach(spacing);
  int count = 0, kept = 0;
  const auto meet = [&](int solid) {
    pbf_vec normal;
    const pbf_real distance = solid_distance(o, solid, x, &normal);
    if (distance < reach && count < PBF_LOAD_PLANES)
      of[count++] = grid_load_solid_of(spacing, solid, distance, normal);
  };
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall) meet(wall);
  near.each(o, [&](int k) { meet(PBF_WALLS + k); });
  bool hidden[PBF_LOAD_PLANES];
  for (int k = 0; k < count; ++k) hidden[k] = is_hidden(o, of, count, k, spacing, x);
  for (int k = 0; k < count; ++k)
    if (!hidden[k]) of[kept++] = of[k];
  return kept;
}

/* The slope of psi p, psi being of the k-th of the solids. */
PBF_FN load_share grid_load_share(const grid_load_solid *of, int count, int k, double p,
                                  const double slope[PBF_DIM]) {
  load_share share = {{0}, {0}};
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += of[i].weight;
  if (!(sum > 0)) return share;
  const double part = of[k].weight / sum;
  for (int i = 0; i < count; ++i) {
    double along = of[k].fall * ((i == k) - part) / sum * of[i].weight_slope;
    if (i == k) along += of[k].fall_slope * part;
    for (int j = 0; j < PBF_DIM; ++j)
      share.change[j] += p * along * (double)of[i].plane.normal.c[j];
  }
  for (int j = 0; j < PBF_DIM; ++j) share.change[j] += of[k].fall * part * slope[j];
  return share;
}

/* What a solid has of a share. What a wall has along itself is another solid's, which meets it in
 * an edge, where psi goes from 1 to 0 between two points: it is noted apart. */
PBF_FN load_share grid_load_of_solid(const load_share &of, int solid, double factor) {
  load_share share = {{0}, {0}};
  for (int j = 0; j < PBF_DIM; ++j)
    (solid < PBF_WALLS && j != solid / 2 ? share.along : share.change)[j] = factor * of.change[j];
  return share;
}

/* Calls take(plane, share) for each solid that the grid's pressure at a point x presses on, which
 * stands for so many particles; pressure(x, slope) is over the reference density. */
template <class Obstacles, class Near, class Pressure, class Take>
PBF_FN void share_grid_pressure(const pbf_load_scales *s, const Obstacles &o, const Near &near,
                                pbf_vec x, double particles, Pressure pressure, Take take) {
  grid_load_solid of[PBF_LOAD_PLANES];
  const int count = find_grid_load_solids(o, near, s->spacing, x, of);
  if (!count) return;
  double slope[PBF_DIM];
  const double p = pressure(x, slope), factor = -s->time_step * particles;
  for (int k = 0; k < count; ++k)
    take(of[k].plane,
         grid_load_of_solid(grid_load_share(of, count, k, p, slope), of[k].plane.solid, factor));
}

/* Points along an axis of a cell, at most a spacing apart and in 2D half of one. */
PBF_FN int grid_load_points(const pbf_pressure_grid *c) {
  const double points = (PBF_DIM == 2 ? 2 : 1) * ceil(1 / c->spacing - 1e-6);
  return (int)pbf_greater(1, pbf_lesser(points, 32));
}

/* What of a cube of this width around x is free of solids, 0 to 1. Moves x out of the nearest. */
template <class Obstacles, class Near>
PBF_FN double grid_load_free_part(const Obstacles &o, const Near &near, double width, pbf_vec *x) {
  double part = 1, nearest = 0.25 * width;
  pbf_vec out = {{0}};
  const auto meet = [&](int solid) {
    pbf_vec normal;
    const double distance = (double)solid_distance(o, solid, *x, &normal);
    part *= pbf_greater(pbf_lesser(0.5 + distance / width, 1), 0);
    if (distance >= nearest) return;
    nearest = distance;
    out = normal;
  };
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall) meet(wall);
  near.each(o, [&](int k) { meet(PBF_WALLS + k); });
  if (part > 0) *x = pbf_add_scaled(*x, (pbf_real)(0.25 * width - nearest), out);
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
  const double width = c->width / grid_load_points(c);
  const double part = grid_load_free_part(o, near, width, &x);
  if (!(part > 0)) return;
  const double particles = part * (PBF_DIM == 3 ? width : 1) * width * width / s->mass;
  share_grid_pressure(
      s, o, near, x, particles, pressure,
      [&](const pbf_load_plane &plane, const load_share &share) { take(plane, x, share); });
}

}  // namespace

#endif
