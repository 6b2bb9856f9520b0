#include "overlap.h"

#include <math.h>

#include "backend_call.h"
#include "physics/depenetration.h"
#include "solver_time.h"

/* Before the first step nothing has moved: pre-stabilization sees to what is placed then. */
static pbf_overlap *noted(pbf_solver *solver) {
  const pbf_collider_set placed = pbf_colliders_set(solver, 0, PBF_COLLIDERS_PLACED);
  if (!solver->overlap.found.struct_size) {
    solver->overlap.found = (pbf_overlap){.struct_size = sizeof(pbf_overlap), .first_id = 1};
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

void pbf_overlap_note_colliders(pbf_solver *solver, const pbf_collider_set *colliders) {
  if (!solver->overlap.moved || pbf_collider_set_is_empty(colliders)) return;
  pbf_overlap *o = noted(solver);
  pbf_collider_set placed = pbf_colliders_set(solver, o->colliders, PBF_COLLIDERS_PLACED);
  pbf_collider_set_unite(&placed, colliders);
  o->colliders = placed.first;
}

/* What steps leave of a density error at rest is as their length squared. Of what longer ones have
 * left the shorter ones are to make no velocity, and what is allowed for of that is what the longer
 * ones leave again. */
static double part_of_other_step(double before, double now) {
  const double ratio = now / before, all = -1e6;
  return fmax(1 - ratio * ratio, all);
}

/* Steps that differ by less than a fourth are as good as equal. So many small changes add up to one
 * that counts. */
static int is_another_step(const pbf_solver *solver, double time_step) {
  const double before = solver->overlap.time_step;
  if (time_step > before) return !(solver->overlap.end > 0) || 0.75 * time_step > before;
  return time_step < 0.75 * before;
}

void pbf_overlap_note_step(pbf_solver *solver, double time_step) {
  const double before = solver->overlap.time_step;
  if (before > 0 && !is_another_step(solver, time_step)) return;
  const int allows = time_step < before || solver->overlap.end > 0;
  if (before > 0 && solver->overlap.moved && allows)
    noted(solver)->part = part_of_other_step(before, time_step);
  solver->overlap.time_step = time_step;
}

void pbf_overlap_note_walls(pbf_solver *solver) {
  if (solver->overlap.moved) noted(solver)->walls = 1;
}

/* When what is left is nothing, however much it was: a thousand times rest density falls to 1 in
 * seven times the time that 1 would take evenly, which is five times that in which the last fifth
 * falls by e. */
static double time_apart(const pbf_solver *solver) {
  return 10 / pbf_overlap_rate(&solver->params, (int)solver->kind.dimension);
}

static pbf_status tell(pbf_solver *solver, const pbf_overlap *overlap) {
  pbf_status status = solver->api.set_overlap(solver->backend, overlap);
  return pbf_backend_result(solver, status, "set_overlap");
}

/* Nothing overlaps any more. */
pbf_status pbf_overlap_forget(pbf_solver *solver) {
  solver->overlap.found.struct_size = 0;
  if (!(solver->overlap.end > 0)) return PBF_OK;
  solver->overlap.end = 0;
  return tell(solver, NULL);
}

pbf_status pbf_overlap_restore(pbf_solver *solver, const pbf_overlap_state *overlap) {
  static const pbf_overlap none = {.struct_size = sizeof none, .first_id = 1};
  if (!solver->api.set_overlap) return PBF_OK;
  return tell(solver, overlap->end > 0 ? &none : NULL);
}

pbf_status pbf_overlap_to_backend(pbf_solver *solver, uint32_t *steps) {
  double now = pbf_solver_time(solver);
  if (!solver->api.set_overlap) return PBF_OK;
  if (solver->params.solver != PBF_SOLVER_CHEBYSHEV) return pbf_overlap_forget(solver);
  if (solver->overlap.found.struct_size) {
    pbf_overlap found = solver->overlap.found;
    found.more_colliders = pbf_colliders_set(solver, 0, PBF_COLLIDERS_PLACED).more;
    pbf_status status = tell(solver, &found);
    if (status != PBF_OK) return status;
    solver->overlap.found.struct_size = 0;
    solver->overlap.end = now + time_apart(solver);
  } else if (solver->overlap.end > 0 && now >= solver->overlap.end) {
    return pbf_overlap_forget(solver);
  }
  double left = (solver->overlap.end - now) / solver->params.time_step;
  /* At least one: a time that is lost in rounding would else be waited for without a step. */
  if (solver->overlap.end > 0 && left < *steps) *steps = left > 1 ? (uint32_t)ceil(left) : 1;
  return PBF_OK;
}
