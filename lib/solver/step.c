#include "step.h"

#include <math.h>

#include "backend_call.h"
#include "diffuse/diffuse.h"
#include "emission/emission.h"
#include "error.h"
#include "handles.h"
#include "overlap.h"
#include "params.h"
#include "particles/accelerations.h"
#include "physics/motion.h"
#include "plan.h"
#include "prestabilize.h"
#include "previous.h"
#include "snapshots.h"
#include "solver_time.h"
#include "step_limit.h"
#include "substeps.h"

static double time_after(const pbf_solver *solver, uint32_t steps) {
  return solver->time_base + (double)(solver->steps_since + steps) * solver->params.time_step;
}

/* How many of the steps end before moving walls meet. */
static uint32_t steps_before_walls_meet(const pbf_solver *solver, uint32_t steps) {
  uint32_t dimension = solver->kind.dimension;
  if (!pbf_params_walls_move(&solver->params, dimension)) return steps;
  for (uint32_t i = 0; i < steps; ++i) {
    pbf_box box = pbf_params_box(&solver->params, dimension, time_after(solver, i + 1));
    if (pbf_box_closed_axis(&box, dimension) != dimension) return i;
  }
  return steps;
}

/* Null when all of it is a number for the backend, else the member that is not. */
static const char *overflowing_member(const pbf_solver *solver, const pbf_collider *now) {
  const uint32_t precision = solver->kind.precision;
  for (uint32_t k = 0; k < solver->kind.dimension; ++k) {
    if (pbf_check_finite(now->position[k], precision)) return "position";
    if (pbf_check_finite(now->half_extents[k], precision)) return "half_extents";
  }
  for (int k = 0; k < 4; ++k)
    if (!isfinite(now->orientation[k])) return "orientation";
  if (pbf_check_finite(now->radius, precision)) return "radius";
  return pbf_check_finite(now->half_length, precision) ? "half_length" : NULL;
}

/* Of the first collider that a step which ends then can't place: its number, or the count. */
static uint32_t overflowing_collider(const pbf_solver *solver, double time, const char **member) {
  uint32_t k = 0;
  for (; k < solver->collider_count; ++k) {
    pbf_collider now;
    pbf_motion_collider(&solver->colliders[k], time - solver->collider_time, &now);
    *member = overflowing_member(solver, &now);
    if (*member) break;
  }
  return k;
}

/* A collider moves one way until its motion ends: what is a number at the end is one before. */
static uint32_t steps_before_overflow(const pbf_solver *solver, uint32_t steps) {
  const char *member;
  if (overflowing_collider(solver, time_after(solver, steps), &member) == solver->collider_count)
    return steps;
  for (uint32_t i = 0; i < steps; ++i)
    if (overflowing_collider(solver, time_after(solver, i + 1), &member) < solver->collider_count)
      return i;
  return steps;
}

static pbf_status fail_to_place(const pbf_solver *solver, uint32_t step, uint32_t steps) {
  const char *member = "";
  uint32_t k = overflowing_collider(solver, time_after(solver, 1), &member);
  return pbf_fail(PBF_ERROR_STATE,
                  "step %u of %u would end at time %.9g, when colliders[%u].%s is beyond what "
                  "float%u holds; set it with other velocities first",
                  step, steps, time_after(solver, 1), k, member, 8 * solver->kind.precision);
}

static pbf_status run_backend(pbf_solver *solver, double time, uint64_t before, uint32_t steps,
                              uint32_t *done) {
  pbf_status status = solver->api.step(solver->backend, time, before, steps, done);
  if (*done > steps || (status == PBF_OK && *done != steps)) {
    uint32_t claimed = *done;
    *done = claimed > steps ? steps : claimed;
    return pbf_fail(PBF_ERROR_PLUGIN, "the backend \"%s\" says it has done %u of %u steps",
                    solver->plugin->name, claimed, steps);
  }
  return pbf_backend_result(solver, status, "step");
}

pbf_status pbf_time_to_backend(pbf_solver *solver, double time) {
  uint32_t done = 0;
  return run_backend(solver, time, 0, 0, &done);
}

/* All parts of one step, the nth of their length as if all steps had been divided so: what is done
 * every third step would else be done in the third part of each alone, or never. What fails between
 * two of them is a shorter step that has been done. */
static pbf_status run_divided(pbf_solver *solver, uint32_t substeps, uint32_t *done) {
  double begin = pbf_solver_time(solver);
  uint32_t parts = 0;
  const uint64_t before = solver->steps_since * substeps;
  pbf_status status = run_backend(solver, solver->time_base, before, substeps, &parts);
  *done = parts == substeps;
  if (*done || parts == 0) return status;
  solver->time_base = begin + parts * (solver->params.time_step / substeps);
  solver->steps_since = 0;
  solver->overlap.moved = 1;
  ++solver->generation;
  return status;
}

/* A backend runs so many of the steps at once, without a look at whether they are cancelled: in
 * some 20 ms. */
static uint32_t steps_at_once(const pbf_solver *solver, uint32_t steps) {
  const double most_steps = 1000; /* a step of a GPU takes 20 µs however few particles there are */
  const double one = fmax(((double)solver->count + 1) * solver->params.iterations,
                          solver->work_at_once / most_steps);
  const double most = 1 + solver->work_at_once / one;
  return most < steps ? (uint32_t)most : steps;
}

/* So many of the steps as go alike. */
static pbf_status run(pbf_solver *solver, uint32_t steps, uint32_t *done) {
  uint32_t substeps, alike = solver->params.max_substeps > 1 ? 1 : steps_at_once(solver, steps);
  pbf_status status = pbf_substeps_of(solver, &substeps);
  if (status == PBF_OK) status = pbf_divide_step(solver, substeps);
  if (status != PBF_OK) return status;
  pbf_overlap_note_step(solver, solver->time_step_there);
  status = pbf_overlap_to_backend(solver, &alike);
  if (status != PBF_OK) return status;
  solver->substeps = substeps;
  if (substeps > 1) return run_divided(solver, substeps, done);
  return run_backend(solver, solver->time_base, solver->steps_since, alike, done);
}

/* A step that fails leaves velocities as they were; a part of it that is done is a shorter step. */
static pbf_status run_accelerated(pbf_solver *solver, uint32_t steps, uint32_t *done) {
  pbf_accelerated_rows rows;
  const double begin = pbf_solver_time(solver);
  pbf_status status = pbf_accelerate(solver, &rows);
  if (status != PBF_OK) return status;
  status = run(solver, steps, done);
  if (*done == 0 && pbf_solver_time(solver) == begin) pbf_undo_accelerations(solver, &rows);
  return status;
}

/* A step that fails leaves positions as they were, too, and what is noted of overlaps. */
static pbf_status run_placed(pbf_solver *solver, uint32_t steps, uint32_t *done) {
  pbf_before_projection before;
  const pbf_overlap_state overlap = solver->overlap;
  const double begin = pbf_solver_time(solver);
  pbf_status status = pbf_prestabilize(solver, &before);
  if (status == PBF_OK) status = run_accelerated(solver, steps, done);
  if (*done > 0 || pbf_solver_time(solver) != begin) {
    pbf_prestabilize_accept(solver, &before);
  } else {
    pbf_prestabilize_undo(solver, &before);
    solver->overlap = overlap;
  }
  return status;
}

static pbf_status advance_part(pbf_solver *solver, uint32_t steps, uint32_t *advanced) {
  uint32_t done = 0;
  pbf_status status = pbf_emission_work(solver);
  if (pbf_emission_is_active(solver) || pbf_has_accelerations(solver)) steps = 1;
  if (status == PBF_OK && solver->diffuse) status = solver->diffuse->work->prepare(solver, &steps);
  if (status == PBF_OK) status = pbf_plan_step(solver);
  if (status != PBF_OK) return status;
  if (solver->count > 0) {
    status = run_placed(solver, steps, &done);
    solver->overlap.moved |= done > 0;
  } else {
    status = pbf_time_to_backend(solver, time_after(solver, steps));
    done = status == PBF_OK ? steps : 0;
  }
  solver->step += done;
  solver->steps_since += done;
  solver->generation += done > 0;
  *advanced = done;
  if (status != PBF_OK || !solver->diffuse) return status;
  return solver->diffuse->work->advance(solver);
}

/* All of them, or those before a cancellation. */
static pbf_status advance(pbf_solver *solver, uint32_t steps) {
  pbf_status status = PBF_OK;
  for (uint32_t done = 0; status == PBF_OK && steps > 0; steps -= done) {
    if (atomic_load_explicit(&solver->cancelled, memory_order_relaxed)) break;
    status = advance_part(solver, steps, &done);
  }
  return status;
}

/* The last step alone, where what is before it is kept. After a cancellation that is where the
 * particles are. */
static pbf_status advance_and_keep(pbf_solver *solver, uint32_t steps) {
  if (!solver->previous) return advance(solver, steps);
  pbf_previous_forget(solver);
  pbf_status status = advance(solver, steps - 1);
  if (status == PBF_OK) status = pbf_previous_note(solver);
  if (status == PBF_OK) status = advance(solver, 1);
  if (status != PBF_OK) pbf_previous_forget(solver);
  return status;
}

/* With a snapshot of what is done. */
static pbf_status advance_and_show(pbf_solver *solver, uint32_t steps, uint32_t of) {
  const uint64_t before = solver->step;
  pbf_status status = advance_and_keep(solver, steps);
  if (status == PBF_OK) status = pbf_snapshots_make(solver);
  if (status != PBF_OK || solver->step - before == steps) return status;
  return pbf_fail(PBF_ERROR_CANCELLED, "pbf_cancel has ended the call after %u of %u steps",
                  (uint32_t)(solver->step - before), of);
}

pbf_status pbf_run_steps(pbf_solver *solver, uint32_t steps) {
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK || steps == 0) return status;
  pbf_check_step_length(solver);
  uint32_t with_room = steps_before_walls_meet(solver, steps);
  uint32_t possible = steps_before_overflow(solver, with_room);
  if (possible > 0) status = advance_and_show(solver, possible, steps);
  if (status != PBF_OK || possible == steps) return status;
  if (possible < with_room) return fail_to_place(solver, possible + 1, steps);
  return pbf_fail(PBF_ERROR_STATE,
                  "step %u of %u would end at time %.9g, when the moving walls have left no room "
                  "between them; change params.wall_… first",
                  possible + 1, steps, time_after(solver, 1));
}

pbf_status pbf_step(pbf_solver *solver, uint32_t steps) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_run_steps(solver, steps));
}

pbf_status pbf_synchronize(pbf_solver *solver) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  status = solver->api.synchronize(solver->backend);
  return pbf_leave(solver, pbf_backend_result(solver, status, "synchronize"));
}
