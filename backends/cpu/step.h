/* Part of backend.cpp: steps, run by every thread of the team. */
#ifndef PBF_CPU_STEP_H
#define PBF_CPU_STEP_H

#include "cpu/executor.h"
#include "cpu/placing.h"
#include "physics/overfull.h"

typedef struct step_job {
  solver *s;
  pbf_step_times times;
  uint32_t steps, done;
  uint32_t stop;     /* of the team's run: after so many */
  int sorted;        /* the next step has come as far as that */
  uint32_t reached;  /* step, by the team's run, */
  step_outcome last; /* and how that ended */
  buffers after;     /* it */
} step_job;

static step_outcome step_once(worker *w, double begin, double end, uint64_t nth, int sorted) {
  solver *s = w->s;
  if ((PBF_BUILT & PBF_FEATURE_TIMING) && s->timing) w->stage_begin = pbf_seconds();
  w->forces = pbf_forces_of(&s->params, begin);
  place_step_obstacles(
      w, begin, end,
      (PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && (s->residual_density || finds_overlap(w)));
  pbf_set_constants_of_step(&w->constants, &s->constants, &s->params, particles_of_all(s),
                            &s->schedule, end);
  w->sort_positions = &w->b.predicted();
  w->sorted_positions = &w->b.sorted_predicted;
  w->sort_payload = &w->b.predicted_velocity();
  w->sorted_payload = &w->b.sorted_velocity;
  w->sort_ids = w->b.ids;
  w->sort_overlap = w->b.overlap;
  w->sort_acceleration = has_accelerations(w) ? &w->b.acceleration : NULL;
  w->sort_phase = w->b.phase;
  w->sort_push = has_ranks(s) && notes_pushes(s) ? &s->push : NULL;
  w->activity = w->b.activity;
  w->sleeping_lambda = w->b.sleeping_lambda;
  w->iteration = 0;
  executor e = {w, sorted != 0, nth, false, false, {}};
  return run_step(e, s->schedule);
}

/* A thread may begin when the others are at the end: what it begins with is not written here. */
static void run_steps(void *context, team_thread *self) {
  step_job *job = static_cast<step_job *>(context);
  worker w = worker_of(job->s, self);
  step_outcome last = STEP_COMPLETE;
  for (w.step = job->done; w.step < job->stop && last == STEP_COMPLETE;) {
    last =
        step_once(&w, pbf_time_after(&job->times, w.step), pbf_time_after(&job->times, w.step + 1),
                  pbf_nth_after(&job->times, w.step + 1), job->sorted && w.step == job->done);
    if (last != STEP_SHORT_OF_MEMORY) ++w.step;
  }
  if (self->thread != 0) return;
  job->reached = w.step;
  job->last = last;
  job->after = w.b;
}

static uint32_t steps_at_once(const solver *s, uint32_t left) {
  const uint64_t max_steps = s->team_api->run_length / (particles_of_all(s) + UINT64_C(1)) + 1;
  return max_steps < left ? (uint32_t)max_steps : left;
}

static void note_grid_pressure(solver *s) {
  const bool pending = s->schedule.runs[PBF_STAGE_GRID] && s->schedule.accelerated;
  s->grid_pressure_pending = pending ? s->count : 0;
  s->grid_inv_time_step = (pbf_real)(1 / s->params.time_step);
}

/* Steps until all are done, or memory is lacking that is not to be had. */
static void run_job(step_job *job) {
  solver *s = job->s;
  uint32_t before = job->done;
  if (has_ranks(s)) count_sleepers_of_ranks(s);
  do {
    uint32_t left = job->steps - job->done;
    const uint32_t asleep = job->sorted ? 0 : steps_asleep(s, &job->times, job->done, left);
    if (asleep && finds_loads(s)) pbf_repeat_loads(s->load_tally, asleep, s->params.time_step);
    job->done += asleep;
    if (job->done == job->steps) break;
    atomic_store(&s->stopped, 0);
    atomic_store(&s->all_asleep, 0);
    atomic_store(&s->near_sleep_count, 0);
    job->stop = job->done + steps_at_once(s, job->steps - job->done);
    s->team_api->run(&s->tasks, s->team, threads_now(s), run_steps, job);
    s->buffers = job->after;
    if (job->reached > job->done) note_grid_pressure(s);
    job->done = job->reached;
    job->sorted = job->last == STEP_SHORT_OF_MEMORY;
  } while (job->done < job->steps && !s->ranks.failed && (!job->sorted || grow_lists_of_all(s)));
  if (job->sorted && has_ranks(s)) s->count = s->ranks.before;
  if (job->done > before) s->pressure_scale = s->constants.pressure;
  s->now = pbf_time_after(&job->times, job->done);
}

#endif
