/* Accelerations of particles' own in deep water, which the pressure grid carries as it carries
 * weight. */
#include "leaning_tank.h"

#include <stdlib.h>
#include <string.h>

/* One that all have, aside, is the slope, with drag towards rest as without: what it drags is what
 * moved before the step, and not what accelerations and pressure do in it. */
static void check_tank(uint32_t dimension, uint32_t precision, double drag) {
  const uint32_t count = WIDE * DEEP * (dimension == 3 ? 4 : 1);
  pbf_params params = leaning_params(dimension);
  params.drag = drag;
  pbf_solver *solver = leaning_tank(NULL, dimension, precision, &params, 0);
  char *a = calloc((size_t)count * dimension, precision);
  for (uint64_t i = 0; i < count; ++i) test_put(a, i * dimension, precision, tilt * pull);
  assert_ok(pbf_set_accelerations(solver, 0, count, a));
  free(a);
  check_leaning(solver, dimension, 0);
  pbf_destroy(solver);
}

static void a_deep_tank_leans(void **state) {
  (void)state;
  test_skip_if_watched();
  check_tank(2, PBF_FLOAT32, 0);
  check_tank(2, PBF_FLOAT32, 10);
  if (strcmp(test_backend(), "reference") != 0) check_tank(3, PBF_FLOAT32, 0); /* takes it long */
}

/* Another one for each, and drag: whole, and parted by a thin wall; and of particles of which some
 * are gone, as long as rounding has not grown. */
static pbf_solver *stirred_tank(const char *backend, int parts) {
  const pbf_collider wall = wall_in_the_middle();
  pbf_params params = leaning_params(2);
  params.drag = 1;
  params.drag_velocity[0] = 0.5;
  pbf_solver *solver = leaning_tank(backend, 2, PBF_FLOAT32, &params, 0);
  static float a[WIDE * DEEP][2];
  for (int i = 0; i < WIDE * DEEP; ++i) {
    a[i][0] = 4 * sinf((float)(i % WIDE) / 5);
    a[i][1] = 3 * cosf((float)(i / WIDE) / 4);
  }
  assert_ok(pbf_set_accelerations(solver, 0, WIDE * DEEP, a));
  if (parts) assert_ok(pbf_set_colliders(solver, 1, &wall));
  assert_ok(pbf_step(solver, 3));
  const uint32_t gone[] = {3, 77, 400}, come = sizeof gone / sizeof gone[0];
  assert_ok(pbf_remove_particles(solver, come, gone));
  const float x[3][2] = {{0.5f, 1.8f}, {1, 1.8f}, {1.5f, 1.8f}};
  assert_ok(pbf_add_particles(solver, come, x, NULL, NULL));
  assert_ok(pbf_step(solver, 3));
  return solver;
}

static void as_the_reference(void **state) {
  (void)state;
  check_as_reference(stirred_tank);
}

/* The stub has none. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(as_the_reference),
      cmocka_unit_test(a_deep_tank_leans),
  };
  return TEST_RUN(tests);
}
