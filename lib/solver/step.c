#include "step.h"

#include <math.h>

#include "backend_call.h"
#include "cancelled.h"
#include "diffuse/diffuse.h"
#include "emission/emission.h"
#include "error.h"
#include "handles.h"
#include "look_ahead.h"
#include "os.h"
#include "overlap.h"
#include "particles/phases.h"
#include "plan.h"
#include "prestabilize.h"
#include "previous.h"
#include "snapshots.h"
#include "solver_time.h"
#include "step_limit.h"
#include "substeps.h"

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

/* So much of a step has been done: a shorter one. */
static void end_shorter(pbf_solver *solver, double begin, double length) {
  if (!(length > 0)) return;
  solver->time_base = begin + length;
  solver->steps_since = 0;
  solver->overlap.moved = 1;
  ++solver->generation;
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
  if (!*done) end_shorter(solver, begin, parts * (solver->params.time_step / substeps));
  return status;
}

/* A backend runs so many of the steps at once, without a look at whether they are cancelled: by
 * their work in some 20 ms, which ranks on CPUs share. */
static uint32_t steps_at_once(const pbf_solver *solver, uint32_t steps) {
  const double most_steps = 1000; /* a step of a GPU takes 20 µs however few particles there are */
  const double one = fmax(((double)solver->count + 1) * solver->params.iterations,
                          solver->work_at_once / most_steps);
  const double sharers = solver->on_device ? 1 : fmax(1, solver->ranks.count);
  const double most = 1 + solver->work_at_once * sharers / one;
  return most < steps ? (uint32_t)most : steps;
}

/* What steps find overlapping. */
static pbf_status tell_overlap(pbf_solver *solver, uint32_t *alike) {
  const pbf_emission_work *work = solver->emission ? solver->emission->work : NULL;
  pbf_entering entering;
  const int any =
      work && pbf_overlap_can_be_found(solver) && work->find_entering(solver, &entering);
  pbf_status status = pbf_overlap_to_backend(solver, any ? &entering : NULL, alike);
  if (status == PBF_OK && any) status = work->tell_entering(solver, &entering);
  return status;
}

/* So many of the steps as go alike. */
static pbf_status run(pbf_solver *solver, uint32_t steps, uint32_t *done) {
  uint32_t substeps = solver->parts;
  uint32_t alike = solver->params.max_substeps > 1 ? 1 : steps_at_once(solver, steps);
  pbf_status status = substeps == 0 ? pbf_substeps_of(solver, &substeps) : PBF_OK;
  if (status == PBF_OK) status = pbf_divide_step(solver, substeps);
  if (status != PBF_OK) return status;
  pbf_overlap_note_step(solver, solver->time_step_there);
  status = tell_overlap(solver, &alike);
  if (status != PBF_OK) return status;
  solver->substeps = substeps;
  if (solver->parts > 0) {
    const uint64_t before = solver->steps_since * substeps + solver->part;
    return run_backend(solver, solver->time_base, before, 1, done);
  }
  if (substeps > 1) return run_divided(solver, substeps, done);
  return run_backend(solver, solver->time_base, solver->steps_since, alike, done);
}

/* A step that fails, or does not begin, leaves positions as they were, and what is noted of
 * overlaps. */
static pbf_status run_placed(pbf_solver *solver, uint32_t steps, uint32_t *done) {
  pbf_before_projection before;
  const pbf_overlap_state overlap = solver->overlap;
  const double begin = pbf_solver_time(solver);
  pbf_status status = pbf_phases_tell_used(solver);
  if (status != PBF_OK) return status;
  status = pbf_prestabilize(solver, &before);
  if (status == PBF_OK) status = run(solver, steps, done);
  if (*done > 0 || pbf_solver_time(solver) != begin) {
    pbf_prestabilize_accept(solver, &before);
  } else {
    pbf_prestabilize_undo(solver, &before);
    solver->overlap = overlap;
  }
  return status;
}

/* What comes and goes before each step, which are then made one at a time, and room for what
 * follows from that. */
static pbf_status prepare(pbf_solver *solver, uint32_t *steps) {
  pbf_status status = PBF_OK;
  if (solver->emission) status = solver->emission->work->prepare(solver);
  if (pbf_emission_is_active(solver)) *steps = 1;
  if (status == PBF_OK && solver->diffuse) status = solver->diffuse->work->prepare(solver, steps);
  if (status == PBF_OK) status = pbf_plan_step(solver);
  return status;
}

/* What the host does before a step it does before each part of a divided one, since it goes by how
 * long that is: a stream that got the columns of a whole step at once would run into itself. */
static pbf_status run_parts(pbf_solver *solver, uint32_t *advanced) {
  const double begin = pbf_solver_time(solver);
  pbf_status status = PBF_OK;
  for (uint32_t done = 1; status == PBF_OK && done && solver->part < solver->parts;) {
    done = 0;
    if (solver->part > 0) {
      uint32_t one = 1;
      pbf_emission_begin_part(solver);
      status = prepare(solver, &one);
    }
    if (status == PBF_OK && solver->count > 0) status = run_placed(solver, 1, &done);
    if (status == PBF_OK && solver->count == 0) done = 1;
    solver->overlap.moved |= done > 0 && solver->count > 0;
    solver->part += done;
  }
  *advanced = solver->part == solver->parts;
  if (*advanced && solver->emission) solver->emission->work->end_parts(solver);
  const double length = solver->part * pbf_part_time_step(solver);
  solver->part = solver->parts = 0;
  if (!*advanced) end_shorter(solver, begin, length);
  if (*advanced && status == PBF_OK && solver->count == 0)
    status = pbf_time_to_backend(solver, pbf_time_of_step(solver, 1));
  return status;
}

/* Of the next step; 0: nothing is done before them. */
static pbf_status find_parts(pbf_solver *solver) {
  uint32_t parts = 0;
  if (solver->params.max_substeps <= 1 || !pbf_emission_is_active(solver)) return PBF_OK;
  pbf_status status = pbf_substeps_of(solver, &parts);
  if (status == PBF_OK) solver->parts = parts;
  return status;
}

static pbf_status advance_part(pbf_solver *solver, uint32_t steps, uint32_t *advanced) {
  uint32_t done = 0;
  pbf_status status = find_parts(solver);
  if (status == PBF_OK) status = prepare(solver, &steps);
  if (status != PBF_OK) solver->parts = 0;
  if (status != PBF_OK) return status;
  if (solver->parts > 0) {
    status = run_parts(solver, &done);
  } else if (solver->count > 0) {
    status = run_placed(solver, steps, &done);
    solver->overlap.moved |= done > 0;
  } else {
    status = pbf_time_to_backend(solver, pbf_time_of_step(solver, steps));
    done = status == PBF_OK ? steps : 0;
  }
  solver->step += done;
  solver->steps_since += done;
  solver->generation += done > 0;
  *advanced = done;
  if (status != PBF_OK || !solver->diffuse) return status;
  return solver->diffuse->work->advance(solver);
}

/* Not before a first step, by which ranks know that all are in this call. */
static pbf_status tell_ranks(pbf_solver *solver) {
  if (!solver->ranks.count || solver->untold < steps_at_once(solver, UINT32_MAX)) return PBF_OK;
  return pbf_tell_cancelled(solver);
}

/* What steps cost beside their particles, and how busy the processors are, the clock tells; of a
 * device, which goes on working after a call, it does not, and to ranks, which are to make the same
 * calls, clocks tell different things. No bit depends on it. */
static uint32_t next_piece(const pbf_solver *solver, uint32_t piece, double seconds) {
  const double long_time = 0.02;
  if (solver->on_device || solver->count == 0 || solver->ranks.count) return UINT32_MAX;
  if (seconds > long_time) return piece > 1 ? piece / 2 : 1;
  return seconds < 0.4 * long_time && piece <= UINT32_MAX / 2 ? 2 * piece : piece;
}

/* All of them, or those before a cancellation. */
static pbf_status advance(pbf_solver *solver, uint32_t steps) {
  enum { FIRST_PIECE = 16 };
  pbf_status status = PBF_OK;
  uint32_t piece = next_piece(solver, FIRST_PIECE / 2, 0);
  double begin = pbf_seconds();
  for (uint32_t done = 0; status == PBF_OK && steps > 0 && !pbf_is_cancelled(solver);
       steps -= done) {
    status = advance_part(solver, steps < piece ? steps : piece, &done);
    solver->untold += done;
    if (status == PBF_OK && done < steps) status = tell_ranks(solver);
    const double now = pbf_seconds();
    piece = next_piece(solver, piece, now - begin);
    begin = now;
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

/* Those steps of a call that are too many to look at at once, in parts after each of which there is
 * a last one still to be made. */
static pbf_status advance_far(pbf_solver *solver, uint32_t *steps) {
  pbf_status status = PBF_OK;
  for (;;) {
    const uint32_t look = pbf_steps_to_look_at(solver, *steps);
    if (status != PBF_OK || look == *steps || pbf_is_cancelled(solver)) return status;
    const uint64_t before = solver->step;
    if (pbf_steps_possible(solver, look) < look) return status;
    pbf_previous_forget(solver);
    status = advance(solver, look - 1);
    *steps -= (uint32_t)(solver->step - before);
  }
}

/* With a snapshot of what is done. */
static pbf_status run_to_end(pbf_solver *solver, uint32_t left, uint32_t of) {
  const uint32_t look = pbf_steps_to_look_at(solver, left);
  const uint64_t before = solver->step;
  const uint32_t possible = pbf_steps_possible(solver, look);
  pbf_status status = PBF_OK;
  if (possible > 0) status = advance_and_keep(solver, possible);
  if (status == PBF_OK && (possible > 0 || left < of)) status = pbf_snapshots_make(solver);
  if (status != PBF_OK) return status;
  left -= (uint32_t)(solver->step - before);
  if (left == 0) return PBF_OK;
  if (pbf_is_cancelled(solver))
    return pbf_fail(PBF_ERROR_CANCELLED, "pbf_cancel has ended the call after %u of %u steps",
                    of - left, of);
  return pbf_fail_to_move(solver, of - left + 1, of);
}

pbf_status pbf_run_steps(pbf_solver *solver, uint32_t steps) {
  uint32_t left = steps;
  pbf_status status = pbf_check_unmapped(solver);
  if (status != PBF_OK || steps == 0) return status;
  solver->untold = solver->told = 0;
  pbf_check_step_length(solver);
  status = advance_far(solver, &left);
  return status == PBF_OK ? run_to_end(solver, left, steps) : status;
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
