/* Which compartment a particle is in, and what that does to it. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_PARTICLES_H
#define PBF_PHYSICS_PRESSURE_GRID_PARTICLES_H

#include "physics/pressure_grid/division.h"

/* The solids that can be between x and a point near it. */
typedef struct pbf_solids_beside {
  pbf_topology_near near;
  uint64_t bits; /* of the first of these; of more than 64 nothing is known */
} pbf_solids_beside;

template <class Topology>
PBF_FN pbf_solids_beside pbf_find_solids_beside(const pbf_pressure_grid *c, const Topology *t,
                                                pbf_vec x) {
  const double reach = 2.0 * c->width / PBF_SAMPLES;
  pbf_solids_beside beside = {pbf_topology_near_of(t, x, reach), 0};
  for (int k = 0; k < beside.near.count && k < 64; ++k) {
    const int s = pbf_topology_number(&beside.near, k);
    pbf_vec normal;
    if (pbf_surface_is_unbounded(&t->surfaces[s]) ||
        pbf_surface_is_beyond(&t->surfaces[s], x, (pbf_real)reach))
      continue;
    if ((double)pbf_surface_distance(pbf_topology_surface(t, s), x, &normal) <
        (double)t->surfaces[s].steepest * reach)
      beside.bits |= UINT64_C(1) << k;
  }
  return beside;
}

template <class Topology>
PBF_FN int pbf_is_seen(const Topology *t, const pbf_solids_beside &beside, pbf_vec x,
                       pbf_vec point) {
  for (int k = 0; k < beside.near.count; ++k) {
    if (k < 64 && !(beside.bits >> k)) k = 64;
    if (k >= beside.near.count) break;
    if ((k >= 64 || (beside.bits >> k & 1)) &&
        pbf_surface_blocks(pbf_topology_surface(t, pbf_topology_number(&beside.near, k)), x, point))
      return 0;
  }
  return 1;
}

/* The compartment of the nearest point where that is known without a look at solids; PBF_NO_INDEX
 * elsewhere. Either no solid is between the point and what it is nearest to, or x is nearer to it
 * than any solid: distances of solids may be too large by half. */
PBF_FN uint32_t pbf_compartment_at_point(const pbf_pressure_grid *c,
                                         const pbf_pressure_grid_topology *t,
                                         const double before[PBF_DIM]) {
  const double near = 0.5 * PBF_SAMPLE_CLEARANCE, half = 0.5 - 1e-6; /* no other is as near */
  int at[PBF_DIM], alone = 1;
  uint32_t cell = 0;
  double away = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k) {
    const double among = before[k] * PBF_SAMPLES - 0.5;
    const int point = (int)floor(among + 0.5);
    if (point < 0 || point >= PBF_SAMPLES * c->n[k]) return PBF_NO_INDEX;
    at[k] = point % PBF_SAMPLES;
    cell = cell * c->size[k] + (uint32_t)(point / PBF_SAMPLES + 1);
    alone &= fabs(among - point) < half;
    away += (among - point) * (among - point);
  }
  const int p = pbf_sample_index(at);
  const int clear = alone && pbf_cell_is_cut(t, cell) && t->clear[cell] >> p & 1;
  if (!clear && !(away < near * near)) return PBF_NO_INDEX;
  const int k = pbf_compartment_with(t, cell, p);
  return k < 0 ? PBF_NO_INDEX : pbf_cell_compartment(t, cell, k);
}

/* In which period, from the one of the domain, a point is that is counted on over a periodic axis'
 * faces; it becomes that inside. */
PBF_FN int pbf_sample_period(const pbf_pressure_grid *c, int axis, int *point) {
  const int points = PBF_SAMPLES * c->n[axis];
  if (!c->wrap[axis] || (*point >= 0 && *point < points)) return 0;
  const int period = *point < 0 ? -1 : 1;
  *point -= period * points;
  return period;
}

/* The compartment of the nearest point that no solid hides from x; PBF_NO_INDEX: none is near. */
template <class Topology>
PBF_FN_HOST_NOINLINE uint32_t pbf_nearest_compartment(const pbf_pressure_grid *c, const Topology *t,
                                                      pbf_vec x, const double before[PBF_DIM]) {
  const uint32_t here = pbf_compartment_at_point(c, t, before);
  if (here != PBF_NO_INDEX) return here;
  const pbf_solids_beside beside = pbf_find_solids_beside(c, t, x);
  uint32_t nearest = PBF_NO_INDEX;
  double nearest2 = 1e30;
  for (int a = 0; a < PBF_CORNERS; ++a) {
    int i[PBF_DIM], at[PBF_DIM], periods[PBF_DIM], outside = 0;
    uint32_t cell = 0;
    double away = 0;
    for (int k = PBF_DIM - 1; k >= 0; --k) {
      const double among = before[k] * PBF_SAMPLES - 0.5;
      int point = (int)floor(among) + (a >> k & 1);
      away += (among - point) * (among - point);
      periods[k] = pbf_sample_period(c, k, &point);
      outside |= point < 0 || point >= PBF_SAMPLES * c->n[k];
      i[k] = point / PBF_SAMPLES + 1;
      at[k] = point % PBF_SAMPLES;
      cell = cell * c->size[k] + (uint32_t)i[k];
    }
    if (outside || !(away < nearest2)) continue;
    const int k = pbf_compartment_with(t, cell, pbf_sample_index(at));
    if (k < 0) continue;
    pbf_vec place = pbf_sample_at(c, i, at);
    for (int axis = 0; axis < PBF_DIM; ++axis)
      if (periods[axis]) place.c[axis] += (pbf_real)(periods[axis] * c->n[axis] * c->width);
    if (!pbf_is_seen(t, beside, x, place)) continue;
    nearest2 = away;
    nearest = pbf_cell_compartment(t, cell, k);
  }
  return nearest;
}

/* Where in the cell of a compartment a particle at x is, which may be beyond its edge. */
template <class Topology>
PBF_FN void pbf_place_in_compartment(const pbf_pressure_grid *c, const Topology *t,
                                     uint32_t compartment, pbf_vec x, double at[PBF_DIM]) {
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, pbf_compartment_cell(t, compartment), i);
  for (int k = 0; k < PBF_DIM; ++k) {
    at[k] = pbf_pressure_grid_before(c, k, x.c[k]) - (i[k] - 1);
    if (c->wrap[k] && fabs(at[k] - 0.5) > 0.5 * c->n[k]) at[k] += at[k] < 0 ? c->n[k] : -c->n[k];
  }
}

/* What a particle at x, `at` in the cell that it is in, belongs to: the cell, or the compartment
 * that has it, with its place in the cell of that. */
template <class Topology>
PBF_FN uint32_t pbf_compartment_of(const pbf_pressure_grid *c, const Topology *t, uint32_t cell,
                                   pbf_vec x, double at[PBF_DIM]) {
  if (!pbf_cell_is_cut(t, cell)) return cell;
  double before[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) before[k] = pbf_pressure_grid_before(c, k, x.c[k]);
  uint32_t compartment = pbf_nearest_compartment(c, t, x, before);
  if (compartment == PBF_NO_INDEX) return compartment;
  if (!pbf_compartment_is_own(t, compartment)) compartment = t->target[compartment];
  pbf_place_in_compartment(c, t, compartment, x, at);
  return compartment;
}

/* u at the place `at` in a compartment. */
PBF_FN pbf_vec pbf_pressure_grid_correction(const pbf_pressure_grid *c,
                                            const pbf_pressure_grid_topology *t,
                                            const double *lambda, uint32_t compartment,
                                            const double at[PBF_DIM]) {
  double values[PBF_CORNERS];
  pbf_pressure_grid_corners(c, t, lambda, compartment, values);
  return pbf_pressure_grid_correction_from(c, values, at);
}

/* lambda there. */
PBF_FN double pbf_pressure_grid_lambda(const pbf_pressure_grid *c,
                                       const pbf_pressure_grid_topology *t, const double *lambda,
                                       uint32_t compartment, const double at[PBF_DIM]) {
  double values[PBF_CORNERS];
  pbf_pressure_grid_corners(c, t, lambda, compartment, values);
  return c->width * c->width * pbf_min(pbf_pressure_grid_in_cell(values, at, PBF_DIM), 0);
}

/* And its slope, from the values at the corners: means over a cube around the place, so many cells
 * wide, of which a part may be above the surface. A sum over points would else have so many whole
 * rows of them below it, and of what fluid beside a solid weighs half a row too much or too little.
 */
PBF_FN double pbf_pressure_grid_lambda_sloped_from(const pbf_pressure_grid *c,
                                                   const double values[PBF_CORNERS],
                                                   const double at[PBF_DIM], double cube,
                                                   double slope[PBF_DIM]) {
  double slope2 = 0;
  const double value = pbf_pressure_grid_in_cell(values, at, PBF_DIM);
  for (int k = 0; k < PBF_DIM; ++k) {
    slope[k] = pbf_pressure_grid_in_cell(values, at, k);
    slope2 += slope[k] * slope[k];
  }
  const double across = sqrt(slope2) * cube;
  const double part = across > 0 ? pbf_max(pbf_min(0.5 - value / across, 1), 0) : 1;
  for (int k = 0; k < PBF_DIM; ++k) slope[k] *= c->width * part;
  return c->width * c->width * (part < 1 ? -0.5 * across * part * part : value);
}

PBF_FN double pbf_pressure_grid_lambda_sloped(const pbf_pressure_grid *c,
                                              const pbf_pressure_grid_topology *t,
                                              const double *lambda, uint32_t compartment,
                                              const double at[PBF_DIM], double cube,
                                              double slope[PBF_DIM]) {
  double values[PBF_CORNERS];
  pbf_pressure_grid_corners(c, t, lambda, compartment, values);
  return pbf_pressure_grid_lambda_sloped_from(c, values, at, cube, slope);
}

#endif
