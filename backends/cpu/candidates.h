/* Part of lists.h. Where the neighbours of particles that lie near each other in a row are looked
 * for: in runs of cells around them, and beyond the faces of periodic axes. The same for all
 * instruction sets. */
#ifndef PBF_CPU_CANDIDATES_H
#define PBF_CPU_CANDIDATES_H

#include "cpu/kernels.h"

/* Cells along a row; none where left > right. */
typedef struct cell_run {
  uint32_t left, right;
  uint32_t image; /* of the particles, from which these are there */
} cell_run;

static cell_run reached_between(const grid *g, const reached_cells *from) {
  const uint32_t end = g->cells[0] - 1, right = from->last + g->reach;
  return (cell_run){from->first > g->reach ? from->first - g->reach : 0, right > end ? end : right,
                    0};
}

static cell_run reached_beyond_lower(const grid *g, const reached_cells *from) {
  const uint32_t cells = g->cells[0];
  if (from->first >= g->reach) return (cell_run){1, 0, 0};
  const uint32_t more = g->reach - from->first;
  return (cell_run){more < cells ? cells - more : 0, cells - 1, g->up[0]};
}

static cell_run reached_beyond_upper(const grid *g, const reached_cells *from) {
  const uint32_t cells = g->cells[0], right = from->last + g->reach;
  if (right < cells) return (cell_run){1, 0, 0};
  return (cell_run){0, right - cells < cells ? right - cells : cells - 1, 2 * g->up[0]};
}

static void find_candidates(const search *s, const reached_cells *from, int where,
                            row_candidates *found) {
  const grid *g = s->grid;
  const cell_run run = where == BETWEEN_FACES  ? reached_between(g, from)
                       : where == BEYOND_LOWER ? reached_beyond_lower(g, from)
                                               : reached_beyond_upper(g, from);
  uint32_t at[PBF_DIM];
  grid_row_indices(g, from->row, at);
#pragma GCC unroll 9
  for (int k = 0; k < GRID_ROWS_AROUND; ++k) {
    uint32_t image = run.image;
    const uint32_t row = grid_row_around(g, at, k, &image);
    const uint32_t *ends = s->cell_end + (uint64_t)row * g->cells[0];
    found->in[k] = row == GRID_NO_ROW || run.left > run.right
                       ? (candidate_range){0, 0, 0}
                       : (candidate_range){*(ends + run.left - 1), ends[run.right], image};
  }
}

#endif
