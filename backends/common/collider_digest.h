/* Part of rank_call.h: a number of colliders by which ranks compare them. */
#ifndef PBF_COMMON_COLLIDER_DIGEST_H
#define PBF_COMMON_COLLIDER_DIGEST_H

#include <stddef.h>

#include <pbf/pbf_backend.h>

#include "common/digest.h"

/* 0 where there is none, and of a host that does not say. */
static inline uint64_t hash_of_shape(const pbf_shape *shape) {
  const int is_told = shape && shape->struct_size > offsetof(pbf_shape, hash);
  return is_told ? shape->hash : 0;
}

/* Ranks that are processes have shapes at other addresses: what counts is what they are made of. */
static inline uint64_t digest_of_colliders(uint32_t count, const pbf_collider *list) {
  uint64_t all = DIGEST_OF_NOTHING;
  for (uint32_t k = 0; k < count; ++k) {
    pbf_collider one;
    memcpy(&one, &list[k], sizeof one);
    const uint64_t shape = hash_of_shape(one.geometry);
    one.geometry = NULL;
    all = digest_word(digest(all, &one, sizeof one), shape);
  }
  return all;
}

#endif
