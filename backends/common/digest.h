/* A number of what ranks must have in common, by which they compare it (FNV-1a's steps). */
#ifndef PBF_COMMON_DIGEST_H
#define PBF_COMMON_DIGEST_H

#include <stdint.h>

enum { DIGEST_OF_NOTHING = 1469598103 };

static inline uint64_t digest(uint64_t before, const void *data, uint64_t bytes) {
  const uint8_t *of = static_cast<const uint8_t *>(data);
  uint64_t hash = before;
  for (uint64_t k = 0; k < bytes; ++k) hash = (hash ^ of[k]) * UINT64_C(1099511628211);
  return hash;
}

#endif
