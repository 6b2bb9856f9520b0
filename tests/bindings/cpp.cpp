/* pbf.hpp as programs use it; built with exceptions and without. Of the backend PBF_TEST_BACKEND.
 */
#include <algorithm>
#include <array>
#include <atomic>
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

/* malloc, counted; of a batch by several threads at once. */
class counted final : public pbf::allocator {
 public:
  std::atomic<long> live{0};
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

static void assert_near(double got, double wanted, double bound) {
  if (!(std::abs(got - wanted) <= bound)) fail_msg("%.9g is not %.9g", got, wanted);
}

static const double d = 0.05; /* the spacing by default */

/* 10 by 10 by 10 particles, at rest, in a corner of the tank. */
static pbf::solver block() {
  pbf::desc desc = test_desc();
  desc.capacity = 1000;
  auto fluid = given(pbf::solver::create(desc));
  std::vector<float> x;
  for (int i = 0; i < 1000; ++i)
    for (const int n : {i % 10, i / 10 % 10, i / 100})
      x.push_back(static_cast<float>((n + .5) * d));
  given(fluid.add_particles(x));
  return fluid;
}

/* Half extents 0.2, 0.1 and 0.3, by its corners. */
static pbf::shape brick() {
  std::vector<double> corners;
  for (const double x : {-.2, .2})
    for (const double y : {-.1, .1})
      for (const double z : {-.3, .3}) corners.insert(corners.end(), {x, y, z});
  return given(pbf::shape::from_points(3, corners, .025));
}

static void shapes_are_as_far_as_their_faces(void **) {
  const pbf::shape solid = brick();
  double normal[3] = {0, 0, 0};
  assert_near(given(solid.info()).volume, .2 * .1 * .3 * 8, 1e-3);
  assert_near(given(solid.distance({.24, 0, 0}, &normal)), .04, 1e-3);
  assert_near(normal[0], 1, 1e-3);
  assert_near(given(solid.distance({0, .06, 0})), -.04, 1e-3);
  const std::array<double, 8> square = {0, 0, 1, 0, 1, 1, 0, 1};
  const std::array<std::uint32_t, 8> sides = {0, 1, 1, 2, 2, 3, 3, 0};
  const pbf::shape mesh = given(pbf::shape::from_mesh(2, square, sides, .05));
  assert_near(given(mesh.info()).volume, 1, 5e-3);
  assert_near(given(mesh.distance({1.08, .5, 0})), .08, 1e-3);
  const pbf::shape shell =
      given(pbf::shape::from_mesh(2, {square.data(), 4}, {sides.data(), 2}, .05, .2));
  assert_near(given(shell.distance({.5, .18, 0})), .08, 1e-3);
  const std::array<std::uint32_t, 1> three = {3};
  const std::array<double, 3> heights = {.5, .5, .5};
  const pbf::shape hill = given(pbf::shape::from_heights(three, heights, .5, -.5, .05));
  assert_near(given(hill.distance({.5, .58, 0})), .08, 1e-3);
  std::vector<float> values; /* a disc of radius 0.3 */
  for (int i = 0; i < 441; ++i)
    values.push_back(static_cast<float>(.05 * std::hypot(i % 21 - 10, i / 21 - 10) - .3));
  const std::array<std::uint32_t, 2> nodes = {21, 21};
  const std::array<double, 2> origin = {-.5, -.5};
  const pbf::shape disc = given(pbf::shape::from_grid(nodes, origin, .05, values));
  assert_near(given(disc.distance({.4, 0, 0})), .1, 2e-3);
}

static void shapes_come_back_from_bytes(void **) {
  const pbf::shape solid = brick();
  const std::vector<unsigned char> saved = given(solid.save());
  const pbf::shape again = given(pbf::shape::load(saved));
  const pbf_shape_info info = given(solid.info());
  assert_true(given(again.info()).hash == info.hash);
  std::vector<float> values(std::size_t{info.nodes[0]} * info.nodes[1] * info.nodes[2]);
  done(again.values(values));
  assert_near(values[0], std::hypot(info.origin[0] + .2, info.origin[1] + .1, info.origin[2] + .3),
              1e-3);
  values.pop_back();
  assert_refused(again.values(values), PBF_ERROR_INVALID_ARGUMENT, "count is");
  assert_refused(pbf::shape::load({saved.data(), 71}), PBF_ERROR_DATA, "cut short");
}

/* A capsule along x, as collider and as volume: 0.5 from end to end. */
static void capsules_lie_along_their_axis(void **) {
  auto fluid = block();
  const pbf::volume lying = pbf::volume::capsule(.25, .25, .25, 1, 0, 0, .15, .1);
  const double right = acos(-1) * (.01 * .3 + .001 * 4 / 3);
  assert_near(given(fluid.measure(lying)).volume, right, .05 * right);
  std::vector<std::uint32_t> ids(1000);
  ids.resize(given(fluid.find_in(lying, ids)));
  const std::vector<float> x = given(fluid.positions<float>());
  for (std::size_t i = 0; i < 1000; ++i) {
    const double along = std::fmax(std::fabs(double{x[3 * i]} - .25) - .15, 0);
    const bool in = std::hypot(along, double{x[3 * i + 1]} - .25, double{x[3 * i + 2]} - .25) < .1;
    assert_true(in == (std::find(ids.begin(), ids.end(), i) != ids.end()));
  }
  std::array<pbf::collider, 1> solid = {pbf::collider::capsule(.7, .9, .7, 0, 0, 1, .1, .05)};
  done(fluid.set_colliders(solid));
  const pbf::collider back = given(fluid.get_collider(0));
  assert_true(back.axis[2] == 1 && back.half_length == .1 && back.radius == .05);
}

static void shapes_live_while_something_has_them(void **) {
  std::optional<pbf::shape> shape = brick();
  const pbf::shape copy = *shape;
  assert_int_equal(given(copy.info()).references, 2);
  {
    auto fluid = block();
    std::array<pbf::collider, 1> solid = {pbf::collider::solid(*shape, .7, .9, .7)};
    done(fluid.set_colliders(solid));
    shape.reset();
    assert_int_equal(given(copy.info()).references, 2);
    done(fluid.step());
    assert_true(given(fluid.get_collider(0)).geometry == copy.handle());
  }
  assert_int_equal(given(copy.info()).references, 1);
}

static void what_is_no_shape_is_refused(void **) {
  const pbf_status wrong = PBF_ERROR_INVALID_ARGUMENT;
  const std::vector<double> points(9);
  const std::vector<float> values(8);
  const std::array<std::uint32_t, 2> nodes = {3, 3};
  const std::array<std::uint32_t, 4> faces = {0, 1, 1, 7};
  const std::array<double, 6> vertices = {0, 0, 1, 0, 1, 1};
  assert_refused(pbf::shape::from_points(3, points, .1), wrong, "point_count is 3");
  assert_refused(pbf::shape::from_points(2, points, .1), wrong, "points has 9");
  assert_refused(pbf::shape::from_points(4, points, .1), wrong, "dimension is 4");
  assert_refused(pbf::shape::from_grid(nodes, {points.data(), 2}, .1, values), wrong,
                 "values has 8");
  assert_refused(pbf::shape::from_grid(nodes, points, .1, values), wrong, "origin has 9");
  assert_refused(pbf::shape::from_heights(nodes, {points.data(), 8}, 1, -1, .1), wrong,
                 "heights has 8");
  assert_refused(pbf::shape::from_mesh(2, vertices, faces, .1), wrong, "faces[1][1] is 7");
}

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

/* Oil that begins below water: it rises, and the floor has the weight of both. */
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
  const pbf_collider_load &floor = walls[PBF_WALL_Y_MIN];
  const double weight = d * d * (100 + .5 * 100) * params.gravity[1];
  assert_near(floor.impulse_sum[1] / floor.time_sum / weight, 1, .02);
  const std::array<std::uint32_t, 1> third = {2};
  const pbf_status wrong = PBF_ERROR_INVALID_ARGUMENT;
  assert_refused(fluid.set_particle_phases(third), wrong, "phases[0] is 2");
  phases[0].rest_density = -1;
  assert_refused(fluid.set_phases(phases), wrong, "phases[0].rest_density is -1");
}

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

static void log_exceptions_of_batches_do(void **) {
  pbf::params params;
  params.time_step = .5; /* which the log is told of */
  pbf::desc desc = test_desc();
  desc.log_to = [](int, const char *sentence) { throw std::string(sentence); };
  auto batch = given(pbf::batch::create(desc, params, 2));
  const std::array<std::uint32_t, 2> counts = {1, 1};
  done(batch.add_particles(counts, std::vector<float>(6, .5f)));
  done(batch.step());
  assert_true(batch.take_log_exception() != nullptr);
  assert_false(given(batch.world(0)).take_log_exception() != nullptr);
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
    cmocka_unit_test_teardown(shapes_are_as_far_as_their_faces, nothing_live),
    cmocka_unit_test_teardown(shapes_come_back_from_bytes, nothing_live),
    cmocka_unit_test_teardown(capsules_lie_along_their_axis, nothing_live),
    cmocka_unit_test_teardown(shapes_live_while_something_has_them, nothing_live),
    cmocka_unit_test_teardown(what_is_no_shape_is_refused, nothing_live),
    cmocka_unit_test_teardown(queries_know_water_at_rest, nothing_live),
    cmocka_unit_test_teardown(queries_want_arrays_that_fit, nothing_live),
    cmocka_unit_test_teardown(as_much_comes_as_the_rate_says, nothing_live),
    cmocka_unit_test_teardown(oil_floats_and_the_floor_bears_both, nothing_live),
    cmocka_unit_test_teardown(worlds_fall_as_they_would_alone, nothing_live),
    cmocka_unit_test_teardown(a_world_that_fails_says_so, nothing_live),
    cmocka_unit_test_teardown(worlds_and_batches_go_in_any_order, nothing_live),
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
    cmocka_unit_test_teardown(log_exceptions_of_batches_do, nothing_live),
    cmocka_unit_test_teardown(values_throw, nothing_live),
#endif
  };
  const int failed = cmocka_run_group_tests(tests, nullptr, nullptr);
  if (failed) return failed;
  at_exit = filled();
  return at_exit->begin_step(1000000000).status();
}
