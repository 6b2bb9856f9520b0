/* Part of backend.cpp: what callers ask for between steps: densities, pressures and statistics at
 * the present positions. Uses the buffers of a step; the state stays where it is, since a caller
 * may be looking at it. */
#ifndef PBF_CPU_DIAGNOSTICS_H
#define PBF_CPU_DIAGNOSTICS_H

#include "common/report.h"
#include "cpu/calls_on_ranks.h"
#include "cpu/lists.h"
#include "cpu/placing.h"
#include "cpu/sort.h"

static void density_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.sorted_x(), packed_positions(w->s));
  w->s->kernels->density(&pairs, diagnosed_densities(w->s), neighbor_counts(w->s), r.first, r.last);
}

/* The sorted lambda, for the passes that look it up. */
static void sort_lambda_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = has_ranks(w->s) ? held_places(w->s) : task_particles(w, task);
  const pbf_real *lambda = has_ranks(w->s) ? w->sort_payload->c[0] : w->s->lambda;
  gather_reals(w->s->order, r, lambda, w->b.sorted_lambda());
  fill_packed(w->s, packed_positions(w->s), &w->b.sorted_x(), w->b.sorted_lambda(), r);
}

static void fit_lambda_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.sorted_x(), packed_positions(w->s));
  w->s->kernels->fit(&pairs, w->b.sorted_lambda(), w->b.fitted_lambda(), r.first, r.last);
}

/* On ranks `payload` goes along, too. */
static worker begin_diagnostics(solver *s, team_thread *self, const field *payload) {
  worker w = worker_of(s, self);
  w.sort_positions = &s->buffers.x;
  w.sorted_positions = &s->buffers.sorted_x();
  place_step_obstacles(&w, s->now, s->now, false);
  parallel_for(self, particle_task_count(&w), find_bounds, make_grid, &w);
  if (has_ranks(s)) {
    w.sort_payload = payload;
    w.sorted_payload = &s->buffers.sorted_velocity;
  }
  sort_particles(&w, &s->buffers.scratch[0], &s->buffers.scratch[1]);
  return w;
}

static void diagnose_densities(void *context, team_thread *self) {
  solver *s = static_cast<solver *>(context);
  worker w = begin_diagnostics(s, self, &s->buffers.v);
  if (!s->ranks.failed && find_neighbors(&w, end_search))
    parallel_for(self, pair_task_count(&w), density_task, NULL, &w);
}

static void diagnose_pressures(void *context, team_thread *self) {
  solver *s = static_cast<solver *>(context);
  field lambda;
  for (int k = 0; k < PBF_DIM; ++k) lambda.c[k] = s->lambda;
  worker w = begin_diagnostics(s, self, &lambda);
  if (s->ranks.failed) return;
  parallel_for(self, particle_task_count(&w), sort_lambda_task, NULL, &w);
  if (find_neighbors(&w, end_search))
    parallel_for(self, pair_task_count(&w), fit_lambda_task, NULL, &w);
}

/* The same on ranks, where the sorted places are s->ranks's. */
static int diagnose_on_ranks(solver *s, team_function what) {
  const uint32_t own = s->count;
  do {
    s->count = own;
    atomic_store(&s->stopped, 0);
    s->team_api->run(&s->tasks, s->team, s->threads, what, s);
  } while (!s->ranks.failed && atomic_load(&s->stopped) && grow_lists_of_all(s));
  s->count = own;
  return !s->ranks.failed && !atomic_load(&s->stopped);
}

/* Afterwards s->order is sorted by cell and id, and particle s->order[k] has the density
 * diagnosed_densities(s)[k] and neighbor_counts(s)[k] neighbours, or the fitted lambda of k. 0 when
 * the memory for the neighbours is lacking. */
static int diagnose(solver *s, team_function what) {
  if (!particles_of_all(s)) return 1;
  if (has_ranks(s)) return diagnose_on_ranks(s, what);
  do {
    atomic_store(&s->stopped, 0);
    s->team_api->run(&s->tasks, s->team, threads_now(s), what, s);
  } while (atomic_load(&s->stopped) && grow_lists(s));
  return !atomic_load(&s->stopped);
}

/* The skin of a collider is a small part of how far away places may ask. */
static bool is_squeezed(const pbf_obstacles &o, pbf_vec x) {
  return pbf_surface_count(o) && pbf_is_squeezed_by(pbf_obstacles_near(o, x, 0), x);
}

/* After diagnose: sums in the sorted order, which no number of threads changes. */
static void sum_stats(solver *s, pbf_stats *stats) {
  pbf_obstacles obstacles;
  pbf_stats sums = *stats; /* of which no number read can be a part */
  place_obstacles(s, s->now, &obstacles);
  for (uint32_t k = 0; k < s->count; ++k) {
    const pbf_vec x = field_at(&s->buffers.sorted_x(), k);
    pbf_stats_add(&sums, k == 0, x, field_at(&s->buffers.v, s->order[k]),
                  (double)diagnosed_densities(s)[k], neighbor_counts(s)[k]);
    sums.squeezed += is_squeezed(obstacles, x);
  }
  if (s->count) pbf_stats_finish(&sums);
  *stats = sums;
}

/* The same sums on ranks, each of which adds its own particles to what those before it have. */
static void sum_stats_of_ranks(solver *s, pbf_stats *stats) {
  pbf_obstacles obstacles;
  const range own = own_places(s);
  const bool begins = s->ranks.shares[s->ranks.rank].own_first == 0;
  place_obstacles(s, s->now, &obstacles);
  if (!s->ranks.total) return;
  pass_along(s, stats, [&] {
    for (uint32_t k = own.first; k < own.last; ++k) {
      const pbf_vec x = field_at(&s->buffers.sorted_x(), k);
      pbf_stats_add(stats, begins && k == own.first, x, field_at(&s->buffers.sorted_velocity, k),
                    (double)diagnosed_densities(s)[k], neighbor_counts(s)[k]);
      stats->squeezed += is_squeezed(obstacles, x);
    }
  });
  pbf_stats_finish(stats);
}

#endif
