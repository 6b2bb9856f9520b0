/* Who falls asleep and who wakes (physics/sleep.h): at the end of a step, at the start of one where
 * something moves, and between steps at the caller's word. */
#ifndef PBF_CPU_SLEEP_H
#define PBF_CPU_SLEEP_H

#include "cpu/lists.h"

/* ---- At the end of a step ------------------------------------------------------------------ */

static void unrest_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  const field &around = w->b.mean_velocity();
  range all = piece_sorted(w, piece);
  uint32_t drowsy = 0;
  memset(stirred_at_end(s) + all.first, 0, (all.last - all.first) * sizeof(uint32_t));
  smooth_velocities(w, piece, 1, around);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i) {
      pbf_vec v = field_at(&around, i);
      w->unrest[i] = pbf_unrest(&s->sleep, w->unrest[i], v);
      w->b.wakes()[i] = pbf_stirs(&s->sleep, w->unrest[i], v);
    }
  for (uint32_t i = all.first; i < all.last; ++i) {
    if (!(w->unrest[i] < s->sleep.still2)) continue;
    mark_calm(s, i, 1);
    ++drowsy;
  }
  atomic_fetch_add_explicit(&s->drowsy, drowsy, memory_order_relaxed);
}

/* Where nobody sleeps nor is about to, nobody need know of what stirs. */
static void stir_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range groups = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(s));
  if (atomic_load_explicit(&s->drowsy, memory_order_relaxed) == 0) return;
  for (range g = awake_groups(w, groups.first, groups.last); g.first < g.last;
       g = awake_groups(w, g.last, groups.last))
    s->kernels->stir(&pairs, w->b.wakes(), s->calm, stirred_at_end(s), g.first, g.last);
}

static void settle_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = piece_sorted(w, piece);
  uint32_t sleepers = 0;
  for (uint32_t i = all.first; i < all.last; ++i) {
    w->unrest[i] = pbf_settle(&s->sleep, w->unrest[i], stirred_at_end(s)[i] != 0);
    sleepers += (uint32_t)pbf_is_asleep(w->unrest[i]);
    if (i % CALM_CHUNK == 0 || i == all.first) mark_calm(s, i, 0);
  }
  keep_still(w, all, w->b.v.c, PBF_DIM);
  atomic_fetch_add_explicit(&s->sleepers, sleepers, memory_order_relaxed);
}

static void end_settling(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  s->asleep = atomic_exchange_explicit(&s->sleepers, 0, memory_order_relaxed);
  atomic_store_explicit(&s->drowsy, 0, memory_order_relaxed);
  if (s->asleep < s->count) return;
  s->all_asleep_at = w->step;
  atomic_store_explicit(&s->all_asleep, 1, memory_order_release);
}

/* 1 when now all sleep. */
static int settle(worker *w) {
  pack_vectors(w, velocities_piece);
  team_for(w->me, pair_pieces(w), unrest_piece, NULL, w);
  team_for(w->me, pair_pieces(w), stir_piece, NULL, w);
  team_for(w->me, pair_pieces(w), settle_piece, end_settling, w);
  stage_end(w, PBF_STAGE_SLEEP);
  return atomic_load_explicit(&w->s->all_asleep, memory_order_acquire) &&
         w->s->all_asleep_at == w->step;
}

/* ---- At its start -------------------------------------------------------------------------- */

static void wake_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = piece_particles(w, piece);
  for (range r = sleeping_particles(w, all.first, all.last); r.first < r.last;
       r = sleeping_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i)
      if (pbf_moves_near(s->movers, w->obstacles, s->constants.h, field_at(&w->b.x, i)))
        w->unrest[i] = pbf_woken(&s->sleep);
}

/* ---- Between steps ------------------------------------------------------------------------- */

static int sleeps(const solver *s) { return (PBF_BUILT & PBF_FEATURE_SLEEP) && s->buffers.unrest; }

/* Particles first … count - 1 are new. */
static void greet(solver *s, uint32_t first) {
  if (!sleeps(s)) return;
  for (uint32_t i = first; i < s->count; ++i) {
    s->buffers.unrest[i] = pbf_newcomer(&s->sleep);
    s->buffers.sleeping_lambda[i] = 0;
  }
}

static void wake_all(solver *s) {
  if (!sleeps(s) || !s->asleep) return;
  pbf_real *unrest = s->buffers.unrest;
  for (uint32_t i = 0; i < s->count; ++i)
    if (pbf_is_asleep(unrest[i])) unrest[i] = pbf_woken(&s->sleep);
  s->asleep = 0;
}

/* Wakes who is near these colliders as they stand at a time; 1 where somebody is. */
static int wake_near(solver *s, pbf_movers movers, double time) {
  pbf_obstacles obstacles;
  uint32_t before = s->asleep;
  if (!sleeps(s) || !s->asleep || !pbf_any_moves(movers)) return 0;
  place_obstacles(s, time, &obstacles);
  for (uint32_t i = 0; i < s->count; ++i) {
    pbf_real *unrest = &s->buffers.unrest[i];
    if (!pbf_is_asleep(*unrest) ||
        !pbf_moves_near(movers, obstacles, s->constants.h, field_at(&s->buffers.x, i)))
      continue;
    *unrest = pbf_woken(&s->sleep);
    --s->asleep;
  }
  return s->asleep < before;
}

/* How many of `steps` steps from `time` on pass without anybody awake, when all sleep. */
static uint32_t steps_asleep(solver *s, double time, uint32_t steps) {
  if (!sleeps(s) || s->asleep < s->count) return 0;
  if (!pbf_any_moves(s->movers)) return steps;
  for (uint32_t k = 0; k < steps; ++k)
    if (wake_near(s, s->movers, time + (k + 1) * s->params.time_step)) return k;
  return steps;
}

#endif
