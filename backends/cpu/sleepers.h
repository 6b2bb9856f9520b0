/* What the stages of a step ask about sleepers. Where nothing sleeps all groups are awake. Once
 * neighbours are known, some sleepers are the shore (physics/sleep.h). */
#ifndef PBF_CPU_SLEEPERS_H
#define PBF_CPU_SLEEPERS_H

#include "cpu/worker.h"

static inline int sleep_is_on(const worker *w) {
  return (PBF_BUILT & PBF_FEATURE_SLEEP) && w->unrest;
}

/* The first particle of first … last - 1 whose unrest is below a bound, or is not, or last. */
static inline uint32_t find_rest(const pbf_real *unrest, uint32_t first, uint32_t last,
                                 pbf_real bound, int below) {
  while (first < last && (unrest[first] < bound) != below) ++first;
  return first;
}

/* The first of these particles of whom that is so, in a row. */
static inline range particles_at_rest(const worker *w, uint32_t first, uint32_t last,
                                      pbf_real bound, int below) {
  if (!sleep_is_on(w)) return (range){below ? last : first, last};
  first = find_rest(w->unrest, first, last, bound, below);
  return (range){first, find_rest(w->unrest, first, last, bound, !below)};
}

static inline range awake_particles(const worker *w, uint32_t first, uint32_t last) {
  return particles_at_rest(w, first, last, 0, 0);
}

static inline range sleeping_particles(const worker *w, uint32_t first, uint32_t last) {
  return particles_at_rest(w, first, last, 0, 1);
}

/* Asleep, and not the shore. */
static inline range idle_particles(const worker *w, uint32_t first, uint32_t last) {
  return particles_at_rest(w, first, last, pbf_shore(), 1);
}

/* Whether the unrest of everybody in a group is below a bound. */
static inline int is_group_below(const worker *w, uint32_t g, pbf_real bound) {
  uint32_t width = w->s->kernels->width, count = w->s->count;
  uint32_t begin = g * width, end = count - begin < width ? count : begin + width;
  return find_rest(w->unrest, begin, end, bound, 0) == end;
}

/* The first of these groups of which that is not so, in a row. */
static inline range restless_groups(const worker *w, uint32_t first, uint32_t last,
                                    pbf_real bound) {
  if (!sleep_is_on(w)) return (range){first, last};
  while (first < last && is_group_below(w, first, bound)) ++first;
  range r = {first, first};
  while (r.last < last && !is_group_below(w, r.last, bound)) ++r.last;
  return r;
}

/* Those in each of which somebody is awake, … */
static inline range awake_groups(const worker *w, uint32_t first, uint32_t last) {
  return restless_groups(w, first, last, 0);
}

/* … or solves at least. */
static inline range solving_groups(const worker *w, uint32_t first, uint32_t last) {
  return restless_groups(w, first, last, pbf_shore());
}

/* Chunks reach across the ends of pieces: others may say the same at the same time. */
static inline void mark_calm(solver *s, uint32_t i, uint8_t calm) {
  __atomic_store_n(&s->calm[i / CALM_CHUNK], calm, __ATOMIC_RELAXED);
}

/* Of sorted particles, before their neighbours are known. */
static inline void mark_sleepers(const worker *w, range r) {
  if (!sleep_is_on(w) || !w->s->asleep) return;
  for (uint32_t i = r.first; i < r.last; ++i)
    if (pbf_is_asleep(w->b.sorted_unrest[i])) mark_calm(w->s, i, 1);
}

/* Sleepers among these particles stay where they were … */
static inline void keep_places(const worker *w, range r, const field *from, const field *to) {
  for (range s = sleeping_particles(w, r.first, r.last); s.first < s.last;
       s = sleeping_particles(w, s.last, r.last))
    for (int k = 0; k < PBF_DIM; ++k)
      memcpy(to->c[k] + s.first, from->c[k] + s.first, (s.last - s.first) * sizeof(pbf_real));
}

/* … and at rest. */
static inline void keep_still(const worker *w, range r, pbf_real *const *values, int components) {
  for (range s = sleeping_particles(w, r.first, r.last); s.first < s.last;
       s = sleeping_particles(w, s.last, r.last))
    for (int k = 0; k < components; ++k)
      memset(values[k] + s.first, 0, (s.last - s.first) * sizeof(pbf_real));
}

/* Those that have just woken begin at rest. */
static inline void calm_woken(const worker *w, range r, const field *v) {
  for (uint32_t i = r.first; i < r.last && sleep_is_on(w); ++i)
    if (pbf_just_woke(&w->s->sleep, w->unrest[i])) field_set(v, i, (pbf_vec){{0}});
}

/* Out of reach of the awake nobody pushes. Returns how many these are. */
static inline uint32_t clear_idle(const worker *w, range r) {
  pbf_real *acts = w->s->added ? w->s->added : w->s->lambda;
  uint32_t idle = 0;
  for (range s = idle_particles(w, r.first, r.last); s.first < s.last;
       s = idle_particles(w, s.last, r.last)) {
    memset(acts + s.first, 0, (s.last - s.first) * sizeof *acts);
    idle += s.last - s.first;
  }
  return idle;
}

/* After the solve: sleepers keep the lambda, and so the pressure, of when they were last awake. */
static inline void keep_lambda(const worker *w, range r) {
  pbf_real *lambda = w->s->lambda, *kept = w->sleeping_lambda;
  for (uint32_t i = r.first; i < r.last && sleep_is_on(w); ++i)
    if (pbf_is_asleep(w->unrest[i]))
      lambda[i] = kept[i];
    else
      kept[i] = lambda[i];
}

#endif
