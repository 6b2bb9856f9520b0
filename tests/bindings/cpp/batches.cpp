/* Many worlds in one call. */
#include "support.h"

static void worlds_fall_as_they_would_alone(void **) {
  pbf::params params;
  auto batch = given(pbf::batch::create(test_desc(), params, 3));
  assert_int_equal(given(batch.info()).worlds, 3);
  const std::array<std::uint32_t, 3> counts = {1, 0, 2};
  const std::vector<float> x(9, .5f);
  done(batch.add_particles(counts, x, std::vector<float>(9)));
  done(batch.set_start());
  const std::array<double, 9> gravity = {0, -1, 0, 0, -2, 0, 3, 0, 0};
  const std::array<std::uint8_t, 3> outer = {1, 0, 1}, first = {1, 0, 0};
  done(batch.set_gravity(gravity));
  done(batch.step(12, outer));
  std::vector<double> v(18, 9);
  done(batch.read(PBF_FIELD_VELOCITY, v));
  const double t = 12 * params.time_step;
  assert_near(v[1], -t, 1e-6);
  for (std::size_t i = 3; i < 12; ++i) assert_true(v[i] == 0); /* rows that worlds have not */
  assert_near(v[12], 3 * t, 1e-6);
  std::array<std::uint32_t, 3> found;
  done(batch.get_counts(found));
  assert_true(found == counts);

  auto alone = given(pbf::solver::create(test_desc(), params));
  given(alone.add_particles(pbf::span<const float>(x.data(), 3)));
  params.gravity[1] = -1;
  done(alone.set_params(params));
  done(alone.step(12));
  auto world = given(batch.world(0));
  assert_true(given(world.hash()) == given(alone.hash()));
  done(batch.reset(first));
  assert_true(given(world.positions<float>())[1] == .5f);
  assert_near(given(world.get_params()).gravity[1], -9.81, 1e-12);
  const std::array<pbf::collider, 1> ball = {pbf::collider::sphere(.2, .2, .2, .1)};
  const std::array<double, 9> targets = {.2, .3, .2, .2, .3, .2, .2, .3, .2};
  done(batch.set_colliders(ball));
  done(batch.move_colliders(targets, .1));
  done(batch.step(12));
  assert_near(given(given(batch.world(1)).get_collider(0)).position[1], .3, 1e-9);
}

static void a_world_that_fails_says_so(void **) {
  const pbf_status wrong = PBF_ERROR_INVALID_ARGUMENT;
  auto batch = given(pbf::batch::create(test_desc(), pbf::params(), 2));
  const std::array<std::uint32_t, 2> counts = {0, 1}, both = {1, 1};
  const std::vector<float> x(3, .5f);
  done(batch.add_particles(counts, x));
  {
    auto world = given(batch.world(1));
    const auto view = given(world.map(PBF_FIELD_POSITION));
    assert_refused(batch.step(), PBF_ERROR_STATE, "world 1: ");
    const auto results = given(batch.results());
    assert_true(results[0].ok());
    assert_refused(results[1], PBF_ERROR_STATE, "map");
  }
  const std::array<std::uint8_t, 1> mask = {1};
  std::vector<float> five(5);
  assert_refused(batch.step(1, mask), wrong, "the mask has 1");
  assert_refused(batch.add_particles(both, x), wrong, "positions has 3");
  assert_refused(batch.add_particles(both, std::vector<double>(6)), wrong, "precision");
  assert_refused(batch.set_gravity(std::vector<double>(3)), wrong, "gravity has 3");
  assert_refused(batch.read(PBF_FIELD_POSITION, five), wrong, "the array has 5");
  assert_refused(batch.world(2), PBF_ERROR_NOT_FOUND, "world is 2");
  assert_refused(pbf::batch::create(test_desc(), pbf::params(), 0), wrong, "worlds is 0");
  pbf::batch taken = std::move(batch);
  assert_refused(batch.step(), wrong, "batch is null");  // NOLINT
  done(taken.step());
}

static void worlds_and_batches_go_in_any_order(void **) {
  std::optional<pbf::solver> kept;
  {
    auto batch = given(pbf::batch::create(test_desc(), pbf::params(), 2));
    const std::array<std::uint32_t, 2> counts = {1, 1};
    done(batch.add_particles(counts, std::vector<float>(6, .5f)));
    done(given(batch.world(0)).begin_step(1000000000)); /* which end with this */
    done(batch.step());
    kept = given(batch.world(1));
  }
  done(kept->step());
  assert_int_equal(given(kept->info()).step, 2);
}

int batches() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(worlds_fall_as_they_would_alone, nothing_live),
      cmocka_unit_test_teardown(a_world_that_fails_says_so, nothing_live),
      cmocka_unit_test_teardown(worlds_and_batches_go_in_any_order, nothing_live),
  };
  return cmocka_run_group_tests_name("batches", tests, nullptr, nullptr);
}
