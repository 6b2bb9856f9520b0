/* What is asked by place, in a tank at rest. */
#include <cmath>

#include "physics/fluid.h"

namespace bench::physics {
namespace {

// Places away from the tank's walls, at a height.
std::vector<double> places(double height) {
  std::vector<double> points;
  for (double x = 0.25; x < 0.6; x += 0.1)
    for (double z = 0.25; z < 0.6; z += 0.1) points.insert(points.end(), {x, height, z});
  return points;
}

pbf_samples samples_of(const std::vector<double> &points) {
  pbf_samples samples = {};
  samples.struct_size = sizeof samples;
  samples.count = static_cast<uint32_t>(points.size() / 3);
  samples.points = points.data();
  return samples;
}

void ask_levels(Run &run, Fluid &f, double level) {
  const std::vector<double> points = places(0);
  const auto count = static_cast<uint32_t>(points.size() / 3);
  std::vector<double> levels(count), distances(count), from = places(0.95), down(points.size());
  double mean = 0, met = 0;
  for (uint32_t i = 0; i < count; ++i) down[3 * i + 1] = -1;
  check_call(pbf_get_levels(f.handle(), count, points.data(), levels.data()));
  check_call(
      pbf_cast_rays(f.handle(), count, from.data(), down.data(), 2, distances.data(), nullptr));
  for (uint32_t i = 0; i < count; ++i)
    mean += levels[i] / count, met += (0.95 - distances[i]) / count;
  run.difference("level less the volume over the area", (mean - level) / f.params.spacing, 0, 0.5,
                 "spacings");
  run.difference("where rays meet it, the same", (met - level) / f.params.spacing, 0, 0.5,
                 "spacings");
}

// By least squares, 2 to 9 layers below the level.
void ask_pressures(Run &run, Fluid &f, double level) {
  double product = 0, square = 0, density = 0, count = 0;
  for (double depth = 2; depth < 9.5; depth += 1) {
    const double right = -f.params.gravity[1] * depth * f.params.spacing;
    const std::vector<double> points = places(level - depth * f.params.spacing);
    pbf_samples samples = samples_of(points);
    std::vector<double> p(samples.count), rho(samples.count);
    samples.pressures = p.data();
    samples.densities = rho.data();
    check_call(pbf_sample(f.handle(), &samples));
    for (uint32_t i = 0; i < samples.count; ++i) {
      product += p[i] * right, square += right * right;
      density += rho[i], count += 1;
    }
  }
  run.ratio("pressure over ρ g times the depth", product / square, 1, 0.02);
  run.ratio("density inside", density / count, 1, 0.01);
}

void ask_volume(Run &run, Fluid &f, double level) {
  pbf_volume box;
  check_call(pbf_volume_init(&box, sizeof box, PBF_VOLUME_BOX));
  pbf_volume_flow flow = {};
  flow.struct_size = sizeof flow;
  box.position[0] = box.position[2] = 0.4;
  box.position[1] = level;
  for (double &half : box.half_extents) half = 0.2;
  check_call(pbf_measure_volumes(f.handle(), 1, &box, &flow));
  run.difference("part below the level of a box set half into it", flow.fraction, 0.5, 0.02, "");
}

// A field that is a straight line comes out as it is.
void ask_velocities(Run &run, Fluid &f) {
  f.look();
  const auto field = [](const double *x, double *v) {
    for (int k = 0; k < 3; ++k) v[k] = 0.3 * x[(k + 1) % 3] - 0.2 * x[k] + 0.1;
  };
  for (uint32_t i = 0; i < f.count(); ++i) field(f.at(i), f.speed(i));
  f.put();
  const std::vector<double> points = places(0.33);
  pbf_samples samples = samples_of(points);
  std::vector<double> v(points.size());
  double error = 0;
  samples.velocities = v.data();
  check_call(pbf_sample(f.handle(), &samples));
  for (uint32_t i = 0; i < samples.count; ++i) {
    double right[3];
    field(&points[3 * size_t{i}], right);
    for (int k = 0; k < 3; ++k)
      error = std::fmax(error, std::fabs(v[3 * size_t{i} + k] - right[k]));
  }
  run.difference("velocity of a linear field, largest error", error, 0, 1e-5, "");
}

}  // namespace

void queries(Run &run) {
  const Scene scene = run.scene("queries");
  Fluid f(run, scene);
  f.step(scene.steps);
  const double level =
      f.count() * f.particle_volume() / (f.params.domain_max[0] * f.params.domain_max[2]);
  ask_levels(run, f, level);
  ask_pressures(run, f, level);
  ask_volume(run, f, level);
  ask_velocities(run, f);
}

}  // namespace bench::physics
