/* Steps so short that what they do to an error at once would throw the fluid. */
#ifndef PBF_PHYSICS_SHORT_STEPS_H
#define PBF_PHYSICS_SHORT_STEPS_H

#include <math.h>

#include <pbf/pbf.h>

#include "physics/real.h"

static inline double pbf_gravity_of(const pbf_params *params) {
  double g2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) g2 += params->gravity[k] * params->gravity[k];
  return sqrt(g2);
}

/* What a step does to the density error that it finds becomes velocity: error times h / dt, without
 * bound as dt shrinks. So a step shorter than `time`, a fiftieth of the time in which a particle
 * falls by about h (2 ms for h = 0.1 m), undoes only its share dt / time of it. */
static inline double pbf_residual_part(const pbf_params *params) {
  double g = pbf_gravity_of(params);
  if (params->solver != PBF_SOLVER_CHEBYSHEV || !(g > 0)) return 0;
  double time = 0.02 * sqrt(params->smoothing_radius / g);
  return fmax(0, 1 - params->time_step / time);
}

#endif
