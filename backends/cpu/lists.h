/* The windows of all groups, in memory that grows by need. */
#ifndef PBF_CPU_LISTS_H
#define PBF_CPU_LISTS_H

#include "cpu/worker.h"

/* Groups from `first` on store their windows from here on. */
static uint64_t windows_begin(const worker *w, uint32_t first) {
  uint32_t width = w->s->kernels->width;
  uint64_t groups = ((uint64_t)w->s->count + width - 1) / width;
  return (uint64_t)((double)w->s->window_capacity * first / (double)groups);
}

static void free_lists(solver *s) {
  pbf_memory_free(&s->memory, s->windows);
  pbf_memory_free(&s->memory, s->masks);
  s->windows = NULL;
  s->masks = NULL;
  s->window_capacity = 0;
}

/* Room for every thread's windows in its part, and a quarter more. On failure there is none. */
static void grow_lists(worker *w) {
  solver *s = w->s;
  range all = {0, (uint32_t)(((uint64_t)s->count + s->kernels->width - 1) / s->kernels->width)};
  double most = 0;
  for (uint32_t t = 0; t < w->threads; ++t) {
    range r = part_of(all.last, t, w->threads);
    if (r.last > r.first) most = fmax(most, (double)s->shares[t].windows / (r.last - r.first));
  }
  uint64_t capacity = (uint64_t)(1.25 * most * all.last) + 64;
  free_lists(s);
  if (capacity > UINT32_MAX) return;
  s->windows = pbf_memory_take(&s->memory, "window", capacity, sizeof *s->windows);
  s->masks =
      pbf_memory_take(&s->memory, "window mask", capacity * s->kernels->width, sizeof *s->masks);
  if (s->windows && s->masks)
    s->window_capacity = capacity;
  else
    free_lists(s);
}

static int lists_fit(const worker *w) {
  solver *s = w->s;
  uint32_t width = s->kernels->width;
  uint64_t groups = ((uint64_t)s->count + width - 1) / width;
  for (uint32_t t = 0; t < w->threads; ++t) {
    range r = part_of(groups, t, w->threads);
    if (s->shares[t].windows > windows_begin(w, r.last) - windows_begin(w, r.first)) return 0;
  }
  return 1;
}

/* Finds the neighbours at the sorted positions x. 0 when there is no memory for them. */
static int find_neighbors(worker *w, field x) {
  solver *s = w->s;
  range r = my_groups(w);
  for (;;) {
    search job = {.grid = &w->grid,
                  .h2 = s->constants.h2,
                  .x = x,
                  .cells = s->sorted_cells,
                  .cell_end = s->cell_end,
                  .count = s->count,
                  .groups = s->groups,
                  .windows = s->windows,
                  .masks = s->masks};
    s->shares[w->thread].windows = s->kernels->search(
        &job, r.first, r.last, windows_begin(w, r.first), windows_begin(w, r.last));
    team_barrier();
    if (lists_fit(w)) return 1;
    team_barrier();
    if (w->thread == 0) grow_lists(w);
    team_barrier();
    if (s->window_capacity == 0) return 0;
  }
}

static pair_pass pairs_at(const worker *w, field x) {
  const solver *s = w->s;
  return (pair_pass){.constants = &s->constants,
                     .features = s->schedule.features,
                     .lists = {.groups = s->groups,
                               .windows = s->windows,
                               .masks = s->masks,
                               .far = w->grid.far,
                               .count = s->count},
                     .x = x};
}

#endif
