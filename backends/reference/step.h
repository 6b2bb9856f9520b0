/* Part of backend.cpp: Algorithm 1 of Macklin & Müller 2013, stage by stage. The equations are in
 * physics/. */
#ifndef PBF_REFERENCE_STEP_H
#define PBF_REFERENCE_STEP_H

#include "physics/passes/angular_momentum.h"
#include "physics/passes/confinement.h"
#include "physics/passes/curl.h"
#include "physics/passes/damping_compensation.h"
#include "physics/passes/density.h"
#include "physics/passes/lambda.h"
#include "physics/passes/mobility.h"
#include "physics/passes/move.h"
#include "physics/passes/overlap.h"
#include "physics/passes/torque.h"
#include "physics/passes/predict.h"
#include "physics/passes/shear_stress.h"
#include "physics/passes/smooth_pressure.h"
#include "physics/passes/surface_tension.h"
#include "physics/passes/pressure_fit.h"
#include "physics/passes/velocity.h"
#include "physics/passes/viscous_stress.h"
#include "physics/step.h"
#include "reference/driver.h"
#include "reference/loads.h"
#include "reference/pressure_grid.h"
#include "reference/sleep.h"

/* Particles on their way from `from` to x*; from before the obstacles moved where
 * `with_obstacle_motion`. */
static inline void collide_all(const solver *s, const pbf_obstacles *o, int with_obstacle_motion,
                               const pbf_vec *from) {
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i))
      s->moved[i] = pbf_resolve_collisions(*o, with_obstacle_motion, from[i], s->moved[i]);
}

/* And once the velocity is that of x*. */
static inline void collide_one(const solver *s, const pbf_obstacles *o, pbf_vec from, uint32_t i) {
  const pbf_vec x = pbf_resolve_collisions(*o, 0, from, s->moved[i]), before = s->v[i];
  s->v[i] = pbf_velocity((pbf_real)pbf_per_time_step(&s->params), before, s->moved[i], x);
  s->moved[i] = x;
  note_push(s, i, pbf_sub(s->v[i], before));
}

static inline void collide_moving(const solver *s, const pbf_obstacles *o) {
  for (uint32_t i = 0; i < s->count; ++i)
    if (!asleep(s, i)) collide_one(s, o, s->predicted[i], i);
}

/* A step that leaves the domain by a face begins an image away. */
static inline void begin_inside(solver *s) {
  const pbf_periods periods = pbf_periods_of(&s->params);
  for (uint32_t i = 0; i < s->count && periods.any; ++i) {
    const pbf_vec left = s->predicted[i];
    s->moved[i] = s->predicted[i] = pbf_image_inside(&periods, left);
    s->x[i] = pbf_add_scaled(s->x[i], 1, pbf_sub(s->predicted[i], left));
  }
}

static inline void accelerate(solver *s, const pbf_forces *forces) {
  for (uint32_t i = 0; i < s->count && s->acceleration; ++i)
    if (!asleep(s, i)) s->v[i] = pbf_add_acceleration(forces, s->v[i], s->acceleration[i]);
}

static inline void predict(solver *s, double time, const pbf_obstacles *o) {
  pbf_forces forces = pbf_forces_of(&s->params, time);
  accelerate(s, &forces);
  for (uint32_t i = 0; i < s->count; ++i)
    s->moved[i] = asleep(s, i) ? s->x[i] : pbf_predict(&forces, s->x[i], s->v[i]);
  if (s->schedule.collide_after_prediction) collide_all(s, o, 1, s->x);
  begin_loads(s);
  for (uint32_t i = 0; i < s->count; ++i) {
    s->predicted[i] = s->moved[i];
    if (asleep(s, i)) continue;
    pbf_vec free = pbf_predict(&forces, s->x[i], s->v[i]);
    const pbf_vec forced = pbf_apply_forces(&forces, s->x[i], s->v[i]);
    s->v[i] = pbf_predicted_velocity(&forces, s->x[i], s->v[i], free, s->predicted[i]);
    begin_push(s, &forces, i, forced);
  }
  begin_inside(s);
}

/* What walls and colliders add to the density of particle i at x, and to its gradient. */
static inline void add_boundary(const solver *s, const pbf_obstacles *o, pbf_vec x,
                                pbf_real *density, pbf_vec *gradient) {
  if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && s->schedule.wall_density)
    pbf_add_boundary_at(&s->constants, *o, x, density, gradient);
}

/* rho/rho0 of particle i at x[i], positions sorted into s->grid; adds up its neighbours. */
static inline pbf_real density_at(const solver *s, const pbf_obstacles *o, const pbf_vec *x,
                                  uint32_t i, uint32_t *neighbors) {
  const density_pass<int> pass = {&s->constants, s->schedule.features};
  auto sums = sums_around(s, pass, x, {}, {}, i, neighbors);
  pbf_vec gradient = {{0}};
  add_boundary(s, o, x[i], &sums.density, &gradient);
  add_ghosts(s, pass, o, x, {}, {}, i, &sums);
  return sums.density;
}

static inline pbf_real solver_density(const solver *s, const pbf_obstacles *o, uint32_t i,
                                      uint32_t *neighbors) {
  return density_at(s, o, s->x, i, neighbors);
}

/* Lambda of the last step where particle i stands, positions sorted into s->grid. */
static inline pbf_real fitted_lambda(const solver *s, uint32_t i) {
  const pressure_fit_pass pass = {&s->constants};
  return pass.finish(sums_around(s, pass, s->x, {s->lambda, NULL}, {}, i), s->lambda[i]);
}

/* From the positions at the start of the step, between the obstacles of that time. */
static inline void compute_residual_density(solver *s, const pbf_obstacles *o) {
  for (uint32_t i = 0; i < s->count; ++i)
    s->residual_density[i] = pbf_residual_density(&s->constants, density_at(s, o, s->x, i, NULL));
}

/* From the positions at the start of the step, between the obstacles of that time. */
static inline void add_found_overlap(solver *s, const pbf_obstacles *o) {
  const pbf_constants *c = &s->constants;
  const placed_density_pass<int> pass = {c, s->schedule.features};
  for (uint32_t i = 0; i < s->count; ++i)
    s->lambda[i] = pbf_placed_number(s->found, s->entering, s->ids[i], s->overlap[i]);
  for (uint32_t i = 0; i < s->count; ++i) {
    const auto sums = sums_around(s, pass, s->x, {s->lambda, NULL}, {}, i);
    pbf_real placed = sums.density;
    if (s->schedule.wall_density)
      placed += placed_boundary(c, *o, s->found, s->table.placed, s->x[i], 0,
                                pbf_enters(s->entering, s->ids[i]));
    s->overlap[i] =
        pbf_overlap_found(c, s->found, s->entering, s->ids[i], density_at(s, o, s->x, i, NULL),
                          placed, sums.stream, s->overlap[i]);
  }
}

/* Begins with what is left of the overlap so far. `before`: the obstacles at the step's start. */
static inline void find_overlap(solver *s, const pbf_obstacles *before, const pbf_obstacles *o) {
  for (uint32_t i = 0; i < s->count; ++i)
    s->overlap[i] = pbf_overlap_left(s->constants.overlap_decay, s->overlap[i]);
  if (s->found.struct_size) add_found_overlap(s, before);
  for (uint32_t i = 0; i < s->count && s->schedule.collide_after_prediction; ++i)
    s->overlap[i] = pbf_overlap_at(*o, s->moved[i], s->overlap[i]);
}

/* Deep water: what its weight presses together is undone before the iterations. */
static inline void solve_pressure_grid(solver *s, double time, const pbf_obstacles *o) {
  pbf_real inv_time_step = (pbf_real)(1 / s->params.time_step);
  s->pressure_grid.cell_moves = s->cell_moves.sums;
  pbf_pressure_grid_begin(&s->pressure_grid, &s->topology_memory, &s->params,
                          s->schedule.corrects_shear, time, s->capacity, s->planned, o,
                          s->table.divided);
  s->pressure_grid.carried = s->constants.phases.carried;
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_real target = s->constants.target;
    pressure_grid_add(&s->pressure_grid, s->moved[i], target,
                      inactive(s, i) ? target : density_at(s, o, s->moved, i, NULL),
                      s->overlap ? s->overlap[i] : 0);
    if (s->pressure_grid.cell_moves)
      pressure_grid_add_move(&s->pressure_grid, s->moved[i], s->v[i],
                             s->acceleration ? s->acceleration[i] : (pbf_vec){{0}});
  }
  pressure_grid_solve(&s->pressure_grid, o);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    pbf_vec u = pressure_grid_move(&s->pressure_grid, s->moved[i]);
    if (s->phase) u = pbf_scaled(u, (pbf_real)s->pressure_grid.carried * s->mobility[i]);
    if (s->schedule.collide_after_prediction && pbf_surface_count(*o))
      u = pbf_move_past_obstacles(*o, s->moved[i], u);
    s->v[i] = pbf_add_scaled(s->v[i], inv_time_step, u);
    s->predicted[i] = s->moved[i] = pbf_add_scaled(s->moved[i], 1, u);
  }
  pressure_grid_find_datum(&s->pressure_grid);
}

/* lambda once the step is over, and with it the pressure: all of it. */
static inline void add_weight(solver *s) {
  pbf_real inv_time_step = (pbf_real)(1 / s->params.time_step);
  for (uint32_t i = 0; i < s->count; ++i)
    s->lambda[i] += pbf_pressure_grid_particle_lambda(&s->pressure_grid, s->constants.pressure,
                                                      inv_time_step, s->moved[i]);
}

/* Of particle i in this iteration, where phases differ. */
static inline pbf_real mobility_around(const solver *s, uint32_t i) {
  const mobility_pass<int> pass = {&s->constants, s->schedule.features};
  return pass.finish(sums_around(s, pass, s->moved, {s->mobility, NULL}, {}, i), s->mobility[i]);
}

/* Returns the density error, where it is wanted, in pbf_error_units's units. `last_pressure` is
 * null before the last iteration. */
static inline int64_t compute_lambda(solver *s, const pbf_obstacles *o,
                                     const pbf_real *last_pressure) {
  const pbf_constants *c = &s->constants;
  const lambda_pass<int, SCALED_PAIRS> pass = {c, s->schedule.features};
  int64_t error_units = 0;
  for (uint32_t i = 0; i < s->count; ++i) {
    if (inactive(s, i)) {
      error_units += pbf_inactive_error_units(&s->params);
      continue;
    }
    auto sums = sums_around(s, pass, s->moved, {}, {}, i);
    pbf_vec gradient = vec_of(sums.gradient);
    add_boundary(s, o, s->moved[i], &sums.density, &gradient);
    sums.gradient = lanes_of(gradient);
    add_ghosts(s, pass, o, s->moved, {}, {}, i, &sums);
    pbf_real residual_density = s->residual_density ? s->residual_density[i] : 0;
    if (s->overlap && s->residual_density)
      residual_density = pbf_real_max(residual_density, s->overlap[i]);
    else if (s->overlap)
      residual_density = s->overlap[i];
    const pbf_real lambda = pass.finish(sums, residual_density);
    if ((PBF_BUILT & PBF_FEATURE_TOLERANCE) && s->schedule.checks_convergence)
      error_units += pbf_error_units(c, residual_density, sums.density);
    if (s->overlap) s->overlap[i] = pbf_overlap_of_error(s->overlap[i], sums.density - c->target);
    const pbf_real mobility = s->phase ? mobility_around(s, i) : 1;
    if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->schedule.accelerated)
      pbf_accelerate_for(c, mobility, sums.density, lambda, &s->lambda[i], &s->added[i]);
    else
      s->lambda[i] = pbf_lambda_for(mobility, lambda);
    if (last_pressure) pbf_smooth_pressure(c, last_pressure[i], &s->lambda[i], &s->added[i]);
  }
  return error_units;
}

/* Before the move that it is of. */
static inline void add_torques(solver *s) {
  const torque_pass<int> pass = {&s->constants, s->schedule.features};
  const lookups of = {s->added, s->x};
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    torque_pass<int>::sums<pbf_real> sums;
    for (int k = 0; k < PBF_CURL_DIM; ++k) sums.torque[k] = s->torque[i].c[k];
    add_neighbors(s, pass, s->moved, of, {s->added[i], lanes_of(s->x[i])}, i, &sums);
    s->torque[i] = curl_of(sums.torque);
  }
}

static inline void move(solver *s, const pbf_obstacles *o) {
  const pbf_constants *c = &s->constants;
  const move_pass_of<int, SCALED_PAIRS> pass = {c, s->schedule.features};
  const lookups of = {s->schedule.accelerated ? s->added : s->lambda, NULL};
  const pbf_real inv_time_step = (pbf_real)pbf_per_time_step(&s->params);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    auto sums = sums_around(s, pass, s->moved, of, {of.number[i]}, i);
    pbf_vec pairs = vec_of(sums.change);
    add_ghosts(s, pass, o, s->moved, of, {of.number[i]}, i, &sums);
    s->change[i] = vec_of(sums.change);
    if ((PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && s->schedule.wall_density) {
      pbf_boundary boundary = pbf_boundary_at(c, *o, s->moved[i]);
      s->change[i] = pbf_boundary_correction(s->change[i], of.number[i], &boundary);
    }
    if (s->phase) pairs = pbf_scaled(pairs, s->mobility[i]);
    if (s->phase) s->change[i] = pbf_scaled(s->change[i], s->mobility[i]);
    note_push(s, i, pbf_push(c, inv_time_step, {{0}}, pbf_sub(s->change[i], pairs)));
  }
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    auto x = lanes_of(s->moved[i]), v = lanes_of(s->v[i]);
    pass.finish<pbf_real>({lanes_of(s->change[i])}, inv_time_step, &x, &v);
    s->moved[i] = pbf_break_symmetry(c, of.number[i], s->overlap && s->overlap[i] > 0, s->change[i],
                                     s->ids[i], vec_of(x));
    s->v[i] = vec_of(v);
  }
}

static inline void end_solve(solver *s, const pbf_obstacles *o) {
  for (uint32_t i = 0; i < s->count && sleeps(s); ++i)
    if (asleep(s, i))
      s->lambda[i] = s->held[i];
    else
      s->held[i] = s->lambda[i];
  for (uint32_t i = 0; i < s->count && s->last_pressure; ++i)
    s->last_pressure[i] = pbf_pressure_to_keep(&s->constants, s->lambda[i]);
  if (s->schedule.collide_after_solve) collide_moving(s, o);
  for (uint32_t i = 0; i < s->count; ++i)
    if (just_woke(s, i)) {
      note_push(s, i, pbf_sub({{0}}, s->v[i]));
      s->v[i] = (pbf_vec){{0}};
    }
}

/* And what walls push with. */
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

/* And moves by that. */
static inline void change_velocities(solver *s, const pbf_obstacles *o, const pbf_vec *change) {
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    const pbf_vec from = s->moved[i];
    s->v[i] = pbf_add_scaled(s->v[i], 1, change[i]);
    s->moved[i] = pbf_add_scaled(from, (pbf_real)s->params.time_step, change[i]);
    collide_one(s, o, from, i);
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

static inline void apply_xsph(solver *s) {
  for (uint32_t i = 0; i < s->count; ++i)
    s->change[i] = asleep(s, i) ? s->v[i] : smoothed_velocity(s, s->constants.viscosity, i);
  memcpy(s->v, s->change, s->count * sizeof *s->v);
}

/* Sums over the pairs that are near each other at the prediction, as lists have them, of a pass
 * that looks at them where they came from. */
template <class Pass>
static inline typename Pass::template sums<pbf_real> sums_before(
    const solver *s, const Pass &pass, const lookups &of,
    const typename Pass::template own<pbf_real> &own, uint32_t i) {
  auto sums = pass.template begin<pbf_real>();
  neighbor n = neighbors_of(&s->grid, i);
  while (next_neighbor(&s->grid, s->moved, s->constants.h2, &n)) {
    neighbor before = n;
    before.x_ij = pbf_sub(s->x[i], s->x[n.j]);
    if (s->grid.periods.any) before.x_ij = pbf_add_scaled(before.x_ij, 1, n.image);
    before.r2 = pbf_dot(before.x_ij, before.x_ij);
    pass.pair(&sums, own, looked_up(before, of));
  }
  return sums;
}

/* Before the solve what it adds is not there yet: what crowding leaves out is. */
static inline void find_crowding(solver *s) {
  const crowding_pass pass = {&s->constants};
  for (uint32_t i = 0; i < s->count; ++i) {
    s->added[i] = asleep(s, i) ? 0 : pass.finish(sums_before(s, pass, {}, {}, i));
    if (s->phase) s->added[i] = pbf_left_out(&s->constants.phases, s->phase[i], s->added[i]);
  }
}

/* Stage k, from the state at the step's start, the velocities of the prediction and, of the last
 * stages, s->change: in s->predicted, which is not asked for until it is made anew, are the changes
 * after stage k - 2, and then those after k. */
static inline void apply_viscous_stress(solver *s, const pbf_obstacles *o, uint32_t k) {
  const viscous_stress_pass pass = {&s->constants};
  const pbf_viscosity_weights weights = pbf_viscosity_weights_of(&s->constants, k);
  const pbf_no_slip no_slip = pbf_no_slip_of(&s->params, s->table.list);
  const pbf_vec *of = weights.first ? s->v : s->change;
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_vec none = {{0}}, change = weights.first ? none : s->change[i];
    const pbf_vec before = weights.first ? none : s->predicted[i];
    s->predicted[i] = none;
    if (asleep(s, i)) continue;
    const auto sums = sums_before(s, pass, {s->added, of}, {s->added[i], lanes_of(of[i])}, i);
    pbf_viscous_system system =
        pass.system(sums, weights.first ? none : pbf_sub(s->viscous_force[i], change),
                    s->phase ? pbf_viscous_scale(&s->constants.phases, s->phase[i]) : 1);
    const int with_solids =
        s->schedule.no_slip &&
        add_no_slip(&s->constants, *o, no_slip, weights.first != 0, s->x[i], of[i], &system,
                    s->phase ? s->constants.phases.viscosity[s->phase[i]] : 1);
    if (weights.first) s->viscous_force[i] = system.residual;
    s->predicted[i] = pass.finish(system, with_solids, weights, change, before);
  }
  for (uint32_t i = 0; i < s->count; ++i) {
    const pbf_vec next = s->predicted[i];
    s->predicted[i] = weights.first ? (pbf_vec){{0}} : s->change[i];
    s->change[i] = next;
  }
}

static inline void apply_viscosity(solver *s, const pbf_obstacles *o, uint32_t k) {
  if (s->schedule.accelerated)
    apply_viscous_stress(s, o, k);
  else
    apply_xsph(s);
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

namespace {

namespace {

/* Stages as loops over all particles. */
struct executor {
  solver *s;
  double began, ends;              /* times */
  uint64_t nth;                    /* step of its length */
  pbf_obstacles obstacles, before; /* at the end of the step, and at its start */
  int64_t limit;
  bool over;

  void exchange(int) {} /* neighbours are read where they are, ghosts found where they are needed */

  bool wake() {
    if (!sleeps(s)) return true;
    wake_near_moving(s, moving_obstacles_at(s, began), ends);
    if (sleepers(s) < s->count) return true;
    if (finds_loads(s)) pbf_repeat_loads(s->load_tally, 1, s->params.time_step);
    return false;
  }
  void predict() { ::predict(s, began, &obstacles); }
  bool find_neighbors() {
    grid_build(&s->grid, &s->params, grid_cell_limit(s->count), s->count, s->moved);
    if (sleeps(s)) find_sleeping_boundary(s);
    if (s->torque) memset(s->torque, 0, s->count * sizeof *s->torque);
    for (uint32_t i = 0; i < s->count && s->phase; ++i)
      s->mobility[i] = s->constants.phases.mobility[s->phase[i]];
    return true;
  }
  void residual_density() { compute_residual_density(s, &before); }
  void overlap() { find_overlap(s, &before, &obstacles); }
  void crowding() { find_crowding(s); }
  void viscosity(uint32_t k) { apply_viscosity(s, &obstacles, k); }
  void move_by_viscosity() {
    if (finds_loads(s) && s->schedule.no_slip)
      find_no_slip_loads(s, pbf_forces_of(&s->params, began), &obstacles);
    change_velocities(s, &obstacles, s->change);
    memcpy(s->predicted, s->moved, s->count * sizeof *s->predicted);
  }
  void begin_solve() {
    for (uint32_t i = 0; i < s->count; ++i)
      if (inactive(s, i) || s->schedule.accelerated) s->lambda[i] = 0;
    if (s->schedule.accelerated) memset(s->added, 0, s->count * sizeof *s->added);
    limit = s->schedule.checks_convergence ? pbf_error_units_limit(&s->params, s->count) : -1;
    over = false;
    s->iterations = 0;
  }
  void pressure_grid() { solve_pressure_grid(s, ends, &obstacles); }
  bool is_converged(uint32_t) const { return over; }
  void begin_iteration(uint32_t k) { pbf_set_iteration(&s->constants, k); }
  void lambda(uint32_t k) {
    const pbf_real *last = k + 1 == s->params.iterations ? s->last_pressure : NULL;
    over = compute_lambda(s, &obstacles, last) <= limit;
  }
  void torque_deficit(uint32_t) { add_torques(s); }
  void move(uint32_t k) {
    ::move(s, &obstacles);
    if (s->schedule.collide_in_iteration) collide_moving(s, &obstacles);
    s->iterations = k + 1;
  }
  void velocity() { end_solve(s, &obstacles); }
  bool shear_stress_is_due() const { return pbf_shear_stress_is_due(nth); }
  void deviator() { find_deviators(s, &obstacles); }
  void shear_push() { find_shear_pushes(s); }
  void correct_shear_stress() { ::correct_shear_stress(s, &obstacles); }
  void mean_velocity() { find_flow(s); }
  void compensate_damping() { ::compensate_damping(s, &obstacles); }
  void correction_rate() { find_turn_rates(s); }
  void correct_angular_momentum() { ::turn(s); }
  void friction() { apply_friction(s, pbf_forces_of(&s->params, began), &obstacles); }
  void loads() { find_loads(s, pbf_forces_of(&s->params, began), &obstacles); }
  void curl() { compute_curl(s); }
  void confine() { confine_vorticity(s); }
  void missing_neighbors() { find_missing_neighbors(s, &obstacles); }
  void surface_tension() {
    apply_surface_tension(s);
    if (s->schedule.adhesion) apply_adhesion(s, pbf_forces_of(&s->params, began), &obstacles);
  }
  template <class Pass>
  void over_particles(pbf_stage) {
    const Pass pass = Pass::of(&s->params);
    for (uint32_t i = 0; i < s->count; ++i)
      if (!asleep(s, i)) s->v[i] = pass.finish(s->v[i]);
  }
  bool update_sleep() {
    ::update_sleep(s);
    return false;
  }
  void end() {
    if (runs<PBF_STAGE_GRID>(s->schedule) && s->schedule.accelerated) add_weight(s);
    memcpy(s->x, s->moved, s->count * sizeof *s->x);
    const pbf_periods periods = pbf_periods_of(&s->params);
    for (uint32_t i = 0; i < s->count && periods.any; ++i)
      s->x[i] = pbf_image_inside(&periods, s->x[i]);
  }
};

}  // namespace

}  // namespace

/* The nth step of its length. */
static inline void solver_step(solver *s, double begin, double end, uint64_t nth) {
  executor e = {s, begin, end, nth, obstacles_at(s, end), obstacles_at(s, begin, s->table.before),
                0, false};
  run_step(e, s->schedule);
}

#endif
