#include "solver_time.h"

double pbf_part_time_step(const pbf_solver *solver) {
  const double step = solver->params.time_step;
  return solver->parts > 1 ? step / solver->parts : step;
}

/* Between two steps a part is 0. */
double pbf_solver_time(const pbf_solver *solver) {
  const double time = solver->time_base + (double)solver->steps_since * solver->params.time_step;
  return solver->part == 0 ? time : time + solver->part * pbf_part_time_step(solver);
}

double pbf_time_of_step(const pbf_solver *solver, uint32_t steps) {
  return solver->time_base + (double)(solver->steps_since + steps) * solver->params.time_step;
}

void pbf_solver_rebase_time(pbf_solver *solver) {
  solver->time_base = pbf_solver_time(solver);
  solver->steps_since = 0;
}
