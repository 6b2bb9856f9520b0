/* What stands for -1 where a parameter leaves the choice to the solver: nothing that the build is
 * without. */
#ifndef PBF_PHYSICS_CHOICES_H
#define PBF_PHYSICS_CHOICES_H

#include "physics/features.h"
#include "physics/short_steps.h"

/* Whether velocities may be corrected, where nothing is said. */
static inline int pbf_may_correct(const pbf_params *params) {
  return (PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION) && params->solver == PBF_SOLVER_CHEBYSHEV;
}

/* params.angular_momentum_correction, or what stands for -1: walls that carry a fluid's weight give
 * it angular momentum, without gravity nothing may. */
static inline double pbf_angular_momentum_correction(const pbf_params *params) {
  if (params->angular_momentum_correction >= 0) return params->angular_momentum_correction;
  return pbf_may_correct(params) && pbf_gravity_of(params) == 0;
}

/* params.shear_stress_correction, or what stands for -1 where the fluid is deep (depth.h). */
static inline double pbf_shear_stress_correction(const pbf_params *params) {
  if (params->shear_stress_correction >= 0) return params->shear_stress_correction;
  return pbf_may_correct(params) && pbf_gravity_of(params) > 0 ? 0.75 : 0;
}

#endif
