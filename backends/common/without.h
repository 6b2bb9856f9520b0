/* What a build that was trimmed with PBF_WITHOUT refuses. */
#ifndef PBF_COMMON_WITHOUT_H
#define PBF_COMMON_WITHOUT_H

#include <stddef.h>

#include <pbf/pbf_backend.h>

#include "physics/features.h"

/* What parameters and colliders ask for. */
static inline int pbf_features_wanted(const pbf_params *params, uint32_t count,
                                      const pbf_collider *colliders) {
  int wanted = pbf_features_asked(params) | (count > 0 ? PBF_FEATURE_COLLIDERS : 0);
  for (uint32_t k = 0; k < count; ++k)
    if (colliders[k].friction > 0 || colliders[k].static_friction > 0) wanted |= PBF_FEATURE_LOADS;
  return wanted;
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
