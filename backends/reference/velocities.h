/* Part of step.h: the stages after the solve, which change velocities. */
#ifndef PBF_REFERENCE_VELOCITIES_H
#define PBF_REFERENCE_VELOCITIES_H

#include "physics/passes/angular_momentum.h"
#include "physics/passes/confinement.h"
#include "physics/passes/curl.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/shear_stress.h"
#include "physics/passes/surface_tension.h"
#include "reference/driver.h"
#include "reference/prediction.h"

/* The deviators, and what walls push with. */
static inline void find_deviators(solver *s, const pbf_obstacles *o) {
  const fabric_pass<int> pass = {&s->constants, s->schedule.features};
  for (uint32_t i = 0; i < s->count; ++i) {
    s->deviator[i] = (pbf_deviator){{0}};
    if (asleep(s, i)) continue;
    auto sums = sums_around(s, pass, s->moved, {}, {}, i);
    add_ghosts(s, pass, o, s->moved, {}, {}, i, &sums);
    pbf_fabric fabric = fabric_of(sums);
    if (s->schedule.wall_density) add_walls(&s->constants, o->domain, s->moved[i], &fabric);
    if (!s->schedule.wall_density || !colliders_contribute(&s->constants, *o, s->moved[i]))
      s->deviator[i] = pass.finish(fabric, s->lambda[i]);
    s->change[i] = fabric.wall;
  }
}

static inline void find_shear_pushes(solver *s) {
  const shear_push_pass<int> pass = {&s->constants, s->schedule.features};
  const pbf_deviator *of = s->deviator;
  for (uint32_t i = 0; i < s->count; ++i) {
    const auto own = lanes_of(of[i]);
    s->change[i] =
        asleep(s, i) ? (pbf_vec){{0}}
                     : pass.finish(sums_around(s, pass, s->moved, of, {own}, i), own, s->change[i]);
  }
}

/* Where phases differ pushes are over masses, which take the place of what the solve has added. */
static inline void correct_shear_stress(solver *s, const pbf_obstacles *o) {
  const bool masses = s->phase != NULL;
  const shear_stress_pass<int> pass = {&s->constants, s->schedule.features, masses};
  const lookups of = {masses ? s->added : NULL, s->change};
  pbf_vec *change = s->predicted; /* of the velocity: the prediction is not asked for any more */
  for (uint32_t i = 0; i < s->count && masses; ++i) {
    s->change[i] = pbf_scaled(s->change[i], s->mobility[i]);
    s->added[i] = 1 / s->mobility[i];
  }
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i))
      change[i] = pass.finish(
          sums_around(s, pass, s->moved, of, {lanes_of(s->change[i]), masses ? s->added[i] : 0}, i),
          s->change[i], masses ? s->mobility[i] : 1);
  change_velocities(s, o, change);
}

/* Changes velocities, and moves by that. */
static inline void apply_friction(solver *s, const pbf_forces &forces, const pbf_obstacles *o) {
  const pbf_friction_scales scales =
      pbf_friction_scales_of(&s->constants, &forces, &s->params, s->table.list);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    const pbf_vec from = s->moved[i], change = rub(s, scales, o, i);
    s->v[i] = pbf_add_scaled(s->v[i], 1, change);
    s->moved[i] = pbf_add_scaled(from, (pbf_real)s->params.time_step, change);
    collide_one(s, o, from, i);
  }
}

static inline void find_flow(solver *s) {
  for (uint32_t i = 0; i < s->count; ++i)
    s->flow[i] = asleep(s, i) ? s->v[i] : smoothed_velocity(s, PBF_TO_MEAN, i);
}

static inline void compensate_damping(solver *s, const pbf_obstacles *o) {
  const pbf_constants *c = &s->constants;
  const pbf_real inv_time_step = (pbf_real)pbf_per_time_step(&s->params);
  const damping_compensation_pass<int> pass = {c, s->schedule.features | PBF_FEATURE_TORQUE};
  const lookups of = {s->lambda, s->flow};
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    const auto sums = sums_around(s, pass, s->moved, of, {s->lambda[i], lanes_of(s->flow[i])}, i);
    for (int k = 0; k < PBF_CURL_DIM && s->torque; ++k) s->torque[i].c[k] -= sums.torque[k];
    pbf_vec change = pass.change(sums);
    if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && s->schedule.wall_density)
      change = change_near_obstacles(c, *o, s->moved[i], s->flow[i], s->lambda[i], vec_of(sums.end),
                                     vec_of(sums.start));
    if (s->phase) change = pbf_scaled(change, s->mobility[i]);
    s->v[i] = pass.finish(inv_time_step, s->v[i], change);
  }
}

static inline void find_turn_rates(solver *s) {
  const rotation_rate_pass pass = {&s->constants};
  for (uint32_t i = 0; i < s->count; ++i)
    s->change[i] = asleep(s, i)
                       ? (pbf_vec){{0}}
                       : pass.finish(sums_around(s, pass, s->moved, {}, {}, i), s->torque[i]);
}

static inline void turn(solver *s) {
  const rotation_pass pass = {&s->constants};
  const lookups of = {NULL, s->change};
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i))
      s->v[i] = pass.finish(sums_around(s, pass, s->moved, of, {lanes_of(s->change[i])}, i),
                            s->v[i], s->phase ? s->mobility[i] : 1);
}

static inline void compute_curl(solver *s) {
  const curl_pass<int> pass = {&s->constants, s->schedule.features};
  for (uint32_t i = 0; i < s->count; ++i) {
    s->curl[i] = (pbf_curl){{0}};
    if (asleep(s, i)) continue;
    auto sums = sums_around(s, pass, s->moved, {NULL, s->v}, {lanes_of(s->v[i])}, i);
    s->curl[i] = pass.finish(sums);
  }
}

static inline void confine_vorticity(solver *s) {
  const confinement_pass<int> pass = {&s->constants, s->schedule.features};
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    auto sums = sums_around(s, pass, s->moved, curl_sizes{s->curl}, {}, i);
    s->v[i] = pass.finish(sums, s->curl[i], s->v[i]);
  }
}

/* Once the solve is over, what it added is not asked for any more. */
static inline void find_missing_neighbors(solver *s, const pbf_obstacles *o) {
  const missing_neighbors_pass pass = {&s->constants};
  for (uint32_t i = 0; i < s->count; ++i) {
    s->added[i] = 0;
    if (asleep(s, i)) continue;
    const pbf_vec x = s->moved[i];
    const pbf_real solids =
        s->schedule.wall_density ? pbf_density_of_solids(&s->constants, *o, x) : 0;
    s->added[i] = pass.finish(sums_around(s, pass, s->moved, {}, {}, i), solids);
  }
}

static inline void apply_surface_tension(solver *s) {
  const surface_tension_pass pass = {&s->constants};
  const lookups of = {s->added, NULL};
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i))
      s->v[i] = pass.finish(sums_around(s, pass, s->moved, of, {s->added[i]}, i), s->v[i]);
}

/* Particles are where they stay. */
static inline void apply_adhesion(solver *s, const pbf_forces &forces, const pbf_obstacles *o) {
  const pbf_adhesion_scales scales =
      pbf_adhesion_scales_of(&s->constants, &forces, &s->params, s->table.list);
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i)) s->v[i] = pbf_add_scaled(s->v[i], 1, adhere(s, scales, o, i, s->added[i]));
}

#endif
