/* A thread's part in a step: all threads come to the same loops in the same order (team.h). */
#ifndef PBF_CPU_WORKER_H
#define PBF_CPU_WORKER_H

#include "cpu/solver.h"

/* What is in here a thread works out for itself. */
typedef struct worker {
  solver *s;
  team_thread *self;
  buffers b;               /* every thread swaps its own copy */
  struct list_arena arena; /* for lists of neighbours */
  pbf_forces forces;
  pbf_obstacles obstacles;                        /* at the end of the step */
  pbf_obstacles before;                           /* at its start, for the residual density alone */
  double begins_at, placed_at;                    /* the times of these */
  pbf_moving_obstacles moving_obstacles;          /* in this step */
  pbf_constants constants;                        /* of the iteration */
  pbf_real *activity, *sleeping_lambda;           /* in the order of the stage */
  uint32_t step, iteration;                       /* of this run */
  uint32_t viscosity_stage;                       /* of this step */
  const field *sort_positions, *sorted_positions; /* of the sort, … */
  const field *sort_payload, *sorted_payload;     /* … and what goes along; null: nothing */
  const uint32_t *sort_ids;                       /* of the particles to be sorted, */
  const pbf_real *sort_overlap;                   /* what is left of their overlap, */
  const field *sort_acceleration;                 /* their accelerations, or null, */
  const uint8_t *sort_phase;                      /* their phases, */
  const field *sort_push;                         /* and on ranks what solids push them with */
  double stage_begin;
  pbf_surface few[PBF_ASKED_COLLIDERS], few_before[PBF_ASKED_COLLIDERS];
  uint16_t few_numbers[PBF_ASKED_COLLIDERS];
} worker;

static inline worker worker_of(solver *s, team_thread *self) {
  return (worker){.s = s,
                  .self = self,
                  .b = s->buffers,
                  .constants = s->constants,
                  .sort_ids = s->buffers.ids,
                  .sort_overlap = s->buffers.overlap,
                  .sort_phase = s->buffers.phase};
}

static inline bool has_accelerations(const worker *w) { return w->b.acceleration.c[0]; }

/* Before the sort: the velocity of a particle with what an acceleration of its own adds to it. */
static inline pbf_vec accelerated_velocity(const worker *w, uint32_t i) {
  const pbf_vec v = field_at(&w->b.v, i);
  return has_accelerations(w) ? pbf_add_acceleration(&w->forces, v, field_at(&w->b.acceleration, i))
                              : v;
}

static inline uint64_t part_begin(uint64_t total, uint32_t part, uint32_t parts) {
  return total * part / parts;
}

static inline range part_of(uint64_t total, uint32_t part, uint32_t parts) {
  return (range){(uint32_t)part_begin(total, part, parts),
                 (uint32_t)part_begin(total, part + 1, parts)};
}

/* How many tasks a loop over `total` things has, at least `least` of them in each. One thread
 * needs no more than one task. */
static inline uint32_t tasks_of(const worker *w, uint64_t total, uint32_t min_size, uint32_t each) {
  uint64_t max_tasks = (total + min_size - 1) / min_size, tasks = (uint64_t)each * w->self->threads;
  if (w->self->threads == 1) return 1;
  return (uint32_t)(tasks < max_tasks ? tasks : max_tasks);
}

static inline uint32_t particle_task_count(const worker *w) {
  return tasks_of(w, chunks_of(w->s->count), 1, PARTICLE_TASKS);
}

/* The chunks of a task. */
static inline range task_chunks(const worker *w, uint32_t task) {
  return part_of(chunks_of(w->s->count), task, particle_task_count(w));
}

static inline range task_particles(const worker *w, uint32_t task) {
  range r = task_chunks(w, task);
  uint64_t last = (uint64_t)r.last * CHUNK;
  return (range){r.first * CHUNK, last < w->s->count ? (uint32_t)last : w->s->count};
}

/* Where its own particles begin and end in sorted order. Without ranks all are its own. */
static inline range own_places(const solver *s) {
  if (s->ranks.count) return (range){s->ranks.own_first, s->ranks.own_last};
  return (range){0, s->count};
}

/* Those that it holds, with its neighbours' on other ranks. */
static inline range held_places(const solver *s) {
  return (range){s->ranks.pad, s->ranks.pad + s->count};
}

/* The groups of its own particles: a share begins with a group. */
static inline range own_groups(const solver *s) {
  const range own = own_places(s);
  const uint64_t width = s->kernels->width, first = own.first / width;
  return (range){(uint32_t)first, (uint32_t)((own.last + width - 1) / width)};
}

static inline uint64_t groups_of(const solver *s) {
  const range groups = own_groups(s);
  return groups.last - groups.first;
}

static inline uint32_t search_task_count(const worker *w) {
  enum { MIN_PARTICLES = 256 };
  return tasks_of(w, groups_of(w->s), MIN_PARTICLES / w->s->kernels->width, SEARCH_TASKS);
}

/* The tasks of a pass over pairs on ranks that work while they exchange: what others hold at either
 * end of a rank's own groups, and what lies between. */
enum { LOWER_EDGE, INNER_GROUPS, UPPER_EDGE, EDGED_TASKS };
static inline bool has_edges(const solver *s) {
  return s->ranks.count > 1 && s->ranks.link.begin_exchange;
}

static inline uint32_t pair_task_count(const worker *w) {
  enum { MIN_PARTICLES = 128 };
  if (has_edges(w->s)) return EDGED_TASKS;
  return tasks_of(w, groups_of(w->s), MIN_PARTICLES / w->s->kernels->width, PAIR_TASKS);
}

/* The groups of a task of the search. */
static inline range search_groups(const worker *w, uint32_t task) {
  const uint32_t first = own_groups(w->s).first;
  const range part = part_of(groups_of(w->s), task, search_task_count(w));
  return (range){first + part.first, first + part.last};
}

/* The groups of a task of a pass over pairs. */
static inline range task_groups(const worker *w, uint32_t task) {
  return (range){w->s->first_group[task], w->s->first_group[task + 1]};
}

/* The particles in these groups. */
static inline range particles_of(const worker *w, range r) {
  uint32_t width = w->s->kernels->width;
  const uint64_t first = (uint64_t)r.first * width, last = (uint64_t)r.last * width;
  const uint32_t end = own_places(w->s).last;
  return (range){first < end ? (uint32_t)first : end, last < end ? (uint32_t)last : end};
}

static inline range task_sorted(const worker *w, uint32_t task) {
  return particles_of(w, task_groups(w, task));
}

/* The same, and with the first and the last of them what others' particles are held before and
 * behind. */
static inline range task_held(const worker *w, uint32_t task) {
  range r = task_sorted(w, task);
  if (!w->s->ranks.count) return r;
  if (task == 0) r.first = held_places(w->s).first;
  if (task + 1 == pair_task_count(w)) r.last = held_places(w->s).last;
  return r;
}

#ifdef PBF_TRACE_STAGES
#include "cpu/trace.h"
#endif

static inline void stage_end(worker *w, pbf_stage stage) {
#ifdef PBF_TRACE_STAGES
  trace_stage(w, stage);
#endif
  if (!(PBF_BUILT & PBF_FEATURE_TIMING) || !w->s->timing || w->self->thread != 0) return;
  double now = pbf_seconds();
  w->s->seconds[stage] += now - w->stage_begin;
  ++w->s->runs[stage];
  w->stage_begin = now;
}

/* Walls and colliders where they stand at a time, for a caller that is alone with the solver. */
static inline void place_obstacles(solver *s, double time, pbf_obstacles *o) {
  pbf_place_all_obstacles(&s->params, &s->table, s->collider_count, s->collider_time, time,
                          s->schedule.close_phases, o);
}

/* Those that move in the step that begins at a time; of more than a few once they are noted. */
static inline pbf_moving_obstacles moving_obstacles_at(const solver *s, double time) {
  return pbf_still_moving(s->moving_obstacles, s->collider_count, s->table.list,
                          time - s->collider_time, s->table.still_moving);
}
static inline void note_still_moving(const solver *s, double time) {
  pbf_note_still_moving(s->moving_obstacles, s->collider_count, s->table.list,
                        time - s->collider_time, s->table.still_moving);
}

/* What is packed of these sorted particles, where loops over pairs read any (neighbors.h). */
static inline void fill_packed(const solver *s, pbf_real *packed, const field *x,
                               const pbf_real *number, range r) {
  if (s->kernels->pack) s->kernels->pack(*x, number, packed, r.first, r.last);
}

#endif
