/* Part of step.h: the stages of physics/step.h as loops of the team. */
#ifndef PBF_CPU_EXECUTOR_H
#define PBF_CPU_EXECUTOR_H

#include "cpu/load_shares.h"
#include "cpu/pressure_grid.h"
#include "cpu/sleep.h"
#include "cpu/solve.h"
#include "cpu/sort.h"
#include "cpu/step_ranks.h"
#include "cpu/velocities.h"
#include "cpu/viscosity.h"
#include "physics/step.h"

/* To the images in the domain. */
static void move_inside(const worker *w, const field *x, range particles) {
  const pbf_periods periods = pbf_periods_of(&w->s->params);
  for (uint32_t i = particles.first; i < particles.last; ++i)
    field_set(x, i, pbf_image_inside(&periods, field_at(x, i)));
}

static void end_inside_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  move_inside(w, &w->b.x, task_particles(w, task));
}

/* With what accelerations of particles' own make of them. */
static const field &velocities_to_predict(const worker *w, range r) {
  const field &to = w->b.accelerated_velocity();
  if (!has_accelerations(w)) return w->b.v;
  for (uint32_t i = r.first; i < r.last; ++i) field_set(&to, i, accelerated_velocity(w, i));
  return to;
}

static void predict_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range all = task_particles(w, task);
  const field &v = velocities_to_predict(w, all);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    w->s->kernels->predict(&w->forces, &w->obstacles, w->s->schedule.collide_after_prediction,
                           w->b.x, v, w->b.predicted(), w->b.predicted_velocity(), r.first, r.last);
  if (w->s->params.periodic) move_inside(w, &w->b.predicted(), all);
  copy_sleeping(w, all, &w->b.x, &w->b.predicted());
  zero_sleeping(w, all, w->b.predicted_velocity().c, PBF_DIM);
  find_bounds(w, task);
}

static void end_predict(void *context) {
  const worker *w = static_cast<const worker *>(context);
  if (finds_loads(w->s)) pbf_clear_load_sums(w->s->load_tally);
  make_grid(context);
}

namespace {

namespace {

/* All threads of the team come to all of its loops. */
struct executor {
  worker *w;
  bool sorted;    /* the step has come as far as that, … */
  uint64_t nth;   /* step of its length */
  bool solved;    /* … or to where x* is x */
  bool moved;     /* and others' x has not followed it */
  late_pass late; /* on ranks: step_ranks.h */

  void over_pairs(task_function task, completion_function last = NULL) {
    parallel_for(w->self, pair_task_count(w), task, last, w);
  }
  void over_pairs(task_function task, pbf_stage stage) {
    over_pairs(task);
    stage_end(w, stage);
  }

  /* Where ranks exchange what comes of it next: what others hold first, the rest meanwhile. */
  void over_edges(task_function task) {
    if (!has_edges(w->s)) return over_pairs(task);
    task(w, LOWER_EDGE);
    task(w, UPPER_EDGE);
    late = {task, w->b, w->iteration};
  }

  /* What loops over pairs read is packed for them (neighbors.h): positions and lambda by the tasks
   * that find them, while they are in the cache, the others here. */
  void exchange(int fields) {
    if (has_ranks(w->s)) exchange_with_ranks(w, fields, solved, moved, &late);
    if (fields & FIELD_VELOCITY) pack_vectors(w, velocities_task);
    if (fields & FIELD_MEAN_VELOCITY) pack_vectors(w, flows_and_lambda_task);
    if (fields & FIELD_DEVIATOR) pack_vectors(w, deviators_task);
    if (fields & FIELD_SHEAR_PUSH) pack_vectors(w, shear_pushes_task);
    if (fields & FIELD_CORRECTION_RATE) pack_vectors(w, rates_task);
    if (fields & FIELD_CURL_SIZE) pack_positions(w, sizes_task);
    if (fields & FIELD_CROWDING) pack_vectors(w, packed_crowding_task);
    if (fields & FIELD_VISCOUS_CHANGE) pack_vectors(w, viscous_changes_task);
    if (fields & FIELD_MISSING) pack_positions(w, packed_missing_task);
  }

  bool wake() {
    if (!sorted && sleep_is_on(w) && pbf_any_obstacle_moves(w->moving_obstacles))
      parallel_for(w->self, particle_task_count(w), wake_task, NULL, w);
    return true; /* steps of none awake are not begun: steps_asleep */
  }
  void predict() {
    if (sorted) return;
    parallel_for(w->self, particle_task_count(w), predict_task, end_predict, w);
    stage_end(w, PBF_STAGE_PREDICT);
  }
  bool find_neighbors() {
    if (!sorted && !sort_step(w)) return false;
    w->activity = w->b.sorted_activity;
    w->sleeping_lambda = w->b.sorted_sleeping_lambda;
    if (!sorted && notes_pushes(w->s) && !w->sort_push)
      parallel_for(w->self, range_tasks(w), push_task, NULL, w);
    if (!::find_neighbors(w, has_pressure_grid(w) ? end_search_with_grid : end_search))
      return false;
    if (corrects_torque(w)) over_pairs(start_task);
    stage_end(w, PBF_STAGE_NEIGHBORS);
    return true;
  }
  void residual_density() { find_residual_density(w); }
  void overlap() { find_overlap(w); }
  void crowding() {
    over_pairs(viscous_start_task);
    over_pairs(crowding_task);
  }
  void viscosity(uint32_t k) {
    const bool before_solve = w->s->schedule.accelerated;
    w->viscosity_stage = k;
    over_pairs(before_solve ? viscous_stress_task : xsph_task);
    if (before_solve)
      w->b.accept_viscous_stage();
    else
      w->b.accept_smoothed_velocity();
    stage_end(w, PBF_STAGE_VISCOSITY);
  }
  /* Where lambda is looked up then, what is no neighbour is far away again. */
  void move_by_viscosity() {
    if (finds_loads(w->s) && w->s->schedule.no_slip) over_pairs(no_slip_loads_task);
    over_pairs(viscous_way_task, w->s->kernels->pack ? end_positions : NULL);
    w->b.accept_viscous_prediction();
  }
  void begin_solve() {}
  void pressure_grid() { solve_pressure_grid(w); }
  bool is_converged(uint32_t) const { return false; } /* see ::is_converged */
  void begin_iteration(uint32_t k) {
    w->iteration = k;
    pbf_set_iteration(&w->constants, k);
  }
  void lambda(uint32_t) {
    if (has_convergence_check(w->s))
      over_pairs(checked_lambda_task, end_when_converged);
    else
      over_edges(lambda_task);
    stage_end(w, PBF_STAGE_LAMBDA);
  }
  void torque_deficit(uint32_t) { over_pairs(torque_task, PBF_STAGE_TORQUE); }
  void move(uint32_t k) {
    over_edges(has_convergence_check(w->s) ? checked_move_task : move_task);
    w->b.accept_iteration();
    stage_end(w, PBF_STAGE_MOVE);
    w->iteration = k + 1;
  }
  void velocity() {
    update_velocity(w);
    solved = true;
    moved = velocity_moves(w->s);
  }
  bool shear_stress_is_due() const { return pbf_shear_stress_is_due(nth); }
  void deviator() { over_pairs(deviator_task, PBF_STAGE_DEVIATOR); }
  void shear_push() { over_pairs(shear_push_task, PBF_STAGE_SHEAR_PUSH); }
  void correct_shear_stress() {
    over_pairs(shear_stress_task);
    over_pairs(shear_way_task);
    w->b.accept_sheared_x();
    moved = true;
    stage_end(w, PBF_STAGE_SHEAR_STRESS);
  }
  void mean_velocity() { over_pairs(flow_task, PBF_STAGE_MEAN_VELOCITY); }
  void compensate_damping() { over_pairs(compensate_damping_task, PBF_STAGE_DAMPING_COMPENSATION); }
  void correction_rate() { over_pairs(turn_rate_task, PBF_STAGE_CORRECTION_RATE); }
  void correct_angular_momentum() { over_pairs(turn_task, PBF_STAGE_ANGULAR_MOMENTUM); }
  void friction() {
    over_pairs(friction_task);
    w->b.accept_sheared_x();
    moved = true;
    stage_end(w, PBF_STAGE_FRICTION);
  }
  void loads() {
    if (has_grid_pressure(w)) over_pairs(grid_loads_task);
    over_pairs(loads_task, end_loads_of_step);
    stage_end(w, PBF_STAGE_LOADS);
  }
  void curl() { over_pairs(curl_task, PBF_STAGE_CURL); }
  void confine() { over_pairs(confine_task, PBF_STAGE_CONFINE); }
  void missing_neighbors() { over_pairs(missing_task); }
  void surface_tension() {
    over_pairs(surface_tension_task);
    if (w->s->schedule.adhesion) over_pairs(adhesion_task);
    stage_end(w, PBF_STAGE_SURFACE_TENSION);
  }
  template <class Pass>
  void over_particles(pbf_stage stage) {
    over_pairs(particles_task<Pass>, stage);
  }
  bool update_sleep() { return ::update_sleep(w); }
  void end() {
    if (has_ranks(w->s)) keep_own(w);
    if (w->s->params.periodic)
      parallel_for(w->self, particle_task_count(w), end_inside_task, NULL, w);
  }
};

}  // namespace

}  // namespace

#endif
