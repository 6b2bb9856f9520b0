/* Convex hulls of points of which many are all but in one plane, or in one line, with others: those
 * of a box with noise, and needles. */
#include <math.h>

#include <pbf/shapes.h>

#include "support.h"

static uint64_t drawn = 88172645463325252u;

/* 0 … 1, by Marsaglia's xorshift (Journal of Statistical Software 8 (14), 2003). */
static double draw(void) {
  drawn ^= drawn << 13;
  drawn ^= drawn >> 7;
  drawn ^= drawn << 17;
  return (double)(drawn >> 11) / 9007199254740992.0;
}

/* 3 points along each axis of a box of side 2, none farther off its place than half of `noise`. */
static void check_box(uint32_t dimension, double noise, double middle) {
  const uint32_t count = dimension == 3 ? 27 : 9;
  double points[27 * 3];
  pbf_shape *shape = NULL;
  pbf_shape_info info = {.struct_size = sizeof info};
  for (uint32_t i = 0, place = 0; i < count; ++i)
    for (uint32_t k = 0, rest = i; k < dimension; ++k, rest /= 3)
      points[place++] = middle + (double)(rest % 3) - 1 + noise * (draw() - 0.5);
  const pbf_hull_desc hull = {.struct_size = sizeof hull,
                              .dimension = dimension,
                              .point_count = count,
                              .points = points,
                              .cell = 0.1};
  assert_ok(pbf_shape_from_points(&hull, &shape));
  assert_ok(pbf_get_shape_info(shape, &info));
  const double volume = dimension == 3 ? 8 : 4;
  assert_true(fabs(info.volume / volume - 1) < 0.01); /* edges are rounded off by the grid */
  for (uint32_t k = 0; k < dimension; ++k) {
    assert_true(fabs(info.lower[k] - middle + 1) < 0.01);
    assert_true(fabs(info.upper[k] - middle - 1) < 0.01);
  }
  pbf_release_shape(shape);
}

static void boxes_with_noise_are_boxes(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension)
    for (int exponent = -16; exponent <= -3; ++exponent) {
      check_box(dimension, pow(10, exponent), 0);
      check_box(dimension, pow(10, exponent), 1000);
    }
}

/* Points beside a line, at most so far off. */
static void check_needle(uint32_t dimension, uint32_t count, double width) {
  double points[100 * 3];
  pbf_shape *shape = NULL;
  for (uint32_t i = 0; i < count; ++i) {
    const double along = draw();
    for (uint32_t k = 0; k < dimension; ++k)
      points[i * dimension + k] = along * (k + 1) + (k > 0 ? width * (draw() - 0.5) : 0);
  }
  const pbf_hull_desc hull = {.struct_size = sizeof hull,
                              .dimension = dimension,
                              .point_count = count,
                              .points = points,
                              .cell = 0.3};
  const pbf_status status = pbf_shape_from_points(&hull, &shape);
  if (status == PBF_OK) {
    pbf_release_shape(shape);
  } else {
    assert_int_equal(status, PBF_ERROR_INVALID_ARGUMENT);
    assert_true(strstr(pbf_last_error(), "thinner than a cell") ||
                strstr(pbf_last_error(), "all in one"));
  }
}

/* Of each number of points and each width, whichever faces rounding puts before which points. */
static void needles_are_told_of(void **state) {
  (void)state;
  const uint32_t every = TEST_INSTRUMENTED && !test_is_long() ? 24 : 3;
  for (uint32_t count = 4; count <= 100; count += every)
    for (int exponent = -16; exponent <= -2; ++exponent)
      for (uint32_t dimension = 2; dimension <= 3; ++dimension)
        check_needle(dimension, count, pow(10, exponent));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_with_noise_are_boxes),
      cmocka_unit_test(needles_are_told_of),
  };
  return TEST_RUN(tests);
}
