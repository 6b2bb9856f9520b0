/* Open boundaries of given level and pressure. */
#include <algorithm>
#include <cmath>

#include "physics/fluid.h"

namespace bench::physics {
namespace {

// Of a while: the mean of the level, and the farthest of it, from what it must be, in spacings.
struct Level {
  double mean, farthest;
};

Level level_of(Fluid &f, uint32_t steps, double right, const std::vector<double> &points) {
  const uint32_t looks = 100;
  Level level{0, 0};
  for (uint32_t k = 0; k < looks; ++k) {
    f.step(std::max(steps / looks, 1u));
    const double off = (f.mean_level(points) - right) / f.params.spacing;
    level.mean += off / looks;
    level.farthest = std::fmax(level.farthest, std::fabs(off));
  }
  return level;
}

void add_level(Run &run, const std::string &when, const Level &level) {
  run.difference("level " + when + ", mean", level.mean, 0, 0.5, "spacings");
  run.difference("level " + when + ", farthest", level.farthest, 0, 1, "spacings");
}

}  // namespace

void reservoir_level(Run &run) {
  const Scene scene = run.scene("reservoir-level");
  Fluid f(run, scene);
  const double right = scene.reservoirs.at(0).depth;
  const uint32_t steps = run.quick() ? scene.steps / 8 : scene.steps;
  const std::vector<double> points = {0.3, 0, 0.6, 0, 0.9, 0, 1.2, 0};
  f.step(steps / 4);
  add_level(run, "with nothing that comes", level_of(f, steps / 4, right, points));
  pbf_emitter inlet;
  check_call(pbf_emitter_init(&inlet, sizeof inlet, PBF_EMITTER_RECTANGLE));
  const double position[2] = {0.025, 0.15}, velocity[2] = {0.5, 0};
  std::copy_n(position, 2, inlet.position);
  std::copy_n(velocity, 2, inlet.velocity);
  inlet.half_width = 0.1;
  inlet.rate = 0.05;
  check_call(pbf_set_emitters(f.handle(), 1, &inlet));
  f.step(steps / 4);
  const double before = f.given_by(0), began = f.time();
  add_level(run, "with an inlet", level_of(f, steps / 4, right, points));
  run.ratio("what the reservoir takes over what comes",
            (before - f.given_by(0)) / (f.time() - began) / inlet.rate, 1, 0.02);
  run.plain("seconds", f.time());
}

namespace {

// What flows from the first reservoir to the second, in the second half of the scene's steps.
void add_flow(Run &run, const std::string &what, const Scene &scene, double right) {
  Fluid f(run, scene);
  f.step(scene.steps / 2);
  f.look();
  const double before = f.count();
  const double in = f.given_by(0), out = f.given_by(1), began = f.time();
  f.step(scene.steps / 2);
  const double time = f.time() - began;
  run.ratio(what + "what comes over the closed form", (f.given_by(0) - in) / time / right, 1, 0.05);
  run.ratio(what + "what goes over the closed form", (out - f.given_by(1)) / time / right, 1, 0.05);
  f.look();
  run.ratio(what + "particles at the end over those at the middle", f.count() / before, 1, 0.03);
}

}  // namespace

// Poiseuille's resistance, and that of a slit without length in a wall (Hasimoto, J. Phys. Soc.
// Japan 13, 633, 1958): half of it at each end.
void reservoir_channel(Run &run) {
  Scene scene = run.scene("reservoir-channel");
  const pbf_collider &below = scene.colliders.at(0).start, &above = scene.colliders.at(1).start;
  const double height =
      above.position[1] - above.half_extents[1] - below.position[1] - below.half_extents[1];
  const double length = 2 * below.half_extents[0], nu = scene.params.viscosity;
  const double resistance =
      12 * nu * length / (height * height * height) + 32 * nu / (pi * height * height);
  const double middle = (scene.reservoirs.at(0).depth + scene.reservoirs.at(1).depth) / 2;
  for (double head : {0.1, 0.4}) {
    if (run.quick() && head > 0.1) continue;
    scene.reservoirs[0].depth = middle + head / 2;
    scene.reservoirs[1].depth = middle - head / 2;
    char name[40];
    std::snprintf(name, sizeof name, "levels %g apart, ", head);
    add_flow(run, name, scene, -scene.params.gravity[1] * head / resistance);
  }
}

// The same difference of pressures, and seven times as much pressure: what pressed fluid resists.
void reservoir_pressure(Run &run) {
  Scene scene = run.scene("reservoir-pressure");
  pbf_reservoir &a = scene.reservoirs.at(0), &b = scene.reservoirs.at(1);
  const double height = scene.params.domain_max[1],
               from_one_end = a.position[0] + a.half_extents[1];
  const double length = b.position[0] - b.half_extents[1] + b.depth - (from_one_end - a.depth);
  for (double more : {0.0, 6.5}) {
    if (run.quick() && more > 0) continue;
    a.pressure += more;
    b.pressure += more;
    char name[60];
    std::snprintf(name, sizeof name, "from %g to %g, ", a.pressure, b.pressure);
    add_flow(run, name, scene,
             (a.pressure - b.pressure) * height * height * height /
                 (12 * scene.params.viscosity * length));
  }
}

}  // namespace bench::physics
