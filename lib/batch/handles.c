/* Which handles of batches are valid, and in which of them a call runs. */
#include "handles.h"

#include "compiler.h"
#include "error.h"
#include "free.h"
#include "lock.h"
#include "os.h"
#include "solver/handles.h"

static pbf_batch *first_live;

static int is_live(const pbf_batch *batch) {
  const pbf_batch *live = first_live;
  while (live && live != batch) live = live->next_live;
  return live != NULL;
}

static pbf_status enter_locked(pbf_batch *batch) {
  if (!is_live(batch)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "batch is %p, which pbf_batch_create did not give or pbf_batch_destroy has "
                    "taken back",
                    (void *)batch);
  }
  if (batch->left) {
    return pbf_fail(PBF_ERROR_STATE,
                    "another thread was halfway in a call when this process was forked off; this "
                    "batch can only be destroyed");
  }
  if (batch->in_call) {
    return pbf_fail(PBF_ERROR_BUSY,
                    "another call is inside this batch; a batch belongs to one thread at a time");
  }
  batch->thread = pbf_this_thread();
  ++batch->references;
  /* in_call is set last: a fork before that drops no reference which is not there. */
  atomic_signal_fence(memory_order_release);
  batch->in_call = 1;
  return PBF_OK;
}

pbf_status pbf_batch_enter(pbf_batch *batch) {
  if (!batch)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "batch is null; pbf_batch_create makes one");
  pbf_status status = pbf_lock_check();
  if (status != PBF_OK) return status;
  const int cancellation = pbf_uncancelled_begin();
  pbf_lock_take(PBF_LOCK_SOLVERS);
  status = enter_locked(batch);
  if (status == PBF_OK) batch->cancellation = cancellation;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (status != PBF_OK) pbf_uncancelled_end(cancellation);
  return status;
}

/* Called with the lock held, which it opens. */
static void drop_reference(pbf_batch *batch) {
  const int last = --batch->references == 0;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (last) pbf_batch_free(batch);
}

pbf_status pbf_batch_leave(pbf_batch *batch, pbf_status status) {
  const int cancellation = batch->cancellation;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  batch->in_call = 0;
  drop_reference(batch);
  pbf_uncancelled_end(cancellation);
  return status;
}

void pbf_batch_publish(pbf_batch *batch) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  batch->references = 1;
  batch->next_live = first_live;
  first_live = batch;
  pbf_lock_release(PBF_LOCK_SOLVERS);
}

static void destroy(pbf_batch *batch) {
  pbf_lock_take(PBF_LOCK_SOLVERS);
  pbf_batch **link = &first_live;
  while (*link && *link != batch) link = &(*link)->next_live;
  if (!*link) {
    pbf_lock_release(PBF_LOCK_SOLVERS);
    return;
  }
  *link = batch->next_live;
  for (uint32_t k = 0; k < batch->world_count; ++k) pbf_solver_silence(batch->worlds[k].solver);
  drop_reference(batch);
}

void pbf_batch_destroy(pbf_batch *batch) {
  if (!batch || pbf_lock_check() != PBF_OK) return;
  const int cancellation = pbf_uncancelled_begin();
  destroy(batch);
  pbf_uncancelled_end(cancellation);
}

/* ---- In the child of a fork ------------------------------------------------------------------ */

/* The thread that runs there is the one that forked; a call of another one will not come back. */
static void leave_to_other_threads(void) {
  for (pbf_batch *batch = first_live; batch; batch = batch->next_live) {
    if (!batch->in_call || batch->thread == pbf_this_thread()) continue;
    batch->in_call = 0;
    batch->left = 1;
    --batch->references;
  }
}

PBF_AT_LOAD(prepare_for_forks) { pbf_at_fork(NULL, NULL, leave_to_other_threads); }
