/* Part of backend.cpp: what callers ask for between steps: densities, pressures and statistics at
 * the present positions. Uses the buffers of a step; the state stays where it is, since a caller
 * may be looking at it. */
#ifndef PBF_CPU_SURVEY_H
#define PBF_CPU_SURVEY_H

#include "common/report.h"
#include "cpu/lists.h"
#include "cpu/sort.h"

static void density_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.sorted_x(), packed_positions(w->s));
  w->s->kernels->density(&pairs, surveyed_densities(w->s), neighbor_counts(w->s), r.first, r.last);
}

/* The sorted lambda, for who looks it up. */
static void sort_lambda_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_particles(w, task);
  gather_reals(w->s->order, r, w->s->lambda, sorted_lambda(w->s));
  fill_packed(w->s, packed_positions(w->s), &w->b.sorted_x(), sorted_lambda(w->s), r);
}

static void fit_lambda_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.sorted_x(), packed_positions(w->s));
  w->s->kernels->fit(&pairs, sorted_lambda(w->s), w->b.fitted_lambda(), r.first, r.last);
}

static worker begin_diagnostics(solver *s, team_thread *self) {
  worker w = worker_of(s, self);
  w.sort_positions = &s->buffers.x;
  w.sorted_positions = &s->buffers.sorted_x();
  place_obstacles(s, s->now, &w.obstacles);
  parallel_for(self, particle_task_count(&w), find_bounds, make_grid, &w);
  sort_particles(&w);
  return w;
}

static void diagnose_densities(void *context, team_thread *self) {
  worker w = begin_diagnostics((solver *)context, self);
  if (find_neighbors(&w, end_search))
    parallel_for(self, pair_task_count(&w), density_task, NULL, &w);
}

static void diagnose_pressures(void *context, team_thread *self) {
  worker w = begin_diagnostics((solver *)context, self);
  parallel_for(self, particle_task_count(&w), sort_lambda_task, NULL, &w);
  if (find_neighbors(&w, end_search))
    parallel_for(self, pair_task_count(&w), fit_lambda_task, NULL, &w);
}

/* Afterwards s->order is sorted by cell and id, and particle s->order[k] has the density
 * surveyed_densities(s)[k] and neighbor_counts(s)[k] neighbours, or the fitted lambda of k. 0 when
 * the memory for the neighbours is lacking. */
static int diagnose(solver *s, team_function what) {
  if (!s->count) return 1;
  do {
    atomic_store(&s->stopped, 0);
    team_run(&s->tasks, s->team, threads_now(s), what, s);
  } while (atomic_load(&s->stopped) && grow_lists(s));
  return !atomic_load(&s->stopped);
}

/* After a diagnostics: sums in the sorted order, which no number of threads changes. */
static void sum_stats(const solver *s, pbf_stats *stats) {
  pbf_obstacles obstacles;
  place_obstacles(s, s->now, &obstacles);
  for (uint32_t k = 0; k < s->count; ++k) {
    uint32_t i = s->order[k];
    pbf_stats_add(stats, k == 0, field_at(&s->buffers.x, i), field_at(&s->buffers.v, i),
                  (double)surveyed_densities(s)[k], neighbor_counts(s)[k]);
    stats->squeezed += pbf_is_squeezed_by(obstacles, field_at(&s->buffers.x, i));
  }
  if (s->count) pbf_stats_finish(stats);
}

#endif
