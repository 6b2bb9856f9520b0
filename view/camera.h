/* Where the scene is looked at from. */
#ifndef PBF_VIEW_CAMERA_H
#define PBF_VIEW_CAMERA_H

#include <array>

#include "core/surroundings.h"

namespace view {

using Matrix = std::array<float, 16>;  // column-major, as OpenGL wants it

// It looks at a point and turns about it; of 2D scenes the picture is a parallel projection.
class Camera {
 public:
  // So that all of the box is seen, from the front right above.
  void look_at(const bench::Box &box, unsigned dimension, float aspect);

  void turn(float yaw, float pitch);  // radians
  void shift(float x, float y);       // in heights of the picture
  void approach(float factor);        // 0.5: to half the distance

  Matrix to_eye() const;
  Matrix projection(float aspect) const;

 private:
  bool flat_ = false;
  float yaw_ = 0, pitch_ = 0, distance_ = 1, size_ = 1;
  std::array<float, 3> target_{};
};

}  // namespace view

#endif
