/* Surface tension: the pressure in drops, their periods, and contact angles. */
#include <algorithm>
#include <array>
#include <cmath>

#include "physics/fluid.h"

namespace bench::physics {
namespace {

// sqrt(spacing³ / tension)
double capillary_time(const pbf_params &params) {
  return std::sqrt(std::pow(params.spacing, 3) / params.surface_tension);
}

// Of a ball or disc of the fluid's volume.
double radius_of(const Fluid &f) {
  return f.params.spacing *
         (f.dimension == 3 ? std::cbrt(0.75 * f.count() / pi) : std::sqrt(f.count() / pi));
}

std::array<double, 3> middle_of(Fluid &f) {
  std::array<double, 3> middle{};
  for (uint32_t i = 0; i < f.count(); ++i)
    for (unsigned k = 0; k < f.dimension; ++k) middle[k] += f.at(i)[k] / f.count();
  return middle;
}

// The mean of the pressures within 0.6 of the radius, over Laplace's.
double pressure_over_laplace(Fluid &f, double radius) {
  f.look();
  const auto middle = middle_of(f);
  const std::vector<double> p = f.pressures();
  double sum = 0, inside = 0;
  for (uint32_t i = 0; i < f.count(); ++i) {
    double r2 = 0;
    for (unsigned k = 0; k < f.dimension; ++k) r2 += std::pow(f.at(i)[k] - middle[k], 2);
    if (r2 > 0.36 * radius * radius) continue;
    sum += p[i];
    inside += 1;
  }
  return sum / inside / (f.params.surface_tension * (f.dimension - 1) / radius);
}

// The second half of the scene's steps.
double pressure_of_drop(Run &run, const Scene &scene, uint32_t start) {
  Fluid f(run, scene);
  f.shake(1, start);
  const double radius = radius_of(f);
  constexpr uint32_t looks = 25;
  double sum = 0;
  f.step(scene.steps / 2);
  for (uint32_t k = 0; k < looks; ++k) {
    f.step(std::max(scene.steps / 2 / looks, 1u));
    sum += pressure_over_laplace(f, radius) / looks;
  }
  return sum;
}

void add_spread(Run &run, const std::string &what, const std::vector<double> &all) {
  run.plain(what + ", least of " + std::to_string(all.size()),
            *std::min_element(all.begin(), all.end()));
  run.plain(what + ", largest", *std::max_element(all.begin(), all.end()));
}

double mean_of(const std::vector<double> &all) {
  double sum = 0;
  for (double one : all) sum += one;
  return sum / static_cast<double>(all.size());
}

void laplace_of(Run &run, const char *scene, const char *what, uint32_t starts) {
  std::vector<double> all;
  for (uint32_t start = 1; start <= starts; ++start)
    all.push_back(pressure_of_drop(run, run.scene(scene), start));
  const std::string name = std::string("pressure in ") + what + " over Laplace's";
  run.ratio(name + ", mean", mean_of(all), 1, 0.05);
  if (starts > 1) add_spread(run, name, all);
}

}  // namespace

void laplace(Run &run) {
  laplace_of(run, "laplace-drop", "drops", run.quick() ? 1 : 8);
  laplace_of(run, "laplace-disc", "discs", run.quick() ? 2 : 16);
}

// ---- Periods -----------------------------------------------------------------------------------

namespace {

// How long it is along x, less how long along y, over both.
double stretch_of(Fluid &f) {
  f.look();
  const auto middle = middle_of(f);
  double moments[2] = {0, 0};
  for (uint32_t i = 0; i < f.count(); ++i)
    for (unsigned k = 0; k < 2; ++k) moments[k] += std::pow(f.at(i)[k] - middle[k], 2);
  return (moments[0] - moments[1]) / (moments[0] + moments[1]);
}

// What is left of y once the best a + exp(-decay t) (b cos + c sin)(omega t) is taken off: least
// squares by Gram and Schmidt.
double misfit(const std::vector<double> &y, double dt, double omega, double decay) {
  const size_t n = y.size();
  std::array<std::vector<double>, 3> base;
  for (size_t i = 0; i < n; ++i) {
    const double t = dt * static_cast<double>(i), left = std::exp(-decay * t);
    base[0].push_back(1);
    base[1].push_back(left * std::cos(omega * t));
    base[2].push_back(left * std::sin(omega * t));
  }
  std::vector<double> rest = y;
  for (size_t k = 0; k < 3; ++k) {
    double length = 0, along = 0;
    for (size_t j = 0; j < k; ++j) {
      double shared = 0, square = 0;
      for (size_t i = 0; i < n; ++i)
        shared += base[k][i] * base[j][i], square += base[j][i] * base[j][i];
      for (size_t i = 0; i < n; ++i) base[k][i] -= shared / square * base[j][i];
    }
    for (size_t i = 0; i < n; ++i) length += base[k][i] * base[k][i], along += base[k][i] * rest[i];
    for (size_t i = 0; i < n; ++i) rest[i] -= along / length * base[k][i];
  }
  double sum = 0;
  for (double r : rest) sum += r * r;
  return sum;
}

// The frequency of the best fit, over what it should be.
double frequency_of(const std::vector<double> &y, double dt, double right) {
  double best = misfit(y, dt, right, 0), found = 1;
  for (double omega = 0.5; omega < 1.6; omega += 0.005)
    for (double decay = 0; decay < 0.6; decay += 0.02) {
      const double now = misfit(y, dt, omega * right, decay * right);
      if (now < best) best = now, found = omega;
    }
  return found;
}

// A push along the second mode, which would be 0.06 of the radius.
void push(Fluid &f, double rate) {
  f.look();
  const auto middle = middle_of(f);
  for (uint32_t i = 0; i < f.count(); ++i)
    for (unsigned k = 0; k < f.dimension; ++k) {
      const double factor = k == 0 ? 1 : f.dimension == 2 ? -1 : -0.5;
      f.speed(i)[k] = factor * rate * (f.at(i)[k] - middle[k]);
    }
  f.put();
}

double period_over_rayleigh(Run &run, const Scene &scene, uint32_t start) {
  Fluid f(run, scene);
  f.shake(1, start);
  const double radius = radius_of(f), tension = f.params.surface_tension;
  const double right = std::sqrt((f.dimension == 3 ? 8 : 6) * tension / (radius * radius * radius));
  const double periods = f.dimension == 3 ? 1.25 : 2;
  const auto rest = static_cast<uint32_t>(60 * capillary_time(f.params) / f.params.time_step);
  const auto swing = static_cast<uint32_t>(periods * 2 * pi / right / f.params.time_step);
  constexpr uint32_t looks = 120;
  const uint32_t every = std::max(swing / looks, 1u);
  f.step(rest);
  f.params.viscosity = 0;
  f.set_params();
  push(f, 0.06 * right);
  std::vector<double> y = {stretch_of(f)};
  for (uint32_t k = 0; k < looks; ++k) {
    f.step(every);
    y.push_back(stretch_of(f));
  }
  return 1 / frequency_of(y, every * f.params.time_step, right);
}

void rayleigh_of(Run &run, const char *scene, const char *what, uint32_t starts) {
  std::vector<double> all;
  for (uint32_t start = 1; start <= starts; ++start)
    all.push_back(period_over_rayleigh(run, run.scene(scene), start));
  const std::string name = std::string("period of ") + what + " over Rayleigh's";
  run.ratio(name + ", mean", mean_of(all), 1, 0.05);
  if (starts > 1) add_spread(run, name, all);
}

}  // namespace

void rayleigh(Run &run) {
  rayleigh_of(run, "rayleigh-drop", "drops", run.quick() ? 1 : 8);
  rayleigh_of(run, "rayleigh-disc", "discs", run.quick() ? 1 : 8);
}

// ---- Contact angles ----------------------------------------------------------------------------

namespace {

// The height of the centre of mass of a spherical cap over the root mean square of x.
double shape_of_cap(unsigned dimension, double angle) {
  constexpr int slices = 400;
  double all = 0, height = 0, width = 0;
  for (int k = 0; k < slices; ++k) {
    const double y = (1 - std::cos(angle)) * (k + 0.5) / slices, z = y + std::cos(angle);
    const double r2 = 1 - z * z, area = dimension == 3 ? r2 : std::sqrt(r2);
    all += area;
    height += area * y;
    width += area * r2 / (dimension == 3 ? 4 : 3);
  }
  return height / all / std::sqrt(width / all);
}

double angle_of_shape(unsigned dimension, double shape) {
  double low = 0.05, high = pi;
  for (int k = 0; k < 40; ++k) {
    const double middle = (low + high) / 2;
    (shape_of_cap(dimension, middle) < shape ? low : high) = middle;
  }
  return low * 180 / pi;
}

double shape_of(Fluid &f) {
  f.look();
  const auto middle = middle_of(f);
  double width = 0;
  for (uint32_t i = 0; i < f.count(); ++i)
    for (unsigned k = 0; k < f.dimension; k += 2)
      width += std::pow(f.at(i)[k] - middle[k], 2) / f.count();
  return (middle[1] - f.params.domain_min[1]) / std::sqrt(width / (f.dimension - 1));
}

// A cap of the scene's volume that begins with another angle.
void make_cap(Scene &scene, double degrees) {
  const double a = degrees * pi / 180;
  Region &ball = scene.blocks.at(0).within.at(0);
  const double r = std::sqrt(ball.below);
  const double half = scene.dimension == 3 ? 2 * pi / 3 : pi / 2;
  const double unit = scene.dimension == 3
                          ? pi / 3 * (2 + std::cos(a)) * std::pow(1 - std::cos(a), 2)
                          : a - std::sin(a) * std::cos(a);
  const double radius = r * std::pow(half / unit, 1.0 / scene.dimension);
  ball.below = radius * radius;
  ball.center[1] = -radius * std::cos(a);
}

double angle_of_drop(Run &run, const char *name, double angle, double start) {
  Scene scene = run.scene(name);
  make_cap(scene, start);
  scene.params.wall_adhesion = (1 + std::cos(angle * pi / 180)) / 2;
  Fluid f(run, scene);
  f.shake(0.5, 1);
  const uint32_t steps = run.quick() ? scene.steps / 3 : scene.steps;
  constexpr uint32_t looks = 20;
  double shape = 0;
  f.step(steps / 2);
  for (uint32_t k = 0; k < looks; ++k) {
    f.step(steps / 2 / looks);
    shape += shape_of(f) / looks;
  }
  return angle_of_shape(f.dimension, shape);
}

void angles_of(Run &run, const char *scene, const char *dimension) {
  for (double angle = run.quick() ? 90 : 60; angle < (run.quick() ? 100 : 160); angle += 30) {
    const double above = angle > 140 ? 165 : angle + 30;
    const double receding = angle_of_drop(run, scene, angle, angle - 30);
    const double advancing = angle_of_drop(run, scene, angle, above);
    const std::string name = std::string(dimension) + ", " + std::to_string(int(angle)) + "°";
    run.difference(name + ", mean", (receding + advancing) / 2, angle, 10, "degrees");
    run.plain(name + ", from below", receding);
    run.plain(name + ", from above", advancing);
  }
}

}  // namespace

void contact_angles(Run &run) {
  angles_of(run, "contact-angle-2d", "2D");
  if (!run.quick()) angles_of(run, "contact-angle-3d", "3D");
}

}  // namespace bench::physics
