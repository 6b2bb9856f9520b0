/* How a cell grid is wrapped where its domain has more cells than there is room for, as fluid in a
 * vast domain does: far parts then share cells, which costs distance tests and loses no pair.
 *
 * Rows of cells (across y and z) are counted modulo a power of two, in an order that keeps the rows
 * around any place apart: one on along one axis, pbf_grid_wrap_stride on along the other. Along
 * rows (x) the numbering turns back at either end and goes the other way: then neighbours
 * still are in one contiguous run. Host only. */
#ifndef PBF_PHYSICS_GRID_WRAP_H
#define PBF_PHYSICS_GRID_WRAP_H

#include <math.h>

#include "physics/elementary.h"
#include "physics/real.h"

/* What is stored of a grid. */
typedef struct pbf_grid_wrap {
  double columns, rows;
  int wraps_columns, wraps_rows; /* fewer columns, fewer rows than the grid has */
} pbf_grid_wrap;

/* Powers of two, for `rows` that wrap. */
enum { PBF_WRAP_MIN_ROWS = 1 << 5, PBF_WRAP_MAX_ROWS = 1 << 24 };

/* Rows that share a number are a and b apart along the two axes: among all strides, and from 2,048
 * rows on those near 0.618 of the rows, these keep the least a * b largest, a quarter to a third of
 * the rows. So blocks, columns and puddles all spread. */
static inline uint32_t pbf_grid_wrap_stride(double rows) {
  static const uint32_t strides[] = {7,      19,     47,      75,      149,     275,     1191,
                                     2539,   4991,   10155,   20223,   40521,   80929,   161991,
                                     323982, 648053, 1296106, 2592211, 5184422, 10368903};
  uint32_t k = 0;
  while (rows > PBF_WRAP_MIN_ROWS) rows /= 2, ++k;
  return strides[k];
}

static inline double pbf_power_below(double limit) {
  double power = PBF_WRAP_MIN_ROWS;
  while (2 * power <= fmin(limit, PBF_WRAP_MAX_ROWS)) power *= 2;
  return power;
}

/* Of up to `limit` cells (100 or more), up to `finest` of them in a width along rows, given the
 * grid's number of widths. What is wrapped gets about a cube's sides, in 3D up to four times as
 * many columns: fluid falls, and then spreads. A side that the grid has less of leaves its room to
 * the other. */
static inline pbf_grid_wrap pbf_grid_wrap_of(double limit, double finest,
                                             const double widths[PBF_DIM]) {
  const double max_columns = finest * widths[0];
  double rows = 1;
  for (int k = 1; k < PBF_DIM; ++k) rows *= widths[k];
  pbf_grid_wrap wrap = {fmin(max_columns, floor(limit / rows)), rows, 0, 0};
  if (rows * widths[0] <= limit) return wrap;
  double side = pbf_side_of(limit / finest, PBF_DIM);
  double few = pbf_power_below(PBF_DIM == 3 ? side * side : 1.42 * side);
  wrap.columns = fmin(max_columns, floor(limit / fmin(rows, few)));
  wrap.wraps_columns = wrap.columns < max_columns;
  wrap.wraps_rows = rows > few;
  if (wrap.wraps_rows) wrap.rows = pbf_power_below(limit / wrap.columns);
  return wrap;
}

#endif
