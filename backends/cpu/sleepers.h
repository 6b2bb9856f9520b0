/* What the stages of a step ask about sleepers. Where nothing sleeps all groups are awake. */
#ifndef PBF_CPU_SLEEPERS_H
#define PBF_CPU_SLEEPERS_H

#include "cpu/worker.h"

static inline int sleep_is_on(const worker *w) {
  return (PBF_BUILT & PBF_FEATURE_SLEEP) && w->rest.unrest;
}

/* The first particle of first … last - 1 of whom that is so, or last. */
static inline uint32_t find_asleep(const pbf_real *unrest, uint32_t first, uint32_t last,
                                   int asleep) {
  while (first < last && pbf_is_asleep(unrest[first]) != asleep) ++first;
  return first;
}

/* The first of these particles that are awake, in a row. */
static inline range awake_particles(const worker *w, uint32_t first, uint32_t last) {
  if (!sleep_is_on(w)) return (range){first, last};
  first = find_asleep(w->rest.unrest, first, last, 0);
  return (range){first, find_asleep(w->rest.unrest, first, last, 1)};
}

static inline range sleeping_particles(const worker *w, uint32_t first, uint32_t last) {
  if (!sleep_is_on(w)) return (range){last, last};
  first = find_asleep(w->rest.unrest, first, last, 1);
  return (range){first, find_asleep(w->rest.unrest, first, last, 0)};
}

/* The first of these groups in each of which somebody is awake, in a row. */
static inline range awake_groups(const worker *w, uint32_t first, uint32_t last) {
  if (!sleep_is_on(w)) return (range){first, last};
  uint32_t width = w->s->kernels->width, count = w->s->count;
  range r = {first, first};
  for (; r.last < last; ++r.last) {
    uint32_t begin = r.last * width, end = count - begin < width ? count : begin + width;
    int awake = find_asleep(w->rest.unrest, begin, end, 0) < end;
    if (!awake && r.first < r.last) break;
    if (!awake) r.first = r.last + 1;
  }
  return r;
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
    if (pbf_just_woke(&w->s->sleep, w->rest.unrest[i])) field_set(v, i, (pbf_vec){{0}});
}

/* Their lambda stays: all of it acts in the first iteration. */
static inline void keep_lambda(const worker *w, range r) {
  pbf_real *lambda = w->s->lambda, *added = w->s->added;
  for (range s = sleeping_particles(w, r.first, r.last); s.first < s.last;
       s = sleeping_particles(w, s.last, r.last)) {
    uint64_t bytes = (s.last - s.first) * sizeof *lambda;
    memcpy(lambda + s.first, w->rest.lambda + s.first, bytes);
    if (added && w->iteration == 0) memcpy(added + s.first, lambda + s.first, bytes);
    if (added && w->iteration > 0) memset(added + s.first, 0, bytes);
  }
}

#endif
