/* What the hot loop is built for: compile-time constants of a variant. Tested with an ordinary
 * `if (features & …)`, so that both branches stay type-checked and the dead one vanishes. */
#ifndef PBF_PHYSICS_FEATURES_H
#define PBF_PHYSICS_FEATURES_H

#include <pbf/pbf.h>

enum {
  PBF_FEATURE_POLY6 = 1, /* poly6 density and spiky gradient; otherwise Wendland C2 */
  PBF_FEATURE_SCORR = 2, /* artificial pressure */
  PBF_FEATURE_COUNT = 4  /* combinations of the bits above */
};

static inline int pbf_features_of(const pbf_params *params) {
  return (params->kernel == PBF_KERNEL_POLY6_SPIKY ? PBF_FEATURE_POLY6 : 0) |
         (params->scorr_k > 0 ? PBF_FEATURE_SCORR : 0);
}

/* A function of the physics: inlined on every processor. */
#ifdef __CUDACC__
#define PBF_FN static __host__ __device__ __forceinline__
#else
#define PBF_FN static inline __attribute__((always_inline, unused))
#endif

#endif
