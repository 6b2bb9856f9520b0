/* Part of pressure_grid.h: its equations and their solve, by one thread or, where there are many
 * nodes, by all that come by. */
#ifndef PBF_CPU_PRESSURE_GRID_SOLVE_H
#define PBF_CPU_PRESSURE_GRID_SOLVE_H

#include "cpu/worker.h"

/* ---- Equations ----------------------------------------------------------------------------- */

static int has_fluid(const int64_t *sums, uint32_t size) {
  int64_t any = 0;
  for (uint32_t x = 0; x < size; ++x) any |= sums[x];
  return any != 0;
}

/* What of it is in further compartments, too. */
static int find_fluid_between(const pbf_pressure_grid_storage *storage,
                              pbf_pressure_grid_box *fluid) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  int i[PBF_DIM], any = 0;
  for (uint32_t k = t->first; k < pbf_pressure_grid_last_further(t); ++k) {
    if (!storage->sums[k]) continue;
    any = 1;
    pbf_pressure_grid_place(&storage->grid, pbf_compartment_cell(t, k), i);
    for (int a = 0; a < PBF_DIM; ++a) {
      if (i[a] < fluid->first[a]) fluid->first[a] = i[a];
      if (i[a] > fluid->last[a]) fluid->last[a] = i[a];
    }
  }
  return any;
}

/* The cells that hold particles, and those around them: so far nodes reach that are not in the
 * open. 0 when there are none. */
static int find_fluid(const pbf_pressure_grid_storage *storage, pbf_pressure_grid_box *fluid) {
  const pbf_pressure_grid *c = &storage->grid;
  pbf_pressure_grid_box all;
  int i[PBF_DIM], any = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    i[k] = all.first[k] = fluid->last[k] = 1;
    all.last[k] = fluid->first[k] = c->n[k];
  }
  do {
    const int64_t *sums = storage->sums + pbf_pressure_grid_row(c, i);
    if (!has_fluid(sums, c->size[0])) continue;
    any = 1;
    for (i[0] = 1; i[0] < fluid->first[0] && !sums[i[0]]; ++i[0]) continue;
    fluid->first[0] = i[0];
    for (i[0] = c->n[0]; i[0] > fluid->last[0] && !sums[i[0]]; --i[0]) continue;
    fluid->last[0] = i[0];
    for (int k = 1; k < PBF_DIM; ++k) {
      if (i[k] < fluid->first[k]) fluid->first[k] = i[k];
      if (i[k] > fluid->last[k]) fluid->last[k] = i[k];
    }
  } while (pbf_pressure_grid_next_row(&all, i));
  any |= find_fluid_between(storage, fluid);
  for (int k = 0; k < PBF_DIM; ++k) {
    --fluid->first[k];
    ++fluid->last[k];
  }
  return any;
}

/* Adds a node that is not in the open to the runs. What lies between two runs is worth a jump:
 * to begin a run costs as much as the vectors that would fill it. */
static void add_to_runs(pbf_pressure_grid_storage *storage, uint32_t node) {
  pbf_pressure_grid_run *run = &storage->runs[storage->count];
  if (storage->count && node < run[-1].last + 3 * PRESSURE_GRID_LANES) {
    run[-1].last = node + 1;
  } else {
    *run = (pbf_pressure_grid_run){node, node + 1};
    ++storage->count;
  }
}

static uint32_t whole_vectors(uint32_t nodes) {
  return (nodes + PRESSURE_GRID_LANES - 1) / PRESSURE_GRID_LANES * PRESSURE_GRID_LANES;
}

/* Runs have whole vectors of nodes: those behind the last one are in the open. */
static uint32_t round_runs(pbf_pressure_grid_storage *storage) {
  uint32_t nodes = 0;
  for (uint32_t k = 0; k < storage->count; ++k) {
    pbf_pressure_grid_run *run = &storage->runs[k];
    run->last = run->first + whole_vectors(run->last - run->first);
    nodes += run->last - run->first;
  }
  return nodes;
}

/* Returns the largest right side of a node that is not in the open. */
static double find_equations(solver *s, const pbf_pressure_grid_source_scale *source_scale,
                             const pbf_pressure_grid_box *fluid) {
  pbf_pressure_grid_storage *storage = &s->pressure_grid;
  pbf_pressure_grid_box nodes = *fluid;
  double largest = pbf_pressure_grid_torn_equations(storage, source_scale);
  int i[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) i[k] = ++nodes.first[k];
  storage->count = 0;
  do {
    uint32_t row = pbf_pressure_grid_row(&storage->grid, i);
    i[0] = nodes.first[0];
    s->kernels->equations(storage, source_scale, i, nodes.last[0], row);
    for (int x = nodes.first[0]; x <= nodes.last[0]; ++x) {
      uint32_t node = row + (uint32_t)x;
      if (storage->topology.is_active && storage->topology.torn[node]) storage->inverse[node] = 0;
      if (!(storage->inverse[node] > 0)) continue;
      storage->inverse[node] =
          pbf_pressure_grid_end_equation(&storage->grid, &storage->topology, storage->free_volumes,
                                         storage->depths, node, storage->inverse[node]);
      storage->right[node] += pbf_pressure_grid_moves_at(storage, source_scale, node);
      largest = pbf_max(largest, fabs(storage->right[node]));
      add_to_runs(storage, node);
    }
  } while (pbf_pressure_grid_next_row(&nodes, i));
  return largest;
}

/* Once all particles have added to the sums: what is to be solved. */
static void find_solve(solver *s, const pbf_obstacles *o) {
  pbf_pressure_grid_storage *storage = &s->pressure_grid;
  pressure_grid_solve *d = &s->pressure_grid_solve;
  pbf_pressure_grid_source_scale source_scale = {0, 0, 1};
  pbf_pressure_grid_box fluid = {{0}, {0}};
  const uint32_t torn = pbf_pressure_grid_torn_count(&storage->topology);
  double largest = 0;
  storage->count = 0;
  memset(storage->inverse, 0, storage->grid.nodes * sizeof *storage->inverse);
  if (torn) memset(storage->topology.inverse, 0, torn * sizeof *storage->topology.inverse);
  if (find_fluid(storage, &fluid)) {
    source_scale = pbf_pressure_grid_find_free_volumes(storage, o, &fluid);
    pbf_pressure_grid_find_surface(storage, &fluid);
    if (source_scale.part > 0) largest = find_equations(s, &source_scale, &fluid);
  }
  pbf_pressure_grid_guess_all(storage, &source_scale);
  d->in_runs = round_runs(storage);
  d->nodes = d->in_runs + whole_vectors(torn);
  d->solve = pbf_pressure_grid_solve_begin(source_scale.longest, largest);
  d->iteration = 0;
  d->inside = fluid;
  for (int k = 0; k < PBF_DIM; ++k) ++d->inside.first[k];
}

/* ---- Iterations ---------------------------------------------------------------------------- */

static int relax_torn_nodes(const solver *s, uint32_t first, uint32_t last) {
  const pbf_pressure_grid_storage *storage = &s->pressure_grid;
  const pbf_pressure_grid_solve *solve = &s->pressure_grid_solve.solve;
  int lacking = 0;
  for (uint32_t k = first; k < last; ++k)
    lacking |=
        pbf_pressure_grid_relax_torn(&storage->grid, &storage->topology, solve,
                                     storage->free_volumes, storage->lambda, k) > solve->enough;
  return lacking;
}

/* The nodes first … last - 1 of all in the runs and, after these, of the torn ones; 1 when one of
 * them was missing more than enough. */
static int relax_nodes(const solver *s, uint32_t first, uint32_t last) {
  const pbf_pressure_grid_storage *storage = &s->pressure_grid;
  const pressure_grid_solve *d = &s->pressure_grid_solve;
  uint32_t before = 0;
  int lacking = 0;
  for (uint32_t k = 0; k < storage->count && before < last; ++k) {
    pbf_pressure_grid_run run = storage->runs[k];
    uint32_t begin = first > before ? first - before : 0, nodes = run.last - run.first;
    uint32_t end = last - before < nodes ? last - before : nodes;
    if (begin < end)
      lacking |= s->kernels->relax(storage, &s->pressure_grid_solve.solve, run.first + begin,
                                   run.first + end);
    before += nodes;
  }
  const uint32_t torn = pbf_pressure_grid_torn_count(&storage->topology), runs = d->in_runs;
  const uint32_t end = last > runs ? last - runs : 0;
  lacking |= relax_torn_nodes(s, first > runs ? first - runs : 0, end < torn ? end : torn);
  return lacking;
}

/* Once an iteration has been done; 1: it was the last. */
static int end_iteration(solver *s, int lacking) {
  pressure_grid_solve *d = &s->pressure_grid_solve;
  int k = d->iteration++;
  pbf_pressure_grid_swap(&s->pressure_grid);
  if (pbf_pressure_grid_asks(k) && !lacking) return 1;
  pbf_pressure_grid_solve_go_on(&d->solve, k);
  return d->iteration >= d->solve.max_iterations;
}

static void solve_alone(solver *s) {
  pressure_grid_solve *d = &s->pressure_grid_solve;
  int over = d->solve.max_iterations <= 0;
  if (over) return;
  while (!over) over = end_iteration(s, relax_nodes(s, 0, d->nodes));
  pbf_pressure_grid_extrapolate(&s->pressure_grid, &d->inside);
}

/* ---- Iterations by several threads --------------------------------------------------------- */

/* How many iterations there are is known at their end, when a thread may be late for any number of
 * loops of the team: so all of them are in one. The first thread that comes leads, and later ones
 * help. The leader waits for no help that has not begun. */

/* A grid of fewer nodes is solved faster than it is shared out; and nodes in a part, at least. */
enum { PRESSURE_GRID_SHARED = 4096, PRESSURE_GRID_PART = 1024 };

static uint64_t part_word(int iteration, uint32_t part) { return (uint64_t)iteration << 32 | part; }

/* Takes a part of the iteration under way; 0 when none is left. */
static int take_part(pressure_grid_solve *d, uint32_t *part) {
  unsigned long long seen = atomic_load_explicit(&d->next, memory_order_acquire);
  do {
    *part = (uint32_t)seen;
    if (*part >= d->parts) return 0;
  } while (!atomic_compare_exchange_weak_explicit(&d->next, &seen, seen + 1, memory_order_acquire,
                                                  memory_order_acquire));
  return 1;
}

static void relax_parts(solver *s) {
  pressure_grid_solve *d = &s->pressure_grid_solve;
  for (uint32_t part; take_part(d, &part);) {
    range r = part_of(d->nodes / PRESSURE_GRID_LANES, part, d->parts);
    if (relax_nodes(s, r.first * PRESSURE_GRID_LANES, r.last * PRESSURE_GRID_LANES))
      atomic_store_explicit(&d->lacking, 1, memory_order_relaxed);
    atomic_fetch_add_explicit(&d->done, 1, memory_order_release);
  }
}

static void lead_solve(solver *s) {
  pressure_grid_solve *d = &s->pressure_grid_solve;
  for (int over = 0; !over;) {
    uint32_t parts = (uint32_t)(d->iteration + 1) * d->parts;
    atomic_store_explicit(&d->next, part_word(d->iteration, 0), memory_order_release);
    relax_parts(s);
    for (unsigned looks = 1; atomic_load_explicit(&d->done, memory_order_acquire) != parts;)
      wait_a_little(&looks);
    over = end_iteration(s, (int)atomic_exchange_explicit(&d->lacking, 0, memory_order_relaxed));
  }
  pbf_pressure_grid_extrapolate(&s->pressure_grid, &d->inside);
  atomic_store_explicit(&d->solved, 1, memory_order_release);
}

/* Before what needs the solution, in any thread. */
static void help_solving(solver *s) {
  pressure_grid_solve *d = &s->pressure_grid_solve;
  unsigned looks = 1;
  if (atomic_load_explicit(&d->solved, memory_order_acquire)) return;
  if (!atomic_exchange_explicit(&d->led, 1, memory_order_acquire)) lead_solve(s);
  for (; !atomic_load_explicit(&d->solved, memory_order_acquire); wait_a_little(&looks))
    relax_parts(s);
}

/* Where there is too little to share it has been done on return. */
static void begin_solve(solver *s, uint32_t threads) {
  pressure_grid_solve *d = &s->pressure_grid_solve;
  uint32_t max_parts = d->nodes / PRESSURE_GRID_PART;
  int alone = threads == 1 || d->nodes < PRESSURE_GRID_SHARED || d->solve.max_iterations <= 0;
  if (alone) solve_alone(s);
  d->parts = max_parts < 2 * threads ? max_parts : 2 * threads;
  atomic_store_explicit(&d->next, part_word(0, d->parts), memory_order_relaxed);
  atomic_store_explicit(&d->led, 0, memory_order_relaxed);
  atomic_store_explicit(&d->done, 0, memory_order_relaxed);
  atomic_store_explicit(&d->lacking, 0, memory_order_relaxed);
  atomic_store_explicit(&d->solved, (unsigned)alone, memory_order_relaxed);
}

#endif
