/* Vorticity confinement (eq. 16). */
#ifndef PBF_PHYSICS_PASSES_CONFINEMENT_H
#define PBF_PHYSICS_PASSES_CONFINEMENT_H

#include "physics/real.h"

/* Vorticity confinement (eq. 16), velocity change: dt e (N x curl), N = eta/|eta|, where eta is
 * the gradient of |curl|, sum over the others of V |curl|_j grad_i W. */
PBF_FN pbf_vec pbf_confine(pbf_real dt_strength, pbf_vec eta, pbf_curl curl) {
  pbf_real size = pbf_real_sqrt(pbf_dot(eta, eta));
  pbf_real s = size > 0 ? dt_strength / size : 0;
  pbf_vec dv;
#if PBF_DIM == 3
  dv.c[0] = s * (eta.c[1] * curl.c[2] - eta.c[2] * curl.c[1]);
  dv.c[1] = s * (eta.c[2] * curl.c[0] - eta.c[0] * curl.c[2]);
  dv.c[2] = s * (eta.c[0] * curl.c[1] - eta.c[1] * curl.c[0]);
#else
  dv.c[0] = s * eta.c[1] * curl.c[0];
  dv.c[1] = -s * eta.c[0] * curl.c[0];
#endif
  return dv;
}

#endif
