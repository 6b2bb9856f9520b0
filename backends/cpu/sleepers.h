/* Which particles and groups sleep. Where nothing sleeps all groups are awake. Once
 * neighbours are known, some sleepers are the sleeping boundary (physics/sleep.h). */
#ifndef PBF_CPU_SLEEPERS_H
#define PBF_CPU_SLEEPERS_H

#include "cpu/worker.h"

static inline int sleep_is_on(const worker *w) {
  return (PBF_BUILT & PBF_FEATURE_SLEEP) && w->activity;
}

/* The first particle of first … last - 1 with an activity below a bound, or is not, or last. */
static inline uint32_t find_active(const pbf_real *activity, uint32_t first, uint32_t last,
                                   pbf_real bound, int below) {
  while (first < last && (activity[first] < bound) != below) ++first;
  return first;
}

/* The first of these particles of which that is so, in a row. */
static inline range particles_at_rest(const worker *w, uint32_t first, uint32_t last,
                                      pbf_real bound, int below) {
  if (!sleep_is_on(w)) return (range){below ? last : first, last};
  first = find_active(w->activity, first, last, bound, below);
  return (range){first, find_active(w->activity, first, last, bound, !below)};
}

static inline range awake_particles(const worker *w, uint32_t first, uint32_t last) {
  return particles_at_rest(w, first, last, 0, 0);
}

static inline range sleeping_particles(const worker *w, uint32_t first, uint32_t last) {
  return particles_at_rest(w, first, last, 0, 1);
}

/* Asleep, and not the sleeping boundary. */
static inline range inactive_particles(const worker *w, uint32_t first, uint32_t last) {
  return particles_at_rest(w, first, last, pbf_sleeping_boundary(), 1);
}

/* Whether the activity of all in a group is below a bound. */
static inline int is_group_below(const worker *w, uint32_t g, pbf_real bound) {
  uint32_t width = w->s->kernels->width, count = own_places(w->s).last;
  uint32_t begin = g * width, end = count - begin < width ? count : begin + width;
  return find_active(w->activity, begin, end, bound, 0) == end;
}

/* The first of these groups of which that is not so, in a row. */
static inline range active_groups(const worker *w, uint32_t first, uint32_t last, pbf_real bound) {
  if (!sleep_is_on(w)) return (range){first, last};
  while (first < last && is_group_below(w, first, bound)) ++first;
  range r = {first, first};
  while (r.last < last && !is_group_below(w, r.last, bound)) ++r.last;
  return r;
}

/* Those in each of which a particle is awake, … */
static inline range awake_groups(const worker *w, uint32_t first, uint32_t last) {
  return active_groups(w, first, last, 0);
}

/* … or solves at least. */
static inline range solving_groups(const worker *w, uint32_t first, uint32_t last) {
  return active_groups(w, first, last, pbf_sleeping_boundary());
}

/* Chunks reach across the ends of tasks: others may say the same at the same time. */
static inline void mark_has_sleepers(solver *s, uint32_t i, uint8_t has_sleepers) {
  __atomic_store_n(&s->has_sleepers[i / ACTIVITY_CHUNK], has_sleepers, __ATOMIC_RELAXED);
}

/* Of sorted particles, before their neighbours are known. */
static inline void mark_sleepers(const worker *w, range r) {
  if (!sleep_is_on(w) || !w->s->asleep) return;
  for (uint32_t i = r.first; i < r.last; ++i)
    if (pbf_is_asleep(w->b.sorted_activity[i])) mark_has_sleepers(w->s, i, 1);
}

/* Sleepers among these particles stay where they were … */
static inline void copy_sleeping(const worker *w, range r, const field *from, const field *to) {
  for (range s = sleeping_particles(w, r.first, r.last); s.first < s.last;
       s = sleeping_particles(w, s.last, r.last))
    for (int k = 0; k < PBF_DIM; ++k)
      memcpy(to->c[k] + s.first, from->c[k] + s.first, (s.last - s.first) * sizeof(pbf_real));
}

/* … and at rest. */
static inline void zero_sleeping(const worker *w, range r, pbf_real *const *values,
                                 int components) {
  for (range s = sleeping_particles(w, r.first, r.last); s.first < s.last;
       s = sleeping_particles(w, s.last, r.last))
    for (int k = 0; k < components; ++k)
      memset(values[k] + s.first, 0, (s.last - s.first) * sizeof(pbf_real));
}

/* Those that have just woken begin at rest. */
static inline void zero_woken_velocity(const worker *w, range r, const field *v) {
  for (uint32_t i = r.first; i < r.last && sleep_is_on(w); ++i)
    if (pbf_just_woke(&w->s->sleep, w->activity[i])) field_set(v, i, (pbf_vec){{0}});
}

/* Sleepers out of reach of the awake push nothing. Returns how many these are. */
static inline uint32_t clear_inactive(const worker *w, range r) {
  pbf_real *acts = w->s->added ? w->s->added : w->s->lambda;
  uint32_t inactive = 0;
  for (range s = inactive_particles(w, r.first, r.last); s.first < s.last;
       s = inactive_particles(w, s.last, r.last)) {
    memset(acts + s.first, 0, (s.last - s.first) * sizeof *acts);
    inactive += s.last - s.first;
  }
  return inactive;
}

/* After the solve: sleepers keep the lambda, and so the pressure, of when they were last awake. */
static inline void keep_sleeping_lambda(const worker *w, range r) {
  pbf_real *lambda = w->s->lambda, *kept = w->sleeping_lambda;
  for (uint32_t i = r.first; i < r.last && sleep_is_on(w); ++i)
    if (pbf_is_asleep(w->activity[i]))
      lambda[i] = kept[i];
    else
      kept[i] = lambda[i];
}

#endif
