/* What a build that was trimmed with PBF_WITHOUT refuses. */
#ifndef PBF_COMMON_WITHOUT_H
#define PBF_COMMON_WITHOUT_H

#include <stddef.h>

#include <pbf/pbf_backend.h>

#include "physics/features.h"

/* What parameters and colliders ask for. */
static inline int pbf_features_wanted(const pbf_params *params, uint32_t colliders) {
  return pbf_features_of(params) | (params->vorticity > 0 ? PBF_FEATURE_VORTICITY : 0) |
         (params->viscosity > 0 ? PBF_FEATURE_VISCOSITY : 0) |
         (colliders > 0 ? PBF_FEATURE_COLLIDERS : 0) |
         (params->wall_density > 0 ? PBF_FEATURE_WALL_DENSITY : 0) |
         (params->solver == PBF_SOLVER_CHEBYSHEV ? PBF_FEATURE_CHEBYSHEV : 0) |
         (params->sleep_speed > 0 ? PBF_FEATURE_SLEEP : 0) |
         (params->tolerance > 0 ? PBF_FEATURE_TOLERANCE : 0) |
         (params->pressure_grid > 0 ? PBF_FEATURE_PRESSURE_GRID : 0) |
         (params->undamping > 0 || params->torque_correction > 0 ? PBF_FEATURE_UNDAMPING : 0);
}

/* The sentence for the first of the wanted features that the build is without; null: it has all. */
static inline const char *pbf_without(int wanted) {
  wanted &= ~PBF_BUILT;
#define PBF_FEATURE(NAME, refusal) \
  if (wanted & PBF_FEATURE_##NAME) return "built without " refusal;
#include "physics/features.def"
  return NULL;
}

/* PBF_OK, or a refusal with its sentence. */
static inline pbf_status pbf_refuse_without(const pbf_backend_host *host, int wanted) {
  const char *sentence = pbf_without(wanted);
  if (!sentence) return PBF_OK;
  host->set_error(sentence);
  return PBF_ERROR_UNSUPPORTED;
}

#endif
