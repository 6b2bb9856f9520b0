/* Solids of any form. */
#include <algorithm>

#include "support.h"

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

int shapes() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(shapes_are_as_far_as_their_faces, nothing_live),
      cmocka_unit_test_teardown(shapes_come_back_from_bytes, nothing_live),
      cmocka_unit_test_teardown(capsules_lie_along_their_axis, nothing_live),
      cmocka_unit_test_teardown(shapes_live_while_something_has_them, nothing_live),
      cmocka_unit_test_teardown(what_is_no_shape_is_refused, nothing_live),
  };
  return cmocka_run_group_tests_name("shapes", tests, nullptr, nullptr);
}
