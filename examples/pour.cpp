/* A tap pours water over a stone; after three seconds: how much has come and gone, how high it
 * stands, what it weighs. As in bindings/, in other languages. */
/* code: pour */
#include <array>
#include <cstdio>
#include <exception>

#include <pbf/pbf.hpp>

static void pour() {
  pbf::desc desc;
  desc.capacity = 3000;
  pbf::params params;
  params.loads = 1;  // what the water does to solids
  auto fluid = pbf::solver::create(desc, params).value();

  const std::array<double, 18> tips = {.2, 0,   0, -.2, 0, 0,  0, .2, 0,
                                       0,  -.2, 0, 0,   0, .2, 0, 0,  -.2};
  const auto stone = pbf::shape::from_points(3, tips, .025).value();
  std::array<pbf::collider, 1> colliders = {pbf::collider::solid(stone, .5, .1, .5)};
  std::array<pbf::emitter, 1> taps = {pbf::emitter::disc(.5, .9, .5, .15)};  // downwards, 1 m/s
  std::array<pbf::volume, 1> drains = {
      pbf::volume::box(.95, .5, .5, .05, .3, .5)};  // an overflow at 0.2
  fluid.set_colliders(colliders).value();
  fluid.set_emitters(taps).value();
  fluid.set_drains(drains).value();
  std::array<pbf_collider_load, 6> walls;
  fluid.step(static_cast<std::uint32_t>(2.5 / params.time_step)).value();
  fluid.get_wall_loads(walls).value();  // begins the sums anew
  fluid.step(static_cast<std::uint32_t>(.5 / params.time_step)).value();

  const pbf_in_out in_out = fluid.in_out().value();
  const std::array<double, 3> corner = {.1, .1, .1};
  std::array<double, 1> level, density;
  pbf::samples into;
  into.densities = density;
  fluid.get_wall_loads(walls).value();
  fluid.get_levels(corner, level).value();
  fluid.sample(corner, into).value();
  const pbf_collider_load &floor = walls[PBF_WALL_Y_MIN];
  std::printf("%u came, %u went, %.2f m high, %.0f N on the floor, density %.1f\n",
              static_cast<unsigned>(in_out.emitted), static_cast<unsigned>(in_out.drained),
              level[0], -1000 * floor.impulse_sum[1] / floor.time_sum,
              density[0]);  // water has 1000 kg/m³
}

int main() {
  try {
    pour();
  } catch (const std::exception &failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
  }
  return 0;
}
/* end */
