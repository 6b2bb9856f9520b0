/* What stands for -1 where a parameter leaves the choice to the solver: nothing that the build is
 * without. */
#ifndef PBF_PHYSICS_CHOICES_H
#define PBF_PHYSICS_CHOICES_H

#include "physics/features.h"
#include "physics/short_steps.h"
#include "physics/spacing.h"

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

/* params.shear_stress_correction, or what stands for -1 where the fluid is deep or fills a box
 * (depth.h), or has a surface tension: the layer that this presses would carry it as an arch does,
 * so that inside a drop there would be next to no pressure. Wider
 * kernels resist shear less, and what is taken back is noisier: with 0.5 at h = 2.25 d and 0.25
 * from 2.5 d on eddies keep 0.82 of their angular momentum in 2 s in 3D, 0.86 in 2D, and water at
 * rest moves at half the speed that it has with 0.75. Eddies in full boxes without gravity keep
 * 0.90 to 0.93 with 0.65; with 0.7 those of a box of 16 spacings gained 17 % of their energy in
 * steps of a fiftieth of a spacing, with 0.65 less than 15. */
static inline double pbf_shear_stress_correction(const pbf_params *params) {
  if (params->shear_stress_correction >= 0) return params->shear_stress_correction;
  if (!pbf_may_correct(params)) return 0;
  const int is_pressed = pbf_gravity_of(params) > 0 || params->surface_tension > 0;
  const double most = is_pressed ? 0.75 : 0.65;
  return fmax(0.25, fmin(most, 2.75 - params->smoothing_radius / pbf_derive_spacing(params)));
}

#endif
