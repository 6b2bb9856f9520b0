/* A dam break in C++: 4,000 particles fall and spread, the front is printed ten times a second. */
#include <cmath>
#include <cstdio>
#include <vector>

#include <pbf/pbf.hpp>

static std::vector<float> column() {
  std::vector<float> positions;
  for (int i = 0; i < 10 * 20 * 20; ++i) {
    for (const int n : {i % 10, i / 10 % 20, i / 200}) {
      positions.push_back(0.025f + 0.05f * static_cast<float>(n));
    }
  }
  return positions;
}

static pbf::result<void> run() {
  pbf::desc desc;
  pbf::params params;
  desc.capacity = 4000;
  params.domain_max[0] = 2; /* a tank of 2 x 1 x 1, particles 0.05 apart */
  auto fluid = pbf::solver::create(desc, params);
  if (!fluid) return fluid.failure();
  if (auto added = fluid->add_particles(column()); !added) return added.failure();

  for (int frame = 1; frame <= 10; ++frame) {
    const auto steps = static_cast<std::uint32_t>(std::lround(0.1 / params.time_step));
    if (auto done = fluid->step(steps); !done) return done;
    const auto stats = fluid->stats();
    if (!stats) return stats.failure();
    std::printf("%.1f s: front at %.2f m\n", 0.1 * frame, stats->position_max[0]);
  }
  return {};
}

int main() {
  const auto done = run();
  if (!done) std::fprintf(stderr, "%s\n", done.message());
  return done ? 0 : 1;
}
