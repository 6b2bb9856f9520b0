/* The cell grid of the neighbour search.
 *
 * Cells are h wide across the rows (y, z) and finer along them (x), numbered along x first, so that
 * the cells of one row around a particle are one contiguous run of sorted particles. The grid
 * covers the domain; what lies outside counts to the border cells, which keeps every pair of
 * neighbours in neighbouring cells. A domain with too many cells is wrapped (physics/grid_wrap.h).
 */
#ifndef PBF_CUDA_GRID_H
#define PBF_CUDA_GRID_H

#include <float.h>
#include <stdint.h>

#include "physics/collide.h"
#include "physics/grid_wrap.h"
#include "physics/lane_vector.h"

/* Rows around a particle's own, itself included. */
enum { PBF_ROWS = PBF_DIM == 3 ? 9 : 3 };

struct cell_grid {
  pbf_vec origin, scale; /* cell coordinate = (x - origin) * scale, kept in 0 … last */
  pbf_vec last;
  pbf_real reach, reach2;   /* h and a margin for rounding */
  pbf_vec row_width;        /* of cells across the rows, at least `reach` */
  pbf_vec period;           /* of each axis; 0 between walls */
  int periodic;             /* any */
  pbf_real turn;            /* where the numbering along x turns back first; 0: never */
  uint32_t cells[PBF_DIM];  /* along x those stored, else those that the domain has */
  uint32_t stride[PBF_DIM]; /* row = (stride[1] * y + stride[2] * z) & row_mask */
  uint32_t row_mask;
  uint32_t columns_in_reach; /* cells along a row that `reach` spans */
  uint32_t count;
};

/* Most cells for so many particles. */
static inline uint32_t grid_cell_limit(uint32_t count) { return 2 * count + 4096; }

/* Cells along a row in h: finer cells mean fewer candidates, and more cells. */
enum { PBF_FINEST = 4 };

static inline double grid_margin(double cells) {
  double epsilon = sizeof(pbf_real) == sizeof(float) ? FLT_EPSILON : DBL_EPSILON;
  return 1 + 1e-4 + 8 * epsilon * cells;
}

/* The widths of a cell across the rows that an axis has room for. Those of a periodic one fill it,
 * and are three or more, so that the cells around a cell are different ones. */
static inline double grid_widths(const pbf_periods *periods, int axis, double extent,
                                 double row_width) {
  if (periods->length.c[axis] > 0) return fmax(floor(extent / row_width), 3);
  return floor(extent / row_width) + 1;
}

/* Cells across a face have numbers of their own: with periodic axes they get wider where the grid
 * would be wrapped. */
static inline double grid_width_to_store(const pbf_periods *periods, const double extent[PBF_DIM],
                                         double row_width, uint32_t limit) {
  for (double total = HUGE_VAL; periods->any && total > limit;) {
    total = 1;
    for (int k = 0; k < PBF_DIM; ++k) total *= grid_widths(periods, k, extent[k], row_width);
    if (total > limit) row_width *= 1.25;
  }
  return row_width;
}

/* Of up to `limit` cells, and up to `finest` of them in h along the rows. */
static inline cell_grid grid_over(const pbf_domain *domain, const pbf_periods *periods, double h,
                                  uint32_t limit, double finest) {
  enum { MAX_CELLS = 1 << 21 }; /* along an axis; exact as a float, also if four times as many */
  cell_grid g;
  double extent[PBF_DIM], full[PBF_DIM], longest = 1;
  g.periodic = periods->any;
  g.period = periods->length;
  for (int k = 0; k < PBF_DIM; ++k) {
    extent[k] = g.period.c[k] > 0
                    ? (double)g.period.c[k]
                    : fmax(0, (double)domain->upper.c[k] - (double)domain->lower.c[k]);
    longest = fmax(longest, extent[k] / h);
  }
  double reach = h * grid_margin(fmin(longest, MAX_CELLS));
  g.reach = (pbf_real)reach;
  g.reach2 = (pbf_real)(reach * reach);
  double row_width = fmax(reach * grid_margin(0), longest * h / MAX_CELLS);
  row_width = grid_width_to_store(periods, extent, row_width, limit);
  for (int k = 0; k < PBF_DIM; ++k) full[k] = grid_widths(periods, k, extent[k], row_width);
  const pbf_grid_wrap stored = pbf_grid_wrap_of(limit, finest, full);
  double width =
      stored.wraps_columns ? row_width / finest : fmax(extent[0], row_width) / stored.columns;
  for (int k = 0; k < PBF_DIM; ++k) {
    const bool periodic = g.period.c[k] > 0;
    const double across = periodic ? extent[k] / full[k] : row_width;
    g.origin.c[k] = (periodic ? periods->lower : domain->lower).c[k];
    g.row_width.c[k] = (pbf_real)across;
    g.scale.c[k] = (pbf_real)(1 / (k ? across : width));
    g.cells[k] = (uint32_t)(k ? full[k] : stored.columns);
    g.last.c[k] = (pbf_real)(g.cells[k] - 1);
  }
  g.turn = stored.wraps_columns ? (pbf_real)(stored.columns * width) : 0;
  g.stride[0] = 0;
  g.stride[1] = PBF_DIM == 3 && stored.wraps_rows ? pbf_grid_wrap_stride(stored.rows) : 1;
  if (PBF_DIM == 3) g.stride[PBF_DIM - 1] = stored.wraps_rows ? 1 : g.cells[1];
  g.row_mask = stored.wraps_rows ? (uint32_t)stored.rows - 1 : ~0u;
  g.columns_in_reach = (uint32_t)ceil(reach / width * grid_margin(longest));
  g.count = (uint32_t)(stored.columns * stored.rows);
  return g;
}

/* Along x from the grid's origin, as the cells are numbered. */
PBF_FN pbf_real grid_along(const cell_grid &g, pbf_real x) {
  pbf_real from = x - g.origin.c[0], turn = g.turn;
  if (!(turn > 0)) return from;
  from -= 2 * turn * floor(from / (2 * turn));
  return turn - fabs(turn - from);
}

/* Across the rows, from the grid's origin, in cells. */
PBF_FN pbf_real grid_coordinate(const cell_grid &g, int axis, pbf_real x) {
  return (x - g.origin.c[axis]) * g.scale.c[axis];
}

/* Also for what is no number, the particle stays in the grid. */
PBF_FN uint32_t grid_index(const cell_grid &g, int axis, pbf_real coordinate) {
  pbf_real kept = pbf_real_min(pbf_real_max(coordinate, 0), g.last.c[axis]);
  return (uint32_t)kept;
}

PBF_FN uint32_t grid_column(const cell_grid &g, pbf_real along) {
  return grid_index(g, 0, along * g.scale.c[0]);
}

/* First cell of the row with the indices `at` across the rows. */
PBF_FN uint32_t grid_row(const cell_grid &g, const uint32_t at[PBF_DIM]) {
  uint32_t row = 0;
  for (int k = 1; k < PBF_DIM; ++k) row += g.stride[k] * at[k];
  return (row & g.row_mask) * g.cells[0];
}

PBF_FN uint32_t grid_cell(const cell_grid &g, pbf_vec x) {
  uint32_t at[PBF_DIM];
  for (int k = 1; k < PBF_DIM; ++k) at[k] = grid_index(g, k, grid_coordinate(g, k, x.c[k]));
  return grid_row(g, at) + grid_column(g, grid_along(g, x.c[0]));
}

/* Where a particle looks for neighbours: what its rows have in common. */
struct grid_view {
  pbf_real along;                            /* the rows */
  uint32_t own[PBF_DIM];                     /* its cell's indices, across the rows */
  pbf_real below2[PBF_DIM], above2[PBF_DIM]; /* squared distances to the cells beside its own */
};

PBF_FN grid_view grid_look(const cell_grid &g, pbf_vec x) {
  grid_view view;
  view.along = grid_along(g, x.c[0]);
  for (int k = 1; k < PBF_DIM; ++k) {
    pbf_real t = grid_coordinate(g, k, x.c[k]);
    view.own[k] = grid_index(g, k, t);
    pbf_real own = (pbf_real)view.own[k];
    pbf_real below = pbf_real_max(t - own, 0) * g.row_width.c[k];
    pbf_real above = pbf_real_max(own + 1 - t, 0) * g.row_width.c[k];
    const bool ends = !(g.period.c[k] > 0);
    view.below2[k] = ends && view.own[k] == 0 ? g.reach2 : below * below;
    view.above2[k] = ends && own >= g.last.c[k] ? g.reach2 : above * above;
  }
  return view;
}

/* Steps across the rows from a particle's to row 0 … PBF_ROWS - 1. */
PBF_FN uint32_t grid_step(int row, int axis) {
  return (uint32_t)((axis == 1 ? row % 3 : row / 3) - 1);
}

/* An index across the rows, a step on: beyond a face of a periodic axis. */
PBF_FN uint32_t grid_beyond(const cell_grid &g, int axis, uint32_t at) {
  if (!(g.period.c[axis] > 0) || at < g.cells[axis]) return at;
  return at == g.cells[axis] ? 0 : g.cells[axis] - 1;
}

/* The image of x from which row 0 … PBF_ROWS - 1 is there. */
PBF_FN pbf_vec grid_image(const cell_grid &g, const grid_view &view, int row, pbf_vec x) {
  for (int k = 1; k < PBF_DIM; ++k) {
    const uint32_t at = view.own[k] + grid_step(row, k);
    if (at >= g.cells[k]) x.c[k] += at == g.cells[k] ? -g.period.c[k] : g.period.c[k];
  }
  return x;
}

/* Whether a particle reaches beyond a periodic face along its row. */
PBF_FN bool grid_reaches_beyond(const cell_grid &g, const grid_view &view) {
  const pbf_real period = g.period.c[0];
  return period > 0 && !(view.along > g.reach && view.along < period - g.reach);
}

/* The view from a particle's image beyond the nearer face along its row. */
PBF_FN grid_view grid_view_beyond(const cell_grid &g, grid_view view) {
  const pbf_real period = g.period.c[0];
  view.along += 2 * view.along < period ? period : -period;
  return view;
}

/* Cells first … last of row 0 … PBF_ROWS - 1 that can hold neighbours; false when there are none.
 */
PBF_FN bool grid_reach(const cell_grid &g, const grid_view &view, int row, uint32_t *first,
                       uint32_t *last) {
  uint32_t at[PBF_DIM];
  pbf_real left2 = g.reach2;
  for (int k = 1; k < PBF_DIM; ++k) {
    int step = (int)grid_step(row, k);
    left2 -= step == 0 ? 0 : step < 0 ? view.below2[k] : view.above2[k];
    at[k] = grid_beyond(g, k, view.own[k] + (uint32_t)step);
  }
  if (!(left2 > 0)) return false;
  pbf_real left = ops<pbf_real>::root(left2); /* `reach` has room for its rounding */
  uint32_t start = grid_row(g, at);
  *first = start + grid_column(g, view.along - left);
  *last = start + grid_column(g, view.along + left);
  return true;
}

/* The same from a cell alone, for all particles that may be in it: a superset. */
PBF_FN bool grid_reach_of_cell(const cell_grid &g, uint32_t cell, int row, uint32_t *first,
                               uint32_t *last) {
  uint32_t at[PBF_DIM], column = cell % g.cells[0], span = g.columns_in_reach;
  cell /= g.cells[0];
  if (g.row_mask != ~0u) {
    for (int k = 1; k < PBF_DIM; ++k) at[k] = grid_step(row, k);
    at[PBF_DIM - 1] += cell; /* that axis has stride 1 */
  } else {
    for (int k = 1; k < PBF_DIM; ++k) {
      at[k] = grid_beyond(g, k, cell % g.cells[k] + grid_step(row, k));
      cell /= g.cells[k];
      if (at[k] >= g.cells[k]) return false;
    }
  }
  uint32_t start = grid_row(g, at);
  *first = start + (column > span ? column - span : 0);
  *last = start + (column + span < g.cells[0] ? column + span : g.cells[0] - 1);
  return true;
}

/* Of a cell with these neighbours in a row, those beyond a face along it. */
PBF_FN bool grid_reach_beyond(const cell_grid &g, uint32_t cell, uint32_t *first, uint32_t *last) {
  const uint32_t column = cell % g.cells[0], span = g.columns_in_reach, cells = g.cells[0];
  const uint32_t start = *first / cells * cells;
  if (!(g.period.c[0] > 0) || *last - *first + 1 == cells) return false;
  if (column < span) {
    const uint32_t left = column + cells - span, between = *last - start + 1;
    *first = start + (left > between ? left : between);
    *last = start + cells - 1;
  } else if (column + span >= cells) {
    const uint32_t right = column + span - cells, between = *first - start;
    *first = start;
    *last = start + (right < between ? right : between - 1);
  } else {
    return false;
  }
  return true;
}

#endif
