/* What steps leave of a density error, whatever there is in the fluid. Host only, float64; C17 and
 * C++17, for lib/ needs it, too. */
#ifndef PBF_PHYSICS_STEPS_LEAVE_H
#define PBF_PHYSICS_STEPS_LEAVE_H

#include <math.h>

#include "physics/depenetration.h"
#include "physics/spacing.h"

/* Of errors beyond that none is larger: a state that holds one is loaded. */
#define PBF_MOST_ERROR 1e100

/* The error that n iterations leave for each layer of fluid at rest that is above a particle. It
 * changes with the step, and as much with gravity and with n: g dt² / (n² d), measured under 8 to
 * 16 layers, within a third from 1 to 4, and as in depth.h at 4. */
static inline double pbf_error_per_layer(const pbf_params *params, int dimension) {
  const double n = fmax(params->iterations, 1);
  const double error = pbf_weight_of(params, dimension) * params->time_step * params->time_step /
                       (2 * n * sqrt(n) * pbf_derive_spacing(params));
  return fmin(error, PBF_MOST_ERROR);
}

/* Whether steps leave more of it than any before, and not just by rounding. */
static inline int pbf_is_more_than_ever(double error, double most) { return error > 1.01 * most; }

#endif
