/* FNV-1a, 64 bit (Fowler, Noll, Vo). */
#ifndef PBF_LIB_FNV_H
#define PBF_LIB_FNV_H

#include <stdint.h>

#define PBF_FNV_START UINT64_C(0xcbf29ce484222325)

static inline uint64_t pbf_fnv(uint64_t hash, const void *data, uint64_t size) {
  const unsigned char *bytes = data;
  for (uint64_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
  return hash;
}

#endif
