/* Part of executor.h: viscosity, before the solve, as tasks of the team's loops. */
#ifndef PBF_CPU_VISCOSITY_H
#define PBF_CPU_VISCOSITY_H

#include "cpu/load_shares.h"
#include "cpu/solve.h"
#include "physics/no_slip_loads.h"

/* What the velocities v of particles at x change by moves these at once, to `to`. */
static void change_velocities(const worker *w, uint32_t task, const field &x, const field &v,
                              const field &change, const field &to) {
  const range all = task_sorted(w, task);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last)) {
    for (uint32_t i = r.first; i < r.last; ++i) {
      const pbf_vec more = field_at(&change, i);
      field_set(&v, i, pbf_add_scaled(field_at(&v, i), 1, more));
      field_set(&to, i, pbf_add_scaled(field_at(&x, i), w->forces.time_step, more));
    }
    if (notes_pushes(w->s)) begin_noting(w->s, &v, r);
    w->s->kernels->collide(&w->obstacles, w->forces.inv_time_step, x, to, v, r.first, r.last);
    if (notes_pushes(w->s)) end_noting(w->s, &v, r);
  }
  copy_sleeping(w, all, &x, &to);
  fill_packed(w->s, packed_positions(w->s), &to, w->s->mobility, all);
}

/* Where particles have come from, at which viscosity looks at them. */
static void viscous_start_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range all = task_held(w, task);
  w->s->kernels->backtrack(w->forces.time_step, w->b.sorted_predicted, w->b.sorted_velocity,
                           w->b.step_start(), all.first, all.last);
  fill_packed(w->s, packed_positions(w->s), &w->b.step_start(), NULL, all);
}

static void crowding_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range groups = task_groups(w, task);
  const pair_pass pairs = pairs_at(w, w->b.step_start(), packed_positions(w->s));
  pbf_real *left_out = crowding_of(w->s);
  for (range g = awake_groups(w, groups.first, groups.last); g.first < g.last;
       g = awake_groups(w, g.last, groups.last))
    w->s->kernels->crowding(&pairs, left_out, g.first, g.last);
  const range all = task_sorted(w, task);
  zero_sleeping(w, all, &left_out, 1);
  for (uint32_t i = all.first; i < all.last && w->b.sorted_phase; ++i)
    left_out[i] = pbf_left_out(&w->constants.phases, w->b.sorted_phase[i], left_out[i]);
}

/* With where particles have come from, and the velocities of the prediction. */
static void packed_crowding_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range all = task_held(w, task);
  fill_packed(w->s, packed_positions(w->s), &w->b.step_start(), crowding_of(w->s), all);
  fill_packed(w->s, packed_vectors(w->s), &w->b.sorted_velocity, NULL, all);
}

static void viscous_changes_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_vectors(w->s), &w->b.viscous_change(), NULL, task_held(w, task));
}

static void viscous_stress_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range groups = task_groups(w, task), all = task_sorted(w, task);
  const pair_pass pairs = pairs_at(w, w->b.step_start(), packed_positions(w->s));
  const solver *s = w->s;
  const pbf_no_slip no_slip = pbf_no_slip_of(&s->params, s->table.list);
  const viscous_pass pass = {pbf_viscosity_weights_of(&w->constants, w->viscosity_stage),
                             s->schedule.no_slip ? &w->obstacles : NULL,
                             &no_slip,
                             crowding_of(s),
                             w->b.sorted_phase,
                             w->b.sorted_velocity,
                             w->b.viscous_force(),
                             w->b.viscous_change(),
                             w->b.next_viscous_change()};
  for (range g = awake_groups(w, groups.first, groups.last); g.first < g.last;
       g = awake_groups(w, g.last, groups.last))
    w->s->kernels->viscous_stress(&pairs, &pass, g.first, g.last);
  zero_sleeping(w, all, w->b.viscous_change().c, PBF_DIM);
  zero_sleeping(w, all, w->b.next_viscous_change().c, PBF_DIM);
}

/* What solids take of it, once it is known what velocities change by. */
static void no_slip_loads_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const solver *s = w->s;
  const pbf_load_scales scales = pbf_load_scales_of(&w->constants, &w->forces, &s->params);
  const pbf_no_slip no_slip = pbf_no_slip_of(&s->params, s->table.list);
  const range all = task_sorted(w, task);
  recent_loads loads(w, &scales);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i) {
      const pbf_vec x = field_at(&w->b.step_start(), i),
                    v = pbf_add_scaled(field_at(&w->b.sorted_velocity, i), 1,
                                       field_at(&w->b.viscous_change(), i));
      const pbf_obstacles near = pbf_obstacles_near(w->obstacles, x, w->constants.h);
      share_no_slip(
          &w->constants, near, no_slip, x, v,
          [&](const pbf_load_plane &plane, const load_share &share) {
            loads.add_beside(plane, x, s->mobility ? with_mass(share, s->mobility[i]) : share);
          },
          w->b.sorted_phase ? w->constants.phases.viscosity[w->b.sorted_phase[i]] : 1);
    }
  loads.end();
}

static void viscous_way_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  change_velocities(w, task, w->b.sorted_predicted, w->b.sorted_velocity, w->b.viscous_change(),
                    w->b.viscous_prediction());
}

#endif
