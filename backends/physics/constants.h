/* The derived parameters in the precision that the particles have. */
#ifndef PBF_PHYSICS_CONSTANTS_H
#define PBF_PHYSICS_CONSTANTS_H

#include "physics/derive.h"
#include "physics/real.h"

typedef struct pbf_constants {
  pbf_real h, h2, inv_h, inv_h2;
  pbf_real tiny2; /* r² below which a pair has no direction */
  pbf_real value_scale, gradient_scale, gradient_over_h;
  pbf_real epsilon, omega;
  pbf_real scorr_k, scorr_inv_w;
  pbf_real vorticity, viscosity;
  int scorr_n;
} pbf_constants;

static inline pbf_constants pbf_constants_of(const pbf_params *params) {
  pbf_derived d = pbf_derive(params, PBF_DIM);
  pbf_constants c;
  c.h = (pbf_real)d.h;
  c.h2 = (pbf_real)(d.h * d.h);
  c.inv_h = (pbf_real)(1 / d.h);
  c.inv_h2 = (pbf_real)(1 / (d.h * d.h));
  c.tiny2 = (pbf_real)(1e-14 * d.h * d.h);
  c.value_scale = (pbf_real)d.value_scale;
  c.gradient_scale = (pbf_real)d.gradient_scale;
  c.gradient_over_h = (pbf_real)(d.gradient_scale / d.h);
  c.epsilon = (pbf_real)d.epsilon;
  c.omega = (pbf_real)d.omega;
  c.scorr_k = (pbf_real)d.scorr_k;
  c.scorr_inv_w = (pbf_real)d.scorr_inv_w;
  c.vorticity = (pbf_real)params->vorticity;
  c.viscosity = (pbf_real)params->viscosity;
  c.scorr_n = (int)params->scorr_n;
  return c;
}

#endif
