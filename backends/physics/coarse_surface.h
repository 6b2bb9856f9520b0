/* Where the pressure grid's fluid ends: how far below the surface each node is, and the part of
 * each cell below it. If pressure ended at nodes instead, the grid would not see a wave lower than
 * a cell, and carry its part of the weight as if there were none: half a period of waves one to
 * three spacings high took 0.4 to 2.6 times its time. */
#ifndef PBF_PHYSICS_COARSE_SURFACE_H
#define PBF_PHYSICS_COARSE_SURFACE_H

#include "physics/coarse.h"

/* How far a cell's fluid lies towards its corner `a` from the middle of its room, over all axes, in
 * halves of a cell; `i` is the cell's place. Only where that room is the walls'. */
PBF_FN double pbf_coarse_leaning(const pbf_coarse *c, int64_t count, int64_t places, double room,
                                 const int i[PBF_DIM], int a) {
  double lean = 0;
  if (count == 0 || count > 16383 || room < pbf_coarse_inside(c, i) - 1e-3) return 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    int first = i[k] == 1, last = i[k] == c->n[k];
    double middle = (last - first) * (c->edge[k] - 1);
    double mean = ((double)(places >> 21 * k & 0x1fffff) / (double)count + 0.2) / 64 - 1;
    lean += (a >> k & 1 ? 1 : -1) * (mean - middle);
  }
  return lean;
}

/* How far the i-th node along each axis is below the surface, in cells: from -1, above it, to 1. By
 * what is near it, in cells weighted by how near: lattices come into a cell row by row. Nodes
 * without a filled cell are in the open. */
PBF_FN double pbf_coarse_node_depth(const pbf_coarse *c, const int64_t *sums, const int64_t *places,
                                    const double *rooms, int64_t node, const int i[PBF_DIM]) {
  double filled = 0, room = 0;
  int any = 0;
  for (int a = 0; a < PBF_CORNERS; ++a) {
    int64_t cell = node - (int64_t)c->corner[a], count = pbf_coarse_count(sums[cell]);
    int at[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k) at[k] = i[k] - (a >> k & 1);
    double lean = pbf_coarse_leaning(c, count, places[cell], rooms[cell], at, a);
    any |= pbf_coarse_is_filled(c, sums[cell], rooms[cell]);
    filled += c->unit * (double)count * (1 + lean);
    room += rooms[cell];
  }
  if (room < 0.1) return -1;
  double part = pbf_greater(pbf_lesser(filled / room, 1), 0);
  double depth = part < 0.5 ? sqrt(2 * part) - 1 : 1 - sqrt(2 - 2 * part);
  return any ? depth : pbf_lesser(depth, 0);
}

PBF_FN int pbf_coarse_is_open(double depth) { return depth < PBF_COARSE_SURFACE; }

/* The part of a cell that is below the surface, by its corners' depths: 1 where the surface does
 * not cut it, and more where it is above the corners in the open. */
PBF_FN double pbf_coarse_part_below(const double depths[PBF_CORNERS]) {
  double open = 0, height = 0, inside = 0, depth = 0;
  for (int a = 0; a < PBF_CORNERS; ++a) {
    int is_open = pbf_coarse_is_open(depths[a]);
    open += is_open;
    height -= is_open ? depths[a] : 0;
    inside += !is_open;
    depth += is_open ? 0 : depths[a];
  }
  if (open == 0 || inside == 0) return 1;
  height /= open;
  depth /= inside;
  return height < 0 ? 1 - height : pbf_greater(depth / (depth + height), PBF_COARSE_SURFACE);
}

/* Of a cell: that part, and its room over it. Cells without room are for the sentinel. */
PBF_FN void pbf_coarse_cut(const pbf_coarse *c, const double *depths, const double *rooms,
                           uint32_t cell, double *part, double *weight) {
  double corners[PBF_CORNERS];
  *part = 1;
  *weight = 0;
  if (!(rooms[cell] > 0)) return;
  pbf_coarse_corners(c, depths, cell, corners);
  if (c->level) *part = pbf_coarse_part_below(corners);
  *weight = rooms[cell] / *part;
}

#endif
