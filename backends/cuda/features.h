/* From the features that a solver has to kernels that are built for them. */
#ifndef PBF_CUDA_FEATURES_H
#define PBF_CUDA_FEATURES_H

#include <type_traits>

#include "physics/features.h"

/* Calls launch(constant) with features as a compile-time constant. */
template <class Launch>
static void with_features(int features, Launch launch) {
  static_assert(PBF_FEATURE_COUNT == 4, "every combination has a case");
  switch (features) {
    case 0:
      return launch(std::integral_constant<int, 0>());
    case 1:
      return launch(std::integral_constant<int, 1 & PBF_BUILT>());
    case 2:
      return launch(std::integral_constant<int, 2 & PBF_BUILT>());
    default:
      return launch(std::integral_constant<int, 3 & PBF_BUILT>());
  }
}

/* For what does not depend on the artificial pressure. */
template <class Launch>
static void with_kernel(int features, Launch launch) {
  if (features & PBF_BUILT & PBF_FEATURE_POLY6)
    return launch(std::integral_constant<int, PBF_BUILT & PBF_FEATURE_POLY6>());
  launch(std::integral_constant<int, 0>());
}

#endif
