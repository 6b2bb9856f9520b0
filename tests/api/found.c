/* Particles that the backend looks for itself, where the host can't read its memory: as many as are
 * wanted, in any order, and no more than there are. The stub and cuda do. */
#include <math.h>
#include <stdlib.h>

#include <pbf/emit.h>
#include <pbf/query.h>

#include "support.h"

enum { COUNT = 3000, FEW = 40 };

/* Scattered in the unit box, and nothing moves. */
static pbf_solver *scattered(uint32_t dimension, uint32_t precision, uint32_t count) {
  pbf_desc desc = test_desc(dimension, precision, COUNT);
  pbf_params params = test_params();
  double *x = malloc(COUNT * 3 * sizeof *x);
  uint32_t bits = 1;
  assert_non_null(x);
  for (uint32_t i = 0; i < count * dimension; ++i) {
    bits = bits * 1664525u + 1013904223u;
    test_put(x, i, precision, (bits >> 8) / 16777216.0);
  }
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

/* A ball about the middle, by its definition. */
static uint32_t ids_in_ball(pbf_solver *s, double radius, uint32_t dimension, uint32_t precision,
                            uint32_t *ids) {
  uint32_t count, found = 0, *all = malloc(COUNT * sizeof *all);
  double *x = malloc(COUNT * 3 * sizeof *x);
  assert_true(all && x);
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_get_ids(s, 0, count, all));
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t row = 0; row < count; ++row) {
    double square = 0;
    for (uint32_t k = 0; k < dimension; ++k)
      square += pow(test_value(x, (uint64_t)row * dimension + k, precision) - 0.5, 2);
    if (square <= radius * radius) ids[found++] = all[row];
  }
  free(all);
  free(x);
  return found;
}

static pbf_volume ball_of(double radius) {
  pbf_volume v;
  assert_ok(pbf_volume_init(&v, sizeof v, PBF_VOLUME_SPHERE));
  v.position[0] = v.position[1] = v.position[2] = 0.5;
  v.radius = radius;
  return v;
}

static void check_ball(pbf_solver *s, double radius, uint32_t dimension, uint32_t precision) {
  const pbf_volume v = ball_of(radius);
  uint32_t count = 99999, *ids = malloc(2 * COUNT * sizeof *ids), *right = ids + COUNT;
  assert_non_null(ids);
  const uint32_t inside = ids_in_ball(s, radius, dimension, precision, right);
  assert_ok(pbf_find_in_volume(s, &v, COUNT, ids, &count));
  assert_int_equal(count, inside);
  assert_memory_equal(ids, right, inside * sizeof *ids);
  free(ids);
}

/* From none to all: more than room is made for at first, too. */
static void check_found(uint32_t dimension, uint32_t precision) {
  static const double radii[] = {1e-6, 0.05, 0.3, 0.5, 0.9};
  pbf_solver *s = scattered(dimension, precision, COUNT);
  for (int i = 0; i < 5; ++i) check_ball(s, radii[i], dimension, precision);
  assert_ok(pbf_remove_particles(s, 4, (const uint32_t[]){0, 63, 64, COUNT - 1}));
  for (int i = 0; i < 5; ++i) check_ball(s, radii[i], dimension, precision);
  pbf_destroy(s);
}

static void in_balls(void **state) {
  (void)state;
  test_for_each_kind(check_found);
}

/* Drains as many as there may be, each at one particle: these go, those between them stay. */
static void check_drained(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = scattered(dimension, precision, COUNT);
  pbf_volume drains[PBF_MAX_DRAINS];
  uint32_t count, *ids = malloc(COUNT * sizeof *ids);
  double at[3];
  assert_non_null(ids);
  for (uint32_t i = 0; i < PBF_MAX_DRAINS; ++i) {
    drains[i] = ball_of(1e-7);
    assert_ok(pbf_get_positions(s, 40 * i + 7, 1, at));
    for (uint32_t k = 0; k < dimension; ++k) drains[i].position[k] = test_value(at, k, precision);
  }
  assert_ok(pbf_set_drains(s, PBF_MAX_DRAINS, drains));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_count(s, &count));
  assert_int_equal(count, COUNT - PBF_MAX_DRAINS);
  assert_ok(pbf_get_ids(s, 0, count, ids));
  for (uint32_t row = 0, id = 0; row < count; ++row, ++id) {
    while (id % 40 == 7 && id / 40 < PBF_MAX_DRAINS) ++id;
    assert_int_equal(ids[row], id);
  }
  free(ids);
  pbf_destroy(s);
}

static void in_drains(void **state) {
  (void)state;
  test_for_each_kind(check_drained);
}

static void more_than_there_are(void **state) {
  (void)state;
  const pbf_volume v = ball_of(2);
  uint32_t count = 77, ids[FEW];
  if (!test_is_stub()) return;
  pbf_solver *s = scattered(3, PBF_FLOAT32, FEW);
  test_stub_control()->lie = BALLISTIC_FOUND_COUNT;
  assert_fails(pbf_find_in_volume(s, &v, FEW, ids, &count), PBF_ERROR_PLUGIN,
               "found 41 particles of 40");
  assert_int_equal(count, 77);
  test_stub_control();
  assert_ok(pbf_find_in_volume(s, &v, FEW, ids, &count));
  assert_int_equal(count, FEW);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(in_balls),
      cmocka_unit_test(in_drains),
      cmocka_unit_test(more_than_there_are),
  };
  return TEST_RUN(tests);
}
