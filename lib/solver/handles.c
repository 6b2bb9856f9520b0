/* Which handles are valid, and in which solvers a call runs: one lock for both, so that a handle
 * that was destroyed is refused without looking into its memory. */
#include "handles.h"

#include <stddef.h>
#include <stdint.h>

#include "compiler.h"
#include "worker.h"
#include "callbacks.h"
#include "error.h"
#include "free.h"
#include "lock.h"
#include "snapshot_memory.h"
#include "os.h"

enum { BUCKET_BITS = 10, BUCKETS = 1 << BUCKET_BITS }; /* a batch has a thousand solvers */

static pbf_solver *buckets[BUCKETS];

static pbf_solver **bucket_of(const pbf_solver *solver) {
  const uint32_t mixed = (uint32_t)((uintptr_t)solver / 16) * 2654435761u; /* Knuth's hash */
  return &buckets[mixed >> (32 - BUCKET_BITS)];
}

static int is_live(const pbf_solver *solver) {
  const pbf_solver *live = *bucket_of(solver);
  while (live && live != solver) live = live->next_live;
  return live != NULL;
}

/* Called with the lock held, which it opens. */
static void drop_reference(pbf_solver *solver) {
  int last = --solver->references == 0;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (last) pbf_solver_free(solver);
}

/* The call noted as inside has been left through a callback, and will not return. */
static void leave_halfway(pbf_solver *solver, pbf_left why) {
  solver->in_call = 0;
  solver->begun = PBF_BEGUN_NOT;
  solver->callbacks.frame = NULL;
  solver->left = why;
  --solver->references;
}

static void see_whether_left(pbf_solver *solver) {
  if (solver->in_call && pbf_callbacks_were_left(solver))
    leave_halfway(solver, PBF_LEFT_BY_CALLBACK);
}

static pbf_status fail_as_left(const pbf_solver *solver) {
  return pbf_fail(
      PBF_ERROR_STATE, "%s; this solver can only be destroyed",
      solver->left == PBF_LEFT_BY_CALLBACK
          ? "an exception, a longjmp or the end of its thread has left a callback, and so a "
            "call, halfway"
          : "another thread was halfway in a call when this process was forked off");
}

static pbf_status find_locked(pbf_solver *solver) {
  if (!is_live(solver)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "solver is %p, which pbf_create did not give or pbf_destroy has taken back",
                    (void *)solver);
  }
  see_whether_left(solver);
  return solver->left ? fail_as_left(solver) : PBF_OK;
}

static pbf_status check_handle(const pbf_solver *solver) {
  if (!solver) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "solver is null; pbf_create makes one");
  return pbf_lock_check();
}

static pbf_status enter_locked(pbf_solver *solver) {
  pbf_status status = find_locked(solver);
  if (status != PBF_OK) return status;
  if (solver->begun) {
    return pbf_fail(PBF_ERROR_BUSY,
                    "steps that pbf_begin_step has begun run in this solver until pbf_end_step%s",
                    solver->begun == PBF_BEGUN_ENDING ? ", in which a thread is" : "");
  }
  if (solver->in_call) {
    return pbf_fail(PBF_ERROR_BUSY,
                    "another call is inside this solver; a solver belongs to one thread at a time");
  }
  atomic_store_explicit(&solver->cancelled, 0, memory_order_relaxed);
  solver->callbacks.thread = pbf_this_thread();
  solver->callbacks.frame = NULL;
  atomic_signal_fence(memory_order_release); /* a fork in between must know which call it is in */
  solver->in_call = 1;
  ++solver->references;
  return PBF_OK;
}

pbf_status pbf_enter(pbf_solver *solver) {
  pbf_status status = check_handle(solver);
  if (status != PBF_OK) return status;
  const int cancellation = pbf_uncancelled_begin();
  pbf_lock_take(PBF_LOCK_SOLVERS);
  status = enter_locked(solver);
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (status != PBF_OK) {
    pbf_uncancelled_end(cancellation);
    return status;
  }
  solver->callers_cancellation = cancellation;
  solver->callers_fp = pbf_fp_begin();
  pbf_plugin_message_clear();
  return PBF_OK;
}

pbf_status pbf_leave(pbf_solver *solver, pbf_status status) {
  pbf_fp_end(solver->callers_fp);
  const int cancellation = solver->callers_cancellation;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  solver->in_call = 0;
  drop_reference(solver);
  pbf_uncancelled_end(cancellation);
  return status;
}

pbf_status pbf_hold(pbf_solver *solver) {
  pbf_status status = check_handle(solver);
  if (status != PBF_OK) return status;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  status = find_locked(solver);
  if (status == PBF_OK) ++solver->references;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return status;
}

void pbf_let_go(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  drop_reference(solver);
}

/* With the lock held none begins or ends meanwhile: a call that begins later is not meant. */
pbf_status pbf_cancel(pbf_solver *solver) {
  pbf_status status = check_handle(solver);
  if (status != PBF_OK) return status;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  status = find_locked(solver);
  if (status == PBF_OK && solver->in_call)
    atomic_store_explicit(&solver->cancelled, 1, memory_order_relaxed);
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return status;
}

void pbf_stay(pbf_solver *solver, uintptr_t runner) {
  pbf_fp_end(solver->callers_fp);
  pbf_lock_take(PBF_LOCK_SOLVERS);
  solver->begun = PBF_BEGUN_STEPS;
  solver->callbacks.thread = runner;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  pbf_uncancelled_end(solver->callers_cancellation);
}

static pbf_status begin_end_locked(pbf_solver *solver) {
  pbf_status status = find_locked(solver);
  if (status != PBF_OK) return status;
  if (solver->begun == PBF_BEGUN_NOT)
    return pbf_fail(PBF_ERROR_STATE, "no steps have begun; pbf_begin_step begins them");
  if (solver->begun == PBF_BEGUN_ENDING)
    return pbf_fail(PBF_ERROR_BUSY, "another thread is in pbf_end_step of this solver");
  if (solver->callbacks.thread == pbf_this_thread())
    return pbf_fail(PBF_ERROR_BUSY,
                    "the call comes from a callback of the steps that it would end");
  solver->begun = PBF_BEGUN_ENDING;
  return PBF_OK;
}

pbf_status pbf_begin_end(pbf_solver *solver) {
  pbf_status status = check_handle(solver);
  if (status != PBF_OK) return status;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  status = begin_end_locked(solver);
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return status;
}

pbf_status pbf_leave_begun(pbf_solver *solver, pbf_status status) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  solver->in_call = 0;
  solver->begun = PBF_BEGUN_NOT;
  drop_reference(solver);
  return status;
}

int pbf_is_alone(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  const int is_alone = solver->begun == PBF_BEGUN_ALONE;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return is_alone;
}

/* Steps that have begun are ended first, unless another thread does that. */
static void end_begun(pbf_solver *solver) {
  int ends = 0;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  if (is_live(solver) && solver->begun == PBF_BEGUN_STEPS) {
    atomic_store_explicit(&solver->cancelled, 1, memory_order_relaxed);
    ends = solver->callbacks.thread != pbf_this_thread();
    solver->begun = ends ? PBF_BEGUN_ENDING : PBF_BEGUN_ALONE;
  }
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (!ends) return;
  pbf_worker_wait(solver);
  pbf_leave_begun(solver, PBF_OK);
}

void pbf_solver_publish(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  solver->references = 1;
  solver->next_live = *bucket_of(solver);
  atomic_signal_fence(memory_order_release);
  *bucket_of(solver) = solver;
  pbf_lock_release(PBF_LOCK_SOLVERS);
}

static int belongs_to_batch(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  const int belongs = is_live(solver) && solver->in_batch;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return belongs;
}

void pbf_solver_set_in_batch(pbf_solver *solver, uint32_t in_batch) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  solver->in_batch = in_batch;
  pbf_lock_release(PBF_LOCK_SOLVERS);
}

void pbf_solver_silence(pbf_solver *solver) {
  atomic_store_explicit(&solver->destroyed, 1, memory_order_relaxed);
}

static void destroy(pbf_solver *solver) {
  if (belongs_to_batch(solver)) return;
  end_begun(solver);
  pbf_lock_take(PBF_LOCK_SOLVERS);
  pbf_solver **link = bucket_of(solver);
  while (*link && *link != solver) link = &(*link)->next_live;
  if (!*link) {
    pbf_lock_release(PBF_LOCK_SOLVERS);
    return;
  }
  *link = solver->next_live;
  pbf_solver_silence(solver);
  see_whether_left(solver);
  drop_reference(solver);
}

void pbf_destroy(pbf_solver *solver) {
  if (!solver || pbf_lock_check() != PBF_OK) return;
  const int cancellation = pbf_uncancelled_begin();
  destroy(solver);
  pbf_uncancelled_end(cancellation);
}

/* ---- A thread that ends in a callback -------------------------------------------------------- */

/* As by pthread_exit. Of steps that have begun it may be waited for. */
static void leave_with_thread(pbf_solver *solver) {
  if (solver->begun == PBF_BEGUN_ENDING) {
    solver->left = PBF_LEFT_BY_CALLBACK;
    pbf_worker_has_ended(solver);
  } else {
    if (solver->begun == PBF_BEGUN_STEPS) pbf_worker_has_ended(solver);
    leave_halfway(solver, PBF_LEFT_BY_CALLBACK);
  }
}

static void end_with_thread(void) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  for (int k = 0; k < BUCKETS; ++k)
    for (pbf_solver *solver = buckets[k]; solver; solver = solver->next_live)
      if (solver->in_call && solver->callbacks.thread == pbf_this_thread() &&
          solver->callbacks.frame) /* which other threads note without the lock */
        leave_with_thread(solver);
  pbf_lock_release(PBF_LOCK_SOLVERS);
}

PBF_AT_LOAD(prepare_for_ends) { pbf_os_watch_threads(end_with_thread); }

/* ---- In the child of a fork ------------------------------------------------------------------ */

/* What another thread was about to count. Each change is one of a number or of a link, and those of
 * one call are made in an order in which any part of them can stand. */
static void count_anew(pbf_solver *solver) {
  const pbf_snapshots *snapshots = solver->snapshots;
  if (!solver->in_call) solver->begun = PBF_BEGUN_NOT;
  solver->references = 1 + solver->in_call + solver->exported;
  for (uint32_t k = 0; snapshots && k < snapshots->count; ++k)
    solver->references += snapshots->list[k].readers;
}

/* Its one thread is the one that forked. */
static void leave_to_other_threads(void) {
  const int is_half_done = pbf_lock_forget_others(PBF_LOCK_SOLVERS);
  for (int k = 0; k < BUCKETS; ++k)
    for (pbf_solver *solver = buckets[k]; solver; solver = solver->next_live) {
      if (solver->in_call && solver->callbacks.thread != pbf_this_thread())
        leave_halfway(solver, PBF_LEFT_BY_FORK);
      if (is_half_done) count_anew(solver);
    }
}

PBF_AT_LOAD(prepare_for_forks) { pbf_at_fork(NULL, NULL, leave_to_other_threads); }

void pbf_solver_add_export(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  ++solver->exported;
  ++solver->references;
  pbf_lock_release(PBF_LOCK_SOLVERS);
}

void pbf_solver_drop_export(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  --solver->exported;
  drop_reference(solver);
}

pbf_status pbf_check_unmapped(pbf_solver *solver) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  uint32_t exported = solver->exported;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  uint32_t mapped = 0;
  for (int field = 0; field < PBF_FIELD_COUNT; ++field) mapped += solver->mapped[field];
  if (!mapped && !exported) return PBF_OK;
  return pbf_fail(PBF_ERROR_STATE,
                  "%u views are mapped and %u tensors exported; the particles can change after "
                  "pbf_unmap and the tensors' deleters",
                  mapped, exported);
}
