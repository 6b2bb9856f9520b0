/* The CPU solver's cells: neighbours are in the rows around a particle, each in one of them,
 * wherever the grid is wrapped; and fluid does not share its cells with itself because of a drop
 * far away. */
#include "support.h"

#include "cpu/grid.h"
#include "support/domains.h"
#include "support/random.h"

enum { PAIRS = 500 };

static const uint64_t limits[] = {100, 1026, 2048, 60000, 1000000};

static grid grid_of(const test_domain *b, uint64_t limit) {
  int axis[PBF_DIM];
  pbf_vec low, high;
  grid_axes(b->size, axis);
  for (int k = 0; k < PBF_DIM; ++k) {
    low.c[k] = b->lower[k];
    high.c[k] = b->lower[k] + b->size[k];
  }
  return grid_around(axis, low, high, 1, limit);
}

static uint32_t cell_of(const grid *g, pbf_vec x) {
  return grid_cell(g, grid_vec(g->axis, x), grid_is_wrapped(g));
}

/* In the box or, often, at an end of it or where the numbering of columns turns back. */
static pbf_vec random_place(uint64_t *state, const test_domain *b, const grid *g) {
  double turn = (double)g->cells[0] / g->inv_width[0];
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) {
    double kind = random_in(state, 0, 1), at = random_in(state, 0, b->size[k]);
    if (kind < 0.2) at = kind < 0.1 ? 0 : b->size[k];
    if (kind < 0.4 && k == g->axis[0]) at = turn * floor(at / turn + 0.5);
    if (kind < 0.4) at += random_in(state, -1.5, 1.5);
    x.c[k] = b->lower[k] + at;
  }
  return x;
}

static pbf_vec random_neighbor(uint64_t *state, pbf_vec x) {
  pbf_vec y, d;
  do {
    for (int k = 0; k < PBF_DIM; ++k) y.c[k] = x.c[k] + random_in(state, -1, 1);
    d = pbf_sub(x, y);
  } while (pbf_dot(d, d) >= 1);
  return y;
}

static uint32_t row_around(const grid *g, uint32_t row, int number) {
  uint32_t at[PBF_DIM], image = 0;
  grid_row_indices(g, row, at);
  return grid_row_around(g, at, number, &image);
}

/* As the search looks from a cell. */
static int rows_with(const grid *g, uint32_t from, uint32_t cell) {
  uint32_t column = from % g->cells[0], row = from / g->cells[0];
  uint32_t left = column > g->reach ? column - g->reach : 0, right = column + g->reach;
  int found = 0;
  for (int k = 0; k < GRID_ROWS_AROUND; ++k)
    if (cell / g->cells[0] == row_around(g, row, k))
      found += left <= cell % g->cells[0] && cell % g->cells[0] <= right;
  return found;
}

static void neighbors_are_in_one_row_around(void **unused) {
  uint64_t state = 1;
  (void)unused;
  for (size_t b = 0; b < sizeof TEST_DOMAINS / sizeof *TEST_DOMAINS; ++b)
    for (size_t l = 0; l < sizeof limits / sizeof *limits; ++l) {
      grid g = grid_of(&TEST_DOMAINS[b], limits[l]);
      assert_in_range(g.total, 1, limits[l]);
      for (int k = 0; k < PAIRS; ++k) {
        pbf_vec x = random_place(&state, &TEST_DOMAINS[b], &g), y = random_neighbor(&state, x);
        uint32_t own = cell_of(&g, x), other = cell_of(&g, y);
        assert_true(own < g.total && other < g.total);
        assert_int_equal(rows_with(&g, own, other), 1);
      }
    }
}

static void rows_around_are_different_ones(void **unused) {
  uint64_t state = 2;
  (void)unused;
  for (size_t b = 0; b < sizeof TEST_DOMAINS / sizeof *TEST_DOMAINS; ++b)
    for (size_t l = 0; l < sizeof limits / sizeof *limits; ++l) {
      grid g = grid_of(&TEST_DOMAINS[b], limits[l]);
      for (int k = 0; k < PAIRS / 10; ++k) {
        uint32_t row = cell_of(&g, random_place(&state, &TEST_DOMAINS[b], &g)) / g.cells[0];
        for (int one = 0; one < GRID_ROWS_AROUND; ++one)
          for (int two = 0; two < one; ++two)
            if (row_around(&g, row, one) != GRID_NO_ROW)
              assert_int_not_equal(row_around(&g, row, one), row_around(&g, row, two));
      }
    }
}

/* A block of 30,000 particles at h = 2 d, and one more particle in a far corner of the box. */
static void a_drop_far_away_crowds_nobody(void **unused) {
  enum { SIDE = PBF_DIM == 3 ? 15 : 86, LIMIT = 61024 };
  static uint32_t count[LIMIT];
  (void)unused;
  for (double size = 100; size < 2e5; size *= 3) {
    test_domain box = {{0, 0, 0}, {2 * size, size, 3 * size}};
    grid g = grid_of(&box, LIMIT);
    double sum = 0, places = 0;
    memset(count, 0, sizeof count);
    for (int i = 0; i < SIDE * SIDE * (PBF_DIM == 3 ? SIDE : 1); ++i) {
      int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
      pbf_vec x;
      for (int k = 0; k < PBF_DIM; ++k) x.c[k] = 0.1 + at[k] * (1 + 1e-5 * size);
      sum += 2 * count[cell_of(&g, x)]++ + 1;
      ++places;
    }
    if (sum > 2 * places) fail_msg("box %g: %g places in a cell", size, sum / places);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbors_are_in_one_row_around),
      cmocka_unit_test(rows_around_are_different_ones),
      cmocka_unit_test(a_drop_far_away_crowds_nobody),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
