#include "outlines.h"

#include <cmath>

#include "rotation.h"

namespace view {
namespace {

using bench::Vector;

const char *const outline_vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 to_eye, projection;
void main() { gl_Position = projection * (to_eye * vec4(position, 1)); }
)";

const char *const outline_fragment_shader = R"(#version 330 core
uniform vec3 color;
out vec4 pixel;
void main() { pixel = vec4(color, 1); }
)";

// Pairs of points, from a shape's own axes into space.
class Lines {
 public:
  void place(const pbf_collider *collider) { collider_ = collider; }

  void line(const Vector &from, const Vector &to) {
    add(from);
    add(to);
  }

  void box(const Vector &lower, const Vector &upper, bool flat) {
    for (unsigned from = 0; from < (flat ? 4u : 8u); ++from) {
      for (unsigned axis = 0; axis < (flat ? 2u : 3u); ++axis) {
        if (!(from >> axis & 1))
          line(corner(lower, upper, from), corner(lower, upper, from | 1u << axis));
      }
    }
  }

  // middle + radius (cos a + sin b), over a part of a turn from `start`.
  void arc(const Vector &middle, const Vector &a, const Vector &b, double radius, double start = 0,
           double turn = 2 * pi) {
    constexpr int pieces = 48;
    const auto at = [&](int i) {
      const double angle = start + turn * i / pieces;
      Vector x;
      for (unsigned k = 0; k < 3; ++k)
        x[k] = middle[k] + radius * (std::cos(angle) * a[k] + std::sin(angle) * b[k]);
      return x;
    };
    for (int i = 0; i < pieces; ++i) line(at(i), at(i + 1));
  }

  const std::vector<float> &numbers() const { return numbers_; }

  static constexpr double pi = 3.14159265358979323846;

 private:
  static Vector corner(const Vector &lower, const Vector &upper, unsigned index) {
    Vector x;
    for (unsigned axis = 0; axis < 3; ++axis)
      x[axis] = index >> axis & 1 ? upper[axis] : lower[axis];
    return x;
  }

  void add(Vector x) {
    if (collider_) {
      x = turned(collider_->orientation, x);
      for (unsigned k = 0; k < 3; ++k) x[k] += collider_->position[k];
    }
    for (const double number : x) numbers_.push_back(static_cast<float>(number));
  }

  const pbf_collider *collider_ = nullptr;
  std::vector<float> numbers_;
};

// Two axes that stand on `up`, a unit vector, and on each other.
void across(const Vector &up, Vector &a, Vector &b) {
  const Vector other = std::fabs(up[2]) < 0.9 ? Vector{0, 0, 1} : Vector{1, 0, 0};
  a = {up[1] * other[2] - up[2] * other[1], up[2] * other[0] - up[0] * other[2],
       up[0] * other[1] - up[1] * other[0]};
  const double length = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (double &number : a) number /= length;
  b = {up[1] * a[2] - up[2] * a[1], up[2] * a[0] - up[0] * a[2], up[0] * a[1] - up[1] * a[0]};
}

// A sphere is a capsule whose ends are in one place.
void capsule(Lines &lines, const pbf_collider &collider, double half_length, bool flat) {
  const Vector up = unit({collider.axis[0], collider.axis[1], collider.axis[2]});
  Vector sides[2];
  across(up, sides[0], sides[1]);
  for (const double sign : {-1.0, 1.0}) {
    Vector end, outwards;
    for (unsigned k = 0; k < 3; ++k) {
      end[k] = sign * half_length * up[k];
      outwards[k] = sign * up[k];
    }
    if (!flat) lines.arc(end, sides[0], sides[1], collider.radius);
    for (unsigned side = 0; side < (flat ? 1u : 2u); ++side)
      lines.arc(end, sides[side], outwards, collider.radius, 0, Lines::pi);
  }
  for (unsigned side = 0; side < (flat ? 1u : 2u); ++side) {
    for (const double sign : {-1.0, 1.0}) {
      Vector from, to;
      for (unsigned k = 0; k < 3; ++k) {
        from[k] = -half_length * up[k] + sign * collider.radius * sides[side][k];
        to[k] = half_length * up[k] + sign * collider.radius * sides[side][k];
      }
      if (half_length > 0) lines.line(from, to);
    }
  }
}

void outline(Lines &lines, const pbf_collider &collider, bool flat) {
  lines.place(&collider);
  const double *half = collider.half_extents;
  if (collider.shape == PBF_COLLIDER_BOX)
    lines.box({-half[0], -half[1], flat ? 0 : -half[2]}, {half[0], half[1], flat ? 0 : half[2]},
              flat);
  if (collider.shape == PBF_COLLIDER_SPHERE) capsule(lines, collider, 0, flat);
  if (collider.shape == PBF_COLLIDER_CAPSULE) capsule(lines, collider, collider.half_length, flat);
}

}  // namespace

Outlines::Outlines() : program_(outline_vertex_shader, outline_fragment_shader) {
  glGenVertexArrays(1, &array_);
  glGenBuffers(1, &buffer_);
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
}

Outlines::~Outlines() {
  glDeleteBuffers(1, &buffer_);
  glDeleteVertexArrays(1, &array_);
}

void Outlines::set(const Reading &reading) {
  const bool flat = reading.dimension == 2;
  Lines lines;
  lines.box(reading.domain.lower, reading.domain.upper, flat);
  domain_ = static_cast<GLsizei>(lines.numbers().size() / 3);
  for (const pbf_collider &collider : reading.colliders) outline(lines, collider, flat);
  colliders_ = static_cast<GLsizei>(lines.numbers().size() / 3) - domain_;
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(lines.numbers().size() * sizeof(float)),
               lines.numbers().data(), GL_STREAM_DRAW);
}

void Outlines::draw(const Matrix &to_eye, const Matrix &projection) const {
  program_.use();
  glUniformMatrix4fv(program_.uniform("to_eye"), 1, GL_FALSE, to_eye.data());
  glUniformMatrix4fv(program_.uniform("projection"), 1, GL_FALSE, projection.data());
  glBindVertexArray(array_);
  glUniform3f(program_.uniform("color"), 0.38f, 0.43f, 0.55f);
  glDrawArrays(GL_LINES, 0, domain_);
  glUniform3f(program_.uniform("color"), 0.95f, 0.75f, 0.4f);
  glDrawArrays(GL_LINES, domain_, colliders_);
}

}  // namespace view
