/* Pre-stabilization: positions alone are moved to rest density, by a step of no time. No particle
 * falls or flies in it, and no move becomes velocity, for that is the move times 1 / dt. */
#ifndef PBF_PHYSICS_PROJECT_H
#define PBF_PHYSICS_PROJECT_H

#include <pbf/pbf.h>

/* The column `projected` of params.def. */
enum { PBF_PROJECTED_KEPT = 0, PBF_PROJECTED_CLEARED = 1 };

static inline pbf_params pbf_projection_of(const pbf_params *params, uint32_t iterations) {
  pbf_params p = *params;
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  if (PBF_PROJECTED_##projected) p.name = 0;
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  for (int k = 0; PBF_PROJECTED_##projected && k < count; ++k) p.name[k] = 0;
#include "physics/params.def"
  p.iterations = iterations;
  p.loads = 0;
  return p;
}

/* 1 / dt, and 0 in a projection. */
static inline double pbf_per_time_step(const pbf_params *params) {
  return params->time_step > 0 ? 1 / params->time_step : 0;
}

#endif
