/* Part of executor.h: what a step does with others' particles. */
#ifndef PBF_CPU_STEP_RANKS_H
#define PBF_CPU_STEP_RANKS_H

#include "cpu/velocities.h"
#include "physics/step.h"

/* On ranks this also has each take what it is to hold, in place of what it had. */
static bool sort_step(worker *w) {
  if (has_ranks(w->s)) w->s->ranks.before = w->s->count;
  if (w->sort_push) note_pushes_before_sort(w);
  return sort_particles(w, &w->b.predicted(), &w->b.predicted_velocity());
}

/* Those of others that are held before and behind its own. */
static void pack_others(const worker *w, pbf_real *packed, const field &x, const pbf_real *number) {
  const range own = own_places(w->s), held = held_places(w->s);
  fill_packed(w->s, packed, &x, number, (range){held.first, own.first});
  fill_packed(w->s, packed, &x, number, (range){own.last, held.last});
}

/* Whether velocity() leaves others' positions as the last iteration had them. */
static bool velocity_moves(const solver *s) {
  return s->schedule.collide_after_solve || has_convergence_check(s);
}

static void add_fields(const worker *w, int fields, const field &x) {
  solver *s = w->s;
  if (fields & FIELD_POSITION) add_field(s, &x);
  if (fields & FIELD_LAMBDA) add_array(s, const_cast<pbf_real *>(pushes_of(s)));
  if (fields & FIELD_LAMBDA_TOTAL) add_array(s, s->lambda);
  if (fields & FIELD_VELOCITY) add_field(s, &w->b.v);
  if (fields & FIELD_MEAN_VELOCITY) add_field(s, &w->b.mean_velocity());
  if (fields & FIELD_CORRECTION_RATE)
    for (int k = 0; k < PBF_CURL_DIM; ++k) add_array(s, w->b.rotation_rate().c[k]);
  if (fields & FIELD_CURL_SIZE) add_array(s, curl_sizes(s));
  if (fields & FIELD_CROWDING) add_array(s, crowding_of(s));
  if (fields & FIELD_VISCOUS_CHANGE) add_field(s, &w->b.viscous_change());
  if (fields & FIELD_MISSING) add_array(s, missing_neighbors_of(s));
  if (fields & FIELD_SHEAR_PUSH) add_field(s, &w->b.shear_push());
  if (fields & FIELD_DEVIATOR) {
    add_field(s, &w->b.deviator());
    for (int k = 0; k < PBF_DEVIATOR_DIM - PBF_DIM; ++k) add_array(s, w->b.rest_of_deviator(k));
  }
}

/* A pass over pairs that has been made for what other ranks hold, and is to be for the rest, with
 * the buffers and in the iteration of then. */
struct late_pass {
  task_function task; /* null: none */
  buffers b;
  uint32_t iteration;
};

static void make_late_pass(const worker *w, late_pass *late) {
  worker then = *w;
  then.b = late->b;
  then.iteration = late->iteration;
  late->task(&then, INNER_GROUPS);
  late->task = NULL;
}

/* What a stage has changed of particles that other ranks hold. `solved`: x* is x, and `moved` since
 * others have heard of it. */
static void exchange_with_ranks(worker *w, int fields, bool solved, bool moved, late_pass *late) {
  solver *s = w->s;
  if (late->task && has_convergence_check(s)) make_late_pass(w, late);
  if (fields == FIELD_POSITION && solved && !moved) return;
  if (!solved && has_convergence_check(s) && is_converged(w)) return;
  const field &x = solved ? w->b.x : x_star(w);
  s->ranks.sends.count = s->ranks.receives.count = 0;
  add_fields(w, fields, x);
  if (late->task) {
    begin_exchange_on_ranks(s);
    make_late_pass(w, late);
    end_exchange_on_ranks(s);
  } else {
    exchange_on_ranks(s);
  }
  if (fields & FIELD_POSITION) pack_others(w, packed_positions(s), x, s->mobility);
  if (fields & FIELD_LAMBDA) pack_others(w, packed_lambda(s), x, pushes_of(s));
}

static void move_down(void *values, range own, uint64_t element) {
  char *first = static_cast<char *>(values);
  memmove(first, first + own.first * element, (own.last - own.first) * element);
}

/* The state is that of its own particles alone. */
static void keep_own(worker *w) {
  solver *s = w->s;
  const range own = own_places(s);
  for (int k = 0; k < PBF_DIM; ++k) {
    move_down(w->b.x.c[k], own, sizeof(pbf_real));
    move_down(w->b.v.c[k], own, sizeof(pbf_real));
    if (has_accelerations(w)) move_down(w->b.acceleration.c[k], own, sizeof(pbf_real));
  }
  move_down(s->lambda, own, sizeof(pbf_real));
  move_down(w->b.ids, own, sizeof(uint32_t));
  if (s->last_pressure) move_down(s->last_pressure, own, sizeof(pbf_real));
  if (w->b.overlap) move_down(w->b.overlap, own, sizeof(pbf_real));
  if (w->b.phase) move_down(w->b.phase, own, sizeof(uint8_t));
  if (sleep_is_on(w)) {
    move_down(w->b.activity, own, sizeof(pbf_real));
    move_down(w->b.sleeping_lambda, own, sizeof(pbf_real));
  }
  s->count = own.last - own.first;
}

#endif
