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

  /* The damping_compensation's pass sums up the torque that it exerts. */
  PBF_FEATURE_TORQUE = 1 << PBF_FEATURE_BITS,

  /* What the build has: PBF_WITHOUT is the sum of what it leaves out. */
  PBF_BUILT = ((1 << PBF_FEATURE_BITS) - 1) & ~(PBF_WITHOUT)
};

/* What parameters ask for. */
static inline int pbf_features_asked(const pbf_params *params) {
  int asked = PBF_FEATURE_NONE;
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  if (params->name > 0) asked |= PBF_FEATURE_##feature;
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  if (params->name > 0) asked |= PBF_FEATURE_##feature;
#include "physics/params.def"
  return asked;
}

/* Of that, what the hot loop is built for. */
static inline int pbf_features_of(const pbf_params *params) {
  return pbf_features_asked(params) & (PBF_FEATURE_COUNT - 1);
}

/* A function of the physics (IN: a struct's own): inlined on every processor; `HOST_NOINLINE`,
 * large and asked for from many places, on a device only; `NOINLINE`, large and seldom called,
 * nowhere. One of these that calls others is to end, on a device, in something that all threads
 * do: those that leave early go on without the rest (tests/cuda/barriers.py).
 * UNROLLED is before a loop over arrays that are to be registers of a device. */
#ifdef __CUDACC__
enum { PBF_ON_GPU = 1 };
#define PBF_IN __host__ __device__ __forceinline__
#define PBF_FN static __host__ __device__ __forceinline__
#define PBF_FN_HOST_NOINLINE PBF_FN
#define PBF_FN_NOINLINE static __host__ __device__ __noinline__ __attribute__((unused))
#else
enum { PBF_ON_GPU = 0 };
#define PBF_IN inline __attribute__((always_inline))
#define PBF_FN static inline __attribute__((always_inline, unused))
#define PBF_FN_HOST_NOINLINE static inline __attribute__((noinline, unused))
#define PBF_FN_NOINLINE PBF_FN_HOST_NOINLINE
#endif
#ifdef __CUDA_ARCH__
#define PBF_UNROLLED _Pragma("unroll")
#else
#define PBF_UNROLLED
#endif

#endif
