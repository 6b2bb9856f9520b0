/* A grid that tells which of many surfaces are near a place. Each of its cells lists all that may
 * be within a reach of something in it, in the order of their numbers, so that asking those alone
 * gets the bits of asking all. How wide cells are follows from the surfaces: there is memory for so
 * many entries a surface, and where solids are larger or closer than that, cells are wider and
 * their lists longer; none is left out. The host builds it; a device may ask a copy. */
#ifndef PBF_PHYSICS_SURFACES_NEAR_H
#define PBF_PHYSICS_SURFACES_NEAR_H

#include "physics/elementary.h"
#include "physics/surfaces/domain.h"
#include "physics/surfaces/surface.h"

/* Cells and entries that there is memory for, of so many surfaces. */
enum { PBF_CELLS_A_SURFACE = 4, PBF_ENTRIES_A_SURFACE = 32, PBF_MAX_CELLS_ALONG = 1024 };

/* All places where a surface may have something to do with a particle at rest. */
typedef struct pbf_surface_box {
  double lower[PBF_DIM], upper[PBF_DIM]; /* infinite: everywhere */
  double stretch;  /* a particle's own way counts so many times, since it is carried along */
  double steepest; /* as of the surface */
} pbf_surface_box;

typedef struct pbf_surface_grid {
  double lower[PBF_DIM], per_length[PBF_DIM];
  int cells[PBF_DIM];
  double reach;             /* within which a place asks */
  double stretch, steepest; /* the largest */
  uint32_t count;           /* of surfaces, … */
  uint64_t room;            /* … and how many there is memory for */
  uint32_t finer;           /* so many times as many cells as usual, and memory for them; 0: once */
  uint64_t built;           /* how often */
  uint32_t *starts;         /* of a cell's entries, and the end */
  uint16_t *entries;
  pbf_surface_box *boxes; /* of the surfaces */
} pbf_surface_grid;

static inline uint64_t pbf_grid_cell_room(uint64_t surfaces) {
  return PBF_CELLS_A_SURFACE * surfaces + 64;
}

static inline uint64_t pbf_grid_finer(const pbf_surface_grid *g) { return g->finer ? g->finer : 1; }

/* ---- Where a surface is ---------------------------------------------------------------------- */

/* What grows takes along more than what is rigid. */
static inline double pbf_surface_turn(const pbf_surface *s) {
  for (int row = 0; row < PBF_DIM; ++row) {
    const double long2 = (double)pbf_dot(s->start_frame[row], s->start_frame[row]);
    if (!(long2 > 0.9999 && long2 < 1.0001)) return 2 * (double)s->turn;
  }
  return (double)s->turn;
}

/* Of a surface in a step. A particle that starts `d` away from it is carried along by no more than
 * `step + turn (d + bound)`, and so meets it only where (1 - turn) d is less than its own way and
 * the rest of that. */
static inline pbf_surface_box pbf_surface_box_of(const pbf_surface *s) {
  pbf_surface_box box;
  const double turn = pbf_surface_turn(s), bound = (double)s->bound;
  const bool everywhere = pbf_surface_is_unbounded(s) || !(turn < 0.8);
  const bool has_extents = !(turn > 0) && !pbf_surface_is_field(s);
  box.stretch = everywhere ? 1 : 1 / (1 - turn);
  box.steepest = (double)s->steepest;
  const double around = box.stretch * ((double)s->step + turn * bound + 2 * (double)s->skin);
  for (int k = 0; k < PBF_DIM; ++k) {
    const double now = (double)s->center.c[k], before = (double)s->start_center.c[k];
    double half = has_extents ? fmin(pbf_surface_extent(s, k), bound) : bound;
    half += around + 1e-3 * bound + 16 * (double)s->rounding;
    box.lower[k] = everywhere ? -INFINITY : fmin(now, before) - half;
    box.upper[k] = everywhere ? INFINITY : fmax(now, before) + half;
  }
  return box;
}

/* ---- The grid -------------------------------------------------------------------------------- */

/* The cell of a coordinate: larger ones are in no earlier cell, and those beyond an end in the last
 * one before it. */
PBF_FN int pbf_grid_cell_along(const pbf_surface_grid *g, int k, double x) {
  const double at = (x - g->lower[k]) * g->per_length[k];
  if (!(at > 0)) return 0;
  return at < g->cells[k] ? (int)at : g->cells[k] - 1;
}

typedef struct pbf_cell_range {
  int first[PBF_DIM], last[PBF_DIM];
} pbf_cell_range;

PBF_FN_HOST_NOINLINE pbf_cell_range pbf_cells_between(const pbf_surface_grid *g,
                                                      const double *lower, const double *upper,
                                                      double beyond) {
  pbf_cell_range r;
  for (int k = 0; k < PBF_DIM; ++k) {
    r.first[k] = pbf_grid_cell_along(g, k, lower[k] - beyond);
    r.last[k] = pbf_grid_cell_along(g, k, upper[k] + beyond);
  }
  return r;
}

PBF_FN uint64_t pbf_cells_in(const pbf_cell_range *r) {
  uint64_t cells = 1;
  for (int k = 0; k < PBF_DIM; ++k) cells *= (uint64_t)(r->last[k] - r->first[k] + 1);
  return cells;
}

namespace {

/* Calls visit(cell) for each. */
template <class Visit>
static inline void each_cell(const pbf_surface_grid *g, const pbf_cell_range &r, Visit visit) {
  const int levels = PBF_DIM == 3 ? r.last[PBF_DIM - 1] : 0;
  for (int z = PBF_DIM == 3 ? r.first[PBF_DIM - 1] : 0; z <= levels; ++z)
    for (int y = r.first[1]; y <= r.last[1]; ++y)
      for (int x = r.first[0]; x <= r.last[0]; ++x)
        visit((uint32_t)((z * g->cells[1] + y) * g->cells[0] + x));
}

}  // namespace

/* The region that cells divide: what surfaces with an end reach, within the domain. */
static inline void pbf_grid_region(const pbf_surface_grid *g, const pbf_domain *domain,
                                   double lower[PBF_DIM], double length[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    double low = INFINITY, high = -INFINITY;
    for (uint32_t s = 0; s < g->count; ++s) {
      if (!(g->boxes[s].upper[k] < INFINITY)) continue;
      low = fmin(low, g->boxes[s].lower[k]);
      high = fmax(high, g->boxes[s].upper[k]);
    }
    low = fmax(low - g->reach, (double)domain->lower.c[k]);
    high = fmin(high + g->reach, (double)domain->upper.c[k]);
    lower[k] = low < high ? low : (double)domain->lower.c[k];
    length[k] = low < high ? high - low : 0;
  }
}

/* Cells of such a width; their number. */
static inline uint64_t pbf_grid_divide(pbf_surface_grid *g, const double length[PBF_DIM],
                                       double width) {
  uint64_t cells = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double along = fmin(length[k] / width, PBF_MAX_CELLS_ALONG);
    g->cells[k] = along >= 1 ? (int)along : 1;
    g->per_length[k] = length[k] > 0 ? g->cells[k] / length[k] : 0;
    cells *= (uint64_t)g->cells[k];
  }
  return cells;
}

static inline uint64_t pbf_grid_entries(const pbf_surface_grid *g) {
  uint64_t entries = 0;
  for (uint32_t s = 0; s < g->count; ++s) {
    const pbf_cell_range r = pbf_cells_between(g, g->boxes[s].lower, g->boxes[s].upper, g->reach);
    entries += pbf_cells_in(&r);
  }
  return entries;
}

/* Lists the surfaces in their order, cell by cell. */
static inline void pbf_grid_fill(pbf_surface_grid *g, uint64_t cells) {
  memset(g->starts, 0, (cells + 1) * sizeof *g->starts);
  for (int fills = 0; fills < 2; ++fills) {
    for (uint32_t s = 0; s < g->count; ++s) {
      const pbf_cell_range r = pbf_cells_between(g, g->boxes[s].lower, g->boxes[s].upper, g->reach);
      each_cell(g, r, [&](uint32_t cell) {
        if (fills)
          g->entries[g->starts[cell]++] = (uint16_t)s;
        else
          ++g->starts[cell];
      });
    }
    uint32_t sum = 0, entries;
    for (uint64_t cell = 0; cell <= cells && !fills; ++cell, sum += entries) {
      entries = g->starts[cell];
      g->starts[cell] = sum;
    }
  }
  for (uint64_t cell = cells; cell > 0; --cell) g->starts[cell] = g->starts[cell - 1];
  g->starts[0] = 0;
}

/* Of the first `count` boxes, for places within `reach` of the surfaces. About two
 * cells a surface, or so many times as many; wider ones where these would have more entries than
 * there is memory for. */
static inline void pbf_grid_build(pbf_surface_grid *g, uint32_t count, const pbf_domain *domain,
                                  double reach) {
  double length[PBF_DIM], volume = 1;
  g->reach = reach;
  g->stretch = g->steepest = 1;
  g->count = count;
  ++g->built;
  for (uint32_t s = 0; s < count; ++s) {
    g->stretch = fmax(g->stretch, g->boxes[s].stretch);
    g->steepest = fmax(g->steepest, g->boxes[s].steepest);
  }
  pbf_grid_region(g, domain, g->lower, length);
  for (int k = 0; k < PBF_DIM; ++k) volume *= length[k];
  const double even = volume / (2.0 * fmax(count, 1) * (double)pbf_grid_finer(g));
  double width = fmax(2 * reach, pbf_side_of(even, PBF_DIM));
  uint64_t cells = pbf_grid_divide(g, length, width);
  while (cells > 1 && (cells > pbf_grid_cell_room(g->room * pbf_grid_finer(g)) ||
                       pbf_grid_entries(g) > PBF_ENTRIES_A_SURFACE * g->room))
    cells = pbf_grid_divide(g, length, width *= 1.4);
  pbf_grid_fill(g, cells);
}

/* ---- Asking ---------------------------------------------------------------------------------- */

PBF_FN uint32_t pbf_cell_entries(const pbf_surface_grid *g, uint32_t cell,
                                 const uint16_t **numbers) {
  *numbers = g->entries + g->starts[cell];
  return g->starts[cell + 1] - g->starts[cell];
}

/* How many surfaces may be within reach of x, and which. */
PBF_FN uint32_t pbf_surfaces_at(const pbf_surface_grid *g, pbf_vec x, const uint16_t **numbers) {
  uint32_t cell = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k)
    cell = cell * (uint32_t)g->cells[k] + (uint32_t)pbf_grid_cell_along(g, k, (double)x.c[k]);
  return pbf_cell_entries(g, cell, numbers);
}

/* The surfaces in any of some cells, in the order of their numbers, to `room`. */
static inline uint32_t pbf_merge_cells(const pbf_surface_grid *g, const pbf_cell_range &r,
                                       uint16_t *room) {
  uint64_t among[PBF_MAX_COLLIDERS / 64];
  const uint32_t words = (g->count + 63) / 64;
  uint32_t found = 0;
  memset(among, 0, words * sizeof *among);
  each_cell(g, r, [&](uint32_t cell) {
    const uint16_t *numbers;
    const uint32_t entries = pbf_cell_entries(g, cell, &numbers);
    for (uint32_t k = 0; k < entries; ++k) among[numbers[k] / 64] |= UINT64_C(1) << numbers[k] % 64;
  });
  for (uint32_t w = 0; w < words; ++w)
    for (uint64_t rest = among[w]; rest; rest &= rest - 1)
      room[found++] = (uint16_t)(64 * w + (uint32_t)__builtin_ctzll(rest));
  return found;
}

/* How many surfaces may be within `reach` of something in a box, and which: of one cell
 * its list, of several a list in `room`; null: all. */
static inline __attribute__((noinline)) uint32_t pbf_surfaces_around(const pbf_surface_grid *g,
                                                                     pbf_vec lower, pbf_vec upper,
                                                                     double reach, uint16_t *room,
                                                                     const uint16_t **numbers) {
  enum { MOST_CELLS = 512 }; /* in more than that all are asked as fast */
  double low[PBF_DIM], high[PBF_DIM];
  const double beyond = fmax(reach - g->reach, 0);
  for (int k = 0; k < PBF_DIM; ++k) {
    low[k] = (double)lower.c[k];
    high[k] = (double)upper.c[k];
  }
  const pbf_cell_range r = pbf_cells_between(g, low, high, beyond);
  const uint64_t cells = pbf_cells_in(&r);
  if (cells == 1) return pbf_surfaces_at(g, lower, numbers);
  *numbers = cells > MOST_CELLS ? NULL : room;
  return cells > MOST_CELLS ? g->count : pbf_merge_cells(g, r, room);
}

#endif
