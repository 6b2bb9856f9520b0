/* Pre-stabilization: positions alone are moved to rest density, by a step of no time. Nobody falls
 * or flies in it, and no move becomes velocity, for that is the move times 1 / dt. */
#ifndef PBF_PHYSICS_PROJECT_H
#define PBF_PHYSICS_PROJECT_H

#include <pbf/pbf.h>

static inline pbf_params pbf_projection_of(const pbf_params *params, uint32_t iterations) {
  pbf_params p = *params;
  p.time_step = p.attraction = p.tolerance = p.vorticity = p.viscosity = p.undamping = 0;
  p.torque_correction = 0;
  p.pressure_grid = p.sleep_speed = 0;
  for (int k = 0; k < 3; ++k) p.gravity[k] = 0;
  p.iterations = iterations;
  return p;
}

/* 1 / dt, and 0 in a projection. */
static inline double pbf_per_time_step(const pbf_params *params) {
  return params->time_step > 0 ? 1 / params->time_step : 0;
}

#endif
