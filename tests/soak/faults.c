/* Faults that are not a part of one call: processes that fork, callbacks that are left, arguments
 * that are wrong. */
#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "limits.h"
#include "table.h"
#include "tasks.h"

enum { TIME_LIMIT = 150 /* seconds, of a child that hangs */ };

/* ---- Children ---- */

static pid_t begin_child(void) {
  pid_t child = fork();
  if (child != 0) return child;
  signal(SIGUSR1, SIG_IGN);
  alarm(TIME_LIMIT);
  tasks_after_fork();
  return 0;
}

/* Known statuses are all that is asked of a solver that another thread may have been in. */
static void use(actor *a, pbf_solver *s) {
  uint32_t count = 0;
  uint64_t hash = 0;
  check_status(a, pbf_get_count(s, &count), pbf_last_error());
  check_status(a, pbf_step(s, 2), pbf_last_error());
  check_status(a, pbf_hash(s, &hash), pbf_last_error());
  pbf_status status = pbf_begin_step(s, 1);
  check_status(a, status, pbf_last_error());
  if (status == PBF_OK) check_status(a, pbf_end_step(s), pbf_last_error());
}

/* A device is the parent's. */
static void use_own(actor *a) {
  subject *s = a->subject;
  if (strcmp(s->backend[0], "cuda") == 0) return;
  for (int twin = 0; twin < TWINS; ++twin) { /* another thread may have been inside */
    uint32_t count;
    pbf_status status = pbf_get_count(s->twin[twin], &count);
    check_status(a, status, pbf_last_error());
    if (status == PBF_ERROR_STATE) return;
  }
  call_unmap(a);
  const uint64_t begin = step_of(a, 0);
  advance_both(a, begin, begin + 2);
  subject_drop(a, s);
  if (subject_make(a, s)) {
    call_add_particles(a);
    call_step(a);
  }
}

static void use_others(actor *a) {
  for (uint32_t k = 0; k < a->with->actors; ++k) {
    actor *other = &a->others[k];
    if (other == a) continue;
    for (int i = 0; i < SUBJECTS; ++i)
      for (int twin = 0; twin < TWINS; ++twin) {
        pbf_solver *s = other->subjects[i].twin[twin];
        if (!s) continue;
        use(a, s);
        if (dice_one_in(&a->dice, 3)) pbf_destroy(s);
      }
  }
}

static settings limited;

_Noreturn static void run_child(actor *a) {
  limited = *a->with; /* threads beside this one are gone */
  limited.intruders = limited.readers = limited.cancels = limited.signals = 0;
  limited.forks = 0;
  if (!limited.instrumented && dice_one_in(&a->dice, 3)) {
    limited.limit_addresses = 1;
    limit_addresses(dice_below(&a->dice, 16u << 20));
  }
  a->with = &limited;
  if (!dice_one_in(&a->dice, 4)) use_own(a);
  if (dice_one_in(&a->dice, 2)) use_others(a);
  if (limited.instrumented || !dice_one_in(&a->dice, 3)) _exit(0);
  exit(0); /* with what is left alive */
}

static void wait_for(actor *a, pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == FOUND_STATUS) _exit(FOUND_STATUS);
  if (WIFSIGNALED(status))
    found(a->number, "%s: signal %d%s ends the child", a->function, WTERMSIG(status),
          WTERMSIG(status) == SIGALRM ? " (it hangs)" : "");
  if (WEXITSTATUS(status) != 0)
    found(a->number, "%s: the child exits with %d", a->function, WEXITSTATUS(status));
}

void fault_fork(actor *a) {
  if (!a->with->forks) return;
  pid_t child = begin_child();
  if (child < 0) return;
  if (child == 0) run_child(a);
  count_fault(FAULT_FORK);
  wait_for(a, child);
  check_subject(a);
}

/* The parent's solvers are its own. */
void fault_kill(actor *a) {
  if (!a->with->forks) return;
  pid_t child = begin_child();
  if (child < 0) return;
  if (child == 0)
    for (;;) pbf_step(a->subject->twin[0], 50);
  count_fault(FAULT_KILL);
  const struct timespec nap = {0, (long)dice_below(&a->dice, 4000000)};
  nanosleep(&nap, NULL);
  kill(child, SIGKILL);
  while (waitpid(child, NULL, 0) < 0) {
  }
  check_subject(a);
}

/* ---- A callback that is left ---- */

static pbf_status call_something(actor *a, pbf_solver *s) {
  static _Thread_local unsigned char state[STATE_BYTES];
  uint64_t size = sizeof state;
  pbf_params params;
  switch (dice_below(&a->dice, 5)) {
    case 0:
      return pbf_step(s, 3);
    case 1:
      return pbf_set_snapshots(s, 3);
    case 2:
      return pbf_keep_previous(s, 1);
    case 3:
      return pbf_params_init(&params, sizeof params), pbf_set_params(s, &params);
    default:
      if (pbf_save(s, state, &size) != PBF_OK) return PBF_OK;
      return pbf_load(s, state, size);
  }
}

/* Then the solver can only be destroyed, and gives all back. */
void fault_callback(actor *a) {
  subject *s = a->subject;
  heap *h = s->heap[0];
  uint32_t count;
  if (!a->with->leaving) return;
  h->thread = pthread_self();
  h->left = 0;
  h->leaving_in = 1 + (int)dice_below(&a->dice, 4);
  if (setjmp(h->jump) == 0) call_something(a, s->twin[0]);
  h->leaving_in = 0;
  if (h->left) {
    count_fault(FAULT_CALLBACK);
    pbf_status status;
    while ((status = pbf_get_count(s->twin[0], &count)) == PBF_ERROR_BUSY && a->with->intruders) {
    }
    insist(a, status == PBF_ERROR_STATE);
  }
  fesetenv(FE_DFL_ENV);
  subject_drop(a, s);
  subject_make(a, s);
}

/* ---- Wrong arguments: each fails with a sentence, and changes nothing ---- */

static double lower[3] = {0, 0, 0};

static pbf_status wrongly(pbf_solver *s, int twin, void *context) {
  pbf_params params = {.struct_size = 8};
  pbf_collider collider = {.struct_size = 3};
  pbf_stats stats = {.struct_size = 1};
  pbf_view view = {.struct_size = 0};
  uint32_t count, ids[2] = {4000000000u, 4000000001u};
  uint64_t size = 3;
  double numbers[64] = {NAN};
  (void)twin;
  switch (*(uint32_t *)context) {
    case 0:
      return pbf_set_params(s, NULL);
    case 1:
      return pbf_set_params(s, &params);
    case 2:
      return pbf_get_params(s, NULL);
    case 3:
      return pbf_get_params(s, &params);
    case 4:
      return pbf_get_count(s, NULL);
    case 5:
      return pbf_add_particles(s, 1, NULL, NULL, NULL);
    case 6:
      return pbf_add_particles(s, UINT32_MAX, numbers, NULL, NULL);
    case 7:
      return pbf_add_particles(s, 1, numbers, NULL, NULL);
    case 8:
      return pbf_remove_particles(s, 1, NULL);
    case 9:
      return pbf_remove_particles(s, 2, ids);
    case 10:
      return pbf_remove_particles(s, UINT32_MAX, ids);
    case 11:
      return pbf_remove_in_box(s, NULL, lower, &count);
    case 12:
      return pbf_find_in_box(s, lower, lower, 1, NULL, &count);
    case 13:
      return pbf_find_in_box(s, lower, lower, 0, NULL, NULL);
    case 14:
      return pbf_get_positions(s, 0, UINT32_MAX, numbers);
    case 15:
      return pbf_get_velocities(s, UINT32_MAX, UINT32_MAX, numbers);
    case 16:
      return pbf_get_ids(s, UINT32_MAX, 1, ids);
    case 17:
      return pbf_set_positions(s, 1000000, 1, numbers);
    case 18:
      return pbf_set_velocities(s, 1, UINT32_MAX, numbers);
    case 19:
      return pbf_write(s, NULL) == PBF_OK ? PBF_OK : pbf_read(s, NULL);
    case 20:
      return pbf_keep_previous(s, 77);
    case 21:
      return pbf_set_colliders(s, 1, NULL);
    case 22:
      return pbf_set_colliders(s, 1, &collider);
    case 23:
      return pbf_set_colliders(s, 65, &collider);
    case 24:
      return pbf_move_colliders(s, UINT32_MAX, NULL, 1);
    case 25:
      return pbf_get_collider_count(s, NULL);
    case 26:
      return pbf_get_collider(s, UINT32_MAX, &collider);
    case 27:
      return pbf_map(s, 1, NULL);
    case 28:
      return pbf_map(s, 1, &view);
    case 29:
      return pbf_export_dlpack(s, 1, NULL);
    case 30:
      return pbf_set_snapshots(s, UINT32_MAX);
    case 31:
      return pbf_acquire_snapshot(s, NULL);
    case 32:
      return pbf_get_stats(s, &stats);
    case 33:
      return pbf_get_stats(s, NULL);
    case 34:
      return pbf_get_step_limit(s, NULL);
    case 35:
      return pbf_get_timings(s, NULL);
    case 36:
      return pbf_get_plan(s, NULL);
    case 37:
      return pbf_get_info(s, NULL);
    case 38:
      return pbf_save(s, NULL, NULL);
    case 39:
      return pbf_save(s, numbers, &size);
    case 40:
      return pbf_load(s, NULL, 100);
    case 41:
      return pbf_load(s, numbers, sizeof numbers);
    case 42:
      return pbf_load(s, numbers, 0);
    case 43:
      return pbf_hash(s, NULL);
    case 44:
      return pbf_end_step(s);
    case 45:
      return pbf_set_timing(s, 2);
    default:
      return pbf_unmap(s, 99);
  }
}

void fault_arguments(actor *a) {
  for (int k = 0; k < 3; ++k) {
    uint32_t which = dice_below(&a->dice, 47);
    count_fault(FAULT_ARGUMENT);
    call_both(a, wrongly, &which, CALL_READS | CALL_WRONG | CALL_PLAIN);
  }
}
