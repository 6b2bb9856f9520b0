/* Part of pressure_grid.h: on ranks each adds its own particles to the sums of the grid's cells,
 * and all get the sums over all ranks. These are integers, so their bits are those of one solver;
 * and so are those of the solve, which each rank makes for itself. */
#ifndef PBF_CPU_PRESSURE_GRID_RANKS_H
#define PBF_CPU_PRESSURE_GRID_RANKS_H

#include "cpu/ranks.h"

/* Calls visit(cell) for the cells of a box, and the compartments of what solids divide. */
template <class Visit>
static void each_cell_in(const pbf_pressure_grid_storage *storage,
                         const pbf_pressure_grid_box *cells, Visit visit) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  int i[PBF_DIM];
  memcpy(i, cells->first, sizeof i);
  do {
    const uint32_t row = pbf_pressure_grid_row(&storage->grid, i);
    for (int x = cells->first[0]; x <= cells->last[0]; ++x) visit(row + (uint32_t)x);
  } while (pbf_pressure_grid_next_row(cells, i));
  for (uint32_t k = t->first; k < pbf_pressure_grid_last_further(t); ++k) visit(k);
}

/* The cells that hold particles of any rank, and those around them; false when none do. */
static bool find_fluid_of_ranks(solver *s, pbf_pressure_grid_box *fluid) {
  struct cells_of_rank {
    pbf_pressure_grid_box cells;
    int any;
  } mine, *all = static_cast<cells_of_rank *>(s->ranks.gathered);
  mine.any = find_fluid(&s->pressure_grid, &mine.cells);
  bool any = false;
  if (!gather_on_ranks(s, &mine, all, sizeof mine)) return false;
  for (uint32_t r = 0; r < s->ranks.count; ++r) {
    if (!all[r].any) continue;
    for (int k = 0; k < PBF_DIM; ++k) {
      const int first = all[r].cells.first[k], last = all[r].cells.last[k];
      if (!any || first < fluid->first[k]) fluid->first[k] = first;
      if (!any || last > fluid->last[k]) fluid->last[k] = last;
    }
    any = true;
  }
  return any;
}

/* Where ranks have failed no solver is left to solve anything for. */
static void add_up_cells(solver *s) {
  const pbf_pressure_grid_storage *storage = &s->pressure_grid;
  pbf_pressure_grid_box fluid;
  uint32_t *words = s->rank_words;
  if (!find_fluid_of_ranks(s, &fluid)) return;
  each_cell_in(storage, &fluid, [&](uint32_t cell) {
    cut_number(storage->sums[cell], words);
    cut_number(storage->places[cell], words + PIECES);
    words += 2 * PIECES;
    for (uint64_t k = 0; k < PBF_DIM && storage->cell_moves; ++k, words += PIECES)
      cut_number(storage->cell_moves[PBF_DIM * cell + k], words);
  });
  if (!sum_on_ranks(s, s->rank_words, (uint64_t)(words - s->rank_words))) return;
  words = s->rank_words;
  each_cell_in(storage, &fluid, [&](uint32_t cell) {
    storage->sums[cell] = number_of_pieces(words);
    storage->places[cell] = number_of_pieces(words + PIECES);
    words += 2 * PIECES;
    for (uint64_t k = 0; k < PBF_DIM && storage->cell_moves; ++k, words += PIECES)
      storage->cell_moves[PBF_DIM * cell + k] = number_of_pieces(words);
  });
}

#endif
