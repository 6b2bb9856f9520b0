/* Viscosity: flows between walls that hold the fluid, spheres that settle, vortices that decay. */
#include <cmath>

#include "physics/fluid.h"

namespace bench::physics {
namespace {

// How large what is found is in units of what must be, by least squares, and its largest error in
// units of the largest that must be.
struct Profile {
  double product = 0, square = 0, error = 0, largest = 0;
  void add(double is, double must) {
    product += is * must;
    square += must * must;
    error = std::fmax(error, std::fabs(is - must));
    largest = std::fmax(largest, std::fabs(must));
  }
};

void add_profile(Run &run, const std::string &name, const Profile &profile) {
  run.ratio(name + ", velocity over the closed form", profile.product / profile.square, 1, 0.03);
  run.difference(name + ", largest error over the largest velocity",
                 profile.error / profile.largest, 0, 0.03, "");
}

void plane_couette(Run &run) {
  const Scene scene = run.scene("couette");
  const double height = scene.colliders.at(0).start.position[1];
  const double speed = scene.colliders[0].start.velocity[0];
  Fluid f(run, scene);
  Profile profile;
  f.step(scene.steps - scene.steps / 5);
  f.collider_load(0);
  f.step(scene.steps / 5);
  const pbf_collider_load load = f.collider_load(0);
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i) profile.add(f.speed(i)[0], speed * f.at(i)[1] / height);
  add_profile(run, "between planes", profile);
  const double area = f.params.domain_max[0] - f.params.domain_min[0];
  run.ratio("shear stress on the lid over ν U/H",
            -load.impulse_sum[0] / load.time_sum / area / (f.params.viscosity * speed / height), 1,
            0.03);
}

// Landau & Lifshitz, Fluid Mechanics, § 18.
void cylinders(Run &run) {
  const Scene scene = run.scene("couette-cylinders");
  const pbf_collider &inner = scene.colliders.at(0).start, &outer = scene.colliders.at(1).start;
  const double a2 = inner.radius * inner.radius, b2 = outer.radius * outer.radius;
  const double turn = inner.angular_velocity[2] * a2 / (b2 - a2);
  Fluid f(run, scene);
  Profile profile;
  f.step(scene.steps);
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i) {
    const double *x = f.at(i), *v = f.speed(i), r = std::hypot(x[0], x[1]);
    profile.add((x[0] * v[1] - x[1] * v[0]) / r, turn * (b2 / r - r));
  }
  add_profile(run, "between cylinders", profile);
}

}  // namespace

void couette(Run &run) {
  plane_couette(run);
  cylinders(run);
}

namespace {

// g y (H - y)/(2 ν) less its series, which decays (Batchelor, An Introduction to Fluid Dynamics,
// § 4.3).
double poiseuille_at(const pbf_params &params, double y, double time) {
  const double height = params.domain_max[1], g = params.gravity[0], nu = params.viscosity;
  double u = g * y * (height - y) / (2 * nu);
  for (int n = 1; n < 40; n += 2) {
    const double k = n * pi / height;
    u -= 4 * g / (nu * height) / (k * k * k) * std::exp(-nu * k * k * time) * std::sin(k * y);
  }
  return u;
}

Profile profile_of(Fluid &f) {
  Profile profile;
  const double time = f.time();
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i)
    profile.add(f.speed(i)[0], poiseuille_at(f.params, f.at(i)[1], time));
  return profile;
}

}  // namespace

void poiseuille(Run &run) {
  const Scene scene = run.scene("poiseuille");
  Fluid f(run, scene);
  f.step(scene.steps / 10);
  add_profile(run, "after a tenth of the time", profile_of(f));
  f.step(scene.steps - scene.steps / 10);
  add_profile(run, "steady", profile_of(f));
}

// ---- Stokes ------------------------------------------------------------------------------------

// The drag of a sphere in a cubic array over that of one alone, by the part of the volume that
// spheres have (Hasimoto, J. Fluid Mech. 5, 317, 1959).
static double hasimoto(double part) {
  return 1 / (1 - 1.7601 * std::cbrt(part) + part - 1.5593 * part * part);
}

namespace {

// In the last quarter of the scene's steps, with `push` times its force.
void settle(Run &run, const std::string &what, double push) {
  Scene scene = run.scene("stokes-sphere");
  scene.params.gravity[0] *= push;
  const double a = scene.colliders.at(0).start.radius;
  Fluid f(run, scene);
  const double length = f.params.domain_max[0] - f.params.domain_min[0];
  const double volume = length * length * length, ball = 4 * pi / 3 * a * a * a;
  const double g = f.params.gravity[0];
  const double right = g * volume / (6 * pi * f.params.viscosity * a * hasimoto(ball / volume));
  double flow = 0;
  constexpr uint32_t looks = 20;
  f.step(scene.steps - scene.steps / 4);
  f.collider_load(0);
  for (uint32_t k = 0; k < looks; ++k) {
    f.step(scene.steps / 4 / looks);
    f.look();
    for (uint32_t i = 0; i < f.count(); ++i)
      flow += f.speed(i)[0] * f.particle_volume() / volume / looks;
  }
  const pbf_collider_load load = f.collider_load(0);
  run.ratio("mean velocity at a given force over Hasimoto's, " + what, flow / right, 1, 0.03);
  run.ratio("force on the sphere over that on the fluid, " + what,
            load.impulse_sum[0] / load.time_sum / (g * f.count() * f.particle_volume()), 1, 0.03);
}

}  // namespace

void stokes(Run &run) {
  settle(run, "as it has gone by one spacing", 1);
  if (!run.quick()) settle(run, "by ten", 10);
}

// ---- Vortices ----------------------------------------------------------------------------------

namespace {

void vortex(const pbf_params &params, const double *x, double *v) {
  const double k = 2 * pi / (params.domain_max[0] - params.domain_min[0]);
  v[0] = 0.5 * std::sin(k * x[0]) * std::cos(k * x[1]);
  v[1] = -0.5 * std::cos(k * x[0]) * std::sin(k * x[1]);
}

// How much of them is left.
double left_of(Fluid &f) {
  double product = 0, square = 0;
  f.look();
  for (uint32_t i = 0; i < f.count(); ++i) {
    double v[2];
    vortex(f.params, f.at(i), v);
    for (int k = 0; k < 2; ++k) product += v[k] * f.speed(i)[k], square += v[k] * v[k];
  }
  return product / square;
}

double told_viscosity(Fluid &f) {
  const double k = 2 * pi / (f.params.domain_max[0] - f.params.domain_min[0]);
  return -std::log(std::fmax(left_of(f), 1e-9)) / (2 * k * k * f.time());
}

}  // namespace

void taylor_green(Run &run) {
  const Scene scene = run.scene("taylor-green");
  Fluid f(run, scene);
  for (uint32_t i = 0; i < f.count(); ++i) vortex(f.params, f.at(i), f.speed(i));
  f.put();
  const uint32_t early = scene.steps * 3 / 8;
  f.step(early);
  run.ratio("viscosity that their decay tells, after three spacings", told_viscosity(f),
            f.params.viscosity, 0.03);
  f.step(scene.steps - early);
  run.ratio("viscosity that their decay tells, after eight", told_viscosity(f), f.params.viscosity,
            0.03);
}

}  // namespace bench::physics
