#include "report/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace bench {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int subpixels = 2;  // a side of a pixel

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

// An image with depth, `subpixels` times as fine as the picture.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width * subpixels),
        height_(height * subpixels),
        color_(static_cast<size_t>(width_) * height_, picture_background()),
        depth_(color_.size(), -std::numeric_limits<double>::infinity()) {}

  // `flat`: a disc of one colour; else a ball, lit from above left.
  void ball(double x, double y, double z, double radius, const Color &color, bool flat) {
    const int x0 = std::max(0, static_cast<int>(std::floor(x - radius)));
    const int x1 = std::min(width_ - 1, static_cast<int>(std::ceil(x + radius)));
    const int y0 = std::max(0, static_cast<int>(std::floor(y - radius)));
    const int y1 = std::min(height_ - 1, static_cast<int>(std::ceil(y + radius)));
    for (int j = y0; j <= y1; ++j) {
      for (int i = x0; i <= x1; ++i) {
        const double u = (i + 0.5 - x) / radius, v = (j + 0.5 - y) / radius;
        const double square = u * u + v * v;
        if (square >= 1) continue;
        const double w = std::sqrt(1 - square);
        const double light = flat ? 1 : 0.45 + 0.55 * std::max(0.0, -0.4 * u - 0.6 * v + 0.7 * w);
        put(i, j, z + radius * w, {color[0] * light, color[1] * light, color[2] * light});
      }
    }
  }

  void line(const Vector &a, const Vector &b, const Color &color) {
    const double length = std::max(std::fabs(b[0] - a[0]), std::fabs(b[1] - a[1]));
    const int points = static_cast<int>(std::ceil(length)) + 1;
    for (int p = 0; p <= points; ++p) {
      const double t = static_cast<double>(p) / points;
      const int i = static_cast<int>(a[0] + t * (b[0] - a[0]));
      const int j = static_cast<int>(a[1] + t * (b[1] - a[1]));
      for (int k = 0; k < subpixels; ++k) put(i + k, j, a[2] + t * (b[2] - a[2]), color);
    }
  }

  std::vector<unsigned char> pixels() const {
    std::vector<unsigned char> rgb;
    for (int j = 0; j < height_; j += subpixels) {
      for (int i = 0; i < width_; i += subpixels) {
        for (unsigned c = 0; c < 3; ++c) rgb.push_back(average(i, j, c));
      }
    }
    return rgb;
  }

 private:
  void put(int i, int j, double z, const Color &color) {
    if (i < 0 || j < 0 || i >= width_ || j >= height_) return;
    const size_t at = static_cast<size_t>(j) * width_ + i;
    if (z < depth_[at]) return;
    depth_[at] = z;
    color_[at] = color;
  }

  unsigned char average(int i, int j, unsigned component) const {
    double sum = 0;
    for (int dj = 0; dj < subpixels; ++dj) {
      for (int di = 0; di < subpixels; ++di) {
        sum += color_[static_cast<size_t>(j + dj) * width_ + i + di][component];
      }
    }
    return static_cast<unsigned char>(std::clamp(sum / (subpixels * subpixels) + 0.5, 0.0, 255.0));
  }

  int width_, height_;
  std::vector<Color> color_;
  std::vector<double> depth_;
};

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

class Painter {
 public:
  Painter(unsigned dimension, const View &view)
      : view_(view), flat_(dimension == 2), project_(dimension) {
    for (unsigned i = 0; i < 8; ++i) extent_.cover(project_(corner(view, i)));
    const double margin = 2 * view.particle_radius;
    scale_ = view.width / (extent_.high[0] - extent_.low[0] + 2 * margin);
    left_ = extent_.low[0] - margin;
    top_ = extent_.high[1] + margin;
    height_ = std::max(
        1, static_cast<int>(std::ceil(scale_ * (extent_.high[1] - extent_.low[1] + 2 * margin))));
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

void append(void *context, void *bytes, int size) {
  static_cast<std::string *>(context)->append(static_cast<char *>(bytes),
                                              static_cast<size_t>(size));
}

}  // namespace

Frame particles_of(const std::vector<double> &positions, const std::vector<double> &velocities,
                   unsigned dimension) {
  Frame frame{dimension, {}, {}};
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
  painter.draw_particles(canvas, frame);
  const std::vector<unsigned char> pixels = canvas.pixels();
  std::string png;
  stbi_write_png_to_func(append, &png, view.width, painter.height(), 3, pixels.data(),
                         3 * view.width);
  return png;
}

}  // namespace bench
