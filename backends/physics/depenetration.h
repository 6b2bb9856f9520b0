/* How fast what overlaps is pushed apart. Host only, float64; C17 and C++17. */
#ifndef PBF_PHYSICS_DEPENETRATION_H
#define PBF_PHYSICS_DEPENETRATION_H

#include <math.h>

#include <pbf/pbf.h>

/* The acceleration by which fluid weighs on other fluid: gravity's; without it the attraction's
 * over the domain's extent. */
static inline double pbf_weight_of(const pbf_params *params, int dimension) {
  double g2 = 0, extent = 0;
  for (int k = 0; k < dimension; ++k) {
    g2 += params->gravity[k] * params->gravity[k];
    extent = fmax(extent, params->domain_max[k] - params->domain_min[k]);
  }
  return fmax(sqrt(g2), fabs(params->attraction) * extent);
}

/* As the parameter says, or as fast as a fall by h / 2; without any weight a hundredth of h a step,
 * for nothing else says what is fast. */
static inline double pbf_max_depenetration_speed_of(const pbf_params *params, int dimension) {
  double h = params->smoothing_radius, g = pbf_weight_of(params, dimension);
  if (params->max_depenetration_speed > 0) return params->max_depenetration_speed;
  if (g > 0) return sqrt(g * h);
  return params->time_step > 0 ? 0.01 * h / params->time_step : 0;
}

/* The density that is taken off an overlap in a time unit: passes/overlap.h. Where it is as much as
 * 1, all within h of a particle, what goes moves about a tenth of h. */
static inline double pbf_overlap_rate(const pbf_params *params, int dimension) {
  return 0.05 * pbf_max_depenetration_speed_of(params, dimension) / params->smoothing_radius;
}

#endif
