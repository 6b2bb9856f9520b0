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

enum {
  PBF_FEATURE_POLY6 = 1, /* poly6 density and spiky gradient; otherwise Wendland C2 */
  PBF_FEATURE_SCORR = 2, /* artificial pressure */
  PBF_FEATURE_COUNT = 4, /* combinations of the bits above, those of the hot loop */

  /* What is asked for outside the hot loop. */
  PBF_FEATURE_VORTICITY = 1 << 2,
  PBF_FEATURE_VISCOSITY = 1 << 3,
  PBF_FEATURE_COLLIDERS = 1 << 4,
  PBF_FEATURE_WALL_DENSITY = 1 << 5,
  PBF_FEATURE_CHEBYSHEV = 1 << 6,
  PBF_FEATURE_TIMING = 1 << 7, /* times of stages */
  PBF_FEATURE_STATS = 1 << 8,  /* statistics and densities */
  PBF_FEATURE_SLEEP = 1 << 9,
  PBF_FEATURE_TOLERANCE = 1 << 10,
  PBF_FEATURE_PRESSURE_GRID = 1 << 11,
  PBF_FEATURE_UNDAMPING = 1 << 12,

  /* The undamping's pass sums up the torque that it exerts. */
  PBF_FEATURE_TORQUE = 1 << 13,

  /* What the build has: PBF_WITHOUT is the sum of what it leaves out. */
  PBF_BUILT = ((1 << 13) - 1) & ~(PBF_WITHOUT)
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
