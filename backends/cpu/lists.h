/* The neighbour lists of all groups, in slabs that threads take as they need them. */
#ifndef PBF_CPU_LISTS_H
#define PBF_CPU_LISTS_H

#include "cpu/candidates.h"
#include "cpu/halo.h"
#include "cpu/sleepers.h"

static void free_lists(solver *s) {
  pbf_memory_free(&s->memory, s->list_data);
  s->list_data = NULL;
  s->slabs = 0;
}

/* Makes room for what the last search wanted, and an eighth more: at the end of each slab there is
 * less left than the largest group takes, and each thread has one slab that it does not fill. 0
 * when there is no memory; then there is none at all. */
static int grow_lists(solver *s) {
  uint64_t units = s->wanted.units + s->wanted.units / 8 + 4, parts = 16 * (uint64_t)s->threads;
  uint64_t min_units = 8 * (uint64_t)s->wanted.largest, each = units / parts + 1;
  s->slab_units = s->threads == 1 ? units : each < min_units ? min_units : each;
  uint64_t slabs =
      s->threads == 1 ? 1 : units / (s->slab_units - s->wanted.largest) + 1 + s->threads;
  free_lists(s);
  if (slabs * s->slab_units > UINT32_MAX) return 0;
  s->list_data =
      (uint8_t *)pbf_memory_take(&s->memory, "neighbor list", slabs * s->slab_units, LIST_UNIT);
  if (s->list_data) s->slabs = (uint32_t)slabs;
  return s->list_data != NULL;
}

/* The same; on ranks for those that lack it, and 1 when all have it. */
static int grow_lists_of_all(solver *s) {
  if (!s->ranks.count) return grow_lists(s);
  return on_all_ranks(s, !s->ranks.lacks || grow_lists(s));
}

/* The next slab, of those near the thread first; 0 when there is none. */
static int next_slab(void *context, list_arena *arena) {
  const worker *w = static_cast<const worker *>(context);
  solver *s = w->s;
  uint32_t threads = w->self->threads;
  for (uint32_t k = 0; k < threads; ++k) {
    uint32_t t = (w->self->thread + k) % threads;
    range part = part_of(s->slabs, t, threads);
    atomic_uint *taken = &s->slab_counters[t].taken;
    if (atomic_load_explicit(taken, memory_order_relaxed) >= part.last - part.first) continue;
    uint32_t slab = part.first + atomic_fetch_add_explicit(taken, 1, memory_order_relaxed);
    if (slab >= part.last) continue;
    arena->next = slab * s->slab_units;
    arena->end = arena->next + s->slab_units;
    return 1;
  }
  return 0;
}

static void list_size_add(list_size *all, list_size more) {
  all->units += more.units;
  all->lacking |= more.lacking;
  if (more.largest > all->largest) all->largest = more.largest;
}

/* `quads` are of x, and of what the pass looks up. */
static pair_pass pairs_at(const worker *w, field x, const pbf_real *quads) {
  static const uint8_t none[LIST_UNIT] = {
      0}; /* where no particle has a neighbour there are no lists */
  const solver *s = w->s;
  return (pair_pass){
      .constants = &w->constants,
      .features = s->schedule.features,
      .lists = {.groups = s->groups,
                .data = s->list_data ? s->list_data : none,
                .far = s->grid.far,
                .count = held_places(s).last},
      .images = s->images,
      .x = x,
      .quads = quads,
      .vectors = packed_vectors(s),
      .contributing = s->schedule.wall_density ? &w->obstacles : NULL,
      .residual_density = s->residual_density ? s->residual_density : w->b.sorted_overlap,
      .overlap = w->b.sorted_overlap,
      .activity = sleep_is_on(w) ? w->activity : NULL,
      .order = s->order};
}

static void list_neighbors(worker *w, range groups, list_size *all) {
  const solver *s = w->s;
  const search job = {.grid = &s->grid,
                      .images = s->images,
                      .h2 = s->constants.h2,
                      .x = *w->sorted_positions,
                      .cells = s->sorted_cells,
                      .cell_end = s->cell_end,
                      .count = held_places(s).last,
                      .groups = s->groups,
                      .data = s->list_data,
                      .candidates = find_candidates};
  list_size_add(all, s->kernels->search(&job, groups.first, groups.last, &w->arena));
}

/* The sleepers within h of a particle awake in these groups. */
static void find_sleeping_boundary(const worker *w, range groups) {
  const solver *s = w->s;
  pair_pass pairs = pairs_at(w, *w->sorted_positions, packed_positions(s));
  s->kernels->wake_neighbors(&pairs, w->activity, s->has_sleepers, awakened(s), groups.first,
                             groups.last);
}

static void search_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = search_groups(w, task);
  list_size all = {0};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last)) {
    list_neighbors(w, g, &all);
    if (sleep_is_on(w) && s->asleep && !all.lacking) find_sleeping_boundary(w, g);
  }
  s->list_sizes[task] = all;
}

/* The sleeping boundary has lists of its own. */
static void sleeping_boundary_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = search_groups(w, task);
  uint64_t end = (uint64_t)r.last * s->kernels->width;
  if (!s->asleep) return;
  for (uint32_t i = r.first * s->kernels->width; i < end && i < own_places(s).last; ++i)
    if (awakened(s)[i] == AWAKENED && pbf_is_asleep(w->activity[i]))
      w->activity[i] = pbf_sleeping_boundary();
  for (uint32_t g = r.first; g < r.last; ++g)
    if (is_group_below(w, g, 0) && !is_group_below(w, g, pbf_sleeping_boundary()))
      list_neighbors(w, (range){g, g + 1}, &s->list_sizes[task]);
}

/* What a group's pairs cost, in units of its list, without any of these. */
enum { GROUP_COST = 3 };

/* Passes over pairs have tasks of equal cost. */
static void divide_groups(const worker *w) {
  solver *s = w->s;
  uint32_t searched = search_task_count(w), tasks = pair_task_count(w), next = 1;
  const uint64_t groups = groups_of(s);
  const range own = own_groups(s);
  if (has_edges(s)) {
    const uint32_t ends[EDGED_TASKS + 1] = {own.first, s->ranks.inner.first, s->ranks.inner.last,
                                            own.last};
    memcpy(s->first_group, ends, sizeof ends);
    return;
  }
  double each = ((double)s->wanted.units + GROUP_COST * (double)groups) / tasks, before = 0;
  for (uint32_t k = 0; k < searched; ++k) {
    range r = search_groups(w, k);
    double cost = (double)s->list_sizes[k].units + GROUP_COST * (double)(r.last - r.first);
    double groups_a_cost = (r.last - r.first) / cost;
    for (; next < tasks && each * next < before + cost; ++next)
      s->first_group[next] = r.first + (uint32_t)((each * next - before) * groups_a_cost);
    before += cost;
  }
  while (next < tasks) s->first_group[next++] = own.last;
  s->first_group[0] = own.first;
  s->first_group[tasks] = own.last;
}

static void end_search(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  s->wanted = (list_size){0};
  for (uint32_t k = 0; k < search_task_count(w); ++k) list_size_add(&s->wanted, s->list_sizes[k]);
  for (uint32_t t = 0; t < w->self->threads; ++t)
    atomic_store_explicit(&s->slab_counters[t].taken, 0, memory_order_relaxed);
  divide_groups(w);
  s->ranks.lacks = s->wanted.lacking;
  if (s->ranks.count) s->wanted.lacking = !on_all_ranks(s, !s->wanted.lacking);
  if (!s->wanted.lacking) return;
  s->stopped_at = w->step;
  atomic_store_explicit(&s->stopped, 1, memory_order_release);
}

/* Finds the neighbours at the sorted positions. 0 when there is no memory for them: the team then
 * stops at this step, and the caller's thread alone may take more (grow_lists). `last` is
 * end_search, with or without more. */
static int find_neighbors(worker *w, completion_function last) {
  w->arena = (list_arena){.more = next_slab, .context = w};
  parallel_for(w->self, search_task_count(w), search_task, sleep_is_on(w) ? NULL : last, w);
  if (has_ranks(w->s) && sleep_is_on(w) && w->s->asleep) exchange_marks(w->s, awakened(w->s));
  if (sleep_is_on(w)) parallel_for(w->self, search_task_count(w), sleeping_boundary_task, last, w);
  return !(atomic_load_explicit(&w->s->stopped, memory_order_acquire) &&
           w->s->stopped_at == w->step);
}

/* Densities of a task's particles at the places x between these obstacles, of those in groups
 * where a particle solves. */
static void find_densities(const worker *w, range groups, const pbf_obstacles *obstacles, field x,
                           const pbf_real *quads, pbf_real *densities) {
  pair_pass pairs = pairs_at(w, x, quads);
  if (pairs.contributing) pairs.contributing = obstacles;
  for (range g = solving_groups(w, groups.first, groups.last); g.first < g.last;
       g = solving_groups(w, g.last, groups.last))
    w->s->kernels->density(&pairs, densities, NULL, g.first, g.last);
}

static void velocities_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_vectors(w->s), &w->b.v, NULL, task_held(w, task));
}

/* The sentinel's vector is 0. The next sort puts the sentinel far away again. */
static void end_vectors(void *context) {
  const worker *w = static_cast<const worker *>(context);
  packed_vectors(w->s)[-4] = 0;
}

/* Passes over pairs after the solve look up these vectors, where they read quads. */
static void pack_vectors(worker *w, void (*pack_task)(void *context, uint32_t task)) {
  if (w->s->kernels->pack) parallel_for(w->self, pair_task_count(w), pack_task, end_vectors, w);
}

/* What is no neighbour is far away. */
static void end_positions(void *context) {
  const worker *w = static_cast<const worker *>(context);
  packed_curl_sizes(w->s)[-4] = w->s->grid.far;
}

/* Or these positions, and a number of each. */
static void pack_positions(worker *w, void (*pack_task)(void *context, uint32_t task)) {
  if (w->s->kernels->pack) parallel_for(w->self, pair_task_count(w), pack_task, end_positions, w);
}

/* The velocities of a task's particles, smoothed by so much. */
static void smooth_velocities(const worker *w, uint32_t task, pbf_real viscosity, field smoothed) {
  range groups = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  pbf_constants c = w->constants;
  c.viscosity = viscosity;
  pairs.constants = &c;
  for (range g = awake_groups(w, groups.first, groups.last); g.first < g.last;
       g = awake_groups(w, g.last, groups.last))
    w->s->kernels->viscosity(&pairs, w->b.v, smoothed, g.first, g.last);
  zero_sleeping(w, task_sorted(w, task), smoothed.c, PBF_DIM);
}

#endif
