/* What of the pressure grid is on which side of a thin solid. A cell has one pressure at each of
 * its corners, and so would carry the weight on one side of a wall thinner than a cell to the other
 * one.
 *
 * In a cell that such a solid reaches, points are spaced evenly; two next to each other are
 * connected unless a solid is between them. The points that hang together are a compartment: a cell
 * of its own, with its own particles, free volume and corners. A wall of any thickness is seen, at
 * any angle, since the ways from point to point would lead through it; so is an opening as wide as
 * points are apart, half a spacing to one.
 *
 * A compartment in which there is hardly room for a particle is a part of the largest one that it
 * is open to, as far as that leads to larger ones (cell merging, as in cut-cell methods): it would
 * count as in the open. Not a larger one: a part takes what its whole has of lambda on to where it
 * is, which does not meet what is beside it, and what moves around such a seam gains energy.
 * Compartments are connected with those of the next cells as points are.
 *
 * A node is as many as there are unconnected compartments around it (virtual nodes, Molino, Bao &
 * Fedkiw 2004, as the mesh of finite elements that a cut tears): topology.h. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_COMPARTMENTS_H
#define PBF_PHYSICS_PRESSURE_GRID_COMPARTMENTS_H

#include "physics/pressure_grid/grid.h"

enum {
  PBF_SAMPLES = PBF_DIM == 3 ? 4 : 8,     /* points along an axis of a cell, 64 in all */
  PBF_COMPARTMENTS = 4,                   /* of a cell, at most */
  PBF_PARTS = 1 + PBF_DIM,                /* of a volume: itself, and times its middle */
  PBF_NODE_COMPARTMENTS = 2 * PBF_CORNERS /* compartments that a node is corner of, at most */
};

/* In units of what is between points: nearer to a solid one counts as in it. Of one on a surface
 * rounding would tell whether the way to it leads through the solid. */
#define PBF_SAMPLE_CLEARANCE 0.01f

#define PBF_NO_INDEX 0xffffffffu
#define PBF_ALL_SAMPLES (~UINT64_C(0))

/* A compartment that is no larger than a slice of a cell so many spacings thick, in which no
 * particle is found, is a part of a larger one. */
#define PBF_COMPARTMENT_ROOM 0.5

/* The first compartment of a cell has the cell's index, and so has a node's first copy the node's;
 * further ones have indices from `first` on. */
typedef struct pbf_pressure_grid_topology {
  const pbf_surface *surfaces;
  int is_active; /* 0: no solid is thin, no axis periodic, and all of this idle */
  int surface_count;
  const pbf_surface_grid *grid; /* on a host, of them; null: they are few */
  uint64_t built;               /* when it is another one by now all are asked */
  pbf_domain domain;
  uint32_t first, limit, max_further; /* there may be so many further ones */
  uint32_t *counts;  /* of further compartments, further copies, torn nodes so far */
  uint64_t *samples; /* of compartments: their points */
  uint64_t *clear;   /* of cells: points with no solid between them and what is nearest to them */
  uint64_t *links;   /* of cells: pbf_cell_link's, and how many compartments there are */
  uint64_t *merged;  /* of compartments: what they have of others, pbf_compartment_part's */
  uint32_t *further; /* of cells: the index of the second compartment */
  uint32_t *home;    /* of further compartments: the cell, by index - first */
  uint32_t *target;  /* of compartments: which one they are a part of */
  uint32_t *corners; /* of compartments: PBF_CORNERS nodes; 0: the cell's own */
  uint32_t *touched; /* of cells: 1 when one of its corners is a further node */
  uint32_t *torn;    /* of nodes: 1 + their number among the torn ones; 0: they are none */
  uint32_t *torn_at; /* of torn nodes: the node, … */
  uint32_t *base;    /* … the first copy of it, … */
  uint32_t *node_compartments; /* … and PBF_NODE_COMPARTMENTS compartments, with the corner in the
                                  lowest bits */
  double *volumes; /* of compartments: their own free volume, and its middle along each axis
                      times the volume */
  double *right, *inverse, *next, *before; /* of torn nodes */
} pbf_pressure_grid_topology;

/* A topology of which all surfaces are known to have closed forms. */
struct pbf_closed_topology : pbf_pressure_grid_topology {};

PBF_FN const pbf_surface *pbf_topology_surface(const pbf_pressure_grid_topology *t, int s) {
  return &t->surfaces[s];
}

PBF_FN const pbf_closed_surface *pbf_topology_surface(const pbf_closed_topology *t, int s) {
  return static_cast<const pbf_closed_surface *>(&t->surfaces[s]);
}

/* Surfaces that may be within a reach of a place, by their numbers. */
typedef struct pbf_topology_near {
  int count;
  const uint16_t *numbers; /* null: all, one after another */
} pbf_topology_near;

PBF_FN pbf_topology_near pbf_topology_near_of(const pbf_pressure_grid_topology *t, pbf_vec x,
                                              double reach) {
  pbf_topology_near near = {t->surface_count, NULL};
#ifndef __CUDA_ARCH__
  if (t->grid && t->grid->built == t->built && t->grid->steepest * reach <= t->grid->reach)
    near.count = (int)pbf_surfaces_at(t->grid, x, &near.numbers);
#else
  (void)x, (void)reach;
#endif
  return near;
}

PBF_FN int pbf_topology_number(const pbf_topology_near *near, int k) {
  return near->numbers ? near->numbers[k] : k;
}

enum { PBF_FURTHER_COMPARTMENTS, PBF_FURTHER_COPIES, PBF_TORN_NODES, PBF_TOPOLOGY_COUNTS };

/* Behind the counts: whether a host has found all of it. */
enum { PBF_TOPOLOGY_FOUND = PBF_TOPOLOGY_COUNTS };

/* ---- Memory --------------------------------------------------------------------------------- */

/* Grids with thin solids in them have two thirds of the indices, what else they need the rest. */
static inline uint64_t pbf_pressure_grid_first_further(uint64_t limit) { return limit - limit / 3; }

/* Whole cache lines: colliders may lie behind it. */
static inline uint64_t pbf_pressure_grid_topology_bytes(uint64_t limit) {
  const uint64_t one = 3 * sizeof(uint64_t) + PBF_PARTS * (sizeof(uint64_t) + sizeof(double)) +
                       4 * sizeof(double) +
                       (7 + PBF_CORNERS + PBF_NODE_COMPARTMENTS) * sizeof(uint32_t);
  return (64 + limit * one + 63) / 64 * 64;
}

/* In memory for the largest limit, of a grid with this one. */
static inline pbf_pressure_grid_topology pbf_pressure_grid_topology_in(void *memory,
                                                                       uint64_t largest,
                                                                       uint64_t limit) {
  pbf_pressure_grid_topology t;
  memset(&t, 0, sizeof t);
  if (!memory) return t;
  t.first = (uint32_t)pbf_pressure_grid_first_further(largest);
  t.limit = (uint32_t)largest;
  t.max_further = (uint32_t)(limit - pbf_pressure_grid_first_further(limit));
  t.counts = (uint32_t *)memory;
  t.samples = (uint64_t *)((char *)memory + 64);
  t.clear = t.samples + largest;
  t.links = t.clear + largest;
  t.merged = t.links + largest;
  t.volumes = (double *)(t.merged + largest * PBF_PARTS);
  t.right = t.volumes + largest * PBF_PARTS;
  t.inverse = t.right + largest;
  t.next = t.inverse + largest;
  t.before = t.next + largest;
  t.further = (uint32_t *)(t.before + largest);
  t.home = t.further + largest;
  t.target = t.home + largest;
  t.touched = t.target + largest;
  t.torn = t.touched + largest;
  t.torn_at = t.torn + largest;
  t.base = t.torn_at + largest;
  t.corners = t.base + largest;
  t.node_compartments = t.corners + largest * PBF_CORNERS;
  return t;
}

/* The first of some more of `most`; PBF_NO_INDEX when there are no so many left. */
PBF_FN uint32_t pbf_pressure_grid_take(uint32_t *count, uint32_t more, uint32_t max_further) {
#ifdef __CUDA_ARCH__
  const uint32_t taken = atomicAdd(count, more);
#else
  const uint32_t taken = *count;
  *count += more;
#endif
  return taken + more <= max_further ? taken : PBF_NO_INDEX;
}

PBF_FN uint32_t pbf_pressure_grid_further_count(const pbf_pressure_grid_topology *t, int of) {
  return t->counts[of] < t->max_further ? t->counts[of] : t->max_further;
}

PBF_FN uint32_t pbf_pressure_grid_torn_count(const pbf_pressure_grid_topology *t) {
  return t->is_active ? t->counts[PBF_TORN_NODES] : 0;
}

/* ---- Cells and their compartments ----------------------------------------------------------- */

enum { PBF_LINK_BITS = 16, PBF_CELL_COUNT_BIT = 48, PBF_CELL_CUT_BIT = 52 };

PBF_FN int pbf_cell_is_cut(const pbf_pressure_grid_topology *t, uint32_t cell) {
  return t->is_active && (t->links[cell] >> PBF_CELL_CUT_BIT & 1);
}

/* 1 for a cell that no thin solid reaches. */
PBF_FN int pbf_cell_compartments(const pbf_pressure_grid_topology *t, uint32_t cell) {
  return pbf_cell_is_cut(t, cell) ? (int)(t->links[cell] >> PBF_CELL_COUNT_BIT & 15) : 1;
}

PBF_FN uint32_t pbf_cell_compartment(const pbf_pressure_grid_topology *t, uint32_t cell, int k) {
  return k == 0 ? cell : t->further[cell] + (uint32_t)(k - 1);
}

PBF_FN uint64_t pbf_cell_samples(const pbf_pressure_grid_topology *t, uint32_t cell, int k) {
  return pbf_cell_is_cut(t, cell) ? t->samples[pbf_cell_compartment(t, cell, k)] : PBF_ALL_SAMPLES;
}

/* Whether compartment k of a cell and compartment l of the next cell along the axis are connected.
 */
PBF_FN int pbf_cell_link(const pbf_pressure_grid_topology *t, uint32_t cell, uint32_t next,
                         int axis, int k, int l) {
  if (!pbf_cell_is_cut(t, cell) && !pbf_cell_is_cut(t, next)) return 1;
  return (int)(t->links[cell] >> (PBF_LINK_BITS * axis + PBF_COMPARTMENTS * k + l) & 1);
}

PBF_FN int pbf_cell_is_inside(const pbf_pressure_grid *c, const int i[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k)
    if (i[k] == 0 || i[k] > c->n[k]) return 0;
  return 1;
}

PBF_FN uint32_t pbf_compartment_cell(const pbf_pressure_grid_topology *t, uint32_t compartment) {
  return !t->is_active || compartment < t->first ? compartment : t->home[compartment - t->first];
}

/* Its node at corner `a`. */
PBF_FN uint32_t pbf_pressure_grid_corner(const pbf_pressure_grid *c,
                                         const pbf_pressure_grid_topology *t, uint32_t compartment,
                                         int a) {
  if (t->is_active) {
    uint32_t node = t->corners[(uint64_t)compartment * PBF_CORNERS + (uint64_t)a];
    if (node || compartment >= t->first) return node;
  }
  return compartment + c->corner[a];
}

PBF_FN void pbf_pressure_grid_corners(const pbf_pressure_grid *c,
                                      const pbf_pressure_grid_topology *t, const double *lambda,
                                      uint32_t compartment, double values[PBF_CORNERS]) {
  for (int a = 0; a < PBF_CORNERS; ++a)
    values[a] = lambda[pbf_pressure_grid_corner(c, t, compartment, a)];
}

/* ---- Their volume --------------------------------------------------------------------------- */

PBF_FN double pbf_volume_part(const pbf_pressure_grid_topology *t, uint32_t compartment, int k) {
  return t->volumes[(uint64_t)compartment * PBF_PARTS + (uint64_t)k];
}

PBF_FN double pbf_merged_part(const pbf_pressure_grid_topology *t, uint32_t compartment, int k) {
  return (double)t->merged[(uint64_t)compartment * PBF_PARTS + (uint64_t)k] * 0x1p-32;
}

/* Whether it is one that has pressures: not a part of another. */
PBF_FN int pbf_compartment_is_own(const pbf_pressure_grid_topology *t, uint32_t compartment) {
  const uint32_t cell = pbf_compartment_cell(t, compartment);
  return !pbf_cell_is_cut(t, cell) || t->target[compartment] == compartment;
}

/* Its free volume with what it has of others; `whole`: of a cell that no thin solid reaches. */
PBF_FN double pbf_compartment_volume(const pbf_pressure_grid_topology *t, uint32_t compartment,
                                     double whole) {
  if (!pbf_compartment_is_own(t, compartment)) return 0;
  const int cut = pbf_cell_is_cut(t, pbf_compartment_cell(t, compartment));
  return (cut ? pbf_volume_part(t, compartment, 0) : whole) + pbf_merged_part(t, compartment, 0);
}

/* The middle of that in the i-th cell along each axis, from -1 to 1. Returns 0 where it is not
 * known: where the free volume of a whole cell is not the walls'. */
PBF_FN int pbf_compartment_middle(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                                  uint32_t compartment, double free_volume, const int i[PBF_DIM],
                                  double middle[PBF_DIM]) {
  const int alone = !t->is_active;
  const int cut = !alone && pbf_cell_is_cut(t, pbf_compartment_cell(t, compartment));
  const double merged = alone ? 0 : pbf_merged_part(t, compartment, 0);
  const double inside = pbf_pressure_grid_inside(c, i);
  if (!cut && free_volume - merged < inside - 1e-3) return 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int first = pbf_pressure_grid_is_first(c, k, i[k]);
    const int last = pbf_pressure_grid_is_last(c, k, i[k]);
    middle[k] = (last - first) * (c->edge[k] - 1);
    if (!cut && !(merged > 0)) continue;
    double moment = cut ? pbf_volume_part(t, compartment, 1 + k) : inside * 0.5 * (1 + middle[k]);
    moment += pbf_merged_part(t, compartment, 1 + k);
    middle[k] = 2 * moment / pbf_max(free_volume, 1e-9) - 1;
  }
  return 1;
}

#endif
