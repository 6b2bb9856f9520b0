#include "camera.h"

#include <algorithm>
#include <cmath>

namespace view {
namespace {

constexpr float quarter_turn = 1.5707963f;
constexpr float half_view = 0.35f;  // half the angle of view upwards, radians

}  // namespace

void Camera::look_at(const bench::Box &box, unsigned dimension, float aspect) {
  flat_ = dimension == 2;
  yaw_ = flat_ ? 0 : 0.5f;
  pitch_ = flat_ ? 0 : 0.35f;
  float square = 0;
  std::array<float, 3> half{};
  for (unsigned axis = 0; axis < 3; ++axis) {
    half[axis] = static_cast<float>(0.5 * (box.upper[axis] - box.lower[axis]));
    target_[axis] = static_cast<float>(box.lower[axis]) + half[axis];
    square += 4 * half[axis] * half[axis];
  }
  size_ = std::sqrt(square);
  distance_ = 0;
  const Matrix eye = to_eye();
  const float slope = std::tan(half_view);
  for (unsigned corner = 0; corner < 8; ++corner) {  // each has to be within the sides
    float x[3] = {0, 0, 0};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const float at = corner >> axis & 1 ? half[axis] : -half[axis];
      for (unsigned row = 0; row < 3; ++row) x[row] += eye[4 * axis + row] * at;
    }
    const float needed = std::max(std::fabs(x[0]) / aspect, std::fabs(x[1])) / slope;
    distance_ = std::max(distance_, 1.06f * needed + (flat_ ? 0 : x[2]));
  }
}

void Camera::turn(float yaw, float pitch) {
  if (flat_) return;
  yaw_ += yaw;
  pitch_ = std::clamp(pitch_ + pitch, -quarter_turn, quarter_turn);
}

void Camera::shift(float x, float y) {
  const float length = 2 * distance_ * std::tan(half_view);
  const Matrix eye = to_eye();
  for (unsigned axis = 0; axis < 3; ++axis)
    target_[axis] -= length * (x * eye[4 * axis] + y * eye[4 * axis + 1]);
}

void Camera::approach(float factor) {
  distance_ = std::clamp(distance_ * factor, 0.01f * size_, 20 * size_);
}

Matrix Camera::to_eye() const {
  const float cy = std::cos(yaw_), sy = std::sin(yaw_);
  const float cp = std::cos(pitch_), sp = std::sin(pitch_);
  const std::array<std::array<float, 3>, 3> rows = {
      {{cy, 0, -sy}, {-sy * sp, cp, -cy * sp}, {sy * cp, sp, cy * cp}}};
  Matrix eye{};
  for (unsigned row = 0; row < 3; ++row) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      eye[4 * axis + row] = rows[row][axis];
      eye[12 + row] -= rows[row][axis] * target_[axis];
    }
  }
  eye[14] -= distance_;
  eye[15] = 1;
  return eye;
}

Matrix Camera::projection(float aspect) const {
  const float near = std::max(distance_ - size_, 0.005f * size_), far = distance_ + size_;
  const float f = 1 / std::tan(half_view);
  Matrix out{};
  if (flat_) {
    out[0] = f / (aspect * distance_);
    out[5] = f / distance_;
    out[10] = -2 / (far - near);
    out[14] = -(far + near) / (far - near);
    out[15] = 1;
  } else {
    out[0] = f / aspect;
    out[5] = f;
    out[10] = -(far + near) / (far - near);
    out[11] = -1;
    out[14] = -2 * far * near / (far - near);
  }
  return out;
}

}  // namespace view
