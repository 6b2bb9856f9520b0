/* Where the pressure grid's fluid ends: how far below the surface each node is, and what a node
 * above it stands for: lambda is 0 at the surface, between two nodes (Gibou, Fedkiw, Cheng & Kang
 * 2002, https://doi.org/10.1006/jcph.2001.6977). If pressure ended at nodes instead, the grid would
 * not see a wave lower than a cell, and carry its part of the weight as if there were none: half a
 * period of waves one to three spacings high took 0.4 to 2.6 times its time. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_SURFACE_H
#define PBF_PHYSICS_PRESSURE_GRID_SURFACE_H

#include "physics/pressure_grid/topology.h"

/* How far a cell's fluid lies towards its corner `a` from the middle of its free volume, over all
 * axes, in halves of a cell. */
PBF_FN double pbf_pressure_grid_leaning(int64_t count, int64_t places, const double middle[PBF_DIM],
                                        int a) {
  double lean = 0;
  if (count == 0 || count > PBF_MAX_CELL_PLACES) return 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    double mean = 2 * pbf_pressure_grid_mean_place(places, count, k) - 1;
    lean += (a >> k & 1 ? 1 : -1) * (mean - middle[k]);
  }
  return lean;
}

/* Nodes with less free volume around them are in solids. */
#define PBF_PRESSURE_GRID_NO_VOLUME 0.003

/* What of the cells around a node is filled. */
typedef struct pbf_pressure_grid_filling {
  double filled, free_volume;
  int any; /* whether one of them counts as filled */
} pbf_pressure_grid_filling;

/* The cell, the i-th along each axis, or a compartment of it, of which the node is corner `a`. By
 * what is near the node, in cells weighted by how near: lattices come into a cell row by row. */
PBF_FN void pbf_pressure_grid_add_filling(const pbf_pressure_grid *c,
                                          const pbf_pressure_grid_topology *t, uint32_t compartment,
                                          int64_t sum, int64_t places, double free_volume,
                                          const int i[PBF_DIM], int a,
                                          pbf_pressure_grid_filling *all) {
  int64_t count = pbf_pressure_grid_count(sum);
  double middle[PBF_DIM], lean = 0;
  if (pbf_compartment_middle(c, t, compartment, free_volume, i, middle))
    lean = pbf_pressure_grid_leaning(count, places, middle, a);
  all->any |= pbf_pressure_grid_is_filled(c, sum, free_volume);
  all->filled += c->unit * (double)count * (1 + lean);
  all->free_volume += free_volume;
}

/* How far the node is below the surface, in cells: from -1, above it, to 1. Nodes without a filled
 * cell are in the open. */
PBF_FN double pbf_pressure_grid_depth(const pbf_pressure_grid_filling *all) {
  if (all->free_volume < PBF_PRESSURE_GRID_NO_VOLUME) return -1;
  double part = pbf_max(pbf_min(all->filled / all->free_volume, 1), 0);
  double depth = part < 0.5 ? sqrt(2 * part) - 1 : 1 - sqrt(2 - 2 * part);
  return all->any ? depth : pbf_min(depth, 0);
}

PBF_FN int pbf_pressure_grid_is_open(double depth) { return depth < PBF_PRESSURE_GRID_SURFACE; }

/* ---- Cells where fluid ends: they have a node in the open that is no solid's ----------------- */

/* The bit that the sums of a cell's places leave free says so. Nothing else of them changes while
 * nodes are looked at, so that it does not matter which of several writes last. */
PBF_FN void pbf_pressure_grid_note_end(int64_t *places) { *places |= INT64_MIN; }

PBF_FN int pbf_pressure_grid_is_end(int64_t places) { return places < 0; }

PBF_FN int pbf_pressure_grid_ends_at(const pbf_pressure_grid_filling *all, double depth) {
  return all->free_volume >= PBF_PRESSURE_GRID_NO_VOLUME && pbf_pressure_grid_is_open(depth);
}

/* ---- Nodes ---------------------------------------------------------------------------------- */

/* Of the i-th node along each axis; notes the cells around it where fluid ends. */
PBF_FN double pbf_pressure_grid_node_depth(const pbf_pressure_grid *c,
                                           const pbf_pressure_grid_topology *t, const int64_t *sums,
                                           int64_t *places, const double *free_volumes,
                                           int64_t node, const int i[PBF_DIM]) {
  pbf_pressure_grid_filling all = {0, 0, 0};
  for (int a = 0; a < PBF_CORNERS; ++a) {
    int64_t cell = node - (int64_t)c->corner[a];
    int at[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k) at[k] = i[k] - (a >> k & 1);
    pbf_pressure_grid_add_filling(c, t, (uint32_t)cell, sums[cell], places[cell],
                                  free_volumes[cell], at, a, &all);
  }
  const double depth = pbf_pressure_grid_depth(&all);
  for (int a = 0; a < PBF_CORNERS && pbf_pressure_grid_ends_at(&all, depth); ++a)
    pbf_pressure_grid_note_end(&places[node - (int64_t)c->corner[a]]);
  return depth;
}

/* Of a torn node. */
PBF_FN double pbf_pressure_grid_torn_depth(const pbf_pressure_grid *c,
                                           const pbf_pressure_grid_topology *t, const int64_t *sums,
                                           int64_t *places, const double *free_volumes,
                                           uint32_t torn) {
  pbf_pressure_grid_filling all = {0, 0, 0};
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int a) {
    int i[PBF_DIM];
    pbf_pressure_grid_place(c, pbf_compartment_cell(t, compartment), i);
    pbf_pressure_grid_add_filling(c, t, compartment, sums[compartment], places[compartment],
                                  free_volumes[compartment], i, a, &all);
  });
  const double depth = pbf_pressure_grid_depth(&all);
  if (pbf_pressure_grid_ends_at(&all, depth))
    pbf_for_compartments(t, torn, [&](uint32_t compartment, int) {
      pbf_pressure_grid_note_end(&places[compartment]);
    });
  return depth;
}

/* The slope of lambda below the surface, in depths, by least squares over nodes inside. */
typedef struct pbf_pressure_grid_slope {
  double product, square;
} pbf_pressure_grid_slope;

PBF_FN void pbf_pressure_grid_add_slope(const pbf_pressure_grid *c,
                                        const pbf_pressure_grid_topology *t, const double *depths,
                                        const double *free_volumes, const double *lambda,
                                        uint32_t compartment, pbf_pressure_grid_slope *slope) {
  const int has_room = free_volumes[compartment] > 0;
  /* Without a jump, so that all depths are on their way at once. */
  PBF_UNROLLED
  for (int b = 0; b < PBF_CORNERS; ++b) {
    const uint32_t node = pbf_pressure_grid_corner(c, t, compartment, b);
    const double depth = depths[node];
    const int counts = has_room && !pbf_pressure_grid_is_open(depth);
    slope->product += counts ? lambda[node] * depth : 0;
    slope->square += counts ? depth * depth : 0;
  }
}

/* Lambda of a node in the open at `depth`: as it would go on. */
PBF_FN double pbf_pressure_grid_beyond(const pbf_pressure_grid_slope *slope, double depth) {
  if (!(slope->square > 0)) return 0;
  return pbf_max(depth * slope->product / slope->square, 0);
}

/* Lambda of a node in a solid, as it would go on from the nodes beside it: particles may be in a
 * cell of which a solid leaves a sliver alone, as parts of the next cell. The nodes that are known
 * are those from `first` to `last` along each axis. */
PBF_FN double pbf_pressure_grid_into_solid(const pbf_pressure_grid *c,
                                           const pbf_pressure_grid_topology *t,
                                           const double *depths, const double *lambda, int64_t node,
                                           const int i[PBF_DIM], const int first[PBF_DIM],
                                           const int last[PBF_DIM]) {
  double sum = 0;
  int count = 0;
  for (int side = 0; side < 2 * PBF_DIM; ++side) {
    const int axis = side / 2, way = side % 2 ? 1 : -1;
    const int64_t stride = way * (int64_t)c->corner[1u << axis];
    double value = 0;
    int known = 0;
    for (int steps = 1; steps <= 2; ++steps) {
      const int at = i[axis] + steps * way;
      const int64_t other = node + steps * stride;
      if (at < first[axis] || at > last[axis] || pbf_pressure_grid_is_open(depths[other])) break;
      if (t->is_active && t->torn[other]) break;
      value = known ? 2 * value - lambda[other] : lambda[other];
      known = 1;
    }
    sum += value;
    count += known;
  }
  return count ? pbf_min(sum / count, 0) : 0;
}

/* Once the solution is known, of an ordinary node that is not solved for. */
PBF_FN double pbf_pressure_grid_node_beyond(const pbf_pressure_grid *c,
                                            const pbf_pressure_grid_topology *t,
                                            const double *depths, const double *free_volumes,
                                            const double *lambda, uint32_t node,
                                            const int i[PBF_DIM], const int first[PBF_DIM],
                                            const int last[PBF_DIM]) {
  pbf_pressure_grid_slope slope = {0, 0};
  double free_volume = 0;
  PBF_UNROLLED
  for (int a = 0; a < PBF_CORNERS; ++a) free_volume += free_volumes[node - c->corner[a]];
  if (free_volume < PBF_PRESSURE_GRID_NO_VOLUME)
    return pbf_pressure_grid_into_solid(c, t, depths, lambda, node, i, first, last);
  PBF_UNROLLED
  for (int a = 0; a < PBF_CORNERS; ++a)
    pbf_pressure_grid_add_slope(c, t, depths, free_volumes, lambda, node - c->corner[a], &slope);
  return pbf_pressure_grid_beyond(&slope, depths[node]);
}

/* Of a torn one. */
PBF_FN double pbf_pressure_grid_torn_beyond(const pbf_pressure_grid *c,
                                            const pbf_pressure_grid_topology *t,
                                            const double *depths, const double *free_volumes,
                                            const double *lambda, uint32_t torn) {
  pbf_pressure_grid_slope slope = {0, 0};
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int) {
    pbf_pressure_grid_add_slope(c, t, depths, free_volumes, lambda, compartment, &slope);
  });
  return pbf_pressure_grid_beyond(&slope, depths[t->torn_at[torn]]);
}

#endif
