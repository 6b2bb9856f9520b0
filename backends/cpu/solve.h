/* Part of executor.h: the stages of the solve, from the step's start to its velocities, as tasks
 * of the team's loops. */
#ifndef PBF_CPU_SOLVE_H
#define PBF_CPU_SOLVE_H

#include "cpu/lists.h"
#include "cpu/loads.h"
#include "physics/passes/lambda.h"
#include "physics/passes/overlap.h"
#include "physics/passes/smooth_pressure.h"

/* Lambda of all iterations starts from nothing in each step. */
static void clear_totals(solver *s, range groups) {
  uint64_t width = s->kernels->width;
  uint64_t bytes = (groups.last - groups.first) * width * sizeof *s->lambda;
  memset(s->lambda + groups.first * width, 0, bytes);
  memset(s->added + groups.first * width, 0, bytes);
}

static void forget_clear(const solver *s, pbf_real *ways, range groups) {
  const uint64_t width = s->kernels->width;
  memset(ways + groups.first * width, 0, (groups.last - groups.first) * width * sizeof *ways);
}

static const field &x_star(const worker *w) { return w->b.x_star(w->iteration); }

/* Pairs of the solve. */
static pair_pass pairs_at_x_star(const worker *w, const pbf_real *packed) {
  pair_pass pairs = pairs_at(w, x_star(w), packed);
  pairs.mobility = w->s->mobility;
  if (w->iteration + 1 == w->s->params.iterations) pairs.last_pressure = last_pressures(w->s);
  if (pairs.contributing && pbf_surface_count(w->obstacles))
    pairs.clear = (clear_ways){w->b.clear_ways_of(), w->iteration == 0, w->b.sorted_predicted};
  pairs.boundary = (boundary_cache){w->b.boundary_gradient(), w->b.boundary_rest()};
  return pairs;
}

static void backtrack_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_held(w, task);
  w->s->kernels->backtrack(w->forces.time_step, w->b.sorted_predicted, w->b.sorted_velocity,
                           w->b.step_start(), r.first, r.last);
  fill_packed(w->s, packed_vectors(w->s), &w->b.step_start(), NULL, r);
}

/* What is left of an overlap counts, too. */
static void add_overlap(const worker *w, range r) {
  pbf_real *residual = w->s->residual_density;
  const pbf_real *overlap = w->b.sorted_overlap;
  for (uint32_t i = r.first; i < r.last && overlap; ++i)
    residual[i] = pbf_real_max(residual[i], overlap[i]);
}

static void residual_density_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_sorted(w, task);
  find_densities(w, task_groups(w, task), &w->before, w->b.step_start(), packed_vectors(s),
                 s->residual_density);
  s->kernels->residual_density(&w->constants, s->residual_density, r.first, r.last);
  add_overlap(w, r);
}

static void find_residual_density(worker *w) {
  parallel_for(w->self, pair_task_count(w), backtrack_task, NULL, w);
  parallel_for(w->self, pair_task_count(w), residual_density_task, NULL, w);
  stage_end(w, PBF_STAGE_RESIDUAL_DENSITY);
}

/* In the first of the steps that the team runs alone. */
static int finds_overlap(const worker *w) { return w->step == 0 && w->s->found.struct_size; }

/* What has been placed, at the start of the step. */
static void placed_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_held(w, task);
  pbf_real *placed = w->b.is_placed();
  s->kernels->backtrack(w->forces.time_step, w->b.sorted_predicted, w->b.sorted_velocity,
                        w->b.step_start(), r.first, r.last);
  for (uint32_t i = r.first; i < r.last; ++i)
    placed[i] =
        pbf_placed_number(s->found, s->entering, w->b.sorted_ids[i], w->b.sorted_overlap[i]);
  fill_packed(s, packed_vectors(s), &w->b.step_start(), placed, r);
}

static pbf_real placed_density_of_solids(const worker *w, uint32_t i, pbf_vec x) {
  const pbf_constants *c = &w->constants;
  return placed_boundary(c, pbf_obstacles_near(w->before, x, c->h), w->s->found, w->s->table.placed,
                         x, 0, pbf_enters(w->s->entering, w->b.sorted_ids[i]));
}

static void find_overlap_of(const worker *w, range groups) {
  const solver *s = w->s;
  const field start = w->b.step_start();
  const range r = particles_of(w, groups);
  pbf_real *density = s->added, *placed = w->b.placed_density(), *stream = w->b.stream_density();
  find_densities(w, groups, &w->before, start, packed_vectors(s), density);
  const pair_pass pairs = pairs_at(w, start, packed_vectors(s));
  for (range g = solving_groups(w, groups.first, groups.last); g.first < g.last;
       g = solving_groups(w, g.last, groups.last))
    s->kernels->placed_density(&pairs, w->b.is_placed(), placed, stream, g.first, g.last);
  for (uint32_t i = r.first; i < r.last; ++i) {
    if (pairs.activity && pbf_is_inactive(pairs.activity[i])) continue;
    if (pairs.contributing) placed[i] += placed_density_of_solids(w, i, field_at(&start, i));
    w->b.sorted_overlap[i] =
        pbf_overlap_found(&w->constants, s->found, s->entering, w->b.sorted_ids[i], density[i],
                          placed[i], stream[i], w->b.sorted_overlap[i]);
  }
}

/* Whether no more is to be found than what particles have been placed upon. */
static bool only_particles_are_placed(const solver *s) {
  const pbf_overlap *found = &s->found;
  bool alone = !found->walls && !found->colliders && !(found->part < 0 || found->part > 0);
  for (uint32_t word = 1; word < pbf_words_of(s->collider_count); ++word)
    alone = alone && !s->table.placed[word - 1];
  return alone;
}

/* Whether some of a group have been placed, or one that has may be near them: what is allowed for
 * of others does not change then. Nor of those that only sleep, which have no neighbours listed. */
static bool placed_reach_group(const worker *w, const pair_pass *pairs, uint32_t g) {
  const range r = particles_of(w, {g, g + 1});
  if (solving_groups(w, g, g + 1).first > g) return false;
  for (uint32_t i = r.first; i < r.last; ++i)
    if (w->b.is_placed()[i] != 0) return true;
  return w->s->kernels->any_number_around(pairs, w->b.is_placed(), g);
}

static void overlap_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range groups = task_groups(w, task);
  const pair_pass pairs = pairs_at(w, w->b.step_start(), packed_vectors(w->s));
  const bool near_placed = only_particles_are_placed(w->s);
  for (uint32_t first = groups.first, last; first < groups.last; first = last + 1) {
    for (last = first; last < groups.last && (!near_placed || placed_reach_group(w, &pairs, last));)
      ++last;
    if (last > first) find_overlap_of(w, {first, last});
  }
}

/* Of what is still inside a solid. */
static void overlap_in_solids_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const range r = task_sorted(w, task);
  for (uint32_t i = r.first; i < r.last; ++i) {
    const pbf_vec x = field_at(&w->b.sorted_predicted, i);
    w->b.sorted_overlap[i] =
        pbf_overlap_at(pbf_obstacles_near(w->obstacles, x, 0), x, w->b.sorted_overlap[i]);
  }
}

static void find_overlap(worker *w) {
  if (finds_overlap(w)) {
    parallel_for(w->self, pair_task_count(w), placed_task, NULL, w);
    parallel_for(w->self, pair_task_count(w), overlap_task, NULL, w);
  }
  if (w->s->schedule.collide_after_prediction && pbf_surface_count(w->obstacles))
    parallel_for(w->self, pair_task_count(w), overlap_in_solids_task, NULL, w);
  stage_end(w, PBF_STAGE_OVERLAP);
}

/* What an iteration moves particles by, of each particle. */
static const pbf_real *pushes_of(const solver *s) {
  return s->schedule.accelerated ? s->added : s->lambda;
}

/* Returns how many do not solve. */
static uint32_t find_lambda(const worker *w, const pair_pass *pairs, uint32_t task) {
  solver *s = w->s;
  range r = task_groups(w, task), all = task_sorted(w, task);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->schedule.accelerated && w->iteration == 0)
    clear_totals(s, r);
  if (pairs->clear.first) forget_clear(s, pairs->clear.of, r);
  for (range g = solving_groups(w, r.first, r.last); g.first < g.last;
       g = solving_groups(w, g.last, r.last))
    s->kernels->lambda(pairs, s->lambda, s->added, g.first, g.last);
  uint32_t inactive = clear_inactive(w, all);
  fill_packed(s, packed_lambda(s), &pairs->x, pushes_of(s), all);
  return inactive;
}

static void lambda_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  pair_pass pairs = pairs_at_x_star(w, packed_positions(w->s));
  find_lambda(w, &pairs, task);
}

/* Whether the solve has ended before this iteration. A thread can be late for any number of loops,
 * so none may know this between them: all go through the loops of all iterations, and find nothing
 * to do in those. */
static int is_converged(const worker *w) {
  return w->iteration > 0 && w->s->over && w->s->iterations <= w->iteration;
}

static momentum_pass turns_of(const worker *w) {
  const solver *s = w->s;
  return (momentum_pass){pushes_of(s),         s->start, s->torque,
                         w->b.rotation_rate(), w->b.v,   s->mobility};
}

static void start_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_held(w, task);
  s->kernels->backtrack(w->forces.time_step, w->b.sorted_predicted, w->b.sorted_velocity, s->start,
                        r.first, r.last);
  fill_packed(s, s->packed_start, &s->start, NULL, r);
  for (int k = 0; k < PBF_CURL_DIM; ++k)
    memset(s->torque.c[k] + r.first, 0, (r.last - r.first) * sizeof(pbf_real));
}

/* A pass of the correction of angular momentum over the groups of a task. */
static void correct_awake(const worker *w, uint32_t task, const pair_pass *pairs,
                          void (*pass)(const pair_pass *p, const momentum_pass *t, uint32_t first,
                                       uint32_t last)) {
  range r = task_groups(w, task);
  const momentum_pass turns = turns_of(w);
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    pass(pairs, &turns, g.first, g.last);
}

static void torque_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  pair_pass pairs = pairs_at_x_star(w, packed_lambda(w->s));
  if (is_converged(w)) return;
  pairs.vectors = w->s->packed_start;
  correct_awake(w, task, &pairs, w->s->kernels->torque);
}

static void move_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_groups(w, task), all = task_sorted(w, task);
  pair_pass pairs = pairs_at_x_star(w, packed_lambda(s));
  const move_pass m = {pushes_of(s),
                       w->b.sorted_ids,
                       w->b.sorted_overlap,
                       &w->obstacles,
                       s->schedule.collide_in_iteration,
                       w->forces.inv_time_step,
                       w->b.sorted_predicted,
                       w->b.next_x_star(),
                       w->b.sorted_velocity,
                       notes_pushes(s) ? &s->push : NULL,
                       s->mobility};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->move(&pairs, &m, g.first, g.last);
  copy_sleeping(w, all, &w->b.sorted_predicted, &w->b.next_x_star());
  fill_packed(s, packed_positions(s), &w->b.next_x_star(), s->mobility, all);
}

static void checked_lambda_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  if (is_converged(w)) return;
  pair_pass pairs = pairs_at_x_star(w, packed_positions(w->s));
  int64_t error_units = 0;
  pairs.error_units = &error_units;
  int64_t inactive = find_lambda(w, &pairs, task);
  w->s->error_units[task] = error_units + inactive * pbf_inactive_error_units(&w->s->params);
}

/* Once lambda is known, and with it the density error that the iteration has found. */
static void end_when_converged(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  int64_t sum = 0;
  if (is_converged(w)) return;
  for (uint32_t task = 0; task < pair_task_count(w); ++task) sum += s->error_units[task];
  if (has_ranks(s)) sum = sum_of_ranks(s, sum);
  s->iterations = w->iteration + 1;
  s->over = sum <= pbf_error_units_limit(&s->params, particles_of_all(s));
}

static void checked_move_task(void *context, uint32_t task) {
  if (!is_converged((const worker *)context)) move_task(context, task);
}

/* Where the solve has ended with an odd number of iterations to go, x* is in the other buffer. */
static void fetch_x_star(const worker *w, range particles) {
  const solver *s = w->s;
  if ((s->params.iterations - s->iterations) % 2 == 0) return;
  for (int k = 0; k < PBF_DIM; ++k)
    memcpy(x_star(w).c[k] + particles.first, w->b.next_x_star().c[k] + particles.first,
           (particles.last - particles.first) * sizeof(pbf_real));
}

/* Whether torques are made up for. */
static int corrects_torque(const worker *w) {
  return (PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION) &&
         w->s->schedule.runs[PBF_STAGE_ANGULAR_MOMENTUM];
}

static int has_convergence_check(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_TOLERANCE) && s->schedule.checks_convergence;
}

/* Of the step, for the next one: what it has taken over is no longer needed. */
static void keep_pressure(const worker *w, range r) {
  pbf_real *kept = w->s->last_pressure;
  for (uint32_t i = r.first; i < r.last && kept; ++i)
    kept[i] = pbf_pressure_to_keep(&w->constants, w->s->lambda[i]);
}

static void velocity_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = task_sorted(w, task);
  if (has_convergence_check(s)) fetch_x_star(w, all);
  if (notes_pushes(s)) begin_noting(s, &w->b.sorted_velocity, all);
  for (range r = awake_particles(w, all.first, all.last);
       s->schedule.collide_after_solve && r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    s->kernels->collide(&w->obstacles, w->forces.inv_time_step, w->b.sorted_predicted, x_star(w),
                        w->b.sorted_velocity, r.first, r.last);
  zero_sleeping(w, all, w->b.sorted_velocity.c, PBF_DIM);
  zero_woken_velocity(w, all, &w->b.sorted_velocity);
  if (notes_pushes(s)) end_noting(s, &w->b.sorted_velocity, all);
  keep_sleeping_lambda(w, all);
  keep_pressure(w, all);
  if (s->schedule.collide_after_solve) fill_packed(s, packed_positions(s), &x_star(w), NULL, all);
}

static void count_skipped(void *context) {
  const worker *w = static_cast<const worker *>(context);
  if (w->s->timing) w->s->skipped += w->s->params.iterations - w->s->iterations;
}

/* From here nothing can fail. */
static void update_velocity(worker *w) {
  parallel_for(w->self, pair_task_count(w), velocity_task,
               has_convergence_check(w->s) ? count_skipped : NULL, w);
  w->b.accept_step();
  stage_end(w, PBF_STAGE_VELOCITY);
}

#endif
