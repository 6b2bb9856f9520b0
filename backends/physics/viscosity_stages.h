/* How many stages viscosity takes in a step, and their weights. Host only, float64.
 *
 * v' = nu laplace(v) is integrated over a step by the Runge-Kutta-Legendre method of first order
 * (Meyer, Balsara and Aslam, A stabilized Runge-Kutta-Legendre method for explicit super-time-
 * stepping of parabolic and mixed equations, 2014): s stages are stable up to (s² + s) / 2 times
 * the step that one is. */
#ifndef PBF_PHYSICS_VISCOSITY_STAGES_H
#define PBF_PHYSICS_VISCOSITY_STAGES_H

#include <math.h>

#include "physics/derive.h"

/* More make the step longer than all else in it; a viscosity that asks for more acts as far as
 * these are stable. */
#define PBF_VISCOSITY_MAX_STAGES 15

/* dt times the largest eigenvalue of the laplacian, twice as much as on the rest lattice: there are
 * crowds. */
static inline double pbf_viscosity_stiffness(const pbf_params *params,
                                             const pbf_viscosity_lattice *l, uint32_t dimension) {
  return 4 * params->time_step * l->to_laplacian * l->spread / dimension;
}

/* The viscosity that acts. */
static inline double pbf_viscosity_acting(const pbf_params *params,
                                          const pbf_viscosity_lattice *lattice,
                                          uint32_t dimension) {
  const double most = PBF_VISCOSITY_MAX_STAGES * (PBF_VISCOSITY_MAX_STAGES + 1);
  const double stiffness = pbf_viscosity_stiffness(params, lattice, dimension);
  return stiffness > 0 ? fmin(params->viscosity, most / stiffness) : params->viscosity;
}

/* Odd: an even number does not damp the shortest waves. */
static inline uint32_t pbf_viscosity_stages(const pbf_params *params,
                                            const pbf_viscosity_lattice *lattice,
                                            uint32_t dimension) {
  const double stiffness = params->viscosity * pbf_viscosity_stiffness(params, lattice, dimension);
  uint32_t stages = 1;
  while (stages < PBF_VISCOSITY_MAX_STAGES && stages * (stages + 1) < stiffness) stages += 2;
  return stages;
}

#endif
