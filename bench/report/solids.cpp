#include "report/solids.h"

#include <cmath>

namespace bench {
namespace {

const Color solid_color = {150, 156, 170};
const Color edge_color = {178, 186, 204};
constexpr double tint = 0.16;

Vector minus(const Vector &a, const Vector &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

}  // namespace

bool Solid::opaque() const {
  return !collider_.inverted &&
         (collider_.shape == PBF_COLLIDER_SPHERE || collider_.shape == PBF_COLLIDER_CAPSULE);
}

void Solid::draw(Canvas &canvas) const {
  if (collider_.shape == PBF_COLLIDER_BOX) draw_box(canvas);
  if (collider_.shape == PBF_COLLIDER_SPHERE) draw_capsule(canvas, 0);
  if (collider_.shape == PBF_COLLIDER_CAPSULE) draw_capsule(canvas, collider_.half_length);
}

void Solid::draw_box(Canvas &canvas) const {
  const double *half = collider_.half_extents;
  const Vector middle = place({0, 0, 0});
  const unsigned axes = flat_ ? 2 : 3;
  for (unsigned axis = flat_ ? 2 : 0; axis < 3; ++axis) {  // in 2D the one face that is seen
    const unsigned next = (axis + 1) % 3, last = (axis + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      Vector a{}, b{}, normal{};
      a[next] = half[next], b[last] = half[last], normal[axis] = flat_ ? 0 : side * half[axis];
      canvas.veil(place(normal), minus(place(a), middle), minus(place(b), middle), solid_color,
                  tint);
    }
  }
  for (unsigned from = 0; from < (1u << axes); ++from) {
    for (unsigned axis = 0; axis < axes; ++axis) {
      const unsigned to = from | 1u << axis;
      if (to == from) continue;
      Vector a{}, b{};
      for (unsigned k = 0; k < axes; ++k) {
        a[k] = from >> k & 1 ? half[k] : -half[k];
        b[k] = to >> k & 1 ? half[k] : -half[k];
      }
      canvas.line(place(a), place(b), edge_color);
    }
  }
}

// A sphere where `half_length` is 0: balls side by side, or, of a container, the outline.
void Solid::draw_capsule(Canvas &canvas, double half_length) const {
  const double *axis = collider_.axis;
  const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const int balls = half_length > 0 ? 64 : 1;
  for (int i = 0; i < balls; ++i) {
    const double along = balls > 1 ? half_length * (2.0 * i / (balls - 1) - 1) / length : 0;
    const Vector at = place({along * axis[0], along * axis[1], along * axis[2]});
    if (opaque()) {
      canvas.ball(at[0], at[1], at[2], collider_.radius * scale_, solid_color, flat_);
    } else if (i == 0 || i == balls - 1) {
      draw_rim(canvas, at);
    }
  }
}

void Solid::draw_rim(Canvas &canvas, const Vector &middle) const {
  constexpr int corners = 96;
  Vector before{};
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / corners;
    const Vector at = {middle[0] + collider_.radius * scale_ * std::cos(angle),
                       middle[1] + collider_.radius * scale_ * std::sin(angle),
                       middle[2] + collider_.radius * scale_};
    if (i > 0) canvas.line(before, at, edge_color);
    before = at;
  }
}

// By the collider's quaternion: x + 2 w (q × x) + 2 q × (q × x).
Vector Solid::turned(Vector x) const {
  const double *q = collider_.orientation;
  const auto across = [q](const Vector &v) -> Vector {
    return {q[1] * v[2] - q[2] * v[1], q[2] * v[0] - q[0] * v[2], q[0] * v[1] - q[1] * v[0]};
  };
  const Vector once = across(x), twice = across(once);
  for (unsigned k = 0; k < 3; ++k) x[k] += 2 * (q[3] * once[k] + twice[k]);
  return x;
}

Vector Solid::place(const Vector &local) const {
  Vector x = turned(local);
  for (unsigned k = 0; k < 3; ++k) x[k] += collider_.position[k];
  if (flat_) x[2] = 0;
  return pixel_(x);
}

}  // namespace bench
