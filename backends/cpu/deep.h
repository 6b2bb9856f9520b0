/* Deep water: the pressure of the fluid's weight on a coarse grid (physics/coarse.h), before the
 * iterations. One thread solves: the grid has a node for some ten to sixty particles. */
#ifndef PBF_CPU_DEEP_H
#define PBF_CPU_DEEP_H

#include "cpu/lists.h"

static int is_deep(const worker *w) {
  return (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) && w->s->deep.sums;
}

static void weigh_piece(void *context, uint32_t piece) {
  worker *w = context;
  solver *s = w->s;
  range r = piece_sorted(w, piece);
  find_densities(w, piece, w->b.spare[2], s->lambda);
  for (uint32_t i = r.first; i < r.last; ++i) {
    int asleep = sleep_is_on(w) && pbf_is_asleep(w->rest.unrest[i]);
    pbf_deep_add(&s->deep, field_at(&w->b.spare[2], i), asleep ? 1 : s->lambda[i]);
  }
}

static void solve_deep(void *context) {
  const worker *w = context;
  pbf_deep_solve(&w->s->deep, &w->obstacles);
}

static void carry_piece(void *context, uint32_t piece) {
  worker *w = context;
  range all = piece_sorted(w, piece);
  const field *x = &w->b.spare[2], *v = &w->b.spare[3];
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i) {
      pbf_vec u = pbf_deep_move(&w->s->deep, field_at(x, i));
      field_set(x, i, pbf_add_scaled(field_at(x, i), 1, u));
      field_set(v, i, pbf_add_scaled(field_at(v, i), w->forces.inv_time_step, u));
    }
}

/* What the weight presses together is undone. */
static void carry_weight(worker *w) {
  team_for(w->me, pair_pieces(w), weigh_piece, solve_deep, w);
  team_for(w->me, pair_pieces(w), carry_piece, NULL, w);
  stage_end(w, PBF_STAGE_GRID);
}

/* lambda of these particles once the step is over, and with it the pressure: all of it. */
static void add_weight(const worker *w, range r) {
  solver *s = w->s;
  for (uint32_t i = r.first; i < r.last; ++i)
    s->lambda[i] += pbf_deep_lambda(&s->deep, &s->constants, w->forces.inv_time_step,
                                    field_at(&w->b.spare[1], i));
}

#endif
