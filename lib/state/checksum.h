/* The checksum of a saved state, over whole words of 64 bits: FNV-1a takes four cycles a byte. Each
 * of four sums takes every fourth word, so that none waits for the one before; in the end the first
 * takes the others. What a word does to its sum can be undone, so that no change within one word
 * leaves the checksum as it was; the shift has the high bits act on the low ones. */
#ifndef PBF_LIB_STATE_CHECKSUM_H
#define PBF_LIB_STATE_CHECKSUM_H

#include <stdint.h>
#include <string.h>

enum { PBF_CHECKSUM_SUMS = 4 };

static inline uint64_t pbf_checksum_add(uint64_t sum, uint64_t word) {
  sum = (sum ^ word) * UINT64_C(0x9e3779b97f4a7c15); /* 2^64 over the golden ratio, odd */
  return sum ^ sum >> 32;
}

/* `size` is a multiple of 8. */
static inline uint64_t pbf_checksum(const void *data, uint64_t size) {
  const unsigned char *bytes = data;
  const uint64_t words = size / 8, even = words - words % PBF_CHECKSUM_SUMS;
  uint64_t sums[PBF_CHECKSUM_SUMS] = {1, 2, 3, 4}, word;
  for (uint64_t i = 0; i < even; i += PBF_CHECKSUM_SUMS)
    for (uint32_t k = 0; k < PBF_CHECKSUM_SUMS; ++k) {
      memcpy(&word, bytes + 8 * (i + k), sizeof word);
      sums[k] = pbf_checksum_add(sums[k], word);
    }
  for (uint64_t i = even; i < words; ++i) {
    memcpy(&word, bytes + 8 * i, sizeof word);
    sums[i - even] = pbf_checksum_add(sums[i - even], word);
  }
  for (uint32_t k = 1; k < PBF_CHECKSUM_SUMS; ++k) sums[0] = pbf_checksum_add(sums[0], sums[k]);
  return sums[0];
}

#endif
