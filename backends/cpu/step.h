/* Algorithm 1 in the order of physics/schedule.h, run by every thread of the team. */
#ifndef PBF_CPU_STEP_H
#define PBF_CPU_STEP_H

#include "cpu/lists.h"
#include "cpu/sort.h"

typedef struct step_job {
  solver *s;
  double time;
  uint32_t steps, done;
  int sorted;       /* the next step has come as far as that */
  uint32_t reached; /* step, by the team's run */
  buffers after;    /* it */
} step_job;

static void predict_piece(void *context, uint32_t piece) {
  worker *w = context;
  range r = piece_particles(w, piece);
  w->s->kernels->predict(&w->forces, &w->obstacles, w->s->schedule.collide_after_prediction, w->b.x,
                         w->b.v, w->b.spare[0], w->b.spare[1], r.first, r.last);
  find_bounds(w, piece);
}

/* Lambda of all iterations starts from nothing in each step. */
static void clear_totals(solver *s, range groups) {
  uint64_t width = s->kernels->width;
  uint64_t bytes = (groups.last - groups.first) * width * sizeof *s->lambda;
  memset(s->lambda + groups.first * width, 0, bytes);
  memset(s->before + groups.first * width, 0, bytes);
}

/* Where x* stands: it starts as the prediction in spare[2], and is in spare[1] after an iteration.
 */
static const field *now_at(const worker *w) { return &w->b.spare[w->iteration ? 1 : 2]; }

static void backtrack_piece(void *context, uint32_t piece) {
  worker *w = context;
  range r = piece_sorted(w, piece);
  w->s->kernels->backtrack(w->forces.time_step, w->b.spare[2], w->b.spare[3], w->b.spare[0],
                           r.first, r.last);
}

static void slack_piece(void *context, uint32_t piece) {
  worker *w = context;
  solver *s = w->s;
  range groups = piece_groups(w, piece), r = piece_sorted(w, piece);
  pair_pass pairs = pairs_at(w, w->b.spare[0]);
  s->kernels->density(&pairs, s->slack, s->cells, groups.first, groups.last);
  s->kernels->slack(&s->constants, s->slack, r.first, r.last);
}

static void find_slack(worker *w) {
  team_for(w->me, pair_pieces(w), backtrack_piece, NULL, w);
  team_for(w->me, pair_pieces(w), slack_piece, NULL, w);
  stage_end(w, PBF_STAGE_SLACK);
}

static void lambda_piece(void *context, uint32_t piece) {
  worker *w = context;
  solver *s = w->s;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, *now_at(w));
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->schedule.accelerated && w->iteration == 0)
    clear_totals(s, r);
  s->kernels->lambda(&pairs, s->lambda, s->before, r.first, r.last);
}

static void move_piece(void *context, uint32_t piece) {
  worker *w = context;
  solver *s = w->s;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, *now_at(w));
  s->kernels->move(&pairs, &w->obstacles, s->schedule.collide_in_iteration, w->b.spare[2],
                   s->lambda, w->b.spare[0], r.first, r.last);
}

static void iterate(worker *w) {
  pbf_set_iteration(&w->constants, &w->s->params, w->iteration);
  team_for(w->me, pair_pieces(w), lambda_piece, NULL, w);
  stage_end(w, PBF_STAGE_LAMBDA);
  team_for(w->me, pair_pieces(w), move_piece, NULL, w);
  swap_fields(&w->b.spare[0], &w->b.spare[1]);
  stage_end(w, PBF_STAGE_MOVE);
}

static void velocity_piece(void *context, uint32_t piece) {
  worker *w = context;
  solver *s = w->s;
  range r = piece_sorted(w, piece);
  s->kernels->velocity(&w->obstacles, s->schedule.collide_after_solve, w->forces.inv_time_step,
                       w->b.spare[3], w->b.spare[2], w->b.spare[1], w->b.v, r.first, r.last);
}

/* From here nothing can fail, and the old state gives way to the new one. */
static void update_velocity(worker *w) {
  team_for(w->me, pair_pieces(w), velocity_piece, NULL, w);
  swap_fields(&w->b.x, &w->b.spare[1]);
  uint32_t *ids = w->b.ids;
  w->b.ids = w->b.spare_ids;
  w->b.spare_ids = ids;
  stage_end(w, PBF_STAGE_VELOCITY);
}

static void curl_piece(void *context, uint32_t piece) {
  worker *w = context;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.x);
  w->s->kernels->curl(&pairs, w->b.v, w->b.spare[0].c, spare_reals(w->s), r.first, r.last);
}

static void confine_piece(void *context, uint32_t piece) {
  worker *w = context;
  solver *s = w->s;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.x);
  s->kernels->confine(&pairs, (pbf_real)(s->params.time_step * s->params.vorticity),
                      w->b.spare[0].c, spare_reals(s), w->b.v, r.first, r.last);
}

static void confine_vorticity(worker *w) {
  team_for(w->me, pair_pieces(w), curl_piece, NULL, w);
  stage_end(w, PBF_STAGE_CURL);
  team_for(w->me, pair_pieces(w), confine_piece, NULL, w);
  stage_end(w, PBF_STAGE_CONFINE);
}

static void viscosity_piece(void *context, uint32_t piece) {
  worker *w = context;
  range r = piece_groups(w, piece);
  pair_pass pairs = pairs_at(w, w->b.x);
  w->s->kernels->viscosity(&pairs, w->b.v, w->b.spare[1], r.first, r.last);
}

static void smooth_velocity(worker *w) {
  team_for(w->me, pair_pieces(w), viscosity_piece, NULL, w);
  swap_fields(&w->b.v, &w->b.spare[1]);
  stage_end(w, PBF_STAGE_VISCOSITY);
}

static void predict_and_sort(worker *w) {
  team_for(w->me, particle_pieces(w), predict_piece, make_grid, w);
  stage_end(w, PBF_STAGE_PREDICT);
  sort_particles(w);
}

/* 0 when the memory for the neighbours is lacking; the state is then as before. */
static int step_once(worker *w, double time, int sorted) {
  solver *s = w->s;
  if ((PBF_BUILT & PBF_FEATURE_TIMING) && s->timing) w->stage_begin = seconds_now();
  w->forces = pbf_forces_of(&s->params);
  place_obstacles(w, time + s->params.time_step);
  w->key = &w->b.spare[0];
  w->sorted_key = &w->b.spare[2];
  w->other = &w->b.spare[1];
  w->sorted_other = &w->b.spare[3];
  if (!sorted) predict_and_sort(w);
  if (!find_neighbors(w)) return 0;
  stage_end(w, PBF_STAGE_NEIGHBORS);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && s->slack) find_slack(w);
  for (w->iteration = 0; w->iteration < s->params.iterations; ++w->iteration) iterate(w);
  update_velocity(w);
  if ((PBF_BUILT & PBF_FEATURE_VORTICITY) && s->schedule.runs[PBF_STAGE_CURL]) confine_vorticity(w);
  if ((PBF_BUILT & PBF_FEATURE_VISCOSITY) && s->schedule.runs[PBF_STAGE_VISCOSITY])
    smooth_velocity(w);
  return 1;
}

/* A thread may begin when the others are at the end: what it begins with is not written here. */
static void run_steps(void *context, member *me) {
  step_job *job = context;
  worker w = worker_of(job->s, me);
  for (w.step = job->done; w.step < job->steps; ++w.step)
    if (!step_once(&w, job->time + w.step * job->s->params.time_step,
                   job->sorted && w.step == job->done))
      break;
  if (me->thread != 0) return;
  job->reached = w.step;
  job->after = w.b;
}

/* Steps until all are done, or memory is lacking that is not to be had. */
static void run_job(step_job *job) {
  solver *s = job->s;
  do {
    atomic_store(&s->stopped, 0);
    team_run(s->team, s->threads, run_steps, job);
    s->buffers = job->after;
    s->now = job->time + job->reached * s->params.time_step;
    if (job->reached > job->done) s->pressure_scale = s->constants.pressure;
    job->done = job->reached;
    job->sorted = 1;
  } while (job->done < job->steps && grow_lists(s));
}

#endif
