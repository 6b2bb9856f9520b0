/* Points sorted by cells, to look for neighbours on the host. */
#ifndef PBF_LIB_PARTICLES_CELLS_H
#define PBF_LIB_PARTICLES_CELLS_H

#include <pbf/pbf.h>

/* So many cells lie within a radius: of two, fewer points beyond it are looked at than of one. */
enum { PBF_CELL_REACH = 2, PBF_CELL_LINES = 2 * PBF_CELL_REACH + 1 };
enum { PBF_CELL_RUNS = PBF_CELL_LINES * PBF_CELL_LINES };

/* Elements begin … end - 1 of the sorted points. */
typedef struct pbf_cell_run {
  uint32_t begin, end;
} pbf_cell_run;

/* By cell and, within a cell, in the order in which they were given. Only cells that have points
 * are stored, so that a drop far away costs nothing. */
typedef struct pbf_cells {
  const pbf_allocator *allocator;
  uint32_t dimension, count;
  double radius;
  double origin[3];
  void *memory;
  uint64_t bytes;
  double *points;  /* (count, dimension), sorted */
  uint64_t *keys;  /* of the sorted points' cells, ascending */
  uint32_t *order; /* which of the given points each is */
} pbf_cells;

/* `points`, (count, dimension), are finite; `radius` is above 0. */
pbf_status pbf_cells_build(const pbf_allocator *allocator, const double *points, uint32_t count,
                           uint32_t dimension, double radius, pbf_cells *cells);
void pbf_cells_free(pbf_cells *cells);

/* The runs that have all points within the radius of those in the cell of element `element`, and
 * others; returns how many runs. */
uint32_t pbf_cells_around(const pbf_cells *cells, uint32_t element,
                          pbf_cell_run runs[PBF_CELL_RUNS]);

#endif
