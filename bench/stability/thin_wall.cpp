/* Walls thinner than a particle, and particles that cross many of them in a step: cases 16, 17. */
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

constexpr double thickness = 0.1 * spacing;

// A plate across the x axis, as large as the domain needs.
pbf_collider plate(double x, double size) {
  pbf_collider wall;
  must(pbf_collider_init(&wall, sizeof wall, PBF_COLLIDER_BOX));
  for (unsigned axis = 0; axis < 3; ++axis) {
    wall.position[axis] = size / 2;
    wall.half_extents[axis] = size;
  }
  wall.position[0] = x;
  wall.half_extents[0] = thickness / 2;
  return wall;
}

void set_speed(Particles &particles, double x, double y) {
  for (uint64_t i = 0; i < particles.count; ++i) {
    particles.velocities[3 * i] = x;
    particles.velocities[3 * i + 1] = y;
  }
}

}  // namespace

void fast_at_thin_wall(Record &record) {
  const double speed = 50 * support * 120;  // 50 h a step
  Start start;
  start.params.domain_max[0] = 40;
  start.particles = box({17, 0.3, 0.3}, {17.3, 0.7, 0.7});
  record.note("plate", 20.0);

  Start straight = start;
  straight.colliders = {plate(20, 2)};
  set_speed(straight.particles, speed, 0);
  Trial(record, "straight", straight).run(60, 60);

  Start aslant = straight;
  set_speed(aslant.particles, speed, 0.1 * speed);
  Trial(record, "aslant", aslant).run(60, 60);

  // The wall of the domain itself, which lies 4.6 steps off.
  Start domain = start;
  set_speed(domain.particles, speed, 0);
  Trial(record, "domain", domain).run(60, 60);

  // The same in the plate's own frame: the plate flies, and stops for none.
  Start swept = start;
  swept.colliders = {plate(20, 2)};
  swept.colliders[0].velocity[0] = -speed;
  Trial trial(record, "swept", swept);
  for (unsigned step = 1; step <= 3; ++step) {
    trial.step(1);
    trial.frame();
  }
  record.note("swept_speed", -speed);
}

void long_at_thin_wall(Record &record) {
  Start start = tank({0.5, 0.5, 0.2}, {0.25 - spacing / 2, 0.3, 0.2});
  start.colliders = {plate(0.25, 0.5)};
  record.note("plate", 0.25);
  Trial trial(record, "dam", start);
  trial.run(record.quick_or(1500u, 100000u), record.quick_or(10u, 100u));
  trial.draw("Water behind a plate a tenth of a spacing thin");
}

}  // namespace bench::stability
