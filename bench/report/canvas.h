/* What pictures are drawn on. */
#ifndef PBF_BENCH_CANVAS_H
#define PBF_BENCH_CANVAS_H

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "report/picture.h"

namespace bench {

constexpr int subpixels = 2;  // a side of a pixel

// An image with depth, `subpixels` times as fine as the picture.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width * subpixels),
        height_(height * subpixels),
        color_(static_cast<size_t>(width_) * static_cast<size_t>(height_), picture_background()),
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

  // A parallelogram, middle + s a + t b for s and t from -1 to 1, that tints what lies behind it.
  void veil(const Vector &middle, const Vector &a, const Vector &b, const Color &color,
            double strength) {
    const double area = a[0] * b[1] - a[1] * b[0];
    if (std::fabs(area) < 1e-9) return;
    const double reach_x = std::fabs(a[0]) + std::fabs(b[0]);
    const double reach_y = std::fabs(a[1]) + std::fabs(b[1]);
    const int y1 = std::min(height_ - 1, static_cast<int>(middle[1] + reach_y));
    const int x1 = std::min(width_ - 1, static_cast<int>(middle[0] + reach_x));
    for (int j = std::max(0, static_cast<int>(middle[1] - reach_y)); j <= y1; ++j) {
      for (int i = std::max(0, static_cast<int>(middle[0] - reach_x)); i <= x1; ++i) {
        const double x = i + 0.5 - middle[0], y = j + 0.5 - middle[1];
        const double s = (x * b[1] - y * b[0]) / area, t = (y * a[0] - x * a[1]) / area;
        if (std::fabs(s) > 1 || std::fabs(t) > 1) continue;
        const size_t at = index(i, j);
        if (middle[2] + s * a[2] + t * b[2] < depth_[at]) continue;
        for (unsigned c = 0; c < 3; ++c)
          color_[at][c] = (1 - strength) * color_[at][c] + strength * color[c];
      }
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
  size_t index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(width_) + static_cast<size_t>(i);
  }

  void put(int i, int j, double z, const Color &color) {
    if (i < 0 || j < 0 || i >= width_ || j >= height_) return;
    const size_t at = index(i, j);
    if (z < depth_[at]) return;
    depth_[at] = z;
    color_[at] = color;
  }

  unsigned char average(int i, int j, unsigned component) const {
    double sum = 0;
    for (int dj = 0; dj < subpixels; ++dj) {
      for (int di = 0; di < subpixels; ++di) {
        sum += color_[index(i + di, j + dj)][component];
      }
    }
    return static_cast<unsigned char>(std::clamp(sum / (subpixels * subpixels) + 0.5, 0.0, 255.0));
  }

  int width_, height_;
  std::vector<Color> color_;
  std::vector<double> depth_;
};

}  // namespace bench

#endif
