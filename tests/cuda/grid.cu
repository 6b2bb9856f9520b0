/* The cells of the neighbour search, on the host: neighbours are in the rows around a particle,
 * each in one of them, wherever the domain is wrapped; and fluid spreads over a wrapped domain. */
extern "C" {
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
}

#include <vector>

#include "cuda/grid.h"
#include "support/domains.h"
#include "support/random.h"

namespace {

enum { PAIRS = 20000 };

const uint32_t CELLS_OF_H[] = {1024, 1500, 16024, 31024, 70000, 1000000};

cell_grid grid_of(const test_domain &d, uint32_t limit, double finest) {
  pbf_domain domain = {};
  for (int k = 0; k < PBF_DIM; ++k) {
    domain.lower.c[k] = (pbf_real)d.lower[k];
    domain.upper.c[k] = (pbf_real)(d.lower[k] + d.size[k]);
  }
  const pbf_periods none = {};
  return grid_over(&domain, &none, 1, limit, finest);
}

template <class Visit>
void each_grid(Visit visit) {
  for (const test_domain &d : TEST_DOMAINS)
    for (uint32_t cells : CELLS_OF_H)
      for (uint32_t finest : {1, (int)PBF_FINEST})
        visit(d, grid_of(d, cells * finest, finest), cells * finest);
}

/* Somewhere in the domain; often near its ends, beyond them, or where the numbering turns back. */
pbf_vec random_place(uint64_t *state, const test_domain &d, const cell_grid &g) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) {
    double kind = random_in(state, 0, 1), at = random_in(state, 0, d.size[k]);
    if (kind < 0.2) at = kind < 0.1 ? 0 : d.size[k];
    if (kind < 0.4 && k == 0 && g.turn > 0)
      at = (double)g.turn * floor(random_in(state, 0, d.size[0] / (double)g.turn + 1));
    if (kind < 0.4) at += random_in(state, -1.5, 1.5);
    x.c[k] = (pbf_real)(d.lower[k] + at);
  }
  return x;
}

/* Nearer than h. */
pbf_vec random_neighbor(uint64_t *state, pbf_vec x) {
  for (;;) {
    pbf_vec y, d;
    for (int k = 0; k < PBF_DIM; ++k) y.c[k] = x.c[k] + (pbf_real)random_in(state, -1, 1);
    d = pbf_sub(x, y);
    if (pbf_dot(d, d) < 1) return y;
  }
}

/* In how many of the rows that `reach` names a cell is. */
template <class Reach>
int rows_with(uint32_t cell, Reach reach) {
  int found = 0;
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t first, last;
    if (reach(row, &first, &last)) found += first <= cell && cell <= last;
  }
  return found;
}

void neighbors_are_in_one_row_around(void **) {
  uint64_t state = 1;
  each_grid([&](const test_domain &d, const cell_grid &g, uint32_t) {
    for (int k = 0; k < PAIRS / 20; ++k) {
      pbf_vec x = random_place(&state, d, g), y = random_neighbor(&state, x);
      uint32_t own = grid_cell(g, x), other = grid_cell(g, y);
      grid_view view = grid_look(g, x);
      assert_int_equal(1, rows_with(other, [&](int row, uint32_t *first, uint32_t *last) {
                         return grid_reach(g, view, row, first, last);
                       }));
      assert_int_equal(1, rows_with(other, [&](int row, uint32_t *first, uint32_t *last) {
                         return grid_reach_of_cell(g, own, row, first, last);
                       }));
    }
  });
}

/* Domains that are periodic along all axes. */
const test_domain PERIODIC[] = {
    {{0, 0, 0}, {4, 4, 4}},       {{-3, 2, 1}, {5.3, 4.9, 4.1}}, {{1, 0, -7}, {300, 4.2, 60}},
    {{0, -5, 0}, {4.4, 3000, 9}}, {{0, 0, 0}, {200, 200, 200}},
};

pbf_periods periods_of(const test_domain &d) {
  pbf_periods periods = {};
  periods.any = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    periods.lower.c[k] = (pbf_real)d.lower[k];
    periods.upper.c[k] = (pbf_real)(d.lower[k] + d.size[k]);
    periods.length.c[k] = (pbf_real)d.size[k];
  }
  return periods;
}

/* Anywhere, and often next to a face. */
pbf_vec place_near_faces(uint64_t *state, const test_domain &d) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k) {
    double at = random_in(state, 0, d.size[k]);
    if (random_in(state, 0, 1) < 0.5) at = random_in(state, -1, 1);
    x.c[k] = (pbf_real)(d.lower[k] + (at < 0 ? at + d.size[k] : at));
  }
  return x;
}

/* As lists are made: in how many parts of rows a neighbour is, from an image that is near it. */
int parts_near(const cell_grid &g, pbf_vec x, pbf_vec y) {
  const uint32_t other = grid_cell(g, y);
  int found = 0;
  grid_view view = grid_look(g, x);
  for (int beyond = 0; beyond <= grid_reaches_beyond(g, grid_look(g, x)); ++beyond) {
    if (beyond) view = grid_view_beyond(g, view);
    for (int row = 0; row < PBF_ROWS; ++row) {
      uint32_t first, last;
      if (!grid_reach(g, view, row, &first, &last) || other < first || other > last) continue;
      pbf_vec image = grid_image(g, view, row, x);
      if (beyond)
        image.c[0] += 2 * (x.c[0] - g.origin.c[0]) < g.period.c[0] ? g.period.c[0] : -g.period.c[0];
      const pbf_vec apart = pbf_sub(image, y);
      found += pbf_dot(apart, apart) < 1.001;
    }
  }
  return found;
}

/* As cells are walked. */
int parts_walked(const cell_grid &g, pbf_vec x, pbf_vec y) {
  const uint32_t own = grid_cell(g, x), other = grid_cell(g, y);
  int found = 0;
  for (int row = 0; row < PBF_ROWS; ++row) {
    uint32_t first, last;
    if (!grid_reach_of_cell(g, own, row, &first, &last)) continue;
    found += first <= other && other <= last;
    if (grid_reach_beyond(g, own, &first, &last)) found += first <= other && other <= last;
  }
  return found;
}

void neighbors_beyond_faces_are_met_once(void **) {
  uint64_t state = 6;
  for (const test_domain &d : PERIODIC)
    for (uint32_t cells : CELLS_OF_H) {
      const pbf_periods periods = periods_of(d);
      const pbf_domain domain = {};
      const cell_grid g = grid_over(&domain, &periods, 1, cells, PBF_FINEST);
      assert_in_range(g.count, 1, cells * PBF_FINEST);
      for (int k = 0; k < PAIRS / 20; ++k) {
        const pbf_vec x = place_near_faces(&state, d);
        const pbf_vec y = pbf_image_inside(&periods, random_neighbor(&state, x));
        assert_int_equal(1, parts_near(g, x, y));
        assert_int_equal(1, parts_walked(g, x, y));
      }
    }
}

/* No candidate is met twice. */
void rows_are_apart(void **) {
  uint64_t state = 2;
  each_grid([&](const test_domain &d, const cell_grid &g, uint32_t) {
    for (int k = 0; k < PAIRS / 100; ++k) {
      uint32_t own = grid_cell(g, random_place(&state, d, g)), first[PBF_ROWS], last[PBF_ROWS];
      int rows = 0;
      for (int row = 0; row < PBF_ROWS; ++row)
        if (grid_reach_of_cell(g, own, row, first + rows, last + rows)) ++rows;
      for (int a = 0; a < rows; ++a)
        for (int b = 0; b < a; ++b) assert_true(last[a] < first[b] || last[b] < first[a]);
    }
  });
}

void cells_are_within_the_limit(void **) {
  uint64_t state = 3;
  each_grid([&](const test_domain &d, const cell_grid &g, uint32_t limit) {
    assert_in_range(g.count, 1, limit);
    for (int k = 0; k < PAIRS / 100; ++k) {
      pbf_vec x = random_place(&state, d, g);
      assert_true(grid_cell(g, x) < g.count);
      for (double odd : {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e30}) {
        x.c[k % PBF_DIM] = (pbf_real)odd;
        assert_true(grid_cell(g, x) < g.count);
      }
    }
  });
}

/* Of places as large as a cell, `size` of them along the axes (`finest` times as many along x): how
 * many are in a cell, on an average over the places. */
double sharing(const cell_grid &g, const int size[3], const double at[3], int finest) {
  std::vector<uint32_t> count(g.count);
  double sum = 0;
  int places = finest * size[0] * size[1] * size[2];
  for (int i = 0; i < places; ++i) {
    int row = i / finest / size[0];
    double place[3] = {at[0] + (double)(i - finest * size[0] * row) / finest, at[1] + row % size[1],
                       at[2] + (double)(row / size[1])};
    pbf_vec x;
    for (int k = 0; k < PBF_DIM; ++k) x.c[k] = (pbf_real)place[k];
    sum += 2 * count[grid_cell(g, x)]++ + 1;
  }
  return sum / places;
}

/* 30,000 particles at h = 2 d fill 3,750 cells in three dimensions and 7,500 in two: as a block, as
 * a puddle, as a column and as walls, anywhere in a vast domain. */
void fluid_spreads_over_a_vast_domain(void **) {
#if PBF_DIM == 3
  static const int shapes[][3] = {{16, 15, 16}, {44, 2, 43}, {8, 58, 8}, {4, 30, 31}, {31, 30, 4}};
#else
  static const int shapes[][3] = {{87, 87, 1}, {99, 76, 1}, {76, 99, 1}};
#endif
  uint64_t state = 4;
  for (double size : {1e2, 1e3, 1e4})
    for (int finest : {1, (int)PBF_FINEST}) {
      cell_grid g = grid_of({{0, 0, 0}, {size, size, size}}, finest == 1 ? 31024 : 64096, finest);
      for (const auto &shape : shapes)
        for (int k = 0; k < 50; ++k) {
          double at[3];
          for (int axis = 0; axis < 3; ++axis) at[axis] = random_in(&state, 0, size - shape[axis]);
          double shared = sharing(g, shape, at, finest);
          if (shared > 4.5) fail_msg("%.2f places in a cell", shared);
        }
    }
}

}  // namespace

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbors_are_in_one_row_around),
      cmocka_unit_test(neighbors_beyond_faces_are_met_once),
      cmocka_unit_test(rows_are_apart),
      cmocka_unit_test(cells_are_within_the_limit),
      cmocka_unit_test(fluid_spreads_over_a_vast_domain),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
