/* Part of executor.h: the stages after the solve, which change velocities alone, as tasks of the
 * team's loops. */
#ifndef PBF_CPU_VELOCITIES_H
#define PBF_CPU_VELOCITIES_H

#include "cpu/solve.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/drag.h"
#include "physics/passes/viscosity.h"

static void flow_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  smooth_velocities(w, task, PBF_TO_MEAN, w->b.mean_velocity());
}

static pbf_vec change_between(const pair_pass *p, const undamp_pass *u, uint32_t i, pbf_vec end,
                              pbf_vec start) {
  return change_near_obstacles(p->constants, *p->contributing, field_at(&p->x, i),
                               field_at(&u->flow, i), u->lambda[i], end, start);
}

static void compensate_damping_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(s));
  const undamp_pass u = {s->lambda,
                         w->forces.inv_time_step,
                         w->b.mean_velocity(),
                         w->b.v,
                         corrects_torque(w) ? &s->torque : NULL,
                         change_between};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->compensate_damping(&pairs, &u, g.first, g.last);
  zero_sleeping(w, task_sorted(w, task), w->b.v.c, PBF_DIM);
}

/* Of mean velocities, and lambda beside the positions. */
static void flows_and_lambda_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_positions(w->s), &w->b.x, w->s->lambda, task_sorted(w, task));
  fill_packed(w->s, packed_vectors(w->s), &w->b.mean_velocity(), NULL, task_sorted(w, task));
}

/* Of rates of rotation. */
static void rates_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_vectors(w->s), &w->b.rotation_rate(), NULL, task_sorted(w, task));
}

static void turn_rate_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  turn_awake(w, task, &pairs, w->s->kernels->turn_rate);
  zero_sleeping(w, task_sorted(w, task), w->b.rotation_rate().c, PBF_DIM);
}

static void turn_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  turn_awake(w, task, &pairs, w->s->kernels->turn);
  zero_sleeping(w, task_sorted(w, task), w->b.v.c, PBF_DIM);
}

static void curl_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_groups(w, task);
  pbf_real *sizes = curl_sizes(w->s);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    w->s->kernels->curl(&pairs, w->b.v, w->b.curl().c, sizes, g.first, g.last);
  zero_sleeping(w, task_sorted(w, task), w->b.curl().c, PBF_CURL_DIM);
  zero_sleeping(w, task_sorted(w, task), &sizes, 1);
}

/* Positions, and the sizes of curls. */
static void sizes_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_curl_sizes(w->s), &w->b.x, curl_sizes(w->s), task_sorted(w, task));
}

static void confine_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.x, packed_curl_sizes(w->s));
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->confine(&pairs, w->b.curl().c, curl_sizes(s), w->b.v, g.first, g.last);
  zero_sleeping(w, task_sorted(w, task), w->b.v.c, PBF_DIM);
}

static void xsph_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  smooth_velocities(w, task, w->constants.viscosity, w->b.smoothed_velocity());
}

static void viscous_stress_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range groups = task_groups(w, task);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  const pbf_viscosity_weights weights = pbf_viscosity_weights_of(&w->constants, w->viscosity_stage);
  for (range g = awake_groups(w, groups.first, groups.last); g.first < g.last;
       g = awake_groups(w, g.last, groups.last))
    w->s->kernels->viscous_stress(&pairs, &weights, w->b.v, w->b.smoothed_velocity(), g.first,
                                  g.last);
  zero_sleeping(w, task_sorted(w, task), w->b.smoothed_velocity().c, PBF_DIM);
}

static void drag_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range all = task_sorted(w, task);
  const drag_pass pass = drag_of(&w->s->params);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i)
      field_set(&w->b.v, i, pass.finish(field_at(&w->b.v, i)));
  zero_sleeping(w, all, w->b.v.c, PBF_DIM);
}

#endif
