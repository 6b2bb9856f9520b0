/* A box that turns about the vertical, its water turning with it: case 34. */
#include <cstdio>

#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

constexpr double gravity = 9.81, ceiling = 2.4;

double rise(double omega, double x, double z) {
  return omega * omega * (x * x + z * z) / (2 * gravity);
}

// Water under the paraboloid of its rotation, as long as that reaches no ceiling; else under a
// flat surface.
Particles turning_water(double half, double lowest, double omega) {
  const bool flat = lowest + rise(omega, half, half) > ceiling;
  const Particles all = box({-half, 0, -half}, {half, flat ? 2 * lowest : ceiling, half});
  Particles water;
  for (uint64_t i = 0; i < all.count; ++i) {
    const double *x = &all.positions[3 * i];
    if (!flat && x[1] > lowest + rise(omega, x[0], x[2])) continue;
    ++water.count;
    water.positions.insert(water.positions.end(), x, x + 3);
    water.velocities.insert(water.velocities.end(), {omega * x[2], 0, -omega * x[0]});
  }
  return water;
}

}  // namespace

void turning_tank(Record &record) {
  const double half = record.quick_or(0.25, 0.4), lowest = 0.2;
  const std::vector<double> speeds =
      record.quick() ? std::vector<double>{5, 100} : std::vector<double>{1, 3, 10, 100};
  for (const double omega : speeds) {
    Start start;
    for (const unsigned axis : {0u, 2u}) {
      start.params.domain_min[axis] = -1.5 * half;
      start.params.domain_max[axis] = 1.5 * half;
    }
    start.params.domain_max[1] = ceiling;
    pbf_collider walls;
    must(pbf_collider_init(&walls, sizeof walls, PBF_COLLIDER_BOX));
    walls.inverted = 1;
    walls.half_extents[0] = walls.half_extents[2] = half;
    walls.half_extents[1] = 2 * ceiling;
    walls.angular_velocity[1] = omega;
    start.colliders = {walls};
    start.particles = turning_water(half, lowest, omega);
    char label[32];
    std::snprintf(label, sizeof label, "omega-%g", omega);
    Trial trial(record, label, start);
    trial.run(record.quick_or(60u, 360u), 12);
    trial.draw(std::string(label) + ": the tank turns at that many rad/s");
  }
  record.note("half", half);
}

}  // namespace bench::stability
