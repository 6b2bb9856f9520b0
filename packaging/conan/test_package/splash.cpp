/* A particle falls. */
#include <cstdio>
#include <pbf/pbf.hpp>

int main() {
  auto fluid = pbf::solver::create();
  const float x[3] = {.5f, .5f, .5f};
  if (!fluid) return std::puts(fluid.message()), 1;
  if (auto added = fluid->add_particles(x); !added) return std::puts(added.message()), 1;
  if (auto done = fluid->step(10); !done) return std::puts(done.message()), 1;
  return std::printf("step %d\n", static_cast<int>(fluid->info()->step)) < 0;
}
