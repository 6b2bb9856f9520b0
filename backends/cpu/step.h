/* Algorithm 1 in the order of physics/schedule.h, run by every thread of the team. */
#ifndef PBF_CPU_STEP_H
#define PBF_CPU_STEP_H

#include "cpu/lists.h"
#include "cpu/sort.h"

typedef struct step_job {
  solver *s;
  double time;
  uint32_t steps, done;
} step_job;

/* Lambda of all iterations starts from nothing in each step. */
static void clear_totals(worker *w) {
  solver *s = w->s;
  range r = w->groups;
  uint64_t width = s->kernels->width, bytes = (r.last - r.first) * width * sizeof *s->total;
  memset(s->total + r.first * width, 0, bytes);
  memset(s->before + r.first * width, 0, bytes);
}

/* One solver iteration moves the prediction from spare[2] to spare[0], and swaps them. */
static void iterate(worker *w, double weight) {
  solver *s = w->s;
  range r = w->groups;
  pair_pass pairs = pairs_at(w, w->b.spare[2]);
  acceleration accelerated = {(pbf_real)weight, s->total, s->before};
  s->kernels->lambda(&pairs, accelerated, s->lambda, r.first, r.last);
  stage_end(w, PBF_STAGE_LAMBDA);
  s->kernels->move(&pairs, &w->obstacles, s->schedule.collide_in_iteration, s->lambda,
                   w->b.spare[0], r.first, r.last);
  swap_fields(&w->b.spare[0], &w->b.spare[2]);
  stage_end(w, PBF_STAGE_MOVE);
}

/* Positions before the step are in spare[1], after it in spare[2]. From here nothing can fail, and
 * the old state gives way to the new one. */
static void update_velocity(worker *w) {
  solver *s = w->s;
  range r = my_sorted(w);
  s->kernels->velocity(&w->obstacles, s->schedule.collide_after_solve,
                       (pbf_real)(1 / s->params.time_step), w->b.spare[1], w->b.spare[2], w->b.v,
                       r.first, r.last);
  swap_fields(&w->b.x, &w->b.spare[2]);
  uint32_t *ids = w->b.ids;
  w->b.ids = w->b.spare_ids;
  w->b.spare_ids = ids;
  stage_end(w, PBF_STAGE_VELOCITY);
}

static void confine_vorticity(worker *w) {
  solver *s = w->s;
  range r = w->groups;
  pair_pass pairs = pairs_at(w, w->b.x);
  pbf_real *curl[PBF_CURL_DIM];
  for (int k = 0; k < PBF_CURL_DIM; ++k) curl[k] = w->b.spare[0].c[k];
  s->kernels->curl(&pairs, w->b.v, curl, s->lambda, r.first, r.last);
  stage_end(w, PBF_STAGE_CURL);
  s->kernels->confine(&pairs, (pbf_real)(s->params.time_step * s->params.vorticity), curl,
                      s->lambda, w->b.v, r.first, r.last);
  stage_end(w, PBF_STAGE_CONFINE);
}

static void smooth_velocity(worker *w) {
  range r = w->groups;
  pair_pass pairs = pairs_at(w, w->b.x);
  w->s->kernels->viscosity(&pairs, w->b.v, w->b.spare[1], r.first, r.last);
  swap_fields(&w->b.v, &w->b.spare[1]);
  stage_end(w, PBF_STAGE_VISCOSITY);
}

/* 0 when the memory for the neighbours is lacking; the state is then as before. */
static int step_once(worker *w, double time) {
  solver *s = w->s;
  pbf_forces forces = pbf_forces_of(&s->params);
  range r = my_particles(w);
  if ((PBF_BUILT & PBF_FEATURE_TIMING) && s->timing) w->stage_begin = seconds_now();
  place_obstacles(w, time + s->params.time_step);
  s->kernels->predict(&forces, &w->obstacles, s->schedule.collide_after_prediction, w->b.x, w->b.v,
                      w->b.spare[0], r.first, r.last);
  stage_end(w, PBF_STAGE_PREDICT);
  sort_particles(w, &w->b.spare[0], &w->b.spare[2], &w->b.x, &w->b.spare[1]);
  if (!find_neighbors(w, w->b.spare[2])) return 0;
  stage_end(w, PBF_STAGE_NEIGHBORS);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->total) clear_totals(w);
  double weight = 1;
  for (uint32_t k = 0; k < s->params.iterations; ++k)
    iterate(w, weight = pbf_next_weight(&s->constants, k, weight));
  update_velocity(w);
  if ((PBF_BUILT & PBF_FEATURE_VORTICITY) && s->schedule.runs[PBF_STAGE_CURL]) confine_vorticity(w);
  if ((PBF_BUILT & PBF_FEATURE_VISCOSITY) && s->schedule.runs[PBF_STAGE_VISCOSITY])
    smooth_velocity(w);
  return 1;
}

static void run_steps(void *context, member *me) {
  step_job *job = context;
  worker w = worker_of(job->s, me);
  uint32_t done = 0;
  while (done < job->steps && step_once(&w, job->time + done * job->s->params.time_step)) ++done;
  team_barrier(me);
  if (me->thread != 0) return;
  job->s->buffers = w.b;
  job->s->now = job->time + done * job->s->params.time_step;
  job->done = done;
}

#endif
