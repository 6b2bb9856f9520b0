/* What comes in at one point, in a line or in a plane, in many calls, becomes a fluid: nothing in
 * such an arrangement pushes across it, so that symmetry would hold it together however dense. */
#include <math.h>

#include "support.h"

enum { FRAMES = 120, STEPS = 2 /* a frame */ };

/* `each` particles a frame in a row along x, from the middle of the ceiling on, falling at `speed`;
 * the fluid after it has had time to spread. */
static pbf_stats poured(uint32_t dimension, uint32_t precision, uint32_t solver_kind, uint32_t each,
                        double speed, uint64_t *hash) {
  const pbf_desc desc = test_desc(dimension, precision, FRAMES * each);
  pbf_params params = test_params();
  _Alignas(8) unsigned char x[4 * 3 * 8], v[4 * 3 * 8];
  params.solver = solver_kind;
  memset(v, 0, sizeof v);
  for (uint32_t i = 0; i < each; ++i) {
    const double place[3] = {0.4 + 0.05 * i, 0.9, 0.5};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, place[k]);
    test_put(v, (uint64_t)i * dimension + 1, precision, -speed);
  }
  pbf_solver *s = test_create(&desc, &params);
  for (uint32_t frame = 0; frame < FRAMES; ++frame) {
    assert_ok(pbf_add_particles(s, each, x, v, NULL));
    assert_ok(pbf_step(s, STEPS));
  }
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  /* A fall from the ceiling, and what depenetration may add. */
  const double fall = sqrt(speed * speed + 2 * 9.81 * 0.9);
  assert_true(stats.speed_max < 1.5 * fall);
  assert_ok(pbf_step(s, 600));
  assert_ok(pbf_get_stats(s, &stats));
  *hash = test_hash(s);
  pbf_destroy(s);
  return stats;
}

static void check(uint32_t dimension, uint32_t precision, uint32_t solver_kind, uint32_t each,
                  double speed) {
  uint64_t hash, again;
  const pbf_stats stats = poured(dimension, precision, solver_kind, each, speed, &hash);
  assert_true(stats.density_error_mean < 0.02);
  /* The floor has room for all of them; none stays where it came in. */
  assert_true(stats.position_max[0] - stats.position_min[0] > 0.5);
  if (dimension == 3) assert_true(stats.position_max[2] - stats.position_min[2] > 0.5);
  poured(dimension, precision, solver_kind, each, speed, &again);
  assert_true(hash == again);
}

static void a_needle(uint32_t dimension, uint32_t precision) {
  check(dimension, precision, PBF_SOLVER_CHEBYSHEV, 1, 1);
  check(dimension, precision, PBF_SOLVER_JACOBI, 1, 1);
}

static void a_curtain(uint32_t dimension, uint32_t precision) {
  if (dimension == 3) check(dimension, precision, PBF_SOLVER_CHEBYSHEV, 4, 3);
}

static void a_needle_becomes_a_fluid(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(a_needle);
}

static void a_curtain_becomes_a_fluid(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(a_curtain);
}

/* Ten at one point in as many calls, none of which sees another of them. */
static void at_one_point(uint32_t dimension, uint32_t precision) {
  enum { COUNT = 10 };
  const pbf_desc desc = test_desc(dimension, precision, COUNT);
  pbf_params params = test_params();
  _Alignas(8) unsigned char x[3 * 8];
  params.gravity[1] = 0;
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, 0.5);
  pbf_solver *s = test_create(&desc, &params);
  for (uint32_t i = 0; i < COUNT; ++i) assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_ok(pbf_step(s, 600));
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  assert_true(stats.density_error_max < 0.05);
  for (uint32_t k = 0; k < dimension; ++k)
    assert_true(stats.position_max[k] - stats.position_min[k] > 0.5 * 0.05);
  pbf_destroy(s);
}

static void many_calls_at_one_point(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(at_one_point);
}

/* The same in water at rest, whose particles push all of them alike. */
static void in_water(uint32_t dimension, uint32_t precision) {
  enum { COUNT = 10, SIDE = 9, LAYERS = 4, MOST = SIDE * SIDE * LAYERS };
  const uint32_t water = SIDE * LAYERS * (dimension == 3 ? SIDE : 1);
  const pbf_desc desc = test_desc(dimension, precision, MOST + COUNT);
  pbf_params params = test_params();
  _Alignas(8) static unsigned char x[MOST * 3 * 8];
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = k == 1 ? 1 : 0.05 * SIDE;
  for (uint32_t i = 0; i < water; ++i) {
    const uint32_t at[3] = {i % SIDE, i / SIDE % LAYERS, i / SIDE / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, 0.05 * (at[k] + 0.5));
  }
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, water, x, NULL, NULL));
  assert_ok(pbf_step(s, 60));
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, k == 1 ? 0.07 : 0.21);
  for (uint32_t i = 0; i < COUNT; ++i) assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_ok(pbf_step(s, 1200));
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  pbf_destroy(s);
}

static void many_calls_at_one_point_in_water(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(in_water);
}

int main(void) {
  const struct CMUnitTest hoses[] = {
      cmocka_unit_test(a_needle_becomes_a_fluid),
      cmocka_unit_test(a_curtain_becomes_a_fluid),
      cmocka_unit_test(many_calls_at_one_point),
      cmocka_unit_test(many_calls_at_one_point_in_water),
  };
  return TEST_RUN(hoses);
}
