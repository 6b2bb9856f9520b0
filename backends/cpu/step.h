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
  uint64_t width = s->kernels->width, bytes = (r.last - r.first) * width * sizeof *s->lambda;
  memset(s->lambda + r.first * width, 0, bytes);
  memset(s->before + r.first * width, 0, bytes);
}

static void find_slack(worker *w) {
  solver *s = w->s;
  range sorted = my_sorted(w), r = w->groups;
  s->kernels->backtrack((pbf_real)s->params.time_step, w->b.spare[2], w->b.spare[3], w->b.spare[0],
                        sorted.first, sorted.last);
  team_barrier(w->me);
  pair_pass pairs = pairs_at(w, w->b.spare[0]);
  s->kernels->density(&pairs, s->slack, s->cells, r.first, r.last);
  s->kernels->slack(&s->constants, s->slack, sorted.first, sorted.last);
  stage_end(w, PBF_STAGE_SLACK);
}

/* Moves x*, which starts as the prediction in spare[2] and is in spare[1] after each iteration. */
static void iterate(worker *w, uint32_t k) {
  solver *s = w->s;
  range r = w->groups;
  pbf_set_iteration(&w->constants, &s->params, k);
  pair_pass pairs = pairs_at(w, w->b.spare[k ? 1 : 2]);
  s->kernels->lambda(&pairs, s->lambda, s->before, r.first, r.last);
  stage_end(w, PBF_STAGE_LAMBDA);
  s->kernels->move(&pairs, &w->obstacles, s->schedule.collide_in_iteration, w->b.spare[2],
                   s->lambda, w->b.spare[0], r.first, r.last);
  swap_fields(&w->b.spare[0], &w->b.spare[1]);
  stage_end(w, PBF_STAGE_MOVE);
}

/* From here nothing can fail, and the old state gives way to the new one. */
static void update_velocity(worker *w) {
  solver *s = w->s;
  range r = my_sorted(w);
  s->kernels->velocity(&w->obstacles, s->schedule.collide_after_solve,
                       (pbf_real)(1 / s->params.time_step), w->b.spare[3], w->b.spare[2],
                       w->b.spare[1], w->b.v, r.first, r.last);
  swap_fields(&w->b.x, &w->b.spare[1]);
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
                      w->b.spare[0], w->b.spare[1], r.first, r.last);
  stage_end(w, PBF_STAGE_PREDICT);
  sort_particles(w, &w->b.spare[0], &w->b.spare[2], &w->b.spare[1], &w->b.spare[3]);
  if (!find_neighbors(w, w->b.spare[2])) return 0;
  stage_end(w, PBF_STAGE_NEIGHBORS);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->schedule.accelerated) clear_totals(w);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->slack) find_slack(w);
  for (uint32_t k = 0; k < s->params.iterations; ++k) iterate(w, k);
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
