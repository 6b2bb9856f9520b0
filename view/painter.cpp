#include "painter.h"

#include <algorithm>

#include "report/picture.h"

namespace view {
namespace {

double percentile(const Reading &reading) {
  std::vector<float> values;
  for (const auto &particle : reading.particles) values.push_back(particle[3]);
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

}  // namespace

void Painter::set(const Reading &reading) {
  top_ = std::max({percentile(reading), 0.98 * top_, 1e-9});
  spheres_.set(reading.particles, reading.radius);
  solids_.set(reading);
  outlines_.set(reading);
}

void Painter::draw(const Camera &camera, int width, int height, double top) const {
  const bench::Color background = bench::picture_background();
  glViewport(0, 0, width, height);
  glClearColor(static_cast<float>(background[0] / 255), static_cast<float>(background[1] / 255),
               static_cast<float>(background[2] / 255), 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  const Matrix projection =
      camera.projection(static_cast<float>(width) / static_cast<float>(height));
  const Matrix to_eye = camera.to_eye();
  spheres_.draw(to_eye, projection, height, static_cast<float>(top > 0 ? top : top_));
  solids_.draw(to_eye, projection, height);
  outlines_.draw(to_eye, projection);
}

}  // namespace view
