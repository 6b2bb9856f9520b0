/* Part of loads: what the pressure of a pressure grid does to solids.
 *
 * The grid moves particles by the slope of its pressure p, wherever they are, so that what it does
 * to solids is no sum of pushes of theirs: it is the integral of p n over their surfaces. Where a
 * weight psi is 1 on a solid and 0 on all others, that is by Gauss's theorem the sum over particles
 * of volume times the slope of psi p, whatever the solid's shape. The density that solids lend
 * would weigh p by the first layer of particles alone, and by how far off that is. psi falls from 1
 * to 0 between half a spacing and two and a half, so that its slope is that of a tent two spacings
 * wide: layers a spacing apart are one together, wherever they are, and no gap of a spacing counts.
 */
#ifndef PBF_PHYSICS_GRID_LOADS_H
#define PBF_PHYSICS_GRID_LOADS_H

#include "physics/loads.h"

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

/* Calls take(plane, share) for each solid that the grid's pressure at a particle at x presses on;
 * pressure(x, slope) is over the reference density. */
template <class Obstacles, class Near, class Pressure, class Take>
PBF_FN void share_grid_pressure(const pbf_load_scales *s, const Obstacles &o, const Near &near,
                                pbf_vec x, Pressure pressure, Take take) {
  grid_load_solid of[PBF_LOAD_PLANES];
  const int count = find_grid_load_solids(o, near, s->spacing, x, of);
  if (!count) return;
  double slope[PBF_DIM];
  const double p = pressure(x, slope);
  for (int k = 0; k < count; ++k) {
    load_share share = grid_load_share(of, count, k, p, slope);
    const int solid = of[k].plane.solid;
    for (int j = 0; j < PBF_DIM; ++j)
      share.change[j] *= solid < PBF_WALLS && j != solid / 2 ? 0 : -s->time_step;
    take(of[k].plane, share);
  }
}

}  // namespace

#endif
