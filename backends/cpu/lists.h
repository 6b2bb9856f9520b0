/* The neighbour lists of all groups, in memory that grows by need. */
#ifndef PBF_CPU_LISTS_H
#define PBF_CPU_LISTS_H

#include "cpu/worker.h"

/* Each thread writes the lists of its groups to a part of its own. */
static uint64_t units_begin(const solver *s, uint32_t thread, uint32_t threads) {
  return s->list_units / threads * thread;
}

static void free_lists(solver *s) {
  pbf_memory_free(&s->memory, s->list_data);
  s->list_data = NULL;
  s->list_units = 0;
}

/* Makes room for every thread's lists, and a quarter more. On failure there is none at all. */
static void grow_lists(worker *w) {
  solver *s = w->s;
  uint64_t most = 0;
  for (uint32_t t = 0; t < w->threads; ++t)
    if (s->shares[t].units > most) most = s->shares[t].units;
  uint64_t units = (most + most / 4 + 4) * w->threads;
  free_lists(s);
  if (units > UINT32_MAX) return;
  s->list_data = pbf_memory_take(&s->memory, "neighbor list", units, LIST_UNIT);
  if (s->list_data) s->list_units = units;
}

static int lists_fit(const worker *w) {
  for (uint32_t t = 0; t < w->threads; ++t)
    if (w->s->shares[t].units > w->s->list_units / w->threads) return 0;
  return 1;
}

/* What a group's pairs cost, in units of its list, without any of these. */
enum { GROUP_COST = 3 };

/* Where the groups of a thread begin when all threads shall have equally much to do: the length of
 * its list says what a group costs. */
static uint32_t balanced_group(const worker *w, uint32_t thread) {
  const solver *s = w->s;
  uint64_t groups = groups_of(s), total = GROUP_COST * groups, before = 0;
  for (uint32_t t = 0; t < w->threads; ++t) total += s->shares[t].units;
  uint64_t target = total / w->threads * thread;
  if (thread == w->threads) return (uint32_t)groups;
  for (uint32_t t = 0; t < w->threads; ++t) {
    range r = part_of(groups, t, w->threads);
    uint64_t cost = s->shares[t].units + GROUP_COST * (uint64_t)(r.last - r.first);
    if (before + cost > target) {
      uint64_t begin = units_begin(s, t, w->threads);
      uint32_t low = r.first, high = r.last;
      while (low < high) {
        uint32_t g = low + (high - low) / 2;
        uint64_t at = before + s->groups[g].begin - begin + GROUP_COST * (uint64_t)(g - r.first);
        if (at < target)
          low = g + 1;
        else
          high = g;
      }
      return low;
    }
    before += cost;
  }
  return (uint32_t)groups;
}

/* Finds the neighbours at the sorted positions x. 0 when there is no memory for them. */
static int find_neighbors(worker *w, field x) {
  solver *s = w->s;
  range r = part_of(groups_of(s), w->thread, w->threads);
  for (;;) {
    search job = {.grid = &w->grid,
                  .h2 = s->constants.h2,
                  .x = x,
                  .cells = s->sorted_cells,
                  .cell_end = s->cell_end,
                  .count = s->count,
                  .groups = s->groups,
                  .data = s->list_data};
    s->shares[w->thread].units =
        s->kernels->search(&job, r.first, r.last, units_begin(s, w->thread, w->threads),
                           units_begin(s, w->thread + 1, w->threads));
    team_barrier(w->me);
    if (lists_fit(w)) break;
    team_barrier(w->me);
    if (w->thread == 0) grow_lists(w);
    team_barrier(w->me);
    if (s->list_units == 0) return 0;
  }
  w->groups = (range){balanced_group(w, w->thread), balanced_group(w, w->thread + 1)};
  return 1;
}

static pair_pass pairs_at(const worker *w, field x) {
  const solver *s = w->s;
  return (pair_pass){
      .constants = &w->constants,
      .features = s->schedule.features,
      .lists = {.groups = s->groups, .data = s->list_data, .far = w->grid.far, .count = s->count},
      .x = x,
      .walls = s->schedule.wall_density ? &w->obstacles : NULL,
      .slack = s->slack};
}

#endif
