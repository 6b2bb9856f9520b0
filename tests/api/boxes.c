/* Particles in boxes, against what their positions say. */
#include "support.h"

enum { COUNT = 100, CAPACITY = 128 };

typedef struct box {
  double lower[3], upper[3];
} box;

static int is_inside(const box *b, const void *x, uint32_t row, uint32_t dimension,
                     uint32_t precision) {
  for (uint32_t k = 0; k < dimension; ++k) {
    const double at = test_value(x, (uint64_t)row * dimension + k, precision);
    if (at < b->lower[k] || at > b->upper[k]) return 0;
  }
  return 1;
}

static uint32_t ids_by_hand(pbf_solver *s, const box *b, uint32_t dimension, uint32_t precision,
                            int outside, uint32_t *ids) {
  double x[3 * CAPACITY];
  uint32_t all[CAPACITY], count, found = 0;
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_get_ids(s, 0, count, all));
  for (uint32_t row = 0; row < count; ++row)
    if (is_inside(b, x, row, dimension, precision) != outside) ids[found++] = all[row];
  return found;
}

static void check_found(pbf_solver *s, const box *b, uint32_t dimension, uint32_t precision) {
  uint32_t expected[CAPACITY], ids[CAPACITY], count = 99999;
  const uint32_t inside = ids_by_hand(s, b, dimension, precision, 0, expected);
  assert_ok(pbf_find_in_box(s, b->lower, b->upper, CAPACITY, ids, &count));
  assert_int_equal(count, inside);
  assert_memory_equal(ids, expected, inside * sizeof *ids);
  count = 99999;
  assert_ok(pbf_find_in_box(s, b->lower, b->upper, 0, NULL, &count));
  assert_int_equal(count, inside);
  if (inside < 3) return;
  memset(ids, 0xff, sizeof ids);
  assert_ok(pbf_find_in_box(s, b->lower, b->upper, 2, ids, &count));
  assert_int_equal(count, inside);
  assert_memory_equal(ids, expected, 2 * sizeof *ids);
  assert_int_equal(ids[2], UINT32_MAX);
}

static void check_removed(pbf_solver *s, const box *b, uint32_t dimension, uint32_t precision) {
  uint32_t inside[CAPACITY], others[CAPACITY], ids[CAPACITY], count = 99999, left;
  double before[3 * CAPACITY], after[3 * CAPACITY];
  const uint32_t going = ids_by_hand(s, b, dimension, precision, 0, inside);
  const uint32_t staying = ids_by_hand(s, b, dimension, precision, 1, others);
  const size_t row_bytes = (size_t)dimension * precision;
  uint32_t all[CAPACITY];
  assert_ok(pbf_get_ids(s, 0, going + staying, all));
  assert_ok(pbf_get_positions(s, 0, going + staying, before));
  assert_ok(pbf_remove_in_box(s, b->lower, b->upper, &count));
  assert_int_equal(count, going);
  assert_ok(pbf_get_count(s, &left));
  assert_int_equal(left, staying);
  assert_ok(pbf_get_ids(s, 0, left, ids));
  assert_memory_equal(ids, others, left * sizeof *ids);
  assert_ok(pbf_get_positions(s, 0, left, after));
  for (uint32_t i = 0, row = 0; i < left; ++i, ++row) {
    while (all[row] != ids[i]) ++row;
    assert_memory_equal((char *)after + i * row_bytes, (char *)before + row * row_bytes, row_bytes);
  }
}

/* A particle in the middle is where faces of one box and a corner of another lie. */
static void check_boxes(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_filled(dimension, precision, COUNT, CAPACITY);
  double x[3 * CAPACITY];
  box faces = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}}, corner = faces;
  const box all = faces;
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_get_positions(s, 0, COUNT, x));
  for (uint32_t k = 0; k < dimension; ++k)
    corner.lower[k] = test_value(x, (COUNT / 2) * dimension + k, precision);
  faces.lower[0] = test_value(x, (COUNT / 2) * dimension, precision);
  faces.upper[0] = faces.lower[0] + 0.11;
  if (dimension == 2) faces.lower[2] = corner.lower[2] = NAN; /* which is not looked at */
  check_found(s, &faces, dimension, precision);
  check_found(s, &corner, dimension, precision);
  check_found(s, &all, dimension, precision);
  assert_ok(pbf_remove_particles(s, 3, (const uint32_t[]){2, 50, 98}));
  check_found(s, &faces, dimension, precision);
  check_removed(s, &faces, dimension, precision);
  check_removed(s, &faces, dimension, precision); /* nothing is left in it */
  assert_ok(pbf_step(s, 1));
  check_found(s, &corner, dimension, precision);
  check_removed(s, &all, dimension, precision);
  check_found(s, &all, dimension, precision);
  pbf_destroy(s);
}

static void boxes(void **state) {
  (void)state;
  test_for_each_kind(check_boxes);
}

/* As by their ids. */
static void check_same(uint32_t dimension, uint32_t precision) {
  const box lower_part = {{-1, -1, -1}, {0.45, 2, 2}};
  pbf_solver *by_box = test_filled(dimension, precision, COUNT, CAPACITY);
  pbf_solver *by_ids = test_filled(dimension, precision, COUNT, CAPACITY);
  uint32_t ids[CAPACITY], count;
  assert_ok(pbf_step(by_box, 2));
  assert_ok(pbf_step(by_ids, 2));
  assert_ok(pbf_find_in_box(by_ids, lower_part.lower, lower_part.upper, CAPACITY, ids, &count));
  assert_true(count > 0 && count < COUNT);
  assert_ok(pbf_remove_particles(by_ids, count, ids));
  assert_ok(pbf_remove_in_box(by_box, lower_part.lower, lower_part.upper, NULL));
  assert_ok(pbf_step(by_box, 2));
  assert_ok(pbf_step(by_ids, 2));
  assert_true(test_hash(by_box) == test_hash(by_ids));
  pbf_destroy(by_box);
  pbf_destroy(by_ids);
}

static void removed_as_by_ids(void **state) {
  (void)state;
  test_for_each_kind(check_same);
}

static void refusals(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  const uint64_t before = test_hash(s);
  box b = {{0, 0, 0}, {1, 1, 1}};
  uint32_t ids[4], count = 7;
  const pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;
  pbf_view view = {.struct_size = sizeof view};
  assert_fails(pbf_find_in_box(s, NULL, b.upper, 4, ids, &count), bad, "lower is null");
  assert_fails(pbf_remove_in_box(s, b.lower, NULL, &count), bad, "upper is null");
  assert_fails(pbf_find_in_box(s, b.lower, b.upper, 4, NULL, &count), bad, "ids is null");
  assert_fails(pbf_find_in_box(s, b.lower, b.upper, 4, ids, NULL), bad, "count is null");
  b.upper[1] = -1;
  assert_fails(pbf_find_in_box(s, b.lower, b.upper, 4, ids, &count), bad,
               "lower[1] is 0 and upper[1] -1");
  b.upper[1] = NAN;
  assert_fails(pbf_remove_in_box(s, b.lower, b.upper, &count), bad, "upper[1] NaN");
  b.upper[1] = 1;
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_fails(pbf_remove_in_box(s, b.lower, b.upper, &count), PBF_ERROR_STATE, "mapped");
  assert_int_equal(count, 7);
  assert_ok(pbf_find_in_box(s, b.lower, b.upper, 4, ids, &count));
  assert_ok(pbf_unmap(s, PBF_FIELD_POSITION));
  assert_true(test_hash(s) == before);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes),
      cmocka_unit_test(removed_as_by_ids),
      cmocka_unit_test(refusals),
  };
  return TEST_RUN(tests);
}
