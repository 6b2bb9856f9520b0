/* Steps: in one call, in two, and cancelled. */
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "helpers.h"
#include "table.h"

/* Both have the same end after the same number of steps. */
static void check_ends(actor *a, uint64_t begin, const pbf_status status[TWINS]) {
  if (a->injected[0] || a->injected[1]) {
    if (step_of(a, 0) != step_of(a, 1)) _exit(0); /* a limit parts them */
    return;
  }
  if (status[0] != status[1])
    found(a->number, "%s: %s on %s (%s), %s on %s (%s)", a->function, pbf_status_string(status[0]),
          a->subject->backend[0], a->sentence[0], pbf_status_string(status[1]),
          a->subject->backend[1], a->sentence[1]);
  check_subject(a);
  if (step_of(a, 0) > begin) check_places(a, (int)dice_below(&a->dice, TWINS));
}

static int divides_steps(actor *a) {
  pbf_params params = {.struct_size = sizeof params};
  while (pbf_get_params(a->subject->twin[0], &params) == PBF_ERROR_BUSY) {
  }
  return params.max_substeps > 1;
}

void advance_both(actor *a, uint64_t begin, uint64_t end) {
  const uint64_t same = dice_next(&a->dice);
  const int divides = divides_steps(a);
  const uint64_t memory = soak_record->faults[FAULT_MEMORY];
  pbf_status status[TWINS];
  for (int twin = 0; twin < TWINS; ++twin) {
    a->dice.state = same;
    status[twin] = advance(a, twin, end);
  }
  if (divides && memory != soak_record->faults[FAULT_MEMORY]) even_out(a);
  check_ends(a, begin, status);
}

void call_step(actor *a) {
  const uint64_t now = step_of(a, 0);
  const uint32_t most = dice_one_in(&a->dice, 8) ? 20 : 4;
  advance_both(a, now, now + dice_below(&a->dice, most));
}

/* One that would take for ever, until another thread cancels it; its twin then goes as far. */
void call_cancel(actor *a) {
  insist(a, pbf_cancel(a->subject->twin[0]) == PBF_OK);
  insist(a, pbf_cancel(NULL) == PBF_ERROR_INVALID_ARGUMENT);
  if (!a->with->cancels || !helpers_cancel_soon(a->subject->twin[0])) {
    call_step(a);
    return;
  }
  const uint64_t before = step_of(a, 0);
  pbf_status status = PBF_ERROR_BUSY;
  while (status == PBF_ERROR_BUSY) status = pbf_step(a->subject->twin[0], 100000000);
  const uint64_t end = step_of(a, 0);
  helpers_cancel_no_more();
  if (status == PBF_ERROR_CANCELLED) {
    count_fault(FAULT_CANCEL);
    count_steps(a, end - before);
    status = advance(a, 1, end);
    if (status != PBF_OK && !a->injected[1])
      found(a->number, "%s: %s, which has cancelled none: %s", a->function,
            pbf_status_string(status), a->sentence[1]);
    if (divides_steps(a)) even_out(a);
    check_subject(a);
    even_out(a); /* what was before the last step is kept by the one that was not cancelled */
  } else {
    snprintf(a->sentence[0], sizeof a->sentence[0], "%s", pbf_last_error());
    check_status(a, status, a->sentence[0]);
    advance_both(a, end, end + 1); /* what fails, fails at once on the other one, too */
  }
}

/* ---- In two calls ---- */

static pbf_status begin_step(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_begin_step(solver, *(const uint32_t *)context);
}

/* All but a few calls have to wait. */
static void try_while_begun(actor *a, int twin) {
  pbf_solver *s = a->subject->twin[twin];
  pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
  uint32_t count;
  count_fault(FAULT_BEGUN);
  insist(a, pbf_get_count(s, &count) == PBF_ERROR_BUSY);
  insist(a, pbf_step(s, 1) == PBF_ERROR_BUSY && pbf_begin_step(s, 1) == PBF_ERROR_BUSY);
  insist(a, pbf_set_params(s, NULL) == PBF_ERROR_BUSY);
  if (pbf_acquire_snapshot(s, &snapshot) == PBF_OK)
    insist(a, pbf_release_snapshot(&snapshot) == PBF_OK);
  if (a->with->cancels && dice_one_in(&a->dice, 2)) insist(a, pbf_cancel(s) == PBF_OK);
}

static void begin_and_end(actor *a, int twin, uint32_t steps) {
  const uint64_t before = step_of(a, twin);
  if (call_one(a, twin, begin_step, &steps, CALL_PLAIN) != PBF_OK) return;
  a->subject->begun[twin] = 1;
  try_while_begun(a, twin);
  const struct timespec nap = {0, 200000};
  if (dice_one_in(&a->dice, 3)) nanosleep(&nap, NULL);
  pbf_status status = pbf_end_step(a->subject->twin[twin]);
  a->subject->begun[twin] = 0;
  check_status(a, status, pbf_last_error());
  count_steps(a, step_of(a, twin) - before);
  if (status == PBF_ERROR_CANCELLED) count_fault(FAULT_CANCEL);
}

/* What has been cancelled, or could not begin, is made up for. */
void call_begin_step(actor *a) {
  const uint32_t steps = 1 + dice_below(&a->dice, 6);
  const uint64_t begin = step_of(a, 0);
  for (int twin = 0; twin < TWINS; ++twin) begin_and_end(a, twin, steps);
  advance_both(a, begin, begin + steps);
}

void call_end_step(actor *a) {
  insist(a, pbf_end_step(a->subject->twin[dice_below(&a->dice, TWINS)]) == PBF_ERROR_STATE);
}

static pbf_status synchronize(pbf_solver *solver, int twin, void *context) {
  (void)twin, (void)context;
  return pbf_synchronize(solver);
}

void call_synchronize(actor *a) { call_both(a, synchronize, NULL, CALL_READS); }
