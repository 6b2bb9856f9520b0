/* What callers ask for between steps: densities and statistics at the present positions. Uses the
 * spare buffers; the state stays where it is, since a caller may be looking at it. */
#ifndef PBF_CPU_SURVEY_H
#define PBF_CPU_SURVEY_H

#include "cpu/lists.h"
#include "cpu/sort.h"

static void density_piece(void *context, uint32_t piece) {
  worker *w = context;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.spare[2]);
  w->s->kernels->density(&pairs, w->s->lambda, w->s->cells, r.first, r.last);
}

/* Afterwards s->order is sorted by cell and id, and particle s->order[k] has the density
 * s->lambda[k] and s->cells[k] neighbours. */
static void run_survey(void *context, member *me) {
  solver *s = context;
  worker w = worker_of(s, me);
  w.key = &w.b.x;
  w.sorted_key = &w.b.spare[2];
  place_obstacles(&w, s->now);
  team_for(me, particle_pieces(&w), find_bounds, make_grid, &w);
  sort_particles(&w);
  if (find_neighbors(&w)) team_for(me, pair_pieces(&w), density_piece, NULL, &w);
}

/* 0 when the memory for the neighbours is lacking. */
static int survey(solver *s) {
  if (!s->count) return 1;
  do {
    atomic_store(&s->stopped, 0);
    team_run(s->team, s->threads, run_survey, s);
  } while (atomic_load(&s->stopped) && grow_lists(s));
  return !atomic_load(&s->stopped);
}

static void add_to_stats(pbf_stats *stats, const solver *s, uint32_t k) {
  pbf_vec x = field_at(&s->buffers.x, s->order[k]), v = field_at(&s->buffers.v, s->order[k]);
  double density = (double)s->lambda[k], v2 = 0;
  for (int a = 0; a < PBF_DIM; ++a) {
    double xa = (double)x.c[a], va = (double)v.c[a];
    stats->center_of_mass[a] += xa;
    stats->momentum[a] += va;
    if (k == 0 || xa < stats->position_min[a]) stats->position_min[a] = xa;
    if (k == 0 || xa > stats->position_max[a]) stats->position_max[a] = xa;
    v2 += va * va;
  }
  stats->kinetic_energy += 0.5 * v2;
  stats->speed_max = fmax(stats->speed_max, sqrt(v2));
  stats->density_mean += density;
  stats->density_error_mean += fmax(density - 1, 0);
  stats->density_error_max = fmax(stats->density_error_max, density - 1);
  stats->neighbors_mean += s->cells[k];
  if (s->cells[k] > stats->neighbors_max) stats->neighbors_max = s->cells[k];
}

/* After a survey: sums in the sorted order, which no number of threads changes. */
static void sum_stats(const solver *s, pbf_stats *stats) {
  if (!s->count) return;
  for (uint32_t k = 0; k < s->count; ++k) add_to_stats(stats, s, k);
  for (int a = 0; a < PBF_DIM; ++a) {
    stats->center_of_mass[a] /= s->count;
    stats->momentum[a] /= s->count;
  }
  stats->kinetic_energy /= s->count;
  stats->density_mean /= s->count;
  stats->density_error_mean /= s->count;
  stats->neighbors_mean /= s->count;
}

#endif
