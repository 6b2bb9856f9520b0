/* Several fluids: layers, and an interface that is the wrong way up. */
#include <algorithm>
#include <cmath>
#include <numeric>

#include "physics/fluid.h"

namespace bench::physics {
namespace {

double density_of(const Scene &scene, uint32_t phase) {
  return scene.phases.at(phase).rest_density;
}

// The part of the particles that are not in the layer that is theirs: with all of them in the order
// of height, the heaviest fluid has as many places from the lowest on as it has particles.
double misplaced(const Scene &scene, Fluid &f) {
  f.look();
  const std::vector<uint32_t> phases = f.phases();
  std::vector<uint32_t> by_height(f.count()), by_density(f.count());
  std::iota(by_height.begin(), by_height.end(), 0u);
  by_density = by_height;
  std::sort(by_height.begin(), by_height.end(),
            [&](uint32_t a, uint32_t b) { return f.at(a)[1] < f.at(b)[1]; });
  std::stable_sort(by_density.begin(), by_density.end(), [&](uint32_t a, uint32_t b) {
    return density_of(scene, phases[a]) > density_of(scene, phases[b]);
  });
  double wrong = 0;
  for (uint32_t i = 0; i < f.count(); ++i) wrong += phases[by_height[i]] != phases[by_density[i]];
  return wrong / f.count();
}

}  // namespace

void layers(Run &run) {
  const Scene scene = run.scene("layers-sort");
  Fluid f(run, scene);
  const double before = misplaced(scene, f);
  const uint32_t steps = run.quick() ? scene.steps / 4 : scene.steps;
  double weight = 0;
  for (uint32_t phase : f.phases())
    weight += density_of(scene, phase) * f.particle_volume() * -f.params.gravity[1];
  f.step(steps * 3 / 4);
  f.wall_loads();
  f.step(steps / 4);
  const pbf_collider_load floor = f.wall_loads().at(PBF_WALL_Y_MIN);
  run.plain("particles out of their layer at first", before);
  run.difference("particles out of their layer at the end", misplaced(scene, f), 0, 0.05, "of all");
  run.ratio("weight on the floor over that of the fluids",
            -floor.impulse_sum[1] / floor.time_sum / weight, 1, 0.01);
}

// ---- Instability -------------------------------------------------------------------------------

namespace {

double amplitude(Fluid &f, const std::vector<uint32_t> &phases) {
  const double width = f.params.domain_max[0];
  double sum = 0;
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i)
    if (!phases[i]) sum += 2 / width * f.particle_volume() * std::cos(pi * f.at(i)[0] / width);
  return sum;
}

// The interface has a wave, a spacing high.
std::vector<uint32_t> make_wave(Fluid &f) {
  std::vector<uint32_t> phases(f.count());
  for (uint32_t i = 0; i < f.count(); ++i)
    phases[i] =
        f.at(i)[1] > f.params.domain_max[1] / 2 +
                         f.params.spacing * std::cos(pi * f.at(i)[0] / f.params.domain_max[0]);
  check_call(pbf_set_particle_phases(f.handle(), 0, f.count(), phases.data()));
  return phases;
}

// By the best fit of cosh(s t), so long as the wave is no steeper than k a = 1/4.
double growth_over_theory(Run &run, double heavy, double shaken) {
  Scene scene = run.scene("rayleigh-taylor");
  scene.phases.at(1).rest_density = heavy;
  Fluid f(run, scene);
  const std::vector<uint32_t> phases = make_wave(f);
  if (shaken > 0) f.shake(shaken, 1);
  const double k = pi / f.params.domain_max[0], atwood = (heavy - 1) / (heavy + 1);
  const double rate =
      std::sqrt(atwood * -f.params.gravity[1] * k * std::tanh(k * f.params.domain_max[1] / 2));
  std::vector<double> times, waves;
  for (uint32_t done = 0; done <= 2 * scene.steps; done += 16) {
    times.push_back(f.time());
    waves.push_back(amplitude(f, phases));
    if (k * waves.back() > 0.25) break;
    f.step(16);
  }
  double best = INFINITY, found = 0;
  for (double s = 0; s < 2 * rate; s += 0.005 * rate) {
    double error = 0;
    for (size_t n = 0; n < times.size(); ++n)
      error += std::pow(waves[n] - waves[0] * std::cosh(s * times[n]), 2);
    if (error < best) best = error, found = s / rate;
  }
  return found;
}

}  // namespace

void rayleigh_taylor(Run &run) {
  for (double heavy : {3.0, 1.5, 10.0}) {
    if (run.quick() && heavy != 3) continue;
    char name[100];
    std::snprintf(name, sizeof name, "growth over linear theory, 1 : %g", heavy);
    run.ratio(std::string(name) + ", on a lattice", growth_over_theory(run, heavy, 0), 1, 0.1);
    if (run.quick()) continue;
    run.ratio(std::string(name) + ", off it", growth_over_theory(run, heavy, 0.3), 1, 0.1);
  }
}

// ---- Fronts ------------------------------------------------------------------------------------

namespace {

// Where of the heavy particles in the lowest two layers a fiftieth is farther.
double front_of(Fluid &f, const std::vector<uint32_t> &phases) {
  std::vector<double> low;
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i)
    if (!phases[i] && f.at(i)[1] < 2 * f.params.spacing) low.push_back(f.at(i)[0]);
  std::sort(low.begin(), low.end());
  return low.empty() ? 0 : low[low.size() * 49 / 50];
}

// Of a straight line through the fronts between the lock and the wall.
double front_speed(Run &run, double support_over_spacing, double part_of_step) {
  Scene scene = run.scene("lock-exchange");
  scene.params.smoothing_radius = support_over_spacing * scene.params.spacing;
  scene.params.time_step *= part_of_step;
  Fluid f(run, scene);
  const std::vector<uint32_t> phases = f.phases();
  f.shake(0.04, 1);
  const double length = f.params.domain_max[0], most = scene.steps * scene.params.time_step;
  double n = 0, t = 0, x = 0, tt = 0, tx = 0;
  while (f.time() < most / part_of_step) {
    f.step(4);
    const double front = front_of(f, phases);
    if (front < 0.58 * length) continue;
    if (front > 0.92 * length) break;
    n += 1, t += f.time(), x += front, tt += f.time() * f.time(), tx += f.time() * front;
  }
  return (n * tx - t * x) / (n * tt - t * t);
}

}  // namespace

void lock_exchange(Run &run) {
  const Scene scene = run.scene("lock-exchange");
  const double reduced = -scene.params.gravity[1] * (1 - density_of(scene, 1));
  const double right = 0.5 * std::sqrt(reduced * scene.params.domain_max[1] / 2);
  run.ratio("front over 0.5 sqrt(g' H), h = 3 d", front_speed(run, 3, 1) / right, 1, 0.1);
  if (run.quick()) return;
  run.ratio("front over 0.5 sqrt(g' H), h = 3 d, half of the step",
            front_speed(run, 3, 0.5) / right, 1, 0.1);
  run.ratio("front over 0.5 sqrt(g' H), h = 2 d", front_speed(run, 2, 1) / right, 1, 0.1);
}

}  // namespace bench::physics
