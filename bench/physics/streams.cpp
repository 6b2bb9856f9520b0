/* What comes and goes: openings, a current, a jet on a plate. */
#include <cmath>

#include "physics/fluid.h"

namespace bench::physics {
void volume_flow(Run &run) {
  Scene scene = run.scene("fill-a-tank");
  const pbf_emitter &opening = scene.emitters.at(0);
  Fluid f(run, scene);
  f.step(scene.steps);
  const double volume = opening.rate * f.time();
  const auto emitted = static_cast<double>(f.in_out().emitted);
  run.difference("particles that have come", emitted, volume / f.particle_volume(), 1, "particles");
  check_call(pbf_set_emitters(f.handle(), 0, nullptr));
  f.step(256);
  f.look();
  run.took(f.count());
  const double side = f.params.domain_max[0];
  std::vector<double> points;
  for (double at : {0.25, 0.5, 0.75})
    for (double across : {0.25, 0.5, 0.75})
      points.insert(points.end(), {at * side, 0.0, across * side});
  run.difference("level less the volume over the area",
                 (f.mean_level(points) - volume / (side * side)) / f.params.spacing, 0, 0.5,
                 "spacings");
}

void current_tank(Run &run) {
  const Scene scene = run.scene("current-tank");
  Fluid f(run, scene);
  const double level = 0.5;
  const std::vector<double> points = {0.5, 0, 0.8, 0, 1.1, 0, 1.4, 0};
  constexpr uint32_t looks = 100;
  const uint32_t steps = run.quick() ? scene.steps / 12 : scene.steps;
  double mean = 0, farthest = 0;
  f.step(steps / 2);
  const pbf_in_out half = f.in_out();
  for (uint32_t k = 0; k < looks; ++k) {
    f.step(steps / 2 / looks);
    const double now = f.mean_level(points) - level;
    mean += now / looks;
    farthest = std::fmax(farthest, std::fabs(now));
  }
  const pbf_in_out all = f.in_out();
  const auto came = static_cast<double>(all.emitted - half.emitted);
  const auto went = static_cast<double>(all.drained - half.drained);
  run.plain("seconds", f.time());
  run.difference("level, mean of the second half", mean / f.params.spacing, 0, 1, "spacings");
  run.difference("level, farthest", farthest / f.params.spacing, 0, 1, "spacings");
  run.ratio("what goes over what comes", went / came, 1, 0.02);
}

// Newton's second law: the plate takes all of the momentum along the jet.
void jet(Run &run) {
  const Scene scene = run.scene("jet-on-a-plate");
  const double speed = -scene.emitters.at(0).velocity[1];
  Fluid f(run, scene);
  f.step(scene.steps / 2);
  const uint64_t before = f.in_out().emitted;
  const double began = f.time();
  f.collider_load(0);
  f.step(scene.steps / 2);
  const pbf_collider_load load = f.collider_load(0);
  const double flow =
      static_cast<double>(f.in_out().emitted - before) * f.particle_volume() / (f.time() - began);
  f.look();
  run.took(f.count());
  run.ratio("force on the plate over ρ Q V", -load.impulse_sum[1] / load.time_sum / (flow * speed),
            1, 0.02);
}

}  // namespace bench::physics
