/* The grid of the neighbour search. Cells are numbered along rows, so that the cells within reach
 * of a particle are a contiguous run in each of the 3 (in 3D: 9) rows around it. */
#ifndef PBF_CPU_GRID_H
#define PBF_CPU_GRID_H

#include <float.h>
#include <math.h>

#include "cpu/field.h"
#include "physics/grid_wrap.h"
#include "physics/periodic.h"

/* Images of a particle: a digit to the base 3 for each of the particles' axes, 0 where it is, 1 a
 * period up and 2 a period down. */
enum { IMAGES = PBF_DIM == 3 ? 27 : 9 };

/* Everything along axes is in the grid's own order of them: along rows first. */
typedef struct grid {
  int axis[PBF_DIM]; /* which of the particles' axes */
  pbf_real lower[PBF_DIM];
  pbf_real inv_width[PBF_DIM];
  pbf_real last[PBF_DIM];   /* index of the last cell along each axis */
  uint32_t cells[PBF_DIM];  /* along rows those stored, else those that there are */
  uint32_t stride[PBF_DIM]; /* row = (stride[1] * index + stride[2] * index) & row_mask */
  uint32_t row_mask;
  uint32_t reach;       /* cells along a row that h can span */
  uint32_t up[PBF_DIM]; /* of periodic axes the image a period up, else 0 */
  uint32_t total;
  pbf_real far; /* an x out of reach of all particles */
} grid;

/* Cells are narrower along rows, where this costs nothing: fewer candidates at the ends of a run.
 */
enum { GRID_CELLS_PER_H = 2 };

/* As much wider than h / parts as rounding in grid_index may move a particle. */
PBF_FN double grid_width(double h, double extent, int parts) {
  double epsilon = sizeof(pbf_real) == sizeof(float) ? FLT_EPSILON : DBL_EPSILON;
  return (h + 4 * epsilon * extent) / parts;
}

/* The last axis is the longest: what lies between two cuts through the numbering then has the least
 * border. Rows are the longer of the others. */
static inline void grid_axes(const double size[PBF_DIM], int axis[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) axis[k] = k;
  for (int k = 0; k + 1 < PBF_DIM; ++k)
    if (size[axis[k]] > size[axis[PBF_DIM - 1]]) {
      int longer = axis[k];
      axis[k] = axis[PBF_DIM - 1];
      axis[PBF_DIM - 1] = longer;
    }
  if (PBF_DIM == 3 && size[axis[1]] > size[axis[0]]) {
    int longer = axis[1];
    axis[1] = axis[0];
    axis[0] = longer;
  }
}

/* A vector or a field in the grid's order. */
PBF_FN pbf_vec grid_vec(const int axis[PBF_DIM], pbf_vec a) {
  pbf_vec b;
  for (int k = 0; k < PBF_DIM; ++k) b.c[k] = a.c[axis[k]];
  return b;
}

PBF_FN field grid_field(const int axis[PBF_DIM], field a) {
  field b;
  for (int k = 0; k < PBF_DIM; ++k) b.c[k] = a.c[axis[k]];
  return b;
}

/* Rows one after the other along axis 1, then along axis 2; wrapped along axis 2, then along 1. */
static inline void grid_number_rows(grid *g, const pbf_grid_wrap *stored) {
  g->stride[0] = 0;
  g->stride[1] = 1;
  if (PBF_DIM == 3) g->stride[PBF_DIM - 1] = g->cells[1];
  g->row_mask = UINT32_MAX;
  if (!stored->wraps_rows) return;
  g->row_mask = (uint32_t)stored->rows - 1;
  if (PBF_DIM == 3) g->stride[1] = pbf_grid_wrap_stride(stored->rows);
  g->stride[PBF_DIM - 1] = 1;
}

/* The image a period up along an axis of the particles' ones; 0 where there is none. */
static inline uint32_t image_up(const pbf_periods *periods, int axis) {
  static const uint32_t powers[3] = {1, 3, 9};
  return periods && periods->length.c[axis] > 0 ? powers[axis] : 0;
}

/* A grid of at most `limit` cells (100 or more) around the box low … high. Where that has more,
 * cells get longer along rows, up to h, or it is wrapped (physics/grid_wrap.h). Along a periodic
 * axis the last cell is longer, and ends where the box does. */
static inline grid grid_of_cells(const int axis[PBF_DIM], pbf_vec low, pbf_vec high, double h,
                                 uint64_t limit, const pbf_periods *periods) {
  const pbf_vec lower = grid_vec(axis, low), upper = grid_vec(axis, high);
  grid g = {};
  double cells[PBF_DIM], widths[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    double extent = fmax((double)upper.c[k] - (double)lower.c[k], 0);
    double width = grid_width(h, extent, k ? 1 : GRID_CELLS_PER_H);
    g.up[k] = image_up(periods, axis[k]);
    cells[k] = fmin(fmax(floor(extent / width) + (g.up[k] ? 0 : 1), 1), 1 << 30);
    widths[k] = k ? cells[k] : ceil(cells[k] / GRID_CELLS_PER_H);
    g.axis[k] = axis[k];
    g.lower[k] = lower.c[k];
    g.inv_width[k] = (pbf_real)(1 / width);
    g.cells[k] = (uint32_t)cells[k];
    g.last[k] = (pbf_real)(cells[k] - 1);
  }
  g.far = (pbf_real)((double)high.c[0] + 4 * ((double)high.c[0] - (double)low.c[0] + h));
  g.reach = GRID_CELLS_PER_H;
  const pbf_grid_wrap stored = pbf_grid_wrap_of((double)limit, GRID_CELLS_PER_H, widths);
  if (stored.columns < cells[0]) {
    g.cells[0] = (uint32_t)stored.columns;
    if (!stored.wraps_columns) {
      g.inv_width[0] *= (pbf_real)(stored.columns / (cells[0] + (g.up[0] ? 0 : 1)));
      g.last[0] = (pbf_real)(stored.columns - 1);
    }
  }
  grid_number_rows(&g, &stored);
  g.total = g.cells[0] * (uint32_t)stored.rows;
  return g;
}

static inline int grid_is_stored_whole(const grid *g) {
  return g->row_mask == UINT32_MAX && (pbf_real)g->cells[0] > g->last[0];
}

/* Cells of the same number are not across a face from each other in a wrapped grid: where any axis
 * is periodic, they get wider instead. */
static inline grid grid_around(const int axis[PBF_DIM], pbf_vec low, pbf_vec high, double h,
                               uint64_t limit, const pbf_periods *periods = NULL) {
  grid g = grid_of_cells(axis, low, high, h, limit, periods);
  for (double width = h; periods && periods->any && !grid_is_stored_whole(&g);)
    g = grid_of_cells(axis, low, high, width *= 1.25, limit, periods);
  return g;
}

/* Cell along one of the grid's axes; the last one for all that is beyond, the first for NaN. */
PBF_FN uint32_t grid_index(const grid *g, int axis, pbf_real x) {
  pbf_real t = (x - g->lower[axis]) * g->inv_width[axis];
  t = pbf_real_min(pbf_real_max(t, 0), g->last[axis]);
  return (uint32_t)(int32_t)t;
}

PBF_FN int grid_is_wrapped(const grid *g) { return !grid_is_stored_whole(g); }

/* Row of the indices across rows. */
PBF_FN uint32_t grid_row(const grid *g, const uint32_t at[PBF_DIM]) {
  uint32_t row = 0;
  for (int k = 1; k < PBF_DIM; ++k) row += g->stride[k] * at[k];
  return row & g->row_mask;
}

/* Cell of a position in the grid's order. */
PBF_FN uint32_t grid_cell(const grid *g, pbf_vec x, const int wrapped) {
  uint32_t at[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) at[k] = grid_index(g, k, x.c[k]);
  if (wrapped) {
    at[0] %= 2 * g->cells[0];
    if (at[0] >= g->cells[0]) at[0] = 2 * g->cells[0] - 1 - at[0];
  }
  return grid_row(g, at) * g->cells[0] + at[0];
}

/* The rows around a row, itself in the middle, each once; opposite ones are equally far from the
 * ends of their numbering. */
enum { GRID_ROWS_AROUND = PBF_DIM == 3 ? 9 : 3 };

#define GRID_NO_ROW UINT32_MAX

/* Indices across rows of a row; of a wrapped grid all but the last are 0. */
static inline void grid_row_indices(const grid *g, uint32_t row, uint32_t at[PBF_DIM]) {
  at[PBF_DIM - 1] = row;
  if (PBF_DIM < 3) return;
  at[1] = g->row_mask != UINT32_MAX ? 0 : row % g->cells[1];
  if (g->row_mask == UINT32_MAX) at[PBF_DIM - 1] = row / g->cells[1];
}

/* Of the rows around the one at `from`. `image`: that of its particles, from which what is in that
 * row is there, beyond faces. */
static inline uint32_t grid_row_around(const grid *g, const uint32_t from[PBF_DIM], int number,
                                       uint32_t *image) {
  const int step[3] = {0, number % 3 - 1, PBF_DIM == 3 ? number / 3 - 1 : 0};
  uint32_t at[PBF_DIM];
  const bool wrapped = g->row_mask != UINT32_MAX;
  for (int k = 1; k < PBF_DIM; ++k) {
    at[k] = from[k] + (uint32_t)step[k];
    if (wrapped || at[k] < g->cells[k]) continue;
    if (!g->up[k]) return GRID_NO_ROW;
    *image += step[k] < 0 ? g->up[k] : 2 * g->up[k];
    at[k] = step[k] < 0 ? g->cells[k] - 1 : 0;
  }
  return grid_row(g, at);
}

#endif
