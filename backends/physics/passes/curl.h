/* The vorticity around a particle (eq. 15). */
#ifndef PBF_PHYSICS_PASSES_CURL_H
#define PBF_PHYSICS_PASSES_CURL_H

#include "physics/real.h"

PBF_FN pbf_real pbf_curl_size(pbf_curl curl) {
  pbf_real sum = 0;
  for (int k = 0; k < PBF_CURL_DIM; ++k) sum += curl.c[k] * curl.c[k];
  return pbf_real_sqrt(sum);
}

#endif
