/* Rows found by id are those that looking through all of them finds, however ids have gaps. */
#include "common/id_rows.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { MOST = 20000 };

static uint32_t next_random(uint32_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 17;
  return *state ^= *state << 5;
}

/* Asks for each id from some before the first to some after the last, or where these are many, for
 * some beside each. */
static void check(const uint32_t *ids, uint32_t total) {
  pbf_id_rows rows;
  pbf_id_rows_begin(&rows, ids, total);
  for (uint32_t row = 0; row < total; ++row) {
    assert_int_equal(pbf_id_row(&rows, ids[row]), row);
    const uint32_t next = row + 1 < total ? ids[row + 1] : UINT32_MAX;
    if (next - ids[row] > 1) {
      assert_int_equal(pbf_id_row(&rows, ids[row] + 1), total);
      assert_int_equal(pbf_id_row(&rows, next - (next < UINT32_MAX)), total);
      assert_int_equal(pbf_id_row(&rows, ids[row] + (next - ids[row]) / 2), total);
    }
  }
  if (total > 0 && ids[0] > 0) {
    assert_int_equal(pbf_id_row(&rows, 0), total);
    assert_int_equal(pbf_id_row(&rows, ids[0] - 1), total);
  }
}

static uint32_t ids[MOST];

/* `first`, and then one in `keep` of 256, from which `hole` on `without` are left out. */
static uint32_t fill(uint32_t total, uint32_t first, uint32_t keep, uint32_t hole,
                     uint32_t without) {
  uint32_t state = 7, id = first;
  for (uint32_t row = 0; row < total; ++row, ++id) {
    while (next_random(&state) % 256 >= keep) ++id;
    if (row == hole) id += without;
    ids[row] = id;
  }
  return total;
}

static void rows_are_found(void **state) {
  static const uint32_t totals[] = {1, 2, 3, 7, 100, 5000, MOST};
  (void)state;
  for (uint32_t i = 0; i < sizeof totals / sizeof *totals; ++i) {
    const uint32_t total = totals[i];
    check(ids, fill(total, 0, 256, total, 0));                     /* all */
    check(ids, fill(total, 100, 250, total, 0));                   /* few gone */
    check(ids, fill(total, 5, 10, total / 3, 0));                  /* most gone */
    check(ids, fill(total, 0, 256, total / 2, 700));               /* a block gone */
    check(ids, fill(total, 3, 200, total / 2, UINT32_C(1) << 31)); /* a long time between */
    check(ids, fill(total, UINT32_MAX - 2 * total, 256, total, 0));
  }
}

static void none_and_all(void **state) {
  pbf_id_rows rows;
  (void)state;
  pbf_id_rows_begin(&rows, ids, 0);
  assert_int_equal(pbf_id_row(&rows, 0), 0);
  pbf_id_rows_begin(&rows, NULL, 40);
  assert_int_equal(pbf_id_row(&rows, 17), 17);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rows_are_found),
                                     cmocka_unit_test(none_and_all)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
