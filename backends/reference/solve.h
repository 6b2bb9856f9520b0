/* Part of step.h: the density solve, from what is left of the last step's error to the velocities
 * that it ends with. */
#ifndef PBF_REFERENCE_SOLVE_H
#define PBF_REFERENCE_SOLVE_H

#include "physics/passes/density.h"
#include "physics/passes/lambda.h"
#include "physics/passes/mobility.h"
#include "physics/passes/move.h"
#include "physics/passes/overlap.h"
#include "physics/passes/pressure_fit.h"
#include "physics/passes/smooth_pressure.h"
#include "physics/passes/torque.h"
#include "reference/driver.h"
#include "reference/pressure_grid.h"
#include "reference/prediction.h"

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
  const auto sums = sums_around(s, pass, s->x, {s->lambda, NULL}, {}, i);
  return pass.finish(pass.line(sums, s->lambda[i]), s->lambda[i]);
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
  const pbf_fluid_bounds around = bounds_of(s->moved, s->count);
  s->pressure_grid.cell_moves = s->cell_moves.sums;
  pbf_pressure_grid_begin(&s->pressure_grid, &s->topology_memory, &s->params,
                          s->schedule.corrects_shear, time, s->capacity, s->planned, &around, o,
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

#endif
