/* The same scene in another order or another orientation: cases 37 and 38. */
#include <algorithm>
#include <numeric>
#include <random>

#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

Particles reordered(const Particles &from, const std::vector<uint64_t> &order) {
  Particles to;
  to.count = from.count;
  for (const uint64_t i : order) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      to.positions.push_back(from.positions[3 * i + axis]);
      to.velocities.push_back(from.velocities[3 * i + axis]);
    }
  }
  return to;
}

// x, y, z become y, z and the mirror image of x.
void turn(double *v, double mirror) {
  const double x = v[0];
  v[0] = v[1];
  v[1] = v[2];
  v[2] = mirror - x;
}

}  // namespace

void permuted(Record &record) {
  Start start = dam_break(true);
  const uint32_t steps = 30;
  Trial(record, "in-order", start).run(steps, 3);
  std::vector<uint64_t> order(start.particles.count);
  std::iota(order.begin(), order.end(), uint64_t{0});
  std::mt19937_64 engine(37);
  for (uint64_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[engine() % i]);
  start.particles = reordered(start.particles, order);
  Trial(record, "permuted", start).run(steps, 3);
  record.note("order", order);
}

void turned_and_mirrored(Record &record) {
  Start start = dam_break(true);
  const uint32_t steps = 60;
  Trial(record, "upright", start).run(steps, 3);
  const double mirror = start.params.domain_max[0];
  for (uint64_t i = 0; i < start.particles.count; ++i) {
    turn(&start.particles.positions[3 * i], mirror);
    turn(&start.particles.velocities[3 * i], 0);
  }
  turn(start.params.gravity, 0);
  std::rotate(start.params.domain_max, start.params.domain_max + 1, start.params.domain_max + 3);
  Trial(record, "turned", start).run(steps, 3);
  record.note("mirror", mirror);
}

}  // namespace bench::stability
