/* Extensions that all backends answer alike. */
#ifndef PBF_COMMON_EXTENSIONS_H
#define PBF_COMMON_EXTENSIONS_H

#include <string.h>

#include <pbf/pbf_backend.h>

#include "physics/features.h"

/* How many colliders it takes, and that saved states hold pressures; null: something else. */
static inline const void *pbf_common_extension(const char *name) {
  static const uint32_t most = PBF_MAX_COLLIDERS, keeps = 1;
  if (strcmp(name, PBF_BACKEND_COLLIDERS) == 0)
    return PBF_BUILT & PBF_FEATURE_COLLIDERS ? &most : NULL;
  return strcmp(name, PBF_BACKEND_LAST_PRESSURE) == 0 ? &keeps : NULL;
}

#endif
