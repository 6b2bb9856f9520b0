/* Which handles are valid, and in which solvers a call runs: one lock for both, so that a handle
 * that was destroyed is refused without looking into its memory. */
#include "handles.h"

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "free.h"

enum { BUCKETS = 64 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pbf_solver *buckets[BUCKETS];

static pbf_solver **bucket_of(const pbf_solver *solver) {
  return &buckets[(uintptr_t)solver / 64 % BUCKETS];
}

static int is_live(const pbf_solver *solver) {
  const pbf_solver *live = *bucket_of(solver);
  while (live && live != solver) live = live->next_live;
  return live != NULL;
}

/* Called with the lock held, which it opens. */
static void drop_reference(pbf_solver *solver) {
  int last = --solver->references == 0;
  pthread_mutex_unlock(&lock);
  if (last) pbf_solver_free(solver);
}

static pbf_status enter_locked(pbf_solver *solver) {
  if (!is_live(solver)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "solver is %p, which pbf_create did not give or pbf_destroy has taken back",
                    (void *)solver);
  }
  if (solver->in_call) {
    return pbf_fail(PBF_ERROR_BUSY,
                    "another call is inside this solver; a solver belongs to one thread at a time");
  }
  solver->in_call = 1;
  ++solver->references;
  return PBF_OK;
}

pbf_status pbf_enter(pbf_solver *solver) {
  if (!solver) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "solver is null; pbf_create makes one");
  pthread_mutex_lock(&lock);
  pbf_status status = enter_locked(solver);
  pthread_mutex_unlock(&lock);
  if (status == PBF_OK) pbf_plugin_message_clear();
  return status;
}

pbf_status pbf_leave(pbf_solver *solver, pbf_status status) {
  pthread_mutex_lock(&lock);
  solver->in_call = 0;
  drop_reference(solver);
  return status;
}

void pbf_solver_publish(pbf_solver *solver) {
  pthread_mutex_lock(&lock);
  solver->references = 1;
  solver->next_live = *bucket_of(solver);
  *bucket_of(solver) = solver;
  pthread_mutex_unlock(&lock);
}

void pbf_destroy(pbf_solver *solver) {
  if (!solver) return;
  pthread_mutex_lock(&lock);
  pbf_solver **link = bucket_of(solver);
  while (*link && *link != solver) link = &(*link)->next_live;
  if (!*link) {
    pthread_mutex_unlock(&lock);
    return;
  }
  *link = solver->next_live;
  drop_reference(solver);
}

void pbf_solver_add_export(pbf_solver *solver) {
  pthread_mutex_lock(&lock);
  ++solver->exported;
  ++solver->references;
  pthread_mutex_unlock(&lock);
}

void pbf_solver_drop_export(pbf_solver *solver) {
  pthread_mutex_lock(&lock);
  --solver->exported;
  drop_reference(solver);
}

pbf_status pbf_check_unmapped(pbf_solver *solver) {
  pthread_mutex_lock(&lock);
  uint32_t exported = solver->exported;
  pthread_mutex_unlock(&lock);
  uint32_t mapped = 0;
  for (int field = 0; field < PBF_FIELD_COUNT; ++field) mapped += solver->mapped[field];
  if (!mapped && !exported) return PBF_OK;
  return pbf_fail(PBF_ERROR_STATE,
                  "%u views are mapped and %u tensors exported; the particles can change after "
                  "pbf_unmap and the tensors' deleters",
                  mapped, exported);
}
