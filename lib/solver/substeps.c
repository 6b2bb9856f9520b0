#include "substeps.h"

#include <math.h>

#include "emission/emission.h"
#include "set_params.h"
#include "step_limit.h"

/* A particle may become faster within the step; what it falls by then, gravity's limit bounds. */
pbf_status pbf_substeps_of(pbf_solver *solver, uint32_t *substeps) {
  double speed;
  uint32_t cause;
  *substeps = 1;
  const double stream = solver->emission ? solver->emission->work->speed(solver) : 0;
  if (solver->params.max_substeps <= 1 || (solver->count == 0 && !(stream > 0))) return PBF_OK;
  pbf_status status = pbf_max_speed(solver, &speed);
  if (status != PBF_OK) return status;
  speed = fmax(speed, stream);
  const pbf_step_limits limits = pbf_step_limits_of(solver, speed);
  pbf_warn_of_long_steps(solver, &limits, 1u << PBF_LIMIT_PARTICLES);
  double parts = solver->params.time_step / pbf_shortest_limit(&limits, &cause);
  parts = ceil(parts - 1e-9);
  *substeps = (uint32_t)fmin(fmax(parts, 1), solver->params.max_substeps);
  return PBF_OK;
}

pbf_status pbf_divide_step(pbf_solver *solver, uint32_t substeps) {
  pbf_params part = solver->params;
  part.time_step /= substeps;
  if (part.time_step == solver->time_step_there) return PBF_OK;
  return pbf_params_to_backend(solver, &part);
}
