/* Spray, foam and bubbles. */
#include "support.h"

static void spray_flies(void **) {
  auto fluid = filled();
  pbf_diffuse_desc wanted = given(fluid.default_diffuse());
  const float x[3] = {.5f, .5f, .5f}, life[1] = {1};
  assert_int_equal(fluid.add_diffuse(x, {}, life).status(), PBF_ERROR_STATE);
  wanted.capacity = 7;
  wanted.foam_neighbors = wanted.bubble_neighbors = 1000;
  wanted.struct_size = 0;
  done(fluid.set_diffuse(wanted));
  assert_int_equal(given(fluid.get_diffuse()).capacity, 7);
  done(fluid.add_diffuse(x, {}, life));
  assert_int_equal(fluid.add_diffuse(x, life, life).status(), PBF_ERROR_INVALID_ARGUMENT);
  const double way[3] = {0, .25, 0};
  done(fluid.shift_diffuse(way));
  done(fluid.step(1));
  assert_int_equal(given(fluid.diffuse_info()).spray, 1);
  double at[3];
  pbf_diffuse_read read = {};
  read.count = 1;
  read.element_type = PBF_TYPE_FLOAT64;
  read.positions = at;
  done(fluid.read_diffuse(read));
  const pbf::params params = given(fluid.get_params());
  const double fall = .5 * params.gravity[1] * params.time_step * params.time_step;
  assert_true(at[0] == .5 && at[1] < .75 && at[1] - .75 - fall < 1e-12 &&
              at[1] - .75 - fall > -1e-12);
  done(fluid.end_diffuse());
  assert_int_equal(given(fluid.diffuse_info()).capacity, 0);
}

int diffuse() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(spray_flies, nothing_live),
  };
  return cmocka_run_group_tests_name("diffuse", tests, nullptr, nullptr);
}
