/* pbf.hpp as programs use it; built with exceptions and without. Of the backend PBF_TEST_BACKEND.
 */
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <type_traits>

extern "C" {
#include <cmocka.h>
}

#include <pbf/pbf.hpp>

static_assert(std::is_nothrow_move_constructible_v<pbf::solver>);
static_assert(!std::is_copy_constructible_v<pbf::solver>);
static_assert(!std::is_copy_constructible_v<pbf::view>);
static_assert(!std::is_copy_constructible_v<pbf::snapshot>);
static_assert(std::is_convertible_v<std::vector<float> &, pbf::span<const float>>);
static_assert(!std::is_convertible_v<std::vector<float> &, pbf::span<const double>>);
static_assert(!std::is_convertible_v<const std::vector<float> &, pbf::span<float>>);

/* malloc, counted. */
class counted final : public pbf::allocator {
 public:
  long live = 0;
  long until_none = -1; /* allocations until there is no memory; -1: never */
  void *allocate(std::uint64_t size, std::uint64_t alignment) noexcept override {
    if (until_none == 0) return nullptr;
    if (until_none > 0) --until_none;
    ++live;
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  }
  void release(void *memory, std::uint64_t, std::uint64_t) noexcept override {
    --live;
    std::free(memory);
  }
};
static counted memory;

static pbf::desc test_desc() {
  pbf::desc desc;
  desc.backend = std::getenv("PBF_TEST_BACKEND");
  desc.strict = 1;
  desc.capacity = 100;
  desc.threads = 2;
  desc.memory = &memory;
  return desc;
}

template <class T>
static T given(pbf::result<T> result) {
  if (!result) fail_msg("%s", result.message());
  return std::move(*result);
}

static void done(const pbf::result<void> &result) {
  if (!result) fail_msg("%s", result.message());
}

static void assert_refused(const pbf::detail::outcome &result, pbf_status status,
                           const char *words) {
  assert_false(result.ok());
  assert_int_equal(result.status(), status);
  if (!std::strstr(result.message(), words))
    fail_msg("\"%s\" lacks \"%s\"", result.message(), words);
}

static pbf::solver filled() {
  auto fluid = given(pbf::solver::create(test_desc()));
  const std::vector<float> x = {.5f, .5f, .5f, .6f, .5f, .5f};
  assert_int_equal(given(fluid.add_particles(x)), 0);
  return fluid;
}

static int nothing_live(void **) {
  assert_int_equal(memory.live, 0);
  return 0;
}

static void defaults_are_those_of_c(void **) {
  pbf_params c;
  assert_int_equal(pbf_params_init(&c, sizeof c), PBF_OK);
  const pbf::params cpp;
  assert_memory_equal(&c, static_cast<const pbf_params *>(&cpp), sizeof c);
  const pbf::collider ball = pbf::collider::sphere(1, 2, 3, .25);
  assert_int_equal(ball.shape, PBF_COLLIDER_SPHERE);
  assert_true(ball.position[2] == 3 && ball.radius == .25 && ball.orientation[3] == 1);
}

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

static void queries_answer(void **) {
  auto fluid = filled();
  std::array<double, 3> point = {.55, .5, .5}, down = {0, -1, 0}, normal;
  std::array<double, 1> density, distance, level;
  std::array<std::uint32_t, 4> ids;
  pbf_samples wanted = {};
  wanted.count = 1;
  wanted.points = point.data();
  wanted.densities = density.data();
  done(fluid.sample(wanted));
  assert_true(density[0] > 0.1 && density[0] < 0.5);
  pbf::volume ball(PBF_VOLUME_SPHERE);
  ball.position[0] = .5, ball.position[1] = .5, ball.position[2] = .5;
  ball.radius = .05;
  assert_int_equal(given(fluid.find_in(ball, ids)), 1);
  assert_int_equal(ids[0], 0);
  assert_true(given(fluid.measure(ball)).volume > 5e-4);
  done(fluid.cast_rays(point, down, 1, distance, normal));
  done(fluid.get_levels(point, level));
  assert_true(distance[0] > 1 && level[0] != level[0]);
  assert_int_equal(fluid.cast_rays(point, down, 1, normal).status(), PBF_ERROR_INVALID_ARGUMENT);
  done(fluid.end_queries());
}

static void particles_come_and_go(void **) {
  auto fluid = filled();
  std::vector<pbf::emitter> taps(1, pbf::emitter(PBF_EMITTER_DISC));
  std::vector<pbf::volume> drains(1, pbf::volume(PBF_VOLUME_BOX));
  taps[0].position[0] = taps[0].position[1] = taps[0].position[2] = .5;
  taps[0].radius = .1;
  drains[0].half_extents[1] = .1;
  done(fluid.set_emitters(taps));
  done(fluid.set_drains(drains));
  done(fluid.step(12));
  assert_int_equal(given(fluid.in_out()).emitters, 1);
  assert_true(given(fluid.in_out()).emitted > 10);
}

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

static void struct_sizes_are_set(void **) {
  pbf::params params;
  params.struct_size = 1u << 30;
  pbf::desc desc = test_desc();
  desc.struct_size = 1u << 30;
  auto fluid = given(pbf::solver::create(desc, params));
  done(fluid.set_params(params));
}

static void moved_from_is_refused(void **) {
  auto fluid = filled();
  pbf::solver taken = std::move(fluid);
  assert_refused(fluid.step(), PBF_ERROR_INVALID_ARGUMENT, "solver");  // NOLINT
  assert_refused(fluid.add_particles(std::vector<float>(3)), PBF_ERROR_INVALID_ARGUMENT, "solver");
  assert_refused(fluid.reader().cancel(), PBF_ERROR_INVALID_ARGUMENT, "solver");
  assert_false(fluid.take_log_exception() != nullptr);
  done(taken.step());
  fluid = std::move(taken);
  done(fluid.step());
}

static void views_block_steps_and_outlive_solvers(void **) {
  std::vector<pbf::view> kept;
  {
    auto fluid = filled();
    {
      auto view = given(fluid.map(PBF_FIELD_POSITION));
      assert_int_equal(view.size(), 2);
      assert_refused(fluid.step(), PBF_ERROR_STATE, "map");
    }
    done(fluid.step(0));
    kept.push_back(given(fluid.map(PBF_FIELD_POSITION)));
  }
  if (kept[0].on_host()) {
    const bool first = kept[0].ids()[0] == 0;
    assert_true(kept[0].at<float>(first ? 0 : 1, 0) == .5f);
    assert_true(kept[0].at<float>(first ? 1 : 0, 0) == .6f);
  }
  assert_true(memory.live > 0);
  kept.clear();
}

static void snapshots_outlive_solvers(void **) {
  std::vector<pbf::snapshot> kept;
  {
    auto fluid = filled();
    done(fluid.set_snapshots(2));
    kept.push_back(given(fluid.acquire_snapshot()));
  }
  assert_int_equal(kept[0].size(), 2);
  assert_int_equal(kept[0].positions<float>().size(), 6);
  assert_true(kept[0].positions<float>()[3] == .6f);
  assert_true(kept[0].positions<double>().empty());
}

static void readers_outlive_solvers(void **) {
  std::vector<pbf::reader> kept;
  pbf_solver *handle = nullptr;
  {
    auto fluid = filled();
    handle = fluid.handle();
    kept.push_back(fluid.reader());
    done(fluid.begin_step(1000000000));
    assert_refused(fluid.count(), PBF_ERROR_BUSY, "");
  } /* cancelled and waited for, though the reader still has the solver */
  std::uint32_t count = 0;
  assert_int_equal(pbf_get_count(handle, &count), PBF_OK);
  done(kept[0].cancel());
  assert_refused(kept[0].acquire_snapshot(), PBF_ERROR_STATE, "snapshot");
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

static void memory_that_is_short_is_an_error(void **) {
  for (long n = 0; n < 4; ++n) {
    memory.until_none = n;
    assert_refused(pbf::solver::create(test_desc()), PBF_ERROR_OUT_OF_MEMORY, "");
    memory.until_none = -1;
    assert_int_equal(memory.live, 0);
  }
}

static std::string logged;

/* The log is told of its time step. */
static pbf::solver falling_too_fast(const pbf::desc &desc) {
  pbf::params params;
  params.time_step = 0.5;
  auto fluid = given(pbf::solver::create(desc, params));
  given(fluid.add_particles(std::vector<float>{.5f, .5f, .5f}));
  return fluid;
}

static void logs_are_heard(void **) {
  logged.clear();
  pbf::desc desc = test_desc();
  desc.log_to = [count = 0](int, const char *sentence) mutable {
    logged = std::to_string(++count) + sentence;
  };
  auto fluid = falling_too_fast(desc);
  done(fluid.step());
  assert_non_null(std::strstr(logged.c_str(), "time_step"));
  assert_int_equal(logged[0], '1');
  assert_false(fluid.take_log_exception() != nullptr);
}

#if PBF_HAS_EXCEPTIONS
static void log_exceptions_stay_out_of_the_library(void **) {
  pbf::desc desc = test_desc();
  desc.log_to = [](int, const char *sentence) { throw std::string(sentence); };
  auto fluid = falling_too_fast(desc);
  done(fluid.begin_step());
  done(fluid.end_step());
  const std::exception_ptr thrown = fluid.take_log_exception();
  assert_true(thrown != nullptr);
  try {
    std::rethrow_exception(thrown);
  } catch (const std::string &sentence) {
    assert_non_null(std::strstr(sentence.c_str(), "time_step"));
  }
  assert_false(fluid.take_log_exception() != nullptr);
  done(fluid.step()); /* the solver goes on, as one does not that an exception has left */
}

static void values_throw(void **) {
  auto fluid = pbf::solver::create(test_desc()).value();
  fluid.step().value();
  try {
    given(fluid.get_params());
    pbf::params params;
    params.smoothing_radius = -2;
    fluid.set_params(params).value();
    fail_msg("nothing was thrown");
  } catch (const pbf::exception &thrown) {
    assert_int_equal(thrown.status(), PBF_ERROR_INVALID_ARGUMENT);
    assert_non_null(std::strstr(thrown.what(), "smoothing_radius"));
  }
}
#endif

/* A solver that nothing destroys before the process ends. */
static std::optional<pbf::solver> at_exit;

int main() {
  const CMUnitTest tests[] = {
    cmocka_unit_test(defaults_are_those_of_c),
    cmocka_unit_test_teardown(a_particle_falls, nothing_live),
    cmocka_unit_test_teardown(loads_are_the_momentum_that_is_gone, nothing_live),
    cmocka_unit_test_teardown(accelerations_hold_up, nothing_live),
    cmocka_unit_test_teardown(errors_keep_their_sentences, nothing_live),
    cmocka_unit_test_teardown(arrays_of_another_kind_are_refused, nothing_live),
    cmocka_unit_test_teardown(queries_answer, nothing_live),
    cmocka_unit_test_teardown(particles_come_and_go, nothing_live),
    cmocka_unit_test_teardown(spray_flies, nothing_live),
    cmocka_unit_test_teardown(struct_sizes_are_set, nothing_live),
    cmocka_unit_test_teardown(moved_from_is_refused, nothing_live),
    cmocka_unit_test_teardown(views_block_steps_and_outlive_solvers, nothing_live),
    cmocka_unit_test_teardown(snapshots_outlive_solvers, nothing_live),
    cmocka_unit_test_teardown(readers_outlive_solvers, nothing_live),
    cmocka_unit_test_teardown(states_go_on_alike, nothing_live),
    cmocka_unit_test_teardown(memory_that_is_short_is_an_error, nothing_live),
    cmocka_unit_test_teardown(logs_are_heard, nothing_live),
#if PBF_HAS_EXCEPTIONS
    cmocka_unit_test_teardown(log_exceptions_stay_out_of_the_library, nothing_live),
    cmocka_unit_test_teardown(values_throw, nothing_live),
#endif
  };
  const int failed = cmocka_run_group_tests(tests, nullptr, nullptr);
  if (failed) return failed;
  at_exit = filled();
  return at_exit->begin_step(1000000000).status();
}
