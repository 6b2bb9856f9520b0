/* What the hot loop is built for: compile-time constants of a variant; and what the build has at
 * all. Tested with an ordinary `if (features & …)`, so that both branches stay type-checked and the
 * dead one vanishes. */
#ifndef PBF_PHYSICS_FEATURES_H
#define PBF_PHYSICS_FEATURES_H

#include <pbf/pbf.h>

#include "pbf_build.h"

/* Headers that are C as well as C++. */
#if defined(__cplusplus) && !defined(__CUDACC__)
#define _Alignas alignas
#define _Static_assert static_assert
#define restrict __restrict
#endif

/* Bits by features.def. */
enum {
#define PBF_FEATURE(NAME, refusal) PBF_FEATURE_BIT_##NAME,
#include "physics/features.def"
  PBF_FEATURE_BITS
};

enum {
  PBF_FEATURE_NONE = 0,
#define PBF_FEATURE(NAME, refusal) PBF_FEATURE_##NAME = 1 << PBF_FEATURE_BIT_##NAME,
#include "physics/features.def"

  /* Combinations of the bits up to SCORR, those of the hot loop. */
  PBF_FEATURE_COUNT = 2 * PBF_FEATURE_SCORR,

  /* The undamping's pass sums up the torque that it exerts. */
  PBF_FEATURE_TORQUE = 1 << PBF_FEATURE_BITS,

  /* What the build has: PBF_WITHOUT is the sum of what it leaves out. */
  PBF_BUILT = ((1 << PBF_FEATURE_BITS) - 1) & ~(PBF_WITHOUT)
};

static inline int pbf_features_of(const pbf_params *params) {
  return (params->kernel == PBF_KERNEL_POLY6_SPIKY ? PBF_FEATURE_POLY6 : 0) |
         (params->scorr_k > 0 ? PBF_FEATURE_SCORR : 0);
}

/* A function of the physics: inlined on every processor; `APART`, large and asked for from many
 * places, on a device only. */
#ifdef __CUDACC__
#define PBF_FN static __host__ __device__ __forceinline__
#define PBF_FN_APART PBF_FN
#else
#define PBF_FN static inline __attribute__((always_inline, unused))
#define PBF_FN_APART static __attribute__((noinline, unused))
#endif

#endif
