/* Turns of vectors. */
#ifndef PBF_VIEW_ROTATION_H
#define PBF_VIEW_ROTATION_H

#include <cmath>

#include "scene/scene.h"

namespace view {

// By a unit quaternion: v + 2 q × (q × v + w v).
inline bench::Vector turned(const double q[4], const bench::Vector &v) {
  const auto cross = [](const double *a, const bench::Vector &b) -> bench::Vector {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  bench::Vector inner = cross(q, v);
  for (unsigned k = 0; k < 3; ++k) inner[k] += q[3] * v[k];
  const bench::Vector outer = cross(q, inner);
  return {v[0] + 2 * outer[0], v[1] + 2 * outer[1], v[2] + 2 * outer[2]};
}

// +y in the place of what has no length.
inline bench::Vector unit(const bench::Vector &v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (!(length > 0)) return {0, 1, 0};
  return {v[0] / length, v[1] / length, v[2] / length};
}

}  // namespace view

#endif
