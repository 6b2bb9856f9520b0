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

/* On the rest lattice sum V W r², and the factor on sum V W (v_ji · x_ij) x_ij that makes it the
 * laplacian of v: averaged over directions x² y² is r⁴ / (d (d + 2)). */
typedef struct pbf_viscosity_lattice {
  double spread, to_laplacian;
} pbf_viscosity_lattice;

static inline pbf_viscosity_lattice pbf_viscosity_lattice_of(const pbf_params *params,
                                                             uint32_t dimension) {
  const pbf_derived d = pbf_derive(params, dimension);
  const int n = (int)ceil(d.h / d.spacing), nz = dimension == 3 ? n : 0;
  double spread = 0, fourth = 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        double r2 = d.spacing * d.spacing * (i * i + j * j + k * k);
        double value = d.value_scale * pbf_shape_value(params->kernel, sqrt(r2) / d.h);
        spread += value * r2;
        fourth += value * r2 * r2;
      }
  return (pbf_viscosity_lattice){spread, 2.0 * dimension * (dimension + 2) / fourth};
}

/* dt times the largest eigenvalue of the laplacian, twice as much as on the rest lattice: there are
 * crowds. */
static inline double pbf_viscosity_stiffness(const pbf_params *params, uint32_t dimension) {
  const pbf_viscosity_lattice l = pbf_viscosity_lattice_of(params, dimension);
  return 4 * params->time_step * l.to_laplacian * l.spread / dimension;
}

/* The viscosity that acts. */
static inline double pbf_viscosity_acting(const pbf_params *params, uint32_t dimension) {
  const double most = PBF_VISCOSITY_MAX_STAGES * (PBF_VISCOSITY_MAX_STAGES + 1);
  const double stiffness = pbf_viscosity_stiffness(params, dimension);
  return stiffness > 0 ? fmin(params->viscosity, most / stiffness) : params->viscosity;
}

/* Odd: an even number does not damp the shortest waves. */
static inline uint32_t pbf_viscosity_stages(const pbf_params *params, uint32_t dimension) {
  const double stiffness = params->viscosity * pbf_viscosity_stiffness(params, dimension);
  uint32_t stages = 1;
  while (stages < PBF_VISCOSITY_MAX_STAGES && stages * (stages + 1) < stiffness) stages += 2;
  return stages;
}

#endif
