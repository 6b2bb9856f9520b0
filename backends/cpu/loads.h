/* Part of executor.h: what solids do to particles, noted while a step goes on (physics/loads.h). */
#ifndef PBF_CPU_LOADS_H
#define PBF_CPU_LOADS_H

#include "cpu/sort.h"
#include "physics/loads.h"

static inline bool finds_loads(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_LOADS) && s->schedule.runs[PBF_STAGE_LOADS];
}

/* Whether what solids push with is wanted of each particle. */
static inline bool notes_pushes(const solver *s) {
  return finds_loads(s) ||
         ((PBF_BUILT & PBF_FEATURE_LOADS) && s->schedule.runs[PBF_STAGE_FRICTION]);
}

/* Adds to the tally: all threads do. */
static inline void add_to_shared(pbf_wide_sum *to, pbf_wide_sum more) {
  __atomic_fetch_add(&to->high, more.high, __ATOMIC_RELAXED);
  __atomic_fetch_add(&to->low, more.low, __ATOMIC_RELAXED);
}

static inline void add_change(const solver *s, const pbf_wide_sum change[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) add_to_shared(&s->load_tally->change[k], change[k]);
}

/* Of a particle that has the velocity v by now, and `forced` without solids. */
static inline void note_push(const worker *w, uint32_t i, pbf_vec v, pbf_vec forced, pbf_real mass,
                             double units, pbf_wide_sum change[PBF_DIM]) {
  field_set(&w->s->push, i, pbf_sub(v, forced));
  for (int k = 0; k < PBF_DIM; ++k)
    pbf_wide_add(&change[k], pbf_wide_of(units * (double)(forced.c[k] * mass)));
}

static inline pbf_vec forced_velocity(const worker *w, uint32_t before) {
  return pbf_apply_forces(&w->forces, field_at(&w->b.x, before), accelerated_velocity(w, before));
}

/* What solids have done in the prediction, of sorted particles: the old state, in its old order, is
 * there until neighbours are found. */
static void push_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const solver *s = w->s;
  const double units = -pbf_units_of_momentum(&w->constants, &w->forces);
  pbf_wide_sum change[PBF_DIM] = {};
  const range r = {s->first_place[task], s->first_place[task + 1]};
  for (uint32_t i = r.first; i < r.last; ++i) {
    const bool sleeps = sleep_is_on(w) && pbf_is_asleep(w->activity[i]);
    field_set(&s->push, i,
              sleeps ? field_at(&w->b.sorted_velocity, i) : forced_velocity(w, s->order[i]));
  }
  s->kernels->note_pushes(units, w->b.sorted_velocity, s->push, s->mobility, r.first, r.last,
                          change);
  if (finds_loads(s)) add_change(s, change);
}

/* The same of a rank's particles before they go to others, in the old order. */
static void note_pushes_before_sort(const worker *w) {
  const solver *s = w->s;
  const double units = -pbf_units_of_momentum(&w->constants, &w->forces);
  pbf_wide_sum change[PBF_DIM] = {};
  for (uint32_t i = 0; i < s->count; ++i) {
    const bool sleeps = sleep_is_on(w) && pbf_is_asleep(w->activity[i]);
    const pbf_vec v = field_at(&w->b.predicted_velocity(), i);
    note_push(w, i, v, sleeps ? v : forced_velocity(w, i),
              w->b.phase ? 1 / w->constants.phases.mobility[w->b.phase[i]] : 1, units, change);
  }
  if (finds_loads(s)) add_change(s, change);
}

/* Around what solids alone do to velocities. */
static inline void add_velocities(const solver *s, pbf_real factor, const field *v, range r) {
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t i = r.first; i < r.last; ++i) s->push.c[k][i] += factor * v->c[k][i];
}
static inline void begin_noting(const solver *s, const field *v, range r) {
  add_velocities(s, -1, v, r);
}
static inline void end_noting(const solver *s, const field *v, range r) {
  add_velocities(s, 1, v, r);
}

#endif
