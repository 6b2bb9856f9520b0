/* Starts in which particles lie upon each other, by calls that fill or set the same places, or in a
 * solid, which takes rows of them out to one point of a face: none stay together. Between two
 * particles at a point nothing pushes, and water has as much less room as there are such pairs,
 * until one bursts. */
#include "support.h"

#include <math.h>

enum { WIDE = 16, LAYERS = 8, DEEP = 6, MOST = 2 * WIDE * LAYERS * DEEP };

static const double d = 0.05;

static pbf_solver *tank(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, MOST);
  pbf_params params = test_params();
  params.time_step = 1.0 / 240;
  memcpy(params.domain_max, (double[]){WIDE * d, 4 * LAYERS * d, DEEP * d},
         sizeof params.domain_max);
  return test_create(&desc, &params);
}

/* Columns of the tank's lattice, `off` from it by as little as rounding is. */
static void fill(pbf_solver *s, uint32_t dimension, uint32_t precision, uint32_t from,
                 uint32_t to) {
  static double x[3 * MOST];
  const double off = from > 0 ? 1e-15 : 0;
  uint32_t count = 0;
  for (uint32_t i = from; i < to; ++i)
    for (uint32_t j = 0; j < LAYERS; ++j)
      for (uint32_t k = 0; k < (dimension == 3 ? DEEP : 1); ++k, ++count) {
        const uint32_t at[3] = {i, j, k};
        for (uint32_t axis = 0; axis < dimension; ++axis)
          test_put(x, (uint64_t)count * dimension + axis, precision,
                   d * (at[axis] + 0.5) * (1 + off));
      }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
}

static void add_one(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  double x[3];
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, 2.5 * d);
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
}

static void stand_on_floor(pbf_solver *s) {
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  memcpy(box.position, (double[]){WIDE * d / 2, 0, 0}, sizeof box.position);
  memcpy(box.half_extents, (double[]){2.5 * d, 3 * d, 2.5 * d}, sizeof box.half_extents);
  assert_ok(pbf_set_colliders(s, 1, &box));
}

/* In spacings. */
static double nearest(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  static double x[3 * MOST];
  uint32_t count;
  double least = INFINITY;
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t j = 0; j < i; ++j) {
      double square = 0;
      for (uint32_t k = 0; k < dimension; ++k)
        square += pow(test_value(x, (uint64_t)i * dimension + k, precision) -
                          test_value(x, (uint64_t)j * dimension + k, precision),
                      2);
      least = fmin(least, square);
    }
  return sqrt(least) / d;
}

/* What is filled twice rises by as much, and falls by no more than that. */
static void expect_apart(const char *what, uint32_t dimension, uint32_t precision, pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  double fastest = 0, least = INFINITY;
  for (int step = 0; step < 240; ++step) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_stats(s, &stats));
    fastest = fmax(fastest, stats.speed_max);
    if (step % 60 == 0) least = fmin(least, nearest(s, dimension, precision));
  }
  if (!(least > 0.3) || !(fastest < sqrt(2 * 9.81 * 3 * d)))
    fail_msg("%s, %uD: %g spacings apart, up to %g m/s", what, dimension, least, fastest);
  pbf_destroy(s);
}

static void check_fills(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision);
  fill(s, dimension, precision, 0, 9);
  fill(s, dimension, precision, 7, WIDE);
  expect_apart("two columns filled twice", dimension, precision, s);
  s = tank(dimension, precision);
  fill(s, dimension, precision, 0, WIDE);
  add_one(s, dimension, precision); /* for which nothing else would be moved before the step */
  expect_apart("a place filled twice", dimension, precision, s);
}

/* All are set, the last where another is. */
static void set_upon_another(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  static double x[3 * MOST];
  uint32_t count;
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t k = 0; k < dimension; ++k)
    test_put(x, (uint64_t)(count - 1) * dimension + k, precision,
             test_value(x, (uint64_t)(count / 2) * dimension + k, precision));
  assert_ok(pbf_set_positions(s, 0, count, x));
}

static void check_set(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision);
  fill(s, dimension, precision, 0, WIDE);
  set_upon_another(s, dimension, precision);
  expect_apart("one set upon another", dimension, precision, s);
}

static void check_solid(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = tank(dimension, precision);
  stand_on_floor(s);
  fill(s, dimension, precision, 0, WIDE);
  expect_apart("water filled over a box", dimension, precision, s);
}

static void what_is_filled_twice_parts(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_fills);
}

static void what_is_set_upon_another_parts(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_set);
}

static void what_is_filled_over_a_solid_parts(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_solid);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_filled_twice_parts),
                                     cmocka_unit_test(what_is_set_upon_another_parts),
                                     cmocka_unit_test(what_is_filled_over_a_solid_parts)};
  return TEST_RUN(tests);
}
