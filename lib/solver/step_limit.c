#include "step_limit.h"

#include <math.h>
#include <stdio.h>

#include "backend_call.h"
#include "collider.h"
#include "check.h"
#include "handles.h"
#include "params.h"
#include "particles/accelerations.h"
#include "physics/capillary.h"
#include "physics/step_limit.h"
#include "solver_time.h"
#include "text.h"

static double colliders_speed(const pbf_solver *solver, const pbf_params *params) {
  const double elapsed = pbf_solver_time(solver) - solver->collider_time;
  double fastest = 0;
  for (uint32_t i = 0; i < solver->collider_count; ++i) {
    pbf_collider now;
    pbf_motion_collider_state(&solver->colliders[i], elapsed, &now);
    pbf_collider_clean(&now, solver->kind.dimension);
    fastest = fmax(fastest, pbf_fastest_collider(params, solver->kind.dimension, 1, &now));
  }
  return fastest;
}

pbf_step_limits pbf_step_limits_of(const pbf_solver *solver, double particle_speed) {
  const uint32_t dimension = solver->kind.dimension;
  const pbf_params params = pbf_params_for_backend(&solver->params, dimension);
  const double d = pbf_derive_spacing(&params), now = pbf_solver_time(solver);
  const double falls = fmax(pbf_motion_length(params.gravity), pbf_largest_acceleration(solver));
  const double pull = pbf_attraction_acceleration(&params, dimension, solver->count, now);
  return (pbf_step_limits){{
      [PBF_LIMIT_NONE] = INFINITY,
      [PBF_LIMIT_GRAVITY] = pbf_limit_of_acceleration(d, falls),
      [PBF_LIMIT_ATTRACTION] = pbf_limit_of_acceleration(d, pull),
      [PBF_LIMIT_PARTICLES] = pbf_limit_of_speed(d, particle_speed),
      [PBF_LIMIT_WALLS] = pbf_limit_of_speed(d, pbf_fastest_wall(&params, dimension)),
      [PBF_LIMIT_COLLIDERS] = pbf_limit_of_speed(d, colliders_speed(solver, &params)),
      [PBF_LIMIT_TENSION] = pbf_limit_of_tension(d, params.surface_tension, dimension),
  }};
}

double pbf_shortest_limit(const pbf_step_limits *limits, uint32_t *cause) {
  double shortest = INFINITY;
  *cause = PBF_LIMIT_NONE;
  for (uint32_t k = 0; k <= PBF_LIMIT_TENSION; ++k)
    if (limits->step[k] < shortest) shortest = limits->step[ *cause = k];
  return shortest;
}

pbf_status pbf_max_speed(pbf_solver *solver, double *speed) {
  *speed = 0;
  if (solver->count == 0) return PBF_OK;
  if (solver->api.max_speed)
    return pbf_backend_result(solver, solver->api.max_speed(solver->backend, speed), "max_speed");
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_status status = solver->api.get_stats(solver->backend, &stats);
  *speed = stats.speed_max;
  return pbf_backend_result(solver, status, "get_stats");
}

static const char *const names[] = {
    [PBF_LIMIT_GRAVITY] = "gravity",
    [PBF_LIMIT_ATTRACTION] = "attraction",
    [PBF_LIMIT_PARTICLES] = "the fastest particle",
    [PBF_LIMIT_WALLS] = "the fastest wall",
    [PBF_LIMIT_COLLIDERS] = "the fastest collider",
    [PBF_LIMIT_TENSION] = "surface tension",
};

/* What is too much does not act, and nothing goes wrong. */
static void warn_of_tension(const pbf_solver *solver, double limit) {
  double step = solver->params.time_step, parts = fmax(solver->params.max_substeps, 1);
  double part = limit / (step / parts);
  char text[300];
  pbf_text_write(text, sizeof text,
                 "params.time_step, %.3g, is too long for surface tension: only %.2g of "
                 "params.surface_tension acts; %.3g would do, or max_substeps %.0f",
                 step, part * part, parts * limit, ceil(step / limit - 1e-9));
  solver->log(solver->log_user, PBF_LOG_WARNING, text);
}

static void warn(const pbf_solver *solver, uint32_t cause, double limit) {
  if (cause == PBF_LIMIT_TENSION) {
    warn_of_tension(solver, limit);
    return;
  }
  double step = solver->params.time_step, parts = fmax(solver->params.max_substeps, 1);
  double times = step / parts / limit; /* as long as it may be */
  int falls = cause == PBF_LIMIT_GRAVITY || cause == PBF_LIMIT_ATTRACTION;
  char divided[40] = "", text[300];
  if (parts > 1) snprintf(divided, sizeof divided, " in %.0f parts", parts);
  pbf_text_write(
      text, sizeof text,
      "params.time_step, %.3g%s, is too long for %s: %s %.2g spacings%s, where %s is the most; "
      "%.3g would do, or max_substeps %.0f",
      step, divided, names[cause], falls ? "it makes velocities grow by" : "it goes",
      falls ? 0.5 * times * times : times, falls ? " a step" : " in it", falls ? "0.5" : "1",
      parts * limit, ceil(step / limit - 1e-9));
  solver->log(solver->log_user, PBF_LOG_WARNING, text);
}

void pbf_warn_of_long_steps(pbf_solver *solver, const pbf_step_limits *limits, uint32_t causes) {
  double step = solver->params.time_step / fmax(solver->params.max_substeps, 1);
  for (uint32_t k = PBF_LIMIT_GRAVITY; k <= PBF_LIMIT_TENSION; ++k) {
    if (!(causes >> k & 1)) continue;
    int is_long = step > limits->step[k] * (1 + 1e-9), was_said = (int)(solver->said >> k & 1);
    if (is_long && !was_said) warn(solver, k, limits->step[k]);
    solver->said = (solver->said & ~(1u << k)) | (uint32_t)is_long << k;
  }
}

void pbf_check_step_length(pbf_solver *solver) {
  if (solver->step_length_checked) return;
  const pbf_step_limits limits = pbf_step_limits_of(solver, 0);
  pbf_warn_of_long_steps(solver, &limits,
                         1u << PBF_LIMIT_GRAVITY | 1u << PBF_LIMIT_ATTRACTION |
                             1u << PBF_LIMIT_WALLS | 1u << PBF_LIMIT_COLLIDERS |
                             1u << PBF_LIMIT_TENSION);
  solver->step_length_checked = 1;
}

static pbf_status get_step_limit(pbf_solver *solver, double *limit) {
  uint32_t cause;
  double speed;
  pbf_status status = pbf_check_pointer("limit", limit, sizeof *limit);
  if (status == PBF_OK) status = pbf_max_speed(solver, &speed);
  if (status != PBF_OK) return status;
  const pbf_step_limits limits = pbf_step_limits_of(solver, speed);
  *limit = pbf_shortest_limit(&limits, &cause);
  return PBF_OK;
}

pbf_status pbf_get_step_limit(pbf_solver *solver, double *limit) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_step_limit(solver, limit));
}
