#include "report/picture.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "report/canvas.h"
#include "report/png.h"
#include "report/solids.h"

namespace bench {
namespace {

constexpr double pi = 3.14159265358979323846;

// Where a point of space lands: x and y on the picture in units of length, z towards the viewer.
class Projection {
 public:
  explicit Projection(unsigned dimension) {
    if (dimension == 2) return;
    const double yaw = -30 * pi / 180, pitch = 22 * pi / 180;
    const double cy = std::cos(yaw), sy = std::sin(yaw), cp = std::cos(pitch), sp = std::sin(pitch);
    right_ = {cy, 0, sy};
    up_ = {sy * sp, cp, -cy * sp};
    towards_ = {-sy * cp, sp, cy * cp};
  }

  Vector operator()(const Vector &x) const {
    return {dot(right_, x), dot(up_, x), dot(towards_, x)};
  }

 private:
  static double dot(const Vector &a, const Vector &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  Vector right_{1, 0, 0}, up_{0, 1, 0}, towards_{0, 0, 1};
};

struct Extent {
  Vector low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  void cover(const Vector &x) {
    for (unsigned i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], x[i]);
      high[i] = std::max(high[i], x[i]);
    }
  }
};

Vector corner(const View &view, unsigned index) {
  Vector x;
  for (unsigned axis = 0; axis < 3; ++axis) {
    x[axis] = index >> axis & 1 ? view.upper[axis] : view.lower[axis];
  }
  return x;
}

Color color_at(double fraction) {
  const auto &stops = speed_colors();
  const double at = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), stops.size() - 2);
  const double t = at - static_cast<double>(i);
  Color color;
  for (unsigned c = 0; c < 3; ++c) color[c] = (1 - t) * stops[i][c] + t * stops[i + 1][c];
  return color;
}

// Far things fade into the background.
Color faded(const Color &color, double nearness) {
  const Color far = picture_background();
  const double keep = 0.45 + 0.55 * nearness;
  Color out;
  for (unsigned c = 0; c < 3; ++c) out[c] = keep * color[c] + (1 - keep) * far[c];
  return out;
}

constexpr int max_pixels = 8192 * 8192;

class Painter {
 public:
  Painter(unsigned dimension, const View &view)
      : view_(view), flat_(dimension == 2), project_(dimension) {
    for (unsigned i = 0; i < 8; ++i) extent_.cover(project_(corner(view, i)));
    const double margin = 2 * view.particle_radius;
    scale_ = view.width / (extent_.high[0] - extent_.low[0] + 2 * margin);
    left_ = extent_.low[0] - margin;
    top_ = extent_.high[1] + margin;
    const double height = std::ceil(scale_ * (extent_.high[1] - extent_.low[1] + 2 * margin));
    if (!(view.width * height <= max_pixels))
      throw Error(exit_usage, "a picture of this part would have more than " +
                                  std::to_string(max_pixels) +
                                  " pixels; --view shows another one, --width makes it smaller");
    height_ = std::max(1, static_cast<int>(height));
  }

  int height() const { return height_; }

  void draw_box(Canvas &canvas) const {
    const Color color = {96, 110, 140};
    for (unsigned from = 0; from < 8; ++from) {
      for (unsigned axis = 0; axis < (flat_ ? 2u : 3u); ++axis) {
        const unsigned to = from | 1u << axis;
        if (to != from && (!flat_ || from < 4)) {
          canvas.line(pixel(corner(view_, from)), pixel(corner(view_, to)), color);
        }
      }
    }
  }

  // What hides water behind it before the particles, what only tints it after them.
  void draw_colliders(Canvas &canvas, const Frame &frame, bool opaque) const {
    const auto to_pixels = [this](const Vector &x) { return pixel(x); };
    for (const pbf_collider &collider : frame.colliders) {
      const Solid solid(collider, frame.dimension, scale_ * subpixels, to_pixels);
      if (solid.opaque() == opaque) solid.draw(canvas);
    }
  }

  // White, and small beside the fluid's particles, the balls of which do not hide what is in them;
  // in 2D they lie on top.
  void draw_diffuse(Canvas &canvas, const Frame &frame) const {
    const double around = view_.particle_radius * scale_ * subpixels;
    const double radius = std::max(0.22 * around, 1.0);
    for (const Vector &x : frame.diffuse) {
      const Vector at = pixel(x);
      canvas.ball(at[0], at[1], flat_ ? 1e300 : at[2] + around, radius, {255, 255, 255}, flat_);
    }
  }

  void draw_particles(Canvas &canvas, const Frame &frame) const {
    const double depth = std::max(extent_.high[2] - extent_.low[2], 1e-300);
    const double radius = std::max(view_.particle_radius * scale_ * subpixels, 1.0);
    for (size_t i = 0; i < frame.positions.size(); ++i) {
      const double nearness =
          flat_ ? 1 : (project_(frame.positions[i])[2] - extent_.low[2]) / depth;
      const Vector at = pixel(frame.positions[i]);
      // In 2D the fast ones lie on top.
      const double z = flat_ ? frame.speeds[i] : at[2];
      canvas.ball(at[0], at[1], z, radius,
                  faded(color_at(frame.speeds[i] / view_.fastest), nearness), flat_);
    }
  }

 private:
  Vector pixel(const Vector &x) const {
    const Vector p = project_(x);
    const double s = scale_ * subpixels;
    return {s * (p[0] - left_), s * (top_ - p[1]), s * p[2]};
  }

  const View &view_;
  bool flat_;
  Projection project_;
  Extent extent_;
  double scale_, left_, top_;
  int height_;
};

}  // namespace

Frame particles_of(const std::vector<double> &positions, const std::vector<double> &velocities,
                   unsigned dimension) {
  Frame frame{dimension, {}, {}, {}, {}};
  for (size_t i = 0; i + dimension <= positions.size(); i += dimension) {
    Vector position{};
    double square = 0;
    for (unsigned axis = 0; axis < dimension; ++axis) {
      position[axis] = positions[i + axis];
      square += velocities[i + axis] * velocities[i + axis];
    }
    frame.positions.push_back(position);
    frame.speeds.push_back(std::sqrt(square));
  }
  return frame;
}

const std::vector<Color> &speed_colors() {
  static const std::vector<Color> colors = {{46, 92, 196},   {60, 150, 222}, {84, 205, 214},
                                            {240, 236, 180}, {250, 160, 80}, {232, 80, 64}};
  return colors;
}

Color picture_background() { return {13, 18, 32}; }

std::string draw_png(const Frame &frame, const View &view) {
  const Painter painter(frame.dimension, view);
  Canvas canvas(view.width, painter.height());
  painter.draw_box(canvas);
  painter.draw_colliders(canvas, frame, true);
  painter.draw_particles(canvas, frame);
  painter.draw_diffuse(canvas, frame);
  painter.draw_colliders(canvas, frame, false);
  const std::vector<unsigned char> pixels = canvas.pixels();
  return encode_png(view.width, painter.height(), pixels.data());
}

}  // namespace bench
