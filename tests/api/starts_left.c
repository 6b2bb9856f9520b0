/* Starts that pre-stabilization cannot undo, as where fluid has to rise by as many layers as there
 * are: what it leaves parts by and by, and no step throws it. */
#include "support.h"

#include <math.h>

enum { LAYERS = 12, DEEP = 4, MOST = 40 * LAYERS * DEEP };

static const double d = 0.05;

/* So many columns wide. */
static pbf_params room(uint32_t wide) {
  pbf_params params = test_params();
  params.time_step = 1.0 / 240;
  memcpy(params.domain_max, (double[]){wide * d, 5 * LAYERS * d, DEEP * d},
         sizeof params.domain_max);
  return params;
}

static pbf_solver *filled(uint32_t dimension, uint32_t precision, uint32_t wide) {
  static double x[3 * MOST];
  const pbf_desc desc = test_desc(dimension, precision, MOST);
  const pbf_params params = room(wide);
  const uint32_t count = wide * LAYERS * (dimension == 3 ? DEEP : 1);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % wide, i / wide % LAYERS, i / wide / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, d * (at[k] + 0.5));
  }
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  return s;
}

/* A tank made half as wide at once comes to be twice as deep, and little in it is faster than a
 * fall by as much. */
static void check_narrower(uint32_t dimension, uint32_t precision) {
  const uint32_t wide = 40;
  const double height = 2 * LAYERS * d, fall = sqrt(2 * 9.81 * height);
  pbf_solver *s = filled(dimension, precision, wide);
  const pbf_params narrow = room(wide / 2);
  pbf_stats stats = {.struct_size = sizeof stats};
  double fastest = 0;
  assert_ok(pbf_step(s, 24));
  assert_ok(pbf_set_params(s, &narrow));
  for (int step = 0; step < 720; ++step) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_stats(s, &stats));
    fastest = fmax(fastest, stats.speed_max);
  }
  const double level = 2 * stats.center_of_mass[1] / height;
  if (!(fastest < 1.5 * fall) || !(fabs(level - 1) < 0.05))
    fail_msg("%uD: up to %g of a fall, and then %g times as deep as it should be", dimension,
             fastest / fall, level);
  pbf_destroy(s);
}

static void what_is_left_is_not_thrown(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_narrower);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_left_is_not_thrown)};
  return TEST_RUN(tests);
}
