#include "snapshots.h"

#include "backend_call.h"
#include "error.h"
#include "handles.h"
#include "held_snapshots.h"
#include "ids.h"
#include "lock.h"
#include "rank_settings.h"
#include "snapshot_memory.h"
#include "solver_time.h"
#include "structs.h"

/* ---- Making one ------------------------------------------------------------------------------ */

/* Null where all are held but for the latest. Of that one none begins to be held by this. */
static snapshot *find_free(pbf_snapshots *all) {
  snapshot *found = NULL;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  for (uint32_t k = 0; k < all->count && !found; ++k)
    if (&all->list[k] != all->latest && all->list[k].readers == 0) found = &all->list[k];
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return found;
}

static pbf_status read_particles(pbf_solver *solver, void *positions, void *velocities) {
  const pbf_rows rows = pbf_ids_rows(solver, 0, solver->count);
  if (solver->count == 0) return PBF_OK;
  pbf_status status = solver->api.read(solver->backend, PBF_FIELD_POSITION, &rows, positions);
  if (status == PBF_OK)
    status = solver->api.read(solver->backend, PBF_FIELD_VELOCITY, &rows, velocities);
  return pbf_backend_result(solver, status, "read");
}

static pbf_status fill(pbf_solver *solver, snapshot *to) {
  to->count = solver->count;
  to->step = solver->step;
  to->time = pbf_solver_time(solver);
  for (uint32_t row = 0; row < solver->count; ++row) to->ids[row] = pbf_ids_of_row(solver, row);
  return read_particles(solver, to->positions, to->velocities);
}

/* Readers may hold all of one rank's snapshots, and none of another's, which needs all ranks to
 * make one. */
static pbf_status make(pbf_solver *solver, pbf_snapshots *all) {
  snapshot *next = find_free(all);
  if (!next) return all->spare ? read_particles(solver, all->spare, all->spare) : PBF_OK;
  pbf_status status = fill(solver, next);
  if (status != PBF_OK) return status;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  all->latest = next;
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return PBF_OK;
}

pbf_status pbf_snapshots_make(pbf_solver *solver) {
  return solver->snapshots ? make(solver, solver->snapshots) : PBF_OK;
}

/* ---- Asking for them ------------------------------------------------------------------------- */

/* Puts others in the place of those that there are, unless one of these is held. Returns what is to
 * be freed. */
static pbf_status exchange(pbf_solver *solver, pbf_snapshots **snapshots) {
  pbf_snapshots *before;
  uint32_t held = 0;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  before = solver->snapshots;
  for (uint32_t k = 0; before && k < before->count; ++k) held += before->list[k].readers;
  if (held == 0) {
    solver->snapshots = *snapshots;
    *snapshots = before;
  }
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (held == 0) return PBF_OK;
  return pbf_fail(PBF_ERROR_STATE,
                  "snapshots are held, %u times; pbf_release_snapshot must end that first", held);
}

static pbf_status set_snapshots(pbf_solver *solver, uint32_t count) {
  pbf_snapshots *snapshots = NULL;
  if (count == 1 || count > PBF_MAX_SNAPSHOTS)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "snapshots is %u; it must be 2 … %u, or 0", count,
                    PBF_MAX_SNAPSHOTS);
  pbf_status status = count > 0 ? pbf_snapshots_allocate(solver, count, &snapshots) : PBF_OK;
  if (status == PBF_OK && count > 0) status = make(solver, snapshots);
  if (status == PBF_OK) status = exchange(solver, &snapshots);
  if (status == PBF_OK) pbf_rank_settings_tell(solver);
  pbf_snapshots_free(solver, snapshots);
  return status;
}

pbf_status pbf_set_snapshots(pbf_solver *solver, uint32_t snapshots) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_snapshots(solver, snapshots));
}

/* ---- Holding one ----------------------------------------------------------------------------- */

static snapshot *hold_latest(pbf_solver *solver) {
  snapshot *latest = NULL;
  pbf_lock_take(PBF_LOCK_SOLVERS);
  if (solver->snapshots) {
    latest = solver->snapshots->latest;
    pbf_snapshot_hold(latest);
  }
  pbf_lock_release(PBF_LOCK_SOLVERS);
  return latest;
}

static pbf_status check_holder(const pbf_snapshot *theirs) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_snapshot, theirs);
  if (status != PBF_OK || !theirs->owner) return status;
  return pbf_fail(
      PBF_ERROR_STATE,
      "snapshot.owner is %p; it must be null, and a snapshot that is held released first",
      theirs->owner);
}

/* The reference to the solver stays as long as the snapshot is held. */
pbf_status pbf_acquire_snapshot(pbf_solver *solver, pbf_snapshot *theirs) {
  pbf_status status = check_holder(theirs);
  if (status == PBF_OK) status = pbf_hold(solver);
  if (status != PBF_OK) return status;
  snapshot *latest = hold_latest(solver);
  if (!latest) {
    pbf_let_go(solver);
    return pbf_fail(PBF_ERROR_STATE,
                    "the solver makes no snapshots; pbf_set_snapshots has it do so");
  }
  const pbf_snapshot held = {.struct_size = sizeof held,
                             .count = latest->count,
                             .dimension = solver->kind.dimension,
                             .element_type = solver->kind.precision,
                             .step = latest->step,
                             .time = latest->time,
                             .positions = latest->positions,
                             .velocities = latest->velocities,
                             .ids = latest->ids,
                             .owner = latest};
  pbf_struct_out(&pbf_kind_snapshot, &held, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_release_snapshot(pbf_snapshot *theirs) {
  static const pbf_snapshot none = {0};
  pbf_status status = pbf_struct_check_out(&pbf_kind_snapshot, theirs);
  if (status == PBF_OK) status = pbf_lock_check();
  if (status != PBF_OK) return status;
  if (!theirs->owner) return pbf_fail(PBF_ERROR_STATE, "snapshot.owner is null: nothing is held");
  pbf_lock_take(PBF_LOCK_SOLVERS);
  pbf_solver *solver = pbf_snapshot_let_go(theirs->owner);
  pbf_lock_release(PBF_LOCK_SOLVERS);
  if (!solver)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "snapshot.owner is %p, which pbf_acquire_snapshot did not give, or "
                    "pbf_release_snapshot has taken back",
                    theirs->owner);
  pbf_struct_out(&pbf_kind_snapshot, &none, theirs, theirs->struct_size);
  pbf_let_go(solver); /* which may free what was held */
  return PBF_OK;
}
