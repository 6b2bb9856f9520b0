/* Parameters, colliders and errors: what they hold, and what is refused. */
#include "support.h"

static_assert(std::is_nothrow_move_constructible_v<pbf::solver>);
static_assert(!std::is_copy_constructible_v<pbf::solver>);
static_assert(!std::is_copy_constructible_v<pbf::view>);
static_assert(!std::is_copy_constructible_v<pbf::snapshot>);
static_assert(std::is_convertible_v<std::vector<float> &, pbf::span<const float>>);
static_assert(!std::is_convertible_v<std::vector<float> &, pbf::span<const double>>);
static_assert(!std::is_convertible_v<const std::vector<float> &, pbf::span<float>>);

static void defaults_are_those_of_c(void **) {
  pbf_params c;
  assert_int_equal(pbf_params_init(&c, sizeof c), PBF_OK);
  const pbf::params cpp;
  assert_memory_equal(&c, static_cast<const pbf_params *>(&cpp), sizeof c);
  const pbf::collider ball = pbf::collider::sphere(1, 2, 3, .25);
  assert_int_equal(ball.shape, PBF_COLLIDER_SPHERE);
  assert_true(ball.position[2] == 3 && ball.radius == .25 && ball.orientation[3] == 1);
}

static void errors_keep_their_sentences(void **) {
  pbf::params params;
  params.time_step = -1;
  const auto first = pbf::solver::create(test_desc(), params);
  assert_refused(first, PBF_ERROR_INVALID_ARGUMENT, "time_step");
  pbf::desc desc = test_desc();
  desc.dimension = 4;
  const auto second = pbf::solver::create(desc);
  assert_refused(second, PBF_ERROR_INVALID_ARGUMENT, "dimension");
  assert_refused(first, PBF_ERROR_INVALID_ARGUMENT, "time_step");
  const pbf::error copied = first.failure();
  assert_string_equal(copied.message(), first.message());
  auto fluid = filled();
  assert_refused(fluid.get_collider(7), PBF_ERROR_NOT_FOUND, "7");
}

static void arrays_of_another_kind_are_refused(void **) {
  auto fluid = filled();
  const std::vector<double> doubles(3, .5);
  const std::vector<float> odd(4, .5f), three(3, .5f), six(6, .1f);
  std::vector<double> out(6);
  assert_refused(fluid.add_particles(doubles), PBF_ERROR_INVALID_ARGUMENT, "double");
  assert_refused(fluid.add_particles(odd), PBF_ERROR_INVALID_ARGUMENT, "4 numbers");
  assert_refused(fluid.add_particles(three, six), PBF_ERROR_INVALID_ARGUMENT, "velocities");
  assert_refused(fluid.get_positions(out), PBF_ERROR_INVALID_ARGUMENT, "double");
  std::vector<float> more(9);
  assert_refused(fluid.get_positions(more), PBF_ERROR_INVALID_ARGUMENT, "3");
  assert_int_equal(given(fluid.count()), 2);
}

static void struct_sizes_are_set(void **) {
  pbf::params params;
  params.struct_size = 1u << 30;
  pbf::desc desc = test_desc();
  desc.struct_size = 1u << 30;
  auto fluid = given(pbf::solver::create(desc, params));
  done(fluid.set_params(params));
}

int values() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(defaults_are_those_of_c, nothing_live),
      cmocka_unit_test_teardown(errors_keep_their_sentences, nothing_live),
      cmocka_unit_test_teardown(arrays_of_another_kind_are_refused, nothing_live),
      cmocka_unit_test_teardown(struct_sizes_are_set, nothing_live),
  };
  return cmocka_run_group_tests_name("values", tests, nullptr, nullptr);
}
