/* Solvers that the fuzz targets make. */
#ifndef PBF_TESTS_FUZZ_KIND_H
#define PBF_TESTS_FUZZ_KIND_H

#include <pbf/pbf.h>
#include <string.h>

#include "insist.h"
#include "pbf_build.h"

typedef struct kind {
  uint32_t dimension, precision;
} kind;

static inline int is_built(kind k) {
#define IS_BUILT(dim, bits) \
  if (k.dimension == dim && 8 * k.precision == bits) return 1;
  PBF_EACH_VARIANT(IS_BUILT)
#undef IS_BUILT
  return 0;
}

/* A build for a sanitizer may have one precision of a dimension alone: it serves for the other as
 * well.
 */
static inline kind kind_of(unsigned bits) {
  kind k = {bits & 1 ? 3 : 2, bits & 2 ? PBF_FLOAT64 : PBF_FLOAT32};
  if (!is_built(k)) k.precision = k.precision == PBF_FLOAT64 ? PBF_FLOAT32 : PBF_FLOAT64;
  return k;
}

static inline pbf_solver *make_solver(const char *backend, kind k, uint32_t capacity) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  insist(pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  desc.dimension = k.dimension;
  desc.precision = k.precision;
  desc.capacity = capacity;
  desc.backend = backend;
  desc.strict = 1;
  desc.threads = 1;
  insist(pbf_create(&desc, NULL, &solver) == PBF_OK);
  return solver;
}

static inline void put_number(void *array, size_t index, uint32_t precision, double value) {
  if (precision == PBF_FLOAT64) {
    ((double *)array)[index] = value;
  } else {
    ((float *)array)[index] = (float)value;
  }
}

static inline double number_at(const void *array, size_t index, uint32_t precision) {
  return precision == PBF_FLOAT64 ? ((const double *)array)[index]
                                  : (double)((const float *)array)[index];
}

static inline uint64_t checksum_with(uint64_t sum, uint64_t word) {
  sum = (sum ^ word) * UINT64_C(0x9e3779b97f4a7c15);
  return sum ^ sum >> 32;
}

/* As at the end of a saved state; what is no whole word is left out. */
static inline uint64_t checksum_of(const unsigned char *bytes, size_t size) {
  uint64_t sums[4] = {1, 2, 3, 4}, word;
  for (size_t i = 0; i + sizeof word <= size; i += sizeof word) {
    memcpy(&word, bytes + i, sizeof word);
    sums[i / 8 % 4] = checksum_with(sums[i / 8 % 4], word);
  }
  for (int k = 1; k < 4; ++k) sums[0] = checksum_with(sums[0], sums[k]);
  return sums[0];
}

#endif
