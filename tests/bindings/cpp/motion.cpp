/* Particles that move, and what moves them. */
#include "support.h"

static void a_particle_falls(void **) {
  pbf::params params;
  params.time_step = 1. / 128;
  pbf::desc desc = test_desc();
  auto fluid = given(pbf::solver::create(desc, params));
  const std::array<float, 3> x = {.5f, .5f, .5f};
  given(fluid.add_particles(x));
  done(fluid.step(16));
  /* n steps of symplectic Euler: g dt^2 n (n + 1) / 2 */
  const auto now = given(fluid.positions<float>());
  const double fallen = params.gravity[1] / (128. * 128.) * 16 * 17 / 2;
  assert_int_equal(now.size(), 3);
  assert_true(std::abs(now[1] - (.5 + fallen)) < 1e-6);
  const auto v = given(fluid.velocities<float>());
  assert_true(std::abs(v[1] - params.gravity[1] / 8) < 1e-5);
  assert_int_equal(given(fluid.info()).step, 16);
  assert_int_equal(given(fluid.stats()).count, 1);
  assert_true(given(fluid.get_params()).time_step == 1. / 128);
  assert_int_equal(given(fluid.remove_in_box({0, 0, 0}, {1, 1, 1})), 1);
  assert_int_equal(given(fluid.count()), 0);
}

/* What walls and colliders have had is the momentum that gravity gave and the fluid has not. */
static void loads_are_the_momentum_that_is_gone(void **) {
  pbf::params params;
  params.loads = 1;
  auto fluid = given(pbf::solver::create(test_desc(), params));
  const std::vector<float> x = {.5f, .06f, .5f, .56f, .06f, .5f};
  given(fluid.add_particles(x));
  const std::array<pbf::collider, 1> ball = {pbf::collider::sphere(.9, .9, .9, .05)};
  done(fluid.set_colliders(ball));
  done(fluid.step(16));
  std::array<pbf_collider_load, 1> far;
  std::array<pbf_collider_load, 6> walls;
  done(fluid.get_collider_loads(far));
  done(fluid.get_wall_loads(walls));
  const auto v = given(fluid.velocities<float>());
  const double volume = std::pow(params.smoothing_radius / 2, 3), time = 16 * params.time_step;
  const double gone = volume * (2 * params.gravity[1] * time - v[1] - v[4]);
  assert_true(gone < -volume * .5);
  assert_true(std::abs(walls[PBF_WALL_Y_MIN].impulse_sum[1] / gone - 1) < 1e-5);
  assert_true(std::abs(walls[PBF_WALL_Y_MIN].time_sum - time) < 1e-12);
  assert_true(far[0].contacts == 0 && far[0].impulse_sum[1] == 0);
  assert_refused(fluid.get_wall_loads({walls.data(), 5}), PBF_ERROR_INVALID_ARGUMENT, "5");
}

static void accelerations_hold_up(void **) {
  auto fluid = filled();
  const std::vector<float> up = {0, 9.81f, 0};
  done(fluid.set_accelerations(up, 1));
  done(fluid.step(12));
  auto v = given(fluid.velocities<float>());
  assert_true(std::abs(v[1] + .981f) < 1e-4f && std::abs(v[4]) < 1e-6f);
  done(fluid.clear_accelerations());
  done(fluid.step(12));
  v = given(fluid.velocities<float>());
  assert_true(std::abs(v[4] + .981f) < 1e-4f);
}

static void states_go_on_alike(void **) {
  auto one = filled(), other = given(pbf::solver::create(test_desc()));
  done(one.step(5));
  const auto state = given(one.save());
  done(other.load(state));
  done(one.step(5));
  done(other.step(5));
  assert_true(given(one.hash()) == given(other.hash()));
  auto damaged = state;
  damaged[damaged.size() / 2] ^= 1u;
  assert_refused(other.load(damaged), PBF_ERROR_DATA, "");
}

int motion() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_particle_falls, nothing_live),
      cmocka_unit_test_teardown(loads_are_the_momentum_that_is_gone, nothing_live),
      cmocka_unit_test_teardown(accelerations_hold_up, nothing_live),
      cmocka_unit_test_teardown(states_go_on_alike, nothing_live),
  };
  return cmocka_run_group_tests_name("motion", tests, nullptr, nullptr);
}
