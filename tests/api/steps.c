/* Steps far longer and far shorter than the defaults', an h of few neighbours, impacts, and boxes
 * with too little room: water stands, and nothing is thrown. */
#include "support.h"

#include <math.h>

enum { LAYERS = 20, COLUMNS = 12 };

static const double spacing = 0.05, gravity = 9.81;

/* A tank full to a height of LAYERS; `fall`: what a particle falls in a step, in spacings. */
static pbf_params tank_params(uint32_t dimension, double spacings, uint32_t iterations,
                              double fall) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = spacings * spacing;
  params.iterations = iterations;
  params.time_step = sqrt(fall * spacing / gravity);
  params.prestabilization = 0; /* the steps are to do it */
  for (int k = 0; k < 3; ++k)
    params.domain_max[k] = spacing * (k == 1 ? 2.5 * LAYERS : dimension == 3 ? 6 : COLUMNS);
  return params;
}

/* Its water: a lattice with every coordinate off by up to a part of a spacing, squeezed. */
static pbf_solver *tank(uint32_t dimension, uint32_t precision, const pbf_params *params,
                        double off, double squeeze) {
  uint32_t wide = (uint32_t)lround(params->domain_max[0] / spacing);
  uint32_t count = LAYERS * (dimension == 3 ? wide * wide : wide), seed = 1;
  pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, params);
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % wide, i / wide % LAYERS, i / wide / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k) {
      seed = seed * 1664525u + 1013904223u;
      double place = at[k] + 0.5 + off * (seed / 2147483648.0 - 1);
      test_put(x, (uint64_t)i * dimension + k, precision, (k == 1 ? squeeze : 1) * spacing * place);
    }
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

typedef struct tank_state {
  double height; /* twice the mean, in layers */
  double speed;  /* RMS, over sqrt(g d) */
  double energy; /* a particle, over g d */
} tank_state;

static tank_state state_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  double mean = stats.center_of_mass[1] / spacing;
  double kinetic = stats.kinetic_energy / (gravity * spacing);
  return (tank_state){2 * mean, sqrt(2 * kinetic), mean + kinetic};
}

static void expect_rest(const char *what, uint32_t dimension, pbf_solver *s) {
  tank_state end = state_of(s);
  if (!(fabs(end.height / LAYERS - 1) < 0.1))
    fail_msg("%s, %uD: %g of the height", what, dimension, end.height / LAYERS);
  if (!(end.speed < 0.25)) fail_msg("%s, %uD: moves at %g sqrt(g d)", what, dimension, end.speed);
}

static void expect_rest_after(const char *what, uint32_t dimension, uint32_t precision,
                              const pbf_params *params, double off, uint32_t steps) {
  pbf_solver *s = tank(dimension, precision, params, off, 1);
  assert_ok(pbf_step(s, steps));
  expect_rest(what, dimension, s);
  pbf_destroy(s);
}

/* 0.3 spacings a step: a centimetre at 30 steps a second and g. The rest is what the grid and the
 * iterations make of the weight between them. */
static void check_long(uint32_t dimension, uint32_t precision) {
  pbf_params params = tank_params(dimension, 2, 4, 0.3);
  expect_rest_after("long steps", dimension, precision, &params, 0, 300);
}

static void water_stands_in_long_steps(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_long);
}

/* Small steps of one iteration, so many that density errors could add up. */
static void check_one_iteration(uint32_t dimension, uint32_t precision) {
  pbf_params params = tank_params(dimension, 2, 1, 4e-4);
  params.pressure_grid = 0;
  expect_rest_after("one iteration", dimension, precision, &params, 0, 700);
}

static void one_iteration_in_short_steps_holds_water(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_one_iteration);
}

static void check_few_neighbors(uint32_t dimension, uint32_t precision) {
  pbf_params params = tank_params(dimension, 1.5, 8, 0.2);
  expect_rest_after("few neighbours", dimension, precision, &params, 0.25, 300);
}

static void few_neighbors_do_not_boil(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_few_neighbors);
}

/* Squeezed by a tenth, water has to rise by half a layer a particle to be at rest, and is to do so
 * at the speeds of falling. */
static void check_dense(uint32_t dimension, uint32_t precision) {
  pbf_params params = tank_params(dimension, 2, 4, 5e-5);
  pbf_solver *s = tank(dimension, precision, &params, 0, 0.9);
  tank_state begin = state_of(s);
  double most = begin.energy, rise = 0.5 * (LAYERS - begin.height);
  for (int k = 0; k < 30; ++k) {
    assert_ok(pbf_step(s, 20));
    most = fmax(most, state_of(s).energy);
  }
  if (!(most - begin.energy < 2 * rise))
    fail_msg("%uD: gains %g g d a particle, and rises by %g d", dimension, most - begin.energy,
             rise);
  pbf_destroy(s);
}

static void what_is_dense_is_not_thrown(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_dense);
}

/* A block of `wide` particles by `high`, thrown from the corner of the box that it stands in. */
static void add_thrown(pbf_solver *s, uint32_t dimension, uint32_t precision, uint32_t wide,
                       uint32_t high, const double velocity[3]) {
  const uint32_t count = high * wide * (dimension == 3 ? wide : 1);
  void *x = calloc((size_t)count * dimension, precision);
  void *v = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  assert_non_null(v);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % wide, i / wide % high, i / wide / high};
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)i * dimension + k, precision, spacing * (at[k] + 0.5));
      test_put(v, (uint64_t)i * dimension + k, precision, velocity[k]);
    }
  }
  assert_ok(pbf_add_particles(s, count, x, v, NULL));
  free(x);
  free(v);
}

/* A block in the open, thrown into a corner of the box by about half a spacing a step: what it
 * bounces off with is no more than what it came with. */
static void check_impact(uint32_t dimension, uint32_t precision) {
  pbf_params params = tank_params(dimension, 2, 4, 0.0014);
  const uint32_t wide = dimension == 3 ? 10 : 36, high = dimension == 3 ? 12 : 30;
  const uint32_t count = high * wide * (dimension == 3 ? wide : 1);
  const double speed = -sqrt(2 * gravity * high * spacing);
  for (int k = 0; k < 3; ++k) params.domain_max[k] = spacing * 1.5 * (k == 1 ? high : wide);
  pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, &params);
  add_thrown(s, dimension, precision, wide, high, (double[]){speed, speed, 0});
  double begin = state_of(s).energy, most = 0;
  for (int k = 0; k < 60; ++k) {
    assert_ok(pbf_step(s, 1));
    most = fmax(most, state_of(s).energy);
  }
  if (!(most <= begin)) fail_msg("%uD: ends with %g of its energy", dimension, most / begin);
  pbf_destroy(s);
}

static void impacts_gain_nothing(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_impact);
}

/* Planes in place of the lower walls, which step back. */
static void set_planes(pbf_solver *s, pbf_params *params, uint32_t dimension) {
  pbf_collider planes[3];
  for (uint32_t k = 0; k < dimension; ++k) {
    assert_ok(pbf_collider_init(&planes[k], sizeof planes[k], PBF_COLLIDER_PLANE));
    for (uint32_t axis = 0; axis < 3; ++axis) planes[k].axis[axis] = axis == k;
    params->domain_min[k] = -3 * spacing;
  }
  assert_ok(pbf_set_params(s, params));
  assert_ok(pbf_set_colliders(s, dimension, planes));
}

/* Whom an impact presses into a corner it must not press into one point, where nothing could ever
 * part them: thrown there, all find room again. */
static void throw_into_corner(uint32_t dimension, uint32_t precision, int of_planes) {
  pbf_params params = tank_params(dimension, 2, 4, 0.03);
  const uint32_t side = dimension == 3 ? 10 : 30, count = side * side * (dimension == 3 ? side : 1);
  const double speed = -5 * sqrt(gravity * side * spacing / dimension);
  for (int k = 0; k < 3; ++k) params.domain_max[k] = spacing * 1.6 * side;
  pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, &params);
  if (of_planes) set_planes(s, &params, dimension);
  add_thrown(s, dimension, precision, side, side, (double[]){speed, speed, speed});
  assert_ok(pbf_step(s, 100));
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  if (!(stats.density_error_max < 1))
    fail_msg("%uD: %g times the rest density", dimension, 1 + stats.density_error_max);
  pbf_destroy(s);
}

static void check_corner(uint32_t dimension, uint32_t precision) {
  throw_into_corner(dimension, precision, 0);
  throw_into_corner(dimension, precision, 1);
}

static void corners_give_back_whom_they_get(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_corner);
}

/* The domain as the inside of a box, in a larger one. */
static void box_in(pbf_solver *s, pbf_params *params) {
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  box.inverted = 1;
  for (int k = 0; k < 3; ++k) {
    box.position[k] = box.half_extents[k] = 0.5 * params->domain_max[k];
    params->domain_min[k] -= 1;
    params->domain_max[k] += 1;
  }
  assert_ok(pbf_set_params(s, params));
  assert_ok(pbf_set_colliders(s, 1, &box));
}

/* Half more fluid than its box has room for. Where no place is right there is no reason to fly. */
static void overfill(uint32_t dimension, uint32_t precision, int of_a_collider) {
  pbf_params params = tank_params(dimension, 2, 16, 0.003);
  params.domain_max[1] = spacing * LAYERS / 1.5;
  pbf_solver *s = tank(dimension, precision, &params, 0.1, 1 / 1.5);
  if (of_a_collider) box_in(s, &params);
  assert_ok(pbf_step(s, 40));
  double speed = state_of(s).speed;
  if (!(speed < 2)) fail_msg("%uD: an overfull box flies at %g sqrt(g d)", dimension, speed);
  pbf_destroy(s);
}

static void check_overfull(uint32_t dimension, uint32_t precision) {
  overfill(dimension, precision, 0);
  overfill(dimension, precision, 1);
}

static void overfull_boxes_are_calm(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_overfull);
}

/* A lid that makes the box overfull between two steps: in one call as in many. */
static void check_lid(uint32_t dimension, uint32_t precision) {
  pbf_params params = tank_params(dimension, 2, 4, 0.01);
  params.domain_max[1] = spacing * 1.1 * LAYERS;
  params.wall_velocity[PBF_WALL_Y_MAX] = -0.2 * spacing / params.time_step;
  pbf_solver *a = tank(dimension, precision, &params, 0.1, 1);
  pbf_solver *b = tank(dimension, precision, &params, 0.1, 1);
  assert_ok(pbf_step(a, 20));
  for (int k = 0; k < 20; ++k) assert_ok(pbf_step(b, 1));
  assert_int_equal(test_hash(a), test_hash(b));
  pbf_destroy(a);
  pbf_destroy(b);
}

static void lids_close_in_any_number_of_calls(void **state) {
  (void)state;
  test_for_long_kinds(check_lid);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_stands_in_long_steps),
      cmocka_unit_test(one_iteration_in_short_steps_holds_water),
      cmocka_unit_test(few_neighbors_do_not_boil),
      cmocka_unit_test(what_is_dense_is_not_thrown),
      cmocka_unit_test(impacts_gain_nothing),
      cmocka_unit_test(corners_give_back_whom_they_get),
      cmocka_unit_test(overfull_boxes_are_calm),
      cmocka_unit_test(lids_close_in_any_number_of_calls),
  };
  return TEST_RUN(tests);
}
