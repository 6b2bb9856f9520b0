#include "set_params.h"

#include "backend_call.h"
#include "handles.h"
#include "overlap.h"
#include "params.h"
#include "particles/phases.h"
#include "prestabilize.h"
#include "solver_time.h"
#include "structs.h"

pbf_status pbf_params_to_backend(pbf_solver *solver, const pbf_params *params) {
  pbf_params clean = pbf_params_for_backend(params, solver->kind.dimension);
  pbf_status status = solver->api.set_params(solver->backend, &clean);
  if (status == PBF_OK) solver->time_step_there = params->time_step;
  return pbf_backend_result(solver, status, "set_params");
}

static pbf_status set_params(pbf_solver *solver, const pbf_params *theirs) {
  pbf_params params;
  pbf_status status = pbf_params_in(theirs, &params);
  if (status == PBF_OK) status = pbf_params_check(&params, solver->kind, pbf_solver_time(solver));
  if (status == PBF_OK) status = pbf_phases_check_params(solver->phases, &params);
  if (status != PBF_OK) return status;
  const int other_grid = params.pressure_grid != solver->params.pressure_grid;
  const double left = other_grid ? pbf_overlap_steps_leave(solver) : 0;
  status = pbf_params_to_backend(solver, &params);
  if (status != PBF_OK) return status;
  if (params.time_step != solver->params.time_step) pbf_solver_rebase_time(solver);
  pbf_note_params(solver, &params);
  solver->params = params;
  if (other_grid) pbf_overlap_note_grid(solver, left);
  solver->step_length_checked = 0;
  return PBF_OK;
}

pbf_status pbf_set_params(pbf_solver *solver, const pbf_params *params) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_params(solver, params));
}

static pbf_status get_params(pbf_solver *solver, pbf_params *theirs) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_params, theirs);
  if (status == PBF_OK)
    pbf_struct_out(&pbf_kind_params, &solver->params, theirs, theirs->struct_size);
  return status;
}

pbf_status pbf_get_params(pbf_solver *solver, pbf_params *params) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_params(solver, params));
}
