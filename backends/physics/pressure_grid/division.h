/* How cells are divided into compartments, connected, and what is too small joined to what is
 * larger: cell by cell, each part once the one before is done for all cells. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_DIVISION_H
#define PBF_PHYSICS_PRESSURE_GRID_DIVISION_H

#include "physics/pressure_grid/samples.h"

/* ---- How a cell is divided ------------------------------------------------------------------ */

/* The compartments of the cell, the i-th along each axis, and their free volumes. Where no index is
 * left it stays in one. */
template <class Topology>
PBF_FN void pbf_divide_cell(const pbf_pressure_grid *c, const Topology *t, uint32_t cell,
                            const int i[PBF_DIM]) {
  pbf_cell_points points;
  uint64_t found[PBF_COMPARTMENTS] = {0};
  int count = 0;
  if (!pbf_thin_solid_reaches(c, t, i)) return;
  pbf_find_cell_points(c, t, i, &points);
  uint64_t left = points.free;
  for (; left && count < PBF_COMPARTMENTS; ++count) {
    found[count] = pbf_points_connected(&points, left);
    left &= ~found[count];
  }
  uint32_t further = 0;
  if (count > 1)
    further = pbf_pressure_grid_take(&t->counts[PBF_FURTHER_COMPARTMENTS], (uint32_t)count - 1,
                                     t->max_further);
  if (further == PBF_NO_INDEX) {
    further = 0;
    for (; count > 1; --count) found[0] |= found[count - 1];
  }
  t->further[cell] = t->first + further;
  t->clear[cell] = points.clear;
  t->links[cell] = (uint64_t)1 << PBF_CELL_CUT_BIT | (uint64_t)count << PBF_CELL_COUNT_BIT;
  for (int k = 0; k < count || k == 0; ++k) {
    const uint32_t compartment = pbf_cell_compartment(t, cell, k);
    t->samples[compartment] = found[k];
    pbf_points_volume(c, &points, found[k], &t->volumes[(uint64_t)compartment * PBF_PARTS]);
    t->target[compartment] = compartment;
    for (int part = 0; part < PBF_PARTS; ++part)
      t->merged[(uint64_t)compartment * PBF_PARTS + (uint64_t)part] = 0;
    if (k > 0) t->home[compartment - t->first] = cell;
  }
}

/* Which compartment of the cell has point p; -1: none. */
PBF_FN int pbf_compartment_with(const pbf_pressure_grid_topology *t, uint32_t cell, int p) {
  const int count = pbf_cell_compartments(t, cell);
  for (int k = 0; k < count; ++k)
    if (pbf_cell_samples(t, cell, k) >> p & 1) return k;
  return -1;
}

/* Between two points next to each other. */
template <class Topology>
PBF_FN int pbf_way_is_open(const pbf_pressure_grid *c, const Topology *t, pbf_vec from,
                           pbf_vec to) {
  const pbf_topology_near near = pbf_topology_near_of(t, from, 1.01 * c->width / PBF_SAMPLES);
  for (int k = 0; k < near.count; ++k)
    if (pbf_surface_blocks(pbf_topology_surface(t, pbf_topology_number(&near, k)), from, to))
      return 0;
  return 1;
}

/* Which compartments of a cell are connected with which of the next one along the axis. */
template <class Topology>
PBF_FN_HOST_NOINLINE uint64_t pbf_links_along(const pbf_pressure_grid *c, const Topology *t,
                                              uint32_t cell, uint32_t next, const int i[PBF_DIM],
                                              int axis) {
  const int stride = pbf_sample_stride(axis);
  uint64_t links = 0;
  for (int p = 0; p < 64; ++p) {
    int at[PBF_DIM];
    pbf_sample_place(p, at);
    if (at[axis] != PBF_SAMPLES - 1) continue;
    const int k = pbf_compartment_with(t, cell, p);
    const int l = pbf_compartment_with(t, next, p - stride * (PBF_SAMPLES - 1));
    if (k < 0 || l < 0 || (links >> (PBF_COMPARTMENTS * k + l) & 1)) continue;
    pbf_vec from = pbf_sample_at(c, i, at);
    ++at[axis];
    pbf_vec to = pbf_sample_at(c, i, at);
    int open = pbf_way_is_open(c, t, from, to);
    if (next < cell) { /* solids act where they lie: beside either face */
      from.c[axis] -= (pbf_real)(c->n[axis] * c->width);
      to.c[axis] -= (pbf_real)(c->n[axis] * c->width);
      open = open && pbf_way_is_open(c, t, from, to);
    }
    if (open) links |= UINT64_C(1) << (PBF_COMPARTMENTS * k + l);
  }
  return links;
}

/* Once all cells have been divided. */
template <class Topology>
PBF_FN void pbf_link_cell(const pbf_pressure_grid *c, const Topology *t, uint32_t cell,
                          const int i[PBF_DIM]) {
  if (!pbf_cell_is_inside(c, i)) return;
  for (int k = 0; k < PBF_DIM; ++k) {
    if (i[k] == c->n[k] && !c->wrap[k]) continue;
    const uint32_t next = cell + c->corner[1u << k] - (i[k] == c->n[k] ? c->wrap[k] : 0);
    if (!pbf_cell_is_cut(t, cell) && !pbf_cell_is_cut(t, next)) continue;
    t->links[cell] |= pbf_links_along(c, t, cell, next, i, k) << (PBF_LINK_BITS * k);
  }
}

/* ---- What is too small ---------------------------------------------------------------------- */

/* The largest compartment that compartment k of a cell is open to, of those that have a quarter
 * more than `volume`; PBF_NO_INDEX: none. */
PBF_FN_HOST_NOINLINE uint32_t pbf_larger_neighbor(const pbf_pressure_grid *c,
                                                  const pbf_pressure_grid_topology *t,
                                                  uint32_t cell, int k, double volume) {
  uint32_t largest = PBF_NO_INDEX;
  double largest_free = 1.25 * volume;
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, cell, i);
  for (int side = 0; side < 2 * PBF_DIM; ++side) {
    const int axis = side / 2, up = side % 2;
    if (i[axis] == (up ? c->n[axis] : 1)) continue;
    const uint32_t other = up ? cell + c->corner[1u << axis] : cell - c->corner[1u << axis];
    const int count = pbf_cell_compartments(t, other);
    for (int l = 0; l < count; ++l) {
      const uint32_t compartment = pbf_cell_compartment(t, other, l);
      int at[PBF_DIM];
      pbf_pressure_grid_place(c, other, at);
      const double free = pbf_cell_is_cut(t, other) ? pbf_volume_part(t, compartment, 0)
                                                    : pbf_pressure_grid_inside(c, at);
      const int linked = up ? pbf_cell_link(t, cell, other, axis, k, l)
                            : pbf_cell_link(t, other, cell, axis, l, k);
      if (!linked || !(free > largest_free)) continue;
      largest_free = free;
      largest = compartment;
    }
  }
  return largest;
}

PBF_FN int pbf_compartment_number(const pbf_pressure_grid_topology *t, uint32_t cell,
                                  uint32_t compartment) {
  return compartment == cell ? 0 : (int)(compartment - t->further[cell]) + 1;
}

/* Which compartment a small one is a part of: itself, where none that it is open to is larger. */
PBF_FN uint32_t pbf_merging_target(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                                   uint32_t compartment) {
  for (int steps = 0; steps < PBF_DIM + 1; ++steps) {
    const uint32_t cell = pbf_compartment_cell(t, compartment);
    if (!pbf_cell_is_cut(t, cell) ||
        pbf_volume_part(t, compartment, 0) >= PBF_COMPARTMENT_ROOM * c->spacing)
      break;
    const uint32_t larger =
        pbf_larger_neighbor(c, t, cell, pbf_compartment_number(t, cell, compartment),
                            pbf_volume_part(t, compartment, 0));
    if (larger == PBF_NO_INDEX) break;
    compartment = larger;
  }
  return compartment;
}

PBF_FN void pbf_add_merged(uint64_t *sum, double part) {
  const uint64_t more = (uint64_t)(part * 0x1p32);
#ifdef __CUDA_ARCH__
  atomicAdd((unsigned long long *)sum, (unsigned long long)more);
#else
  *sum += more;
#endif
}

/* What is beyond the target's cell lies at its edge, as particles there do. */
PBF_FN void pbf_merge_into(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                           uint32_t target, uint32_t compartment) {
  uint64_t *merged = &t->merged[(uint64_t)target * PBF_PARTS];
  const double volume = pbf_volume_part(t, compartment, 0);
  int i[PBF_DIM], to[PBF_DIM];
  pbf_pressure_grid_place(c, pbf_compartment_cell(t, compartment), i);
  pbf_pressure_grid_place(c, pbf_compartment_cell(t, target), to);
  pbf_add_merged(&merged[0], volume);
  for (int k = 0; k < PBF_DIM; ++k)
    pbf_add_merged(&merged[1 + k], i[k] == to[k]  ? pbf_volume_part(t, compartment, 1 + k)
                                   : i[k] > to[k] ? volume
                                                  : 0);
}

/* Once all are linked. */
PBF_FN void pbf_merge_compartments(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                                   uint32_t cell) {
  if (!pbf_cell_is_cut(t, cell)) return;
  const int count = pbf_cell_compartments(t, cell);
  for (int k = 0; k < count; ++k) {
    const uint32_t own = pbf_cell_compartment(t, cell, k);
    const uint32_t target = pbf_merging_target(c, t, own);
    t->target[own] = target;
    if (target == own) continue;
    pbf_merge_into(c, t, target, own);
  }
}

#endif
