/* A number of what ranks must have in common, by which they compare it: FNV-1a's steps by words, of
 * which the upper half comes down to the lower one before the next, or two signs that differ would
 * cancel. */
#ifndef PBF_COMMON_DIGEST_H
#define PBF_COMMON_DIGEST_H

#include <stdint.h>
#include <string.h>

enum { DIGEST_OF_NOTHING = 1469598103 };

static inline uint64_t digest_word(uint64_t hash, uint64_t word) {
  hash = (hash ^ word) * UINT64_C(1099511628211);
  return hash ^ hash >> 32;
}

static inline uint64_t digest(uint64_t before, const void *data, uint64_t bytes) {
  const char *of = static_cast<const char *>(data);
  uint64_t hash = before, word = 0, k = 0;
  for (; k + sizeof word <= bytes; k += sizeof word) {
    memcpy(&word, of + k, sizeof word);
    hash = digest_word(hash, word);
  }
  word = 0;
  if (k < bytes) memcpy(&word, of + k, bytes - k);
  return digest_word(hash, word ^ bytes << 56);
}

#endif
