/* Steps that are too long: what for, what would do, and that it is said. */
#ifndef PBF_LIB_SOLVER_STEP_LIMIT_H
#define PBF_LIB_SOLVER_STEP_LIMIT_H

#include "solver.h"

/* The longest step for each PBF_LIMIT_…; infinite where nothing limits it. */
typedef struct pbf_step_limits {
  double step[PBF_LIMIT_TENSION + 1];
} pbf_step_limits;

/* By what the host knows, and by the speed of the fastest particle; 0: unknown. */
pbf_step_limits pbf_step_limits_of(const pbf_solver *solver, double particle_speed);

/* The shortest of them, and which it is. */
double pbf_shortest_limit(const pbf_step_limits *limits, uint32_t *cause);

/* From the backend. */
pbf_status pbf_max_speed(pbf_solver *solver, double *speed);

/* Says once for each of these causes, a bit each, that it makes steps too long, and may say so
 * again once that has ended. */
void pbf_warn_of_long_steps(pbf_solver *solver, const pbf_step_limits *limits, uint32_t causes);

/* Before steps: of the causes that the host knows, if any of them may have changed. */
void pbf_check_step_length(pbf_solver *solver);

#endif
