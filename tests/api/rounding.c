/* What float32 can't tell apart: moves of less than a last bit, and densities of rest. */
#include "support.h"

enum { FLIERS = 5 };

/* Far from each other and from the walls, all with the velocity 0.1. */
static pbf_solver *fliers(uint32_t dimension, uint32_t precision, double time_step) {
  pbf_desc desc = test_desc(dimension, precision, FLIERS);
  pbf_params params = test_params();
  params.time_step = time_step;
  memset(params.gravity, 0, sizeof params.gravity);
  pbf_solver *s = test_create(&desc, &params);
  double x[FLIERS * 3], v[FLIERS * 3];
  for (uint32_t i = 0; i < FLIERS; ++i)
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, i * dimension + k, precision, 0.52 + (k == 1 ? 0 : 0.08 * i) - 0.01 * k);
      test_put(v, i * dimension + k, precision, 0.1);
    }
  assert_ok(pbf_add_particles(s, FLIERS, x, v, NULL));
  return s;
}

/* The third dimension sets out at a power of two. However much of a last bit a step's way is, what
 * rounding loses does not add up: a bound of four bits holds after any number of steps. */
static void assert_way(uint32_t dimension, uint32_t precision, double bits) {
  const uint32_t steps = 3000;
  const double bit = precision == PBF_FLOAT32 ? 0x1p-24 : 0x1p-53; /* of 0.5 … 1 */
  const double time_step = bits * bit / 0.1;
  pbf_solver *s = fliers(dimension, precision, time_step);
  double before[FLIERS * 3], after[FLIERS * 3], v[FLIERS * 3];
  assert_ok(pbf_get_positions(s, 0, FLIERS, before));
  assert_ok(pbf_step(s, steps));
  assert_ok(pbf_get_positions(s, 0, FLIERS, after));
  assert_ok(pbf_get_velocities(s, 0, FLIERS, v));
  const double speed = precision == PBF_FLOAT32 ? (double)0.1f : 0.1;
  for (uint32_t i = 0; i < FLIERS * dimension; ++i) {
    double way = test_value(after, i, precision) - test_value(before, i, precision);
    if (fabs(way - speed * time_step * steps) > 4 * bit)
      fail_msg("%u: %u steps of %.3g bits: %.1f bits off", i, steps, bits,
               (way - speed * time_step * steps) / bit);
    assert_true(test_value(v, i, precision) == speed);
  }
  pbf_destroy(s);
}

static void ways_of_parts_of_a_bit(uint32_t dimension, uint32_t precision) {
  if (precision == PBF_FLOAT64) return;
  const double parts[] = {0.1, 0.37, 0.5, 1, 1.49, 7.7};
  for (uint32_t k = 0; k < sizeof parts / sizeof parts[0]; ++k)
    assert_way(dimension, precision, parts[k]);
}

static void what_rounding_loses_does_not_add_up(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has its own way of moving");
  test_for_each_kind(ways_of_parts_of_a_bit);
}

/* Whoever stands, stands, wherever that is: at a power of two, the last bits below are half as
 * large. */
static void who_stands_stays(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 1);
  pbf_params params = test_params();
  memset(params.gravity, 0, sizeof params.gravity);
  pbf_solver *s = test_create(&desc, &params);
  double x[3], after[3];
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, k == 0 ? 0.5 : 0.3);
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_ok(pbf_step(s, 50));
  assert_ok(pbf_get_positions(s, 0, 1, after));
  assert_memory_equal(x, after, dimension * precision);
  pbf_destroy(s);
}

static void nobody_is_moved_for_rounding(void **state) {
  (void)state;
  test_for_each_kind(who_stands_stays);
}

/* A lattice has the density of rest but for the rounding of its sums and places; without gravity
 * nothing but that could set it in motion. */
static void assert_lattice_rests(uint32_t dimension, uint32_t precision) {
  const uint32_t side = 6, count = dimension == 3 ? side * side * side : side * side;
  pbf_desc desc = test_desc(dimension, precision, count);
  pbf_params params = test_params();
  params.time_step = 1e-7;
  memset(params.gravity, 0, sizeof params.gravity);
  pbf_solver *s = test_create(&desc, &params);
  void *x = calloc((size_t)count * dimension, precision);
  void *v = calloc((size_t)count * dimension, precision);
  assert_true(x && v);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % side, i / side % side, i / side / side};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, 0.31 + 0.05 * at[k]);
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  assert_ok(pbf_step(s, 20));
  assert_ok(pbf_get_velocities(s, 0, count, v));
  for (uint32_t i = 0; i < count * dimension; ++i)
    if (test_value(v, i, precision) != 0)
      fail_msg("velocity %u is %g", i, test_value(v, i, precision));
  free(x);
  free(v);
  pbf_destroy(s);
}

static void rounding_is_no_density_error(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(assert_lattice_rests);
}

int main(void) {
  const struct CMUnitTest rounding[] = {
      cmocka_unit_test(what_rounding_loses_does_not_add_up),
      cmocka_unit_test(nobody_is_moved_for_rounding),
      cmocka_unit_test(rounding_is_no_density_error),
  };
  return TEST_RUN(rounding);
}
