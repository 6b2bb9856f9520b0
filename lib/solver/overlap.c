#include "overlap.h"

#include <math.h>

#include "backend_call.h"
#include "physics/elementary.h"
#include "physics/steps_leave.h"
#include "solver_time.h"

/* Before the first step nothing has moved: pre-stabilization sees to what is placed then. */
static pbf_overlap *noted(pbf_solver *solver) {
  const pbf_collider_set placed = pbf_colliders_set(solver, 0, PBF_COLLIDERS_PLACED);
  if (!solver->overlap.found.struct_size) {
    solver->overlap.found = (pbf_overlap){
        .struct_size = sizeof(pbf_overlap), .first_id = 1, .least = solver->overlap.left};
    for (uint32_t w = 0; w < placed.words; ++w) placed.more[w] = 0;
  }
  return &solver->overlap.found;
}

void pbf_overlap_note_particles(pbf_solver *solver, uint32_t first_id, uint32_t last_id) {
  if (!solver->overlap.moved) return;
  pbf_overlap *o = noted(solver);
  int none = o->first_id > o->last_id;
  if (none || first_id < o->first_id) o->first_id = first_id;
  if (none || last_id > o->last_id) o->last_id = last_id;
}

void pbf_overlap_note_all(pbf_solver *solver) {
  pbf_overlap *o = noted(solver);
  o->first_id = 0;
  o->last_id = (uint32_t)(solver->next_id - 1);
}

void pbf_overlap_note_colliders(pbf_solver *solver, const pbf_collider_set *colliders) {
  if (!solver->overlap.moved || pbf_collider_set_is_empty(colliders)) return;
  pbf_overlap *o = noted(solver);
  pbf_collider_set placed = pbf_colliders_set(solver, o->colliders, PBF_COLLIDERS_PLACED);
  pbf_collider_set_unite(&placed, colliders);
  o->colliders = placed.first;
}

/* The error that steps leave now over that before. Where nothing weighs on the fluid it is as the
 * length of steps squared. */
static double change_of(const pbf_overlap_state *before, double time_step, double error) {
  if (before->error > 0) return error / before->error;
  const double ratio = time_step / before->time_step;
  return error > 0 ? HUGE_VAL : ratio * ratio;
}

/* Steps that differ by less than a fourth are as good as equal. So many small changes add up to one
 * that counts. */
static int is_change(double change) { return change < 0.75 * 0.75 || change > 1 / (0.75 * 0.75); }

/* Under all of the fluid, where steps leave so much for each layer; `unknown` where the backend
 * does not say, which is then a number for what is the same before and now. */
static double left_by(pbf_solver *solver, double error, double most, double unknown) {
  if (!solver->api.steps_leave) return error;
  const double left = error > 0 ? solver->api.steps_leave(solver->backend, error, most) : 0;
  return left < 0 ? unknown : left;
}

/* What is allowed for of a change of steps goes exponentially, and with it how far the error is
 * from what steps leave. */
static double reference_now(const pbf_solver *solver, double left) {
  const pbf_overlap_state *o = &solver->overlap;
  const double away = pbf_exp(-o->rate * (pbf_solver_time(solver) - o->since));
  if (!(o->left > 0)) return left + (o->reference - left) * away;
  return left * (1 + (o->reference / o->left - 1) * away);
}

/* Of what steps have left, those that leave less are to make no velocity; and where they leave more
 * the fluid is not to fall until it is pressed together as far. What would be pressed by more than
 * a twentieth is not at rest: there the length of steps alone counts. */
static void note_left(pbf_solver *solver, double before, double now, double ratio) {
  const double most_parts = 64; /* of small errors that would be noise */
  const double most_at_rest = 0.05;
  pbf_overlap_state *o = &solver->overlap;
  const double reference = reference_now(solver, before);
  const int rests = reference > 0 && before <= most_at_rest && now <= most_at_rest;
  o->reference = rests ? reference : now;
  o->left = now;
  if (!rests && !is_change(ratio * ratio)) return;
  pbf_overlap *found = noted(solver);
  found->reference = rests ? reference : 0;
  found->before = rests ? before / reference : 1;
  found->now = fmin(rests ? now / reference : ratio * ratio, most_parts);
  found->least = rests ? now : 0;
  found->part = found->before > 0 ? 1 - fmin(found->now / found->before, most_parts) : -1;
}

static void note_change(pbf_solver *solver, double time_step, double error) {
  const pbf_overlap_state *o = &solver->overlap;
  const double before = left_by(solver, o->error, o->most, o->left);
  const double now = left_by(solver, error, fmax(o->most, error), 0);
  note_left(solver, before, now, time_step / o->time_step);
}

/* Of what overlaps, a unit of time: never so small that a time by it is none that can be saved, as
 * by the smallest max_depenetration_speed that there is. */
static double rate_of(const pbf_params *params, uint32_t dimension) {
  return fmax(pbf_overlap_rate(params, (int)dimension), 1e-300);
}

void pbf_overlap_note_step(pbf_solver *solver, double time_step) {
  pbf_overlap_state *o = &solver->overlap;
  pbf_params params = solver->params;
  params.time_step = time_step;
  const int dimension = (int)solver->kind.dimension;
  const double error = pbf_error_per_layer(&params, dimension);
  if (o->time_step > 0) {
    const double change = change_of(o, time_step, error);
    if (!is_change(change) && !pbf_is_more_than_ever(error, o->most)) return;
    if (o->moved) note_change(solver, time_step, error);
  } else {
    o->reference = o->left = left_by(solver, error, error, 0);
  }
  o->since = pbf_solver_time(solver);
  o->rate = 5 * rate_of(&params, solver->kind.dimension);
  o->time_step = time_step;
  o->error = error;
  o->most = fmax(o->most, error);
}

double pbf_overlap_steps_leave(pbf_solver *solver) {
  const pbf_overlap_state *o = &solver->overlap;
  return left_by(solver, o->error, o->most, o->left);
}

void pbf_overlap_note_grid(pbf_solver *solver, double before) {
  pbf_overlap_state *o = &solver->overlap;
  if (!o->moved || !(o->time_step > 0)) return;
  note_left(solver, before, pbf_overlap_steps_leave(solver), 1);
  o->since = pbf_solver_time(solver);
  o->rate = 5 * rate_of(&solver->params, solver->kind.dimension);
}

void pbf_overlap_note_walls(pbf_solver *solver) {
  if (solver->overlap.moved) noted(solver)->walls = 1;
}

/* When what is left is nothing, however much it was: a thousand times rest density falls to 1 in
 * seven times the time that 1 would take evenly, which is five times that in which the last fifth
 * falls by e. */
static double time_apart(const pbf_solver *solver) {
  return 10 / rate_of(&solver->params, solver->kind.dimension);
}

static pbf_status tell(pbf_solver *solver, const pbf_overlap *overlap) {
  pbf_status status = solver->api.set_overlap(solver->backend, overlap);
  return pbf_backend_result(solver, status, "set_overlap");
}

static const pbf_overlap none = {.struct_size = sizeof none, .first_id = 1};

pbf_status pbf_overlap_expect(pbf_solver *solver) {
  pbf_status status = solver->overlap.end > 0 ? PBF_OK : tell(solver, &none);
  if (status != PBF_OK) return status;
  solver->overlap.end = pbf_solver_time(solver) + time_apart(solver);
  noted(solver);
  return PBF_OK;
}

/* Nothing overlaps any more. */
pbf_status pbf_overlap_forget(pbf_solver *solver) {
  solver->overlap.found.struct_size = 0;
  if (!(solver->overlap.end > 0)) return PBF_OK;
  solver->overlap.end = 0;
  return tell(solver, NULL);
}

static pbf_status tell_most(pbf_solver *solver, double most) {
  if (most == solver->most_there || !solver->api.plan_steps) return PBF_OK;
  pbf_status status = solver->api.plan_steps(solver->backend, most);
  if (status == PBF_OK) solver->most_there = most;
  return pbf_backend_result(solver, status, "plan_steps");
}

pbf_status pbf_overlap_restore(pbf_solver *solver, const pbf_overlap_state *overlap) {
  pbf_status status = tell_most(solver, overlap->most);
  if (status != PBF_OK) return status;
  if (!solver->api.set_overlap) return PBF_OK;
  return tell(solver, overlap->end > 0 ? &none : NULL);
}

int pbf_overlap_can_be_found(const pbf_solver *solver) {
  return solver->overlap.moved && solver->api.set_overlap &&
         solver->params.solver == PBF_SOLVER_CHEBYSHEV;
}

static pbf_status tell_found(pbf_solver *solver, const pbf_entering *entering) {
  pbf_overlap found = *noted(solver);
  found.more_colliders = pbf_colliders_set(solver, 0, PBF_COLLIDERS_PLACED).more;
  found.entering = entering;
  pbf_status status = tell(solver, &found);
  if (status != PBF_OK) return status;
  solver->overlap.found.struct_size = 0;
  solver->overlap.end = pbf_solver_time(solver) + time_apart(solver);
  return PBF_OK;
}

static pbf_status tell_overlap(pbf_solver *solver, pbf_entering *entering, uint32_t *steps) {
  double now = pbf_solver_time(solver);
  if (!solver->api.set_overlap) return PBF_OK;
  if (solver->params.solver != PBF_SOLVER_CHEBYSHEV) return pbf_overlap_forget(solver);
  if (solver->overlap.found.struct_size || entering) {
    if (entering) entering->alone = !solver->overlap.found.struct_size;
    pbf_status status = tell_found(solver, entering);
    if (status != PBF_OK) return status;
  } else if (solver->overlap.end > 0 && now >= solver->overlap.end) {
    return pbf_overlap_forget(solver);
  }
  double left = (solver->overlap.end - now) / solver->params.time_step;
  /* At least one: a time that is lost in rounding would else be waited for without a step. */
  if (solver->overlap.end > 0 && left < *steps) *steps = left > 1 ? (uint32_t)ceil(left) : 1;
  return PBF_OK;
}

pbf_status pbf_overlap_to_backend(pbf_solver *solver, pbf_entering *entering, uint32_t *steps) {
  pbf_status status = tell_overlap(solver, entering, steps);
  return status == PBF_OK ? tell_most(solver, solver->overlap.most) : status;
}
