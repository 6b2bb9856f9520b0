/* Deep water in wide domains: their pressure grids have so many cells that backends may solve them
 * in other ways. What it does to the fluid is what the reference does, which iterates on one grid.
 */
#include "deep_column.h"

enum { THICK = 3 };

/* In spacings; and how far velocities may be off the reference's. */
typedef struct dam_sizes {
  uint32_t wide, deep, domain;
  double bar;
} dam_sizes;

/* A dam that breaks, and a ball in it. */
static pbf_solver *dam(const pbf_desc *desc, const dam_sizes *sizes, double tilt) {
  pbf_params params = column_params(2);
  pbf_collider ball;
  params.domain_max[0] = spacing * sizes->domain;
  params.domain_max[1] = spacing * 2 * sizes->deep;
  params.domain_max[2] = spacing * THICK;
  params.gravity[0] = tilt * gravity;
  pbf_solver *s = block(desc, &params, sizes->wide, sizes->deep, 0, 0, 1);
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[0] = 1.3 * sizes->wide * spacing;
  ball.radius = 7 * spacing;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  return s;
}

/* Root mean square of the velocities, and of their differences from the other's. */
static double difference(pbf_solver *s, pbf_solver *other, uint32_t dimension, uint32_t precision,
                         double *speed) {
  double sum = 0, square = 0;
  uint32_t count = 0;
  assert_ok(pbf_get_count(s, &count));
  void *v = calloc((size_t)count * dimension, precision);
  void *expected = calloc((size_t)count * dimension, precision);
  assert_non_null(v);
  assert_non_null(expected);
  assert_ok(pbf_get_velocities(s, 0, count, v));
  assert_ok(pbf_get_velocities(other, 0, count, expected));
  for (uint64_t i = 0; i < (uint64_t)count * dimension; ++i) {
    const double right = test_value(expected, i, precision);
    sum += pow(test_value(v, i, precision) - right, 2);
    square += right * right;
  }
  free(v);
  free(expected);
  *speed = sqrt(square / count);
  return sqrt(sum / count);
}

static void check_tilt(uint32_t dimension, uint32_t precision, const dam_sizes *sizes,
                       double tilt) {
  if (!test_has_reference(dimension, precision)) test_skip("there is no reference to ask");
  const uint32_t count = sizes->wide * sizes->deep * (dimension == 3 ? THICK : 1);
  pbf_desc desc = test_desc(dimension, precision, count), of_reference = desc;
  of_reference.backend = "reference";
  pbf_solver *s = dam(&desc, sizes, tilt), *reference = dam(&of_reference, sizes, tilt);
  double speed = 0, away = 0;
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_step(reference, 2));
  away = difference(s, reference, dimension, precision, &speed);
  if (!(away < sizes->bar * speed))
    fail_msg("%uD, tilted by %g: velocities of %g are %g off", dimension, tilt, speed, away);
  pbf_destroy(s);
  pbf_destroy(reference);
}

static void check_dam(uint32_t dimension, uint32_t precision) {
  const dam_sizes wide = {100, 24, 240, 0.005};
  check_tilt(dimension, precision, &wide, 0);
  check_tilt(dimension, precision, &wide, 0.3);
}

/* 500 by 50 cells, in 2D alone, where fewer particles need so many. The reference's iterations
 * leave something of the longest waves: iterated a hundred times as often it is 0.0053 off itself.
 */
static void check_wider(uint32_t dimension, uint32_t precision) {
  const dam_sizes wider = {460, 100, 2000, 0.01};
  if (dimension == 2) check_tilt(dimension, precision, &wider, 0);
}

static void wide_water_moves_as_in_the_reference(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_dam);
}

static void wider_water_moves_as_in_the_reference(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_wider);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wide_water_moves_as_in_the_reference),
      cmocka_unit_test(wider_water_moves_as_in_the_reference),
  };
  return TEST_RUN(tests);
}
