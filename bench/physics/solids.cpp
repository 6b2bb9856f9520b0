/* Forces on solids and friction: the cases of pbf-forces, and slopes. */
#include <cmath>

#include "forces/cases.h"
#include "physics/fluid.h"

namespace bench::physics {
namespace {

Run *current;

int keep(const char *, const char *figure, double is, double right, double bar) {
  if (bar == 0)
    current->plain(figure, is);
  else if (right == 0)
    current->difference(figure, is, right, bar, "");
  else
    current->ratio(figure, is, right, bar);
  return 0;
}

// The cases of pbf-forces are C, and make their own fluid.
void run_forces(Run &run, int (*one)(double spacing), double spacing) {
  current = &run;
  forces_report = keep;
  forces_backend = run.solver().backend.c_str();
  one(spacing / run.finer());
}

}  // namespace

void buoyancy(Run &run) {
  run_forces(run, run.quick() ? run_half_sunk_cube : run_buoyancy, run.quick() ? 0.05 : 0.025);
}

void wall_force(Run &run) { run_forces(run, run_dam_break, run.quick() ? 0.04 : 0.02); }

void towed_ball(Run &run) { run_forces(run, run_tow, run.quick() ? 0.05 : 0.025); }

// ---- Friction ----------------------------------------------------------------------------------

namespace {

double mean_along(Fluid &f) {
  double sum = 0;
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i) sum += f.speed(i)[0] / f.count();
  return sum;
}

// What it gains in a time unit.
double gained(Run &run, double degrees, double sliding, double at_rest, bool tilted_late) {
  Scene scene = run.scene("slope");
  const double a = degrees * pi / 180,
               g = std::hypot(scene.params.gravity[0], scene.params.gravity[1]);
  scene.params.wall_friction = sliding;
  scene.params.wall_static_friction = at_rest;
  scene.params.gravity[0] = tilted_late ? 0 : g * std::sin(a);
  scene.params.gravity[1] = -g * std::cos(a);
  Fluid f(run, scene);
  f.step(40);
  f.params.gravity[0] = g * std::sin(a);
  f.set_params();
  if (tilted_late) f.step(scene.steps);
  const double before = mean_along(f);
  f.step(scene.steps);
  return (mean_along(f) - before) / (scene.steps * f.params.time_step);
}

// A drop that adheres to a floor without friction, which is tilted once it lies: nothing holds it
// back along the floor, and what it gains is gravity's part along that.
double gain_of_drop(Run &run, double degrees) {
  Scene scene = run.scene("contact-angle-2d");
  const double a = degrees * pi / 180, d = scene.params.spacing;
  const double g = 0.5 * scene.params.surface_tension / std::pow(14 * d, 2);  // Bond number 0.5
  scene.params.gravity[1] = -g;
  Fluid f(run, scene);
  f.shake(0.5, 1);
  f.step(600);
  f.params.gravity[0] = g * std::sin(a);
  f.params.gravity[1] = -g * std::cos(a);
  f.set_params();
  const double before = mean_along(f);
  f.step(400);
  return (mean_along(f) - before) / (400 * f.params.time_step * g);
}

}  // namespace

void friction(Run &run) {
  const double g = 9.81;
  for (double mu : {0.0, 0.2, 0.4}) {
    const double right = g * (0.5 - mu * std::cos(pi / 6));
    char name[80];
    std::snprintf(name, sizeof name, "30°, μ = %g: gain over g (sin a - μ cos a)", mu);
    run.ratio(name, gained(run, 30, mu, 0, false), right, 0.02);
  }
  const double holds = std::atan(0.5) * 180 / pi, lets_go = std::atan(0.6) * 180 / pi;
  run.difference("tan a = 0.5, static 0.55, tilted once it lies: gain over g",
                 gained(run, holds, 0.2, 0.55, true) / g, 0, 0.001, "");
  run.ratio("tan a = 0.6, static 0.55: gain over g (sin a - 0.2 cos a)",
            gained(run, lets_go, 0.2, 0.55, true), g * std::cos(std::atan(0.6)) * (0.6 - 0.2),
            0.02);
  run.ratio("a drop that adheres, 30°, no friction: gain over g sin a", gain_of_drop(run, 30) / 0.5,
            1, 0.02);
}

}  // namespace bench::physics
