/* Steps that begin in one call and end in another. */
#include "error.h"
#include "handles.h"
#include "step.h"
#include "os.h"
#include "worker.h"

static const pbf_worker_calls calls = {pbf_run_steps, pbf_is_alone, pbf_leave_begun};

pbf_status pbf_begin_step(pbf_solver *solver, uint32_t steps) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  status = pbf_check_unmapped(solver);
  if (status == PBF_OK) status = pbf_worker_start(solver);
  if (status != PBF_OK) return pbf_leave(solver, status);
  pbf_stay(solver, pbf_worker_thread(solver));
  pbf_worker_run(solver, &calls, steps);
  return PBF_OK;
}

static pbf_status end_step(pbf_solver *solver) {
  char why[PBF_MESSAGE_SIZE];
  pbf_status status = pbf_begin_end(solver);
  if (status != PBF_OK) return status;
  pbf_worker_wait(solver);
  status = pbf_worker_status(solver, why);
  pbf_leave_begun(solver, status);
  return status == PBF_OK ? PBF_OK : pbf_fail(status, "%s", why);
}

pbf_status pbf_end_step(pbf_solver *solver) {
  const int cancellation = pbf_uncancelled_begin();
  const pbf_status status = end_step(solver);
  pbf_uncancelled_end(cancellation);
  return status;
}
