/* Part of executor.h: the stages after the solve, which change velocities alone, as tasks of the
 * team's loops. */
#ifndef PBF_CPU_VELOCITIES_H
#define PBF_CPU_VELOCITIES_H

#include "cpu/viscosity.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/shear_stress.h"
#include "physics/passes/surface_tension.h"
#include "physics/passes/viscosity.h"

/* Runs a pass of shear_stress.h for a task's particles that are awake. */
static void shear_awake(const worker *w, uint32_t task,
                        void (*pass)(const pair_pass *p, const shear_pass *s, uint32_t first,
                                     uint32_t last)) {
  const range r = task_groups(w, task);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  const shear_pass shear = {w->s->lambda,
                            w->b.deviator(),
                            {w->b.rest_of_deviator(0), w->b.rest_of_deviator(1)},
                            w->b.shear_push(),
                            w->b.shear_velocity(),
                            w->s->mobility,
                            w->s->mobility_around};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    pass(&pairs, &shear, g.first, g.last);
}

static void deviator_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  pbf_real *const rest[2] = {w->b.rest_of_deviator(0), w->b.rest_of_deviator(1)};
  shear_awake(w, task, w->s->kernels->deviator);
  zero_sleeping(w, task_sorted(w, task), w->b.deviator().c, PBF_DIM);
  zero_sleeping(w, task_sorted(w, task), rest, PBF_DEVIATOR_DIM - PBF_DIM);
}

/* In two dimensions a vector has room for it. */
static void deviators_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pbf_real *const rest[2] = {w->b.rest_of_deviator(0), w->b.rest_of_deviator(1)};
  const range r = task_held(w, task);
  if (PBF_DEVIATOR_DIM > PBF_DIM) fill_packed(w->s, packed_positions(w->s), &w->b.x, rest[0], r);
  fill_packed(w->s, packed_vectors(w->s), &w->b.deviator(),
              PBF_DEVIATOR_DIM > PBF_DIM ? rest[1] : NULL, r);
}

static void shear_push_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range all = task_sorted(w, task);
  const field push = w->b.shear_push();
  shear_awake(w, task, w->s->kernels->shear_push);
  zero_sleeping(w, all, push.c, PBF_DIM);
  if (!w->s->mobility) return;
  for (uint32_t i = all.first; i < all.last; ++i)
    field_set(&push, i, pbf_scaled(field_at(&push, i), w->s->mobility[i]));
  const range held = task_held(w, task);
  for (uint32_t i = held.first; i < held.last; ++i)
    w->s->mobility_around[i] = 1 / w->s->mobility[i];
}

static void shear_pushes_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range r = task_held(w, task);
  fill_packed(w->s, packed_vectors(w->s), &w->b.shear_push(), NULL, r);
  if (w->s->mobility) fill_packed(w->s, packed_positions(w->s), &w->b.x, w->s->mobility_around, r);
}

static void shear_stress_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  shear_awake(w, task, w->s->kernels->shear_stress);
}

static void shear_way_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  change_velocities(w, task, w->b.x, w->b.v, w->b.shear_velocity(), w->b.sheared_x());
}

static void flow_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  smooth_velocities(w, task, PBF_TO_MEAN, w->b.mean_velocity());
}

static pbf_vec change_between(const pair_pass *p, const damping_pass *u, uint32_t i, pbf_vec end,
                              pbf_vec start) {
  const pbf_constants *c = p->constants;
  const pbf_vec x = field_at(&p->x, i), flow = field_at(&u->flow, i);
  const pbf_vec at = pbf_add_scaled(x, -c->flow_time, flow);
  pbf_vec lower = x, upper = x;
  for (int k = 0; k < PBF_DIM; ++k) {
    lower.c[k] = pbf_real_min(x.c[k], at.c[k]);
    upper.c[k] = pbf_real_max(x.c[k], at.c[k]);
  }
  return change_near_obstacles(c, pbf_obstacles_around(*p->contributing, lower, upper, c->h), x,
                               flow, u->lambda[i], end, start);
}

static void compensate_damping_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_groups(w, task);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(s));
  const damping_pass u = {s->lambda,
                          w->forces.inv_time_step,
                          w->b.mean_velocity(),
                          w->b.v,
                          corrects_torque(w) ? &s->torque : NULL,
                          s->mobility,
                          change_between};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->compensate_damping(&pairs, &u, g.first, g.last);
  zero_sleeping(w, task_sorted(w, task), w->b.v.c, PBF_DIM);
}

/* Of mean velocities, and lambda beside the positions. */
static void flows_and_lambda_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_positions(w->s), &w->b.x, w->s->lambda, task_held(w, task));
  fill_packed(w->s, packed_vectors(w->s), &w->b.mean_velocity(), NULL, task_held(w, task));
}

/* Of rates of rotation. */
static void rates_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_vectors(w->s), &w->b.rotation_rate(), NULL, task_held(w, task));
}

static void turn_rate_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  correct_awake(w, task, &pairs, w->s->kernels->angular_rate);
  zero_sleeping(w, task_sorted(w, task), w->b.rotation_rate().c, PBF_DIM);
}

static void turn_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  correct_awake(w, task, &pairs, w->s->kernels->turn);
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
  fill_packed(w->s, packed_curl_sizes(w->s), &w->b.x, curl_sizes(w->s), task_held(w, task));
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

static pbf_real solids_at(const pair_pass *p, uint32_t i) {
  const pbf_vec x = field_at(&p->x, i);
  return pbf_density_of_solids(p->constants,
                               pbf_obstacles_near(*p->contributing, x, p->constants->h), x);
}

/* Runs a pass of surface_tension.h for a task's particles that are awake. */
static void pull_awake(const worker *w, uint32_t task, const pbf_real *packed,
                       void (*pass)(const pair_pass *p, const tension_pass *t, uint32_t first,
                                    uint32_t last)) {
  const range r = task_groups(w, task);
  const pair_pass pairs = pairs_at(w, w->b.x, packed);
  const tension_pass tension = {missing_neighbors_of(w->s), w->b.v, solids_at};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    pass(&pairs, &tension, g.first, g.last);
}

static void missing_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  pbf_real *missing = missing_neighbors_of(w->s);
  pull_awake(w, task, packed_positions(w->s), w->s->kernels->missing_neighbors);
  zero_sleeping(w, task_sorted(w, task), &missing, 1);
}

/* Positions, and what each particle lacks. */
static void packed_missing_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_missing(w->s), &w->b.x, missing_neighbors_of(w->s), task_held(w, task));
}

static void surface_tension_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  pull_awake(w, task, packed_missing(w->s), w->s->kernels->surface_tension);
  zero_sleeping(w, task_sorted(w, task), w->b.v.c, PBF_DIM);
}

template <class Pass>
static void particles_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range all = task_sorted(w, task);
  const Pass pass = Pass::of(&w->s->params);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i)
      field_set(&w->b.v, i, pass.finish(field_at(&w->b.v, i)));
  zero_sleeping(w, all, w->b.v.c, PBF_DIM);
}

#endif
