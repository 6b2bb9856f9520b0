#include "plan.h"

#include "backend_call.h"

/* As many as there are, yet no fewer than before unless a quarter of them is gone: where particles
 * come and go all the time, water at the depth where a pressure grid begins to serve would breathe
 * with each change of the plan (half a layer, measured). It depends on nothing but what is in the
 * solver and what was in it at its last step, which a saved state knows: not on the capacity. */
static uint32_t count_to_plan_for(const pbf_solver *solver) {
  uint64_t kept = (uint64_t)solver->planned / 4 * 3;
  int fits = solver->count <= solver->planned && solver->count >= kept;
  return fits ? solver->planned : solver->count;
}

pbf_status pbf_plan_now(pbf_solver *solver) {
  uint32_t count = count_to_plan_for(solver);
  if (count == solver->planned_there || !solver->api.plan_for) return PBF_OK;
  pbf_status status = solver->api.plan_for(solver->backend, count);
  if (status == PBF_OK) solver->planned_there = count;
  return pbf_backend_result(solver, status, "plan_for");
}

pbf_status pbf_plan_step(pbf_solver *solver) {
  pbf_status status = pbf_plan_now(solver);
  if (status == PBF_OK) solver->planned = count_to_plan_for(solver);
  return status;
}
