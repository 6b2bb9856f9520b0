/* Several fluids. */
#include "support.h"

/* Oil that begins below water: it rises, and the floor has the weight of both, beside what the full
 * tank's ceiling pushes back. */
static void oil_floats_and_the_floor_bears_both(void **) {
  pbf::params params;
  params.domain_max[0] = .5;
  params.loads = 1;
  pbf::desc desc = test_desc();
  desc.dimension = 2;
  desc.precision = PBF_FLOAT64;
  desc.capacity = 200;
  auto fluid = given(pbf::solver::create(desc, params));
  std::vector<double> x;
  for (int i = 0; i < 200; ++i) x.insert(x.end(), {d * (i % 10 + .5), d * (i / 10 + .5)});
  given(fluid.add_particles(x));
  std::vector<pbf::phase> phases = {pbf::phase(1), pbf::phase(.5)};
  done(fluid.set_phases(phases));
  done(fluid.set_particle_phases(std::vector<std::uint32_t>(100, 1)));
  assert_int_equal(given(fluid.phase_count()), 2);
  assert_near(given(fluid.get_phase(1)).rest_density, .5, 0);
  std::array<pbf_collider_load, 4> walls;
  done(fluid.step(static_cast<std::uint32_t>(10 / params.time_step)));
  done(fluid.get_wall_loads(walls));
  done(fluid.step(static_cast<std::uint32_t>(1 / params.time_step)));
  done(fluid.get_wall_loads(walls));
  done(fluid.get_positions(x));
  std::vector<std::uint32_t> of(200);
  done(fluid.get_particle_phases(of));
  double height[2] = {0, 0};
  for (std::size_t i = 0; i < 200; ++i) height[of[i]] += x[2 * i + 1] / 100;
  assert_true(height[1] > height[0] + .3);
  const double impulse =
      walls[PBF_WALL_Y_MIN].impulse_sum[1] + walls[PBF_WALL_Y_MAX].impulse_sum[1];
  const double weight = d * d * (100 + .5 * 100) * params.gravity[1];
  assert_near(impulse / walls[0].time_sum / weight, 1, .005);
  const std::array<std::uint32_t, 1> third = {2};
  const pbf_status wrong = PBF_ERROR_INVALID_ARGUMENT;
  assert_refused(fluid.set_particle_phases(third), wrong, "phases[0] is 2");
  phases[0].rest_density = -1;
  assert_refused(fluid.set_phases(phases), wrong, "phases[0].rest_density is -1");
}

int phases() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(oil_floats_and_the_floor_bears_both, nothing_live),
  };
  return cmocka_run_group_tests_name("phases", tests, nullptr, nullptr);
}
