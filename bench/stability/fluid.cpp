#include "stability/fluid.h"

#include <algorithm>
#include <random>

namespace bench::stability {
namespace {

Particles filled(const Block &block, unsigned dimension) {
  Scene scene;
  scene.dimension = dimension;
  scene.blocks = {block};
  return fill_scene(scene);
}

// Uniform in 0 … 1; the standard's own distributions differ between libraries.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

Particles box(const Vector &low, const Vector &high, double apart, unsigned dimension) {
  Block block;
  block.shape = Block::Shape::box;
  block.min = low;
  block.max = high;
  block.spacing = apart;
  return filled(block, dimension);
}

Particles ball(const Vector &center, double radius, const Vector &velocity) {
  Block block;
  block.shape = Block::Shape::ball;
  block.center = center;
  block.radius = radius;
  block.spacing = spacing;
  block.velocity = velocity;
  return filled(block, 3);
}

Particles random_box(const Vector &low, const Vector &high, uint64_t count, unsigned seed) {
  Random random(seed);
  Particles particles;
  particles.count = count;
  for (uint64_t i = 0; i < count; ++i) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      particles.positions.push_back(low[axis] + (high[axis] - low[axis]) * random());
      particles.velocities.push_back(0);
    }
  }
  return particles;
}

void jitter(Particles &particles, double distance, unsigned seed) {
  Random random(seed);
  for (double &x : particles.positions) x += distance * (2 * random() - 1);
}

void append(Particles &to, const Particles &more) {
  to.count += more.count;
  to.positions.insert(to.positions.end(), more.positions.begin(), more.positions.end());
  to.velocities.insert(to.velocities.end(), more.velocities.begin(), more.velocities.end());
}

Particles at(std::initializer_list<Vector> positions) {
  Particles particles;
  for (const Vector &x : positions) {
    ++particles.count;
    particles.positions.insert(particles.positions.end(), x.begin(), x.end());
    particles.velocities.insert(particles.velocities.end(), 3, 0.0);
  }
  return particles;
}

Start tank(const Vector &size, const Vector &fluid) {
  Start start;
  std::copy(size.begin(), size.end(), start.params.domain_max);
  start.particles = box({0, 0, 0}, fluid);
  return start;
}

Start dam_break(bool small) {
  return small ? tank({0.8, 0.8, 0.3}, {0.3, 0.5, 0.3}) : tank({1.6, 1.2, 0.5}, {0.5, 1, 0.5});
}

}  // namespace bench::stability
