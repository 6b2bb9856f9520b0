/* Part of backend.cpp: Algorithm 1 of Macklin & Müller 2013, stage by stage. The equations are in
 * physics/. */
#ifndef PBF_REFERENCE_STEP_H
#define PBF_REFERENCE_STEP_H

#include "physics/step.h"
#include "reference/solve.h"
#include "reference/velocities.h"
#include "reference/viscosity.h"

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

/* The nth step of its length. */
static inline void solver_step(solver *s, double begin, double end, uint64_t nth) {
  executor e = {s, begin, end, nth, obstacles_at(s, end), obstacles_at(s, begin, s->table.before),
                0, false};
  run_step(e, s->schedule);
}

#endif
