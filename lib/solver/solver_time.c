#include "solver_time.h"

double pbf_solver_time(const pbf_solver *solver) {
  return solver->time_base + (double)solver->steps_since * solver->params.time_step;
}

double pbf_time_of_step(const pbf_solver *solver, uint32_t steps) {
  return solver->time_base + (double)(solver->steps_since + steps) * solver->params.time_step;
}

void pbf_solver_rebase_time(pbf_solver *solver) {
  solver->time_base = pbf_solver_time(solver);
  solver->steps_since = 0;
}
