/* Questions by place. */
#include "support.h"

static void queries_know_water_at_rest(void **) {
  auto fluid = block();
  const std::array<double, 6> points = {.25, .25, .25, .9, .9, .9}, down = {0, -1, 0, 0, -1, 0};
  std::array<double, 2> rho, p, distances, levels;
  std::array<double, 6> v, normals;
  std::array<std::uint8_t, 2> wet;
  std::array<double, 3> along;
  done(fluid.sample(points, {rho, v, p, wet}));
  assert_near(rho[0], 1, .01);
  assert_true(rho[1] == 0 && v[5] == 0 && wet[0] == 1 && wet[1] == 0);
  const pbf_sample_grid grid = {0, {1, 1, 3}, {.25, .25, .25}, {0, 0, .3}};
  pbf::samples densities;
  densities.densities = along;
  done(fluid.sample_on_grid(grid, densities));
  assert_near(along[0], 1, .01);
  assert_true(along[1] < .5 && along[2] == 0); /* above the surface */
  done(fluid.get_levels(points, levels));
  assert_near(levels[0], .5, .01);
  assert_true(levels[1] != levels[1]);
  const std::array<double, 6> above = {.25, .9, .25, .9, .9, .9};
  done(fluid.cast_rays(above, down, INFINITY, distances, normals));
  assert_near(distances[0], .4, .01);
  assert_near(normals[1], 1, .01);
  assert_true(std::isinf(distances[1]));
  const pbf::volume corner = pbf::volume::box(d, d, d, d, d, d);
  pbf::volume half = pbf::volume::box(.25, .5, .25, .1, .1, .1);
  const pbf::volume dry = pbf::volume::sphere(.8, .8, .8, .1);
  std::array<std::uint32_t, 9> ids;
  assert_int_equal(given(fluid.find_in(corner, ids)), 8);
  assert_int_equal(ids[7], 111);
  const std::array<pbf::volume, 2> volumes = {half, dry};
  std::array<pbf_volume_flow, 2> flows;
  done(fluid.measure(volumes, flows));
  assert_near(flows[0].volume, .008, 1e-12);
  assert_near(flows[0].fraction, .5, .05);
  assert_true(flows[1].fraction == 0);
  half.position[1] = .25;
  assert_near(given(fluid.measure(half)).fraction, 1, 1e-9);
  done(fluid.end_queries());
}

static void queries_want_arrays_that_fit(void **) {
  auto fluid = block();
  const pbf_status wrong = PBF_ERROR_INVALID_ARGUMENT;
  std::array<double, 6> six = {};
  std::array<double, 3> three = {};
  std::array<double, 1> one = {};
  std::array<std::uint8_t, 1> byte = {};
  assert_refused(fluid.sample(six, {one, {}, {}, {}}), wrong, "densities has 1");
  assert_refused(fluid.sample(six, {{}, three, {}, {}}), wrong, "velocities has 3");
  assert_refused(fluid.sample(six, {{}, {}, one, {}}), wrong, "pressures has 1");
  assert_refused(fluid.sample(six, {{}, {}, {}, byte}), wrong, "wet has 1");
  assert_refused(fluid.sample(one, {}), wrong, "1 numbers");
  const pbf_sample_grid grid = {0, {1u << 31, 1u << 31, 4}, {0, 0, 0}, {1, 1, 1}};
  assert_refused(fluid.sample_on_grid(grid, {one, {}, {}, {}}), wrong, "32 bits");
  assert_refused(fluid.cast_rays(three, one, 1, one), wrong, "arrays of points");
  assert_refused(fluid.measure({}, pbf::span<pbf_volume_flow>(nullptr, 1)), wrong, "flows has 1");
  pbf::solver taken = std::move(fluid);
  assert_refused(fluid.sample(three, {}), wrong, "moved from");  // NOLINT
}

int queries() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(queries_know_water_at_rest, nothing_live),
      cmocka_unit_test_teardown(queries_want_arrays_that_fit, nothing_live),
  };
  return cmocka_run_group_tests_name("queries", tests, nullptr, nullptr);
}
