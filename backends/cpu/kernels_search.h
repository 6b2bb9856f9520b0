/* Neighbour search over particles sorted by cell: for each group the windows that hold neighbours
 * of its particles. Distances are tested for a whole group against one candidate at a time. */
#ifndef PBF_CPU_KERNELS_SEARCH_H
#define PBF_CPU_KERNELS_SEARCH_H

#include "cpu/kernels.h"
#include "cpu/lanes.h"

/* Lanes begin … end - 1 of a group, whose particles lie near each other in one row. */
typedef struct run {
  uint32_t group, begin, end;
  uint32_t row, first_cell, last_cell; /* the cells along x */
  lane x[PBF_DIM];
} run;

/* Farther apart than this along x, particles do not search together. */
static inline uint32_t widest_gap(const grid *g) { return 2 * g->reach + 1; }

static run run_from(const search *s, uint32_t i, uint32_t end) {
  const grid *g = s->grid;
  uint32_t first = s->cells[i], last = s->cells[end - 1], nx = g->cells[0], row = first / nx;
  if (last / nx != row || last - first > WIDTH * widest_gap(g) / 4) {
    uint32_t k = i + 1;
    while (k < end && s->cells[k] / nx == row && s->cells[k] - s->cells[k - 1] <= widest_gap(g))
      ++k;
    end = k;
    last = s->cells[end - 1];
  }
  return (run){.begin = i % WIDTH,
               .end = (end - 1) % WIDTH + 1,
               .row = row,
               .first_cell = first - row * nx,
               .last_cell = last - row * nx};
}

/* Which of the particles first … first + size - 1 are within h of each particle of the run. */
static inline slots near_mask(const search *s, const run *r, uint32_t first, uint32_t size) {
  slots near = slots_set(0);
  const lane h2 = lane_set(s->h2);
  for (uint32_t slot = 1; slot <= size; ++slot) {
    uint32_t j = first + slot - 1;
    lane r2 = lane_set(0);
    for (int k = 0; k < PBF_DIM; ++k) {
      lane d = r->x[k] - lane_set(s->x.c[k][j]);
      r2 = k ? lane_fma(d, d, r2) : d * d;
    }
    near = slots_mark(near, r2, h2, 0x80000000u >> slot);
  }
  slots lane_number = slots_iota();
  slots self = lane_number + slots_set(r->group * WIDTH - first + 1);
  near = near & ~slots_bit(self) & slots_below(lane_number, r->end);
  return r->begin ? near & ~slots_below(lane_number, r->begin) : near;
}

/* Windows over the particles begin … end - 1; `next` is where the first one goes. */
static uint64_t search_range(const search *s, const run *r, uint32_t begin, uint32_t end,
                             uint64_t next, uint64_t limit) {
  while (begin < end) {
    uint32_t size = end - begin < SLOTS - 1 ? end - begin : SLOTS - 1;
    slots near = near_mask(s, r, begin, size);
    uint32_t rounds = slots_max(slots_popcount(near));
    if (rounds) {
      if (next < limit) {
        s->windows[next] = (window){begin, rounds};
        slots_store(s->masks + next * WIDTH, near);
      }
      ++next;
    }
    begin += size;
  }
  return next;
}

static uint64_t search_run(const search *s, const run *r, uint64_t next, uint64_t limit) {
  const grid *g = s->grid;
  uint32_t rows[GRID_ROWS_AROUND];
  int count = grid_rows_around(g, r->row, rows);
  uint32_t left = r->first_cell > g->reach ? r->first_cell - g->reach : 0;
  uint32_t right =
      r->last_cell + g->reach < g->cells[0] ? r->last_cell + g->reach : g->cells[0] - 1;
  for (int k = 0; k < count; ++k) {
    const uint32_t *end = s->cell_end + (uint64_t)rows[k] * g->cells[0];
    next = search_range(s, r, *(end + left - 1), end[right], next, limit);
  }
  return next;
}

static uint64_t search_groups(const search *s, uint32_t first, uint32_t last, uint64_t begin,
                              uint64_t end) {
  uint64_t next = begin;
  for (uint32_t g = first; g < last; ++g) {
    uint64_t windows = next;
    uint32_t i = g * WIDTH, stop = s->count - i < WIDTH ? s->count : i + WIDTH;
    while (i < stop) {
      run r = run_from(s, i, stop);
      r.group = g;
      for (int k = 0; k < PBF_DIM; ++k) r.x[k] = lane_load(s->x.c[k] + g * WIDTH);
      next = search_run(s, &r, next, end);
      i = g * WIDTH + r.end;
    }
    s->groups[g] = (group){(uint32_t)windows, (uint32_t)(next - windows)};
  }
  return next - begin;
}

#endif
