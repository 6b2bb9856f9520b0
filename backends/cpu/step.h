/* Algorithm 1 in the order of physics/schedule.h, run by every thread of the team. */
#ifndef PBF_CPU_STEP_H
#define PBF_CPU_STEP_H

#include "cpu/pressure_grid.h"
#include "cpu/sleep.h"
#include "cpu/sort.h"
#include "physics/overfull.h"
#include "physics/passes/lambda.h"
#include "physics/passes/predict.h"
#include "physics/passes/viscosity.h"
#include "physics/passes/drag.h"
#include "physics/step.h"
#include "physics/passes/damping_compensation.h"

typedef struct step_job {
  solver *s;
  double time;
  uint32_t steps, done;
  int sorted;        /* the next step has come as far as that */
  uint32_t reached;  /* step, by the team's run, */
  step_outcome last; /* and how that ended */
  buffers after;     /* it */
} step_job;

static void predict_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  range all = piece_particles(w, piece);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    w->s->kernels->predict(&w->forces, &w->obstacles, w->s->schedule.collide_after_prediction,
                           w->b.x, w->b.v, w->b.predicted(), w->b.predicted_velocity(), r.first,
                           r.last);
  keep_places(w, all, &w->b.x, &w->b.predicted());
  keep_still(w, all, w->b.predicted_velocity().c, PBF_DIM);
  find_bounds(w, piece);
}

/* Lambda of all iterations starts from nothing in each step. */
static void clear_totals(solver *s, range groups) {
  uint64_t width = s->kernels->width;
  uint64_t bytes = (groups.last - groups.first) * width * sizeof *s->lambda;
  memset(s->lambda + groups.first * width, 0, bytes);
  memset(s->added + groups.first * width, 0, bytes);
}

static const field &x_star(const worker *w) { return w->b.x_star(w->iteration); }

/* Pairs of the solve. */
static pair_pass pairs_at_x_star(const worker *w, const pbf_real *packed) {
  pair_pass pairs = pairs_at(w, x_star(w), packed);
  pairs.lent = (walls_lent){w->b.boundary_gradient(), w->b.boundary_rest()};
  return pairs;
}

static void backtrack_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  range r = piece_sorted(w, piece);
  w->s->kernels->backtrack(w->forces.time_step, w->b.sorted_predicted, w->b.sorted_velocity,
                           w->b.step_start(), r.first, r.last);
  fill_packed(w->s, packed_vectors(w->s), &w->b.step_start(), NULL, r);
}

static void slack_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = piece_sorted(w, piece);
  find_densities(w, piece, &w->before, w->b.step_start(), packed_vectors(s), s->slack);
  s->kernels->slack(&w->constants, s->slack, r.first, r.last);
}

static void find_slack(worker *w) {
  team_for(w->me, pair_pieces(w), backtrack_piece, NULL, w);
  team_for(w->me, pair_pieces(w), slack_piece, NULL, w);
  stage_end(w, PBF_STAGE_SLACK);
}

/* What an iteration moves particles by, of each particle. */
static const pbf_real *pushes_of(const solver *s) {
  return s->schedule.accelerated ? s->added : s->lambda;
}

/* Returns how many do not solve. */
static uint32_t find_lambda(const worker *w, const pair_pass *pairs, uint32_t piece) {
  solver *s = w->s;
  range r = piece_groups(w, piece), all = piece_sorted(w, piece);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->schedule.accelerated && w->iteration == 0)
    clear_totals(s, r);
  for (range g = solving_groups(w, r.first, r.last); g.first < g.last;
       g = solving_groups(w, g.last, r.last))
    s->kernels->lambda(pairs, s->lambda, s->added, g.first, g.last);
  uint32_t idle = clear_idle(w, all);
  fill_packed(s, packed_lambda(s), &pairs->x, pushes_of(s), all);
  return idle;
}

static void lambda_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  pair_pass pairs = pairs_at_x_star(w, packed_positions(w->s));
  find_lambda(w, &pairs, piece);
}

/* Whether the solve has ended before this iteration. A thread can be late for any number of loops,
 * so none may know this between them: all go through the loops of all iterations, and find nothing
 * to do in those. */
static int is_over(const worker *w) {
  return w->iteration > 0 && w->s->over && w->s->iterations <= w->iteration;
}

static turn_pass turns_of(const worker *w) {
  const solver *s = w->s;
  return (turn_pass){pushes_of(s), s->start, s->torque, w->b.rotation_rate(), w->b.v};
}

static void start_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = piece_sorted(w, piece);
  s->kernels->backtrack(w->forces.time_step, w->b.sorted_predicted, w->b.sorted_velocity, s->start,
                        r.first, r.last);
  fill_packed(s, s->packed_start, &s->start, NULL, r);
  for (int k = 0; k < PBF_CURL_DIM; ++k)
    memset(s->torque.c[k] + r.first, 0, (r.last - r.first) * sizeof(pbf_real));
}

/* A pass of the correction of angular momentum over the groups of a piece. */
static void turn_awake(const worker *w, uint32_t piece, const pair_pass *pairs,
                       void (*pass)(const pair_pass *p, const turn_pass *t, uint32_t first,
                                    uint32_t last)) {
  range r = piece_groups(w, piece);
  const turn_pass turns = turns_of(w);
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    pass(pairs, &turns, g.first, g.last);
}

static void torque_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  pair_pass pairs = pairs_at_x_star(w, packed_lambda(w->s));
  if (is_over(w)) return;
  pairs.vectors = w->s->packed_start;
  turn_awake(w, piece, &pairs, w->s->kernels->torque);
}

static void move_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = piece_groups(w, piece), all = piece_sorted(w, piece);
  pair_pass pairs = pairs_at_x_star(w, packed_lambda(s));
  const move_pass m = {pushes_of(s),
                       &w->obstacles,
                       s->schedule.collide_in_iteration,
                       w->forces.inv_time_step,
                       w->b.sorted_predicted,
                       w->b.next_x_star(),
                       w->b.sorted_velocity};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->move(&pairs, &m, g.first, g.last);
  keep_places(w, all, &w->b.sorted_predicted, &w->b.next_x_star());
  fill_packed(s, packed_positions(s), &w->b.next_x_star(), NULL, all);
}

static void watched_lambda_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  if (is_over(w)) return;
  pair_pass pairs = pairs_at_x_star(w, packed_positions(w->s));
  int64_t excess = 0;
  pairs.excess = &excess;
  int64_t idle = find_lambda(w, &pairs, piece);
  w->s->excess[piece] = excess + idle * pbf_idle_excess(&w->s->params);
}

/* Once lambda is known, and with it the density error that the iteration has found. */
static void end_when_small(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  int64_t sum = 0;
  if (is_over(w)) return;
  for (uint32_t piece = 0; piece < pair_pieces(w); ++piece) sum += s->excess[piece];
  s->iterations = w->iteration + 1;
  s->over = sum <= pbf_excess_limit(&s->params, s->count);
}

static void watched_move_piece(void *context, uint32_t piece) {
  if (!is_over((const worker *)context)) move_piece(context, piece);
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
  return (PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION) && w->s->schedule.runs[PBF_STAGE_TURN];
}

static int is_watched(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_TOLERANCE) && s->schedule.watched;
}

static void velocity_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = piece_sorted(w, piece);
  if (is_watched(s)) fetch_x_star(w, all);
  for (range r = awake_particles(w, all.first, all.last);
       s->schedule.collide_after_solve && r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    s->kernels->collide(&w->obstacles, w->forces.inv_time_step, w->b.sorted_predicted, x_star(w),
                        w->b.sorted_velocity, r.first, r.last);
  keep_still(w, all, w->b.sorted_velocity.c, PBF_DIM);
  calm_woken(w, all, &w->b.sorted_velocity);
  keep_lambda(w, all);
  if (s->schedule.collide_after_solve) fill_packed(s, packed_positions(s), &x_star(w), NULL, all);
}

static void count_skipped(void *context) {
  const worker *w = static_cast<const worker *>(context);
  if (w->s->timing) w->s->skipped += w->s->params.iterations - w->s->iterations;
}

/* From here nothing can fail. */
static void update_velocity(worker *w) {
  team_for(w->me, pair_pieces(w), velocity_piece, is_watched(w->s) ? count_skipped : NULL, w);
  w->b.accept_step();
  stage_end(w, PBF_STAGE_VELOCITY);
}

static void flow_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  smooth_velocities(w, piece, PBF_TO_MEAN, w->b.mean_velocity());
}

static pbf_vec change_between(const pair_pass *p, const undamp_pass *u, uint32_t i, pbf_vec end,
                              pbf_vec start) {
  return change_near_obstacles(p->constants, &p->walls->walls, pbf_solid_count(p->walls),
                               p->walls->solids, field_at(&p->x, i), field_at(&u->flow, i),
                               u->lambda[i], end, start);
}

static void undamp_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(s));
  const undamp_pass u = {s->lambda,
                         w->forces.inv_time_step,
                         w->b.mean_velocity(),
                         w->b.v,
                         corrects_torque(w) ? &s->torque : NULL,
                         change_between};
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->undamp(&pairs, &u, g.first, g.last);
  keep_still(w, piece_sorted(w, piece), w->b.v.c, PBF_DIM);
}

/* Of mean velocities, and lambda beside the positions. */
static void flows_and_lambda_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_positions(w->s), &w->b.x, w->s->lambda, piece_sorted(w, piece));
  fill_packed(w->s, packed_vectors(w->s), &w->b.mean_velocity(), NULL, piece_sorted(w, piece));
}

/* Of rates of rotation. */
static void rates_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_vectors(w->s), &w->b.rotation_rate(), NULL, piece_sorted(w, piece));
}

static void turn_rate_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  turn_awake(w, piece, &pairs, w->s->kernels->turn_rate);
  keep_still(w, piece_sorted(w, piece), w->b.rotation_rate().c, PBF_DIM);
}

static void turn_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  const pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  turn_awake(w, piece, &pairs, w->s->kernels->turn);
  keep_still(w, piece_sorted(w, piece), w->b.v.c, PBF_DIM);
}

static void curl_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  range r = piece_groups(w, piece);
  pbf_real *sizes = curl_sizes(w->s);
  pair_pass pairs = pairs_at(w, w->b.x, packed_positions(w->s));
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    w->s->kernels->curl(&pairs, w->b.v, w->b.curl().c, sizes, g.first, g.last);
  keep_still(w, piece_sorted(w, piece), w->b.curl().c, PBF_CURL_DIM);
  keep_still(w, piece_sorted(w, piece), &sizes, 1);
}

/* Positions, and the sizes of curls. */
static void sizes_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  fill_packed(w->s, packed_curl_sizes(w->s), &w->b.x, curl_sizes(w->s), piece_sorted(w, piece));
}

static void confine_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.x, packed_curl_sizes(w->s));
  for (range g = awake_groups(w, r.first, r.last); g.first < g.last;
       g = awake_groups(w, g.last, r.last))
    s->kernels->confine(&pairs, w->b.curl().c, curl_sizes(s), w->b.v, g.first, g.last);
  keep_still(w, piece_sorted(w, piece), w->b.v.c, PBF_DIM);
}

static void viscosity_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  smooth_velocities(w, piece, w->constants.viscosity, w->b.smoothed_velocity());
}

static void drag_piece(void *context, uint32_t piece) {
  const worker *w = static_cast<const worker *>(context);
  const range all = piece_sorted(w, piece);
  const drag_pass pass = drag_of(&w->s->params);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i)
      field_set(&w->b.v, i, pass.finish(field_at(&w->b.v, i)));
  keep_still(w, all, w->b.v.c, PBF_DIM);
}

/* Stages as loops of the team, to which all its threads come. */
struct executor {
  worker *w;
  bool sorted; /* the step has come as far as that */

  void over_pairs(team_piece piece, team_last last = NULL) {
    team_for(w->me, pair_pieces(w), piece, last, w);
  }
  void over_pairs(team_piece piece, pbf_stage stage) {
    over_pairs(piece);
    stage_end(w, stage);
  }

  bool wake() {
    if (!sorted && sleep_is_on(w) && pbf_any_moves(w->s->movers))
      team_for(w->me, particle_pieces(w), wake_piece, NULL, w);
    return true; /* steps of none awake are not begun: steps_asleep */
  }
  void predict() {
    if (sorted) return;
    team_for(w->me, particle_pieces(w), predict_piece, make_grid, w);
    stage_end(w, PBF_STAGE_PREDICT);
  }
  bool find_neighbors() {
    if (!sorted) sort_particles(w);
    w->unrest = w->b.sorted_unrest;
    w->sleeping_lambda = w->b.sorted_sleeping_lambda;
    if (!::find_neighbors(w, is_deep(w) ? end_deep_search : end_search)) return false;
    if (corrects_torque(w)) over_pairs(start_piece);
    stage_end(w, PBF_STAGE_NEIGHBORS);
    return true;
  }
  void slack() { find_slack(w); }
  void begin_solve() {}
  void pressure_grid() { carry_weight(w); }
  bool is_over(uint32_t) const { return false; } /* see ::is_over */
  void begin_iteration(uint32_t k) {
    w->iteration = k;
    pbf_set_iteration(&w->constants, k);
  }
  void lambda(uint32_t) {
    const int watched = is_watched(w->s);
    over_pairs(watched ? watched_lambda_piece : lambda_piece, watched ? end_when_small : NULL);
    stage_end(w, PBF_STAGE_LAMBDA);
  }
  void torque(uint32_t) { over_pairs(torque_piece, PBF_STAGE_TORQUE); }
  void move(uint32_t k) {
    over_pairs(is_watched(w->s) ? watched_move_piece : move_piece);
    w->b.accept_iteration();
    stage_end(w, PBF_STAGE_MOVE);
    w->iteration = k + 1;
  }
  void velocity() { update_velocity(w); }
  void flow() {
    pack_vectors(w, velocities_piece);
    over_pairs(flow_piece, PBF_STAGE_FLOW);
  }
  void undamp() {
    pack_vectors(w, flows_and_lambda_piece);
    over_pairs(undamp_piece, PBF_STAGE_UNDAMP);
  }
  void turn_rate() { over_pairs(turn_rate_piece, PBF_STAGE_TURN_RATE); }
  void turn() {
    pack_vectors(w, rates_piece);
    over_pairs(turn_piece, PBF_STAGE_TURN);
  }
  void curl() {
    pack_vectors(w, velocities_piece);
    over_pairs(curl_piece, PBF_STAGE_CURL);
  }
  void confine() {
    pack_positions(w, sizes_piece);
    over_pairs(confine_piece, PBF_STAGE_CONFINE);
  }
  void viscosity() {
    pack_vectors(w, velocities_piece);
    over_pairs(viscosity_piece);
    w->b.accept_smoothed_velocity();
    stage_end(w, PBF_STAGE_VISCOSITY);
  }
  void drag() { over_pairs(drag_piece, PBF_STAGE_DRAG); }
  bool settle() { return ::settle(w); }
  void end() {}
};

static step_outcome step_once(worker *w, double time, int sorted) {
  solver *s = w->s;
  if ((PBF_BUILT & PBF_FEATURE_TIMING) && s->timing) w->stage_begin = seconds_now();
  w->forces = pbf_forces_of(&s->params, time);
  const double end = time + s->params.time_step;
  place_obstacles(s, end, &w->obstacles);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->slack) place_obstacles(s, time, &w->before);
  pbf_fit_to_room(&w->constants, &s->constants, &s->params, s->count, &s->schedule, end);
  w->sort_positions = &w->b.predicted();
  w->sorted_positions = &w->b.sorted_predicted;
  w->sort_payload = &w->b.predicted_velocity();
  w->sorted_payload = &w->b.sorted_velocity;
  w->unrest = w->b.unrest;
  w->sleeping_lambda = w->b.sleeping_lambda;
  w->iteration = 0;
  executor e = {w, sorted != 0};
  return run_step(e, s->schedule);
}

/* A thread may begin when the others are at the end: what it begins with is not written here. */
static void run_steps(void *context, member *me) {
  step_job *job = static_cast<step_job *>(context);
  worker w = worker_of(job->s, me);
  step_outcome last = STEP_COMPLETE;
  for (w.step = job->done; w.step < job->steps && last == STEP_COMPLETE;) {
    last = step_once(&w, job->time + w.step * job->s->params.time_step,
                     job->sorted && w.step == job->done);
    if (last != STEP_SHORT_OF_MEMORY) ++w.step;
  }
  if (me->thread != 0) return;
  job->reached = w.step;
  job->last = last;
  job->after = w.b;
}

/* Steps until all are done, or memory is lacking that is not to be had. */
static void run_job(step_job *job) {
  solver *s = job->s;
  uint32_t before = job->done;
  double step = s->params.time_step;
  do {
    uint32_t left = job->steps - job->done;
    job->done += job->sorted ? 0 : steps_asleep(s, job->time + job->done * step, left);
    if (job->done == job->steps) break;
    atomic_store(&s->stopped, 0);
    atomic_store(&s->all_asleep, 0);
    atomic_store(&s->drowsy, 0);
    team_run(s->team, s->threads, run_steps, job);
    s->buffers = job->after;
    if (job->reached > job->done)
      s->unweighed = s->schedule.runs[PBF_STAGE_GRID] && s->schedule.accelerated;
    job->done = job->reached;
    job->sorted = job->last == STEP_SHORT_OF_MEMORY;
  } while (job->done < job->steps && (!job->sorted || grow_lists(s)));
  if (job->done > before) s->pressure_scale = s->constants.pressure;
  s->now = job->time + job->done * step;
}

#endif
