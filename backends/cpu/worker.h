/* A thread's part in a step. All threads run the same code and cut the work by their number. */
#ifndef PBF_CPU_WORKER_H
#define PBF_CPU_WORKER_H

#include <time.h>

#include "cpu/solver.h"

typedef struct range {
  uint32_t first, last; /* up to last - 1 */
} range;

typedef struct worker {
  solver *s;
  member *me;
  uint32_t thread, threads; /* of me */
  buffers b;                /* every thread swaps its own copy */
  grid grid;
  range groups; /* whose pairs this thread sums up */
  pbf_obstacles obstacles;
  pbf_constants constants; /* of the present iteration */
  double stage_begin;
} worker;

static inline worker worker_of(solver *s, member *me) {
  return (worker){.s = s,
                  .me = me,
                  .thread = me->thread,
                  .threads = me->threads,
                  .b = s->buffers,
                  .constants = s->constants};
}

static inline range part_of(uint64_t total, uint32_t thread, uint32_t threads) {
  return (range){(uint32_t)(total * thread / threads), (uint32_t)(total * (thread + 1) / threads)};
}

static inline range my_chunks(const worker *w) {
  return part_of(chunks_of(w->s->count), w->thread, w->threads);
}

static inline range my_particles(const worker *w) {
  range r = my_chunks(w);
  uint64_t last = (uint64_t)r.last * CHUNK;
  return (range){r.first * CHUNK, last < w->s->count ? (uint32_t)last : w->s->count};
}

static inline uint64_t groups_of(const solver *s) {
  return ((uint64_t)s->count + s->kernels->width - 1) / s->kernels->width;
}

/* The particles in this thread's groups. */
static inline range my_sorted(const worker *w) {
  uint32_t width = w->s->kernels->width;
  uint64_t last = (uint64_t)w->groups.last * width;
  return (range){w->groups.first * width, last < w->s->count ? (uint32_t)last : w->s->count};
}

static inline double seconds_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The end of a stage whose results other threads read next. */
static inline void stage_end(worker *w, pbf_stage stage) {
  team_barrier(w->me);
  if (!(PBF_BUILT & PBF_FEATURE_TIMING) || !w->s->timing || w->thread != 0) return;
  double now = seconds_now();
  w->s->seconds[stage] += now - w->stage_begin;
  ++w->s->runs[stage];
  w->stage_begin = now;
}

/* Walls and colliders where they stand at a time. */
static inline void place_obstacles(worker *w, double time) {
  const solver *s = w->s;
  w->obstacles.walls = pbf_walls_at(&s->params, time);
  w->obstacles.count = (int)s->collider_count;
  for (int k = 0; k < pbf_solid_count(&w->obstacles); ++k)
    w->obstacles.solids[k] =
        pbf_solid_at(&s->colliders[k], time - s->collider_time, s->params.time_step);
}

static inline void swap_fields(field *a, field *b) {
  field c = *a;
  *a = *b;
  *b = c;
}

#endif
