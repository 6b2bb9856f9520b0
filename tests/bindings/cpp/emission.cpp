/* Emitters, drains and reservoirs. */
#include "support.h"

static void as_much_comes_as_the_rate_says(void **) {
  pbf::params params;
  params.time_step = 1. / 128;
  params.gravity[1] = 0;
  pbf::desc desc = test_desc();
  desc.capacity = 1000;
  auto fluid = given(pbf::solver::create(desc, params));
  std::array<pbf::emitter, 1> taps = {pbf::emitter::disc(.5, .9, .5, .15)};
  std::array<pbf::volume, 1> drains = {pbf::volume::box(.5, .1, .5, .5, .1, .5)};
  taps[0].rate = .0371;
  done(fluid.set_emitters(taps));
  done(fluid.set_drains(drains));
  done(fluid.step(256));
  const pbf_in_out after = given(fluid.in_out());
  assert_near(static_cast<double>(after.emitted), .0371 * 2 / (d * d * d), 1);
  assert_true(after.drained > 0 && after.emitters == 1 && after.drains == 1);
  assert_int_equal(after.emitted - after.drained, given(fluid.count()));
  assert_near(given(fluid.get_emitter(0)).radius, .15, 0);
  assert_near(given(fluid.get_drain(0)).half_extents[1], .1, 0);
  std::array<pbf::reservoir, 1> pools = {pbf::reservoir::box(.5, .5, .5, .5, .5, .5, .1)};
  done(fluid.set_reservoirs(pools));
  done(fluid.step(1));
  assert_int_equal(given(fluid.reservoir_count()), 1);
  assert_true(given(fluid.get_reservoir(0)).added > 0);
  done(fluid.set_reservoirs({}));
  taps[0] = pbf::emitter::rectangle(.5, .7, .5, .1, .125);
  done(fluid.set_emitters(taps));
  assert_near(given(fluid.get_emitter(0)).half_height, .125, 0);
  taps[0].rate = 100;
  assert_refused(fluid.set_emitters(taps), PBF_ERROR_INVALID_ARGUMENT, "emitters[0].rate is 100");
}

int emission() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(as_much_comes_as_the_rate_says, nothing_live),
  };
  return cmocka_run_group_tests_name("emission", tests, nullptr, nullptr);
}
