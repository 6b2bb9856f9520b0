/* Coarser levels of the pressure grid against P' A P by brute force, where A is what the residual
 * of the grid's equations says, and a correction against the best one. */
#include "support.h"

#include "physics/pressure_grid/coarse.h"

enum { NODES = 1024, LENGTH = NODES + 200 };

static pbf_pressure_grid grid;
static double free_volumes[LENGTH], inverse[LENGTH];
static uint8_t moves[LENGTH];

static uint32_t strides(int axis) { return grid.corner[1u << axis]; }

/* Cells of all kinds, some without room, and nodes of which some are in the open or held. */
static void make_grid(const int n[PBF_DIM]) {
  uint32_t random = 7;
  memset(&grid, 0, sizeof grid);
  memset(free_volumes, 0, sizeof free_volumes);
  memset(inverse, 0, sizeof inverse);
  memset(moves, 0, sizeof moves);
  grid.nodes = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    grid.n[k] = n[k];
    for (int a = 0; a < PBF_CORNERS; ++a) grid.corner[a] += (uint32_t)(a >> k & 1) * grid.nodes;
    grid.size[k] = (uint32_t)n[k] + 2;
    grid.nodes *= grid.size[k];
  }
  assert_true(grid.nodes <= NODES);
  for (uint32_t cell = 0; cell < grid.nodes; ++cell) {
    int i[PBF_DIM], inside = 1;
    pbf_pressure_grid_place(&grid, cell, i);
    for (int k = 0; k < PBF_DIM; ++k) inside = inside && i[k] >= 1 && i[k] <= n[k];
    const double volume = 1.2 * next_random(&random) - 0.1;
    if (inside) free_volumes[cell] = volume < 0 ? 0 : volume > 1 ? 1 : volume;
  }
  for (uint32_t node = 0; node < grid.nodes; ++node) {
    double around[PBF_CORNERS], sum = 0;
    if (node < grid.corner[PBF_CORNERS - 1]) continue;
    pbf_pressure_grid_around(&grid, free_volumes, node, around);
    for (int a = 0; a < PBF_CORNERS; ++a) sum += around[a];
    const double surface = next_random(&random) < 0.2 ? next_random(&random) : 0;
    const double open = next_random(&random), held = next_random(&random);
    if (sum < 0.1 || open < 0.15) continue;
    inverse[node] =
        1 / (PBF_PRESSURE_GRID_STIFFNESS * PBF_PRESSURE_GRID_STIFFNESS_OWN * sum + surface);
    moves[node] = held > 0.1;
  }
}

/* A times values that are 0 where nothing moves. */
static void multiply_grid(const double *values, double *product) {
  for (uint32_t node = 0; node < LENGTH; ++node) {
    double around[PBF_CORNERS];
    product[node] = 0;
    if (!moves[node]) continue;
    pbf_pressure_grid_around(&grid, free_volumes, node, around);
    const double surface = pbf_pressure_grid_surface_of(around, inverse[node]);
    product[node] = -pbf_pressure_grid_residual(&grid, around, values, 0, surface, node);
  }
}

/* What the coarse node, the I-th, counts on the finer level of n cells. */
static double share_of(const int I[PBF_DIM], const int i[PBF_DIM], const int n[PBF_DIM]) {
  double share = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int away = abs(i[k] - (2 * I[k] - 1));
    share *= i[k] < 1 || i[k] > n[k] + 1 || away > 1 ? 0 : 1 - 0.5 * away;
  }
  return share;
}

static void interpolate_to_grid(const int I[PBF_DIM], double *values) {
  memset(values, 0, LENGTH * sizeof *values);
  for (uint32_t node = 0; node < grid.nodes; ++node) {
    int i[PBF_DIM];
    pbf_pressure_grid_place(&grid, node, i);
    if (moves[node]) values[node] = share_of(I, i, grid.n);
  }
}

static int neighbor(const pbf_coarse_level *l, const int I[PBF_DIM], int k, int J[PBF_DIM]) {
  int inside = 1;
  for (int axis = 0; axis < PBF_DIM; ++axis) {
    J[axis] = I[axis] + pbf_around_offset(k, axis);
    inside = inside && J[axis] >= 1 && J[axis] <= l->n[axis] + 1;
  }
  return inside;
}

static float level_memory[2][PBF_COARSE_ARRAYS * LENGTH];

/* A level's memory, and its stencils by the functions under test. */
template <class Row>
static pbf_coarse_level make_level(int which, const int n[PBF_DIM], const uint32_t stride[PBF_DIM],
                                   Row row_of) {
  pbf_coarse_level l = pbf_coarse_level_of(n);
  assert_true(l.length <= LENGTH);
  memset(level_memory[which], 0, sizeof level_memory[which]);
  l.stencil = level_memory[which];
  float **const arrays[] = {&l.inverse, &l.right, &l.now, &l.before};
  for (int k = 0; k < 4; ++k) *arrays[k] = l.stencil + (PBF_STENCIL + k) * l.length;
  for (uint32_t node = 0; node < l.nodes; ++node) {
    int I[PBF_DIM];
    if (!pbf_coarse_place(&l, node, I)) continue;
    for (int from = 0; from < PBF_AROUND; ++from) {
      const pbf_finer_node finer = pbf_finer_node_of(I, from, n);
      uint32_t index = 0;
      for (int k = 0; k < PBF_DIM; ++k) index += (uint32_t)finer.at[k] * stride[k];
      if (!(finer.weight > 0)) continue;
      const pbf_coarse_row part = pbf_galerkin_part(I, &finer, n, row_of(index));
      for (int k = 0; k < PBF_STENCIL; ++k)
        l.stencil[k * l.length + node] += part.of[PBF_AROUND / 2 + k];
    }
  }
  for (uint32_t node = 0; node < l.nodes; ++node) {
    int I[PBF_DIM];
    if (pbf_coarse_place(&l, node, I)) l.inverse[node] = pbf_coarse_inverse(&l, node);
  }
  return l;
}

static pbf_coarse_level first_level(void) {
  uint32_t stride[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) stride[k] = strides(k);
  return make_level(0, grid.n, stride, [](uint32_t node) {
    return moves[node] ? pbf_row_of_grid(&grid, free_volumes, inverse, moves, node)
                       : pbf_coarse_row{};
  });
}

static void the_first_level_is_that_of_the_grid(void **state) {
  (void)state;
  const int n[] = {7, 6, 5};
  static double of_one[LENGTH], product[LENGTH], of_other[LENGTH];
  make_grid(n);
  const pbf_coarse_level l = first_level();
  uint32_t compared = 0;
  for (uint32_t node = 0; node < l.nodes; ++node) {
    int I[PBF_DIM], J[PBF_DIM];
    if (!pbf_coarse_place(&l, node, I)) continue;
    interpolate_to_grid(I, of_one);
    multiply_grid(of_one, product);
    for (int k = 0; k < PBF_AROUND; ++k) {
      if (!neighbor(&l, I, k, J)) continue;
      double expected = 0;
      interpolate_to_grid(J, of_other);
      for (uint32_t i = 0; i < LENGTH; ++i) expected += of_other[i] * product[i];
      assert_near((double)pbf_coarse_between(&l, node, k), expected, 2e-6);
      compared += expected != 0;
    }
  }
  assert_true(compared > 100);
}

static void the_next_level_is_that_of_the_first(void **state) {
  (void)state;
  const int n[] = {7, 6, 5};
  make_grid(n);
  const pbf_coarse_level f = first_level();
  const pbf_coarse_level l =
      make_level(1, f.n, f.stride, [&](uint32_t node) { return pbf_row_of_level(&f, node); });
  for (uint32_t node = 0; node < l.nodes; ++node) {
    int I[PBF_DIM], J[PBF_DIM], i[PBF_DIM], j[PBF_DIM];
    if (!pbf_coarse_place(&l, node, I)) continue;
    for (int k = 0; k < PBF_AROUND; ++k) {
      if (!neighbor(&l, I, k, J)) continue;
      double expected = 0;
      for (uint32_t a = 0; a < f.nodes; ++a)
        for (int b = 0; pbf_coarse_place(&f, a, i) && b < PBF_AROUND; ++b)
          if (neighbor(&f, i, b, j))
            expected +=
                share_of(I, i, f.n) * (double)pbf_coarse_between(&f, a, b) * share_of(J, j, f.n);
      assert_near((double)pbf_coarse_between(&l, node, k), expected, 4e-6);
    }
  }
}

/* The right side of the level, and its correction on the grid, are P' and P. */
static void values_go_down_and_up(void **state) {
  (void)state;
  const int n[] = {7, 6, 5};
  double values[LENGTH];
  uint32_t random = 3, stride[PBF_DIM];
  make_grid(n);
  pbf_coarse_level l = first_level();
  for (int k = 0; k < PBF_DIM; ++k) stride[k] = strides(k);
  for (uint32_t i = 0; i < LENGTH; ++i) values[i] = next_random(&random);
  double below = 0, above = 0;
  for (uint32_t node = 0; node < l.nodes; ++node) {
    int I[PBF_DIM], i[PBF_DIM];
    if (!pbf_coarse_place(&l, node, I)) continue;
    double expected = 0;
    for (uint32_t fine = 0; fine < grid.nodes; ++fine) {
      pbf_pressure_grid_place(&grid, fine, i);
      expected += share_of(I, i, n) * values[fine];
    }
    const float found =
        pbf_restricted(I, n, stride, [&](uint32_t fine) { return (float)values[fine]; });
    assert_near((double)found, expected, 1e-5);
    l.now[node] = (float)next_random(&random);
    below += expected * (double)l.now[node];
  }
  for (uint32_t fine = 0; fine < grid.nodes; ++fine) {
    int i[PBF_DIM];
    pbf_pressure_grid_place(&grid, fine, i);
    int inside = 1;
    for (int k = 0; k < PBF_DIM; ++k) inside = inside && i[k] > 0;
    if (inside) above += values[fine] * (double)pbf_interpolated(&l, i, l.now);
  }
  assert_near(above, below, 1e-4);
}

/* Iterations of a level go to its solution, and leave hardly anything of a short wave. */
static void a_level_is_solved(void **state) {
  (void)state;
  const int n[] = {7, 6, 5};
  uint32_t random = 5;
  make_grid(n);
  pbf_coarse_level l = first_level();
  for (uint32_t node = 0; node < l.nodes; ++node)
    if (l.inverse[node] > 0) l.right[node] = (float)next_random(&random) - 0.5f;
  pbf_pressure_grid_solve solve = pbf_coarsest_solve();
  double first = 0, last = 0;
  for (int k = 0; k < 200; ++k) {
    double missing = 0;
    for (uint32_t node = 0; node < l.nodes; ++node) {
      if (!(l.inverse[node] > 0)) continue;
      float left = 0;
      for (int b = 0; b < PBF_AROUND; ++b)
        left +=
            pbf_coarse_between(&l, node, b) * l.now[(uint32_t)(node + pbf_coarse_offset(&l, b))];
      missing += pow((double)(l.right[node] - left), 2);
      const pbf_coarse_equation e = pbf_coarse_equation_of(&l, node);
      l.before[node] =
          pbf_coarse_next(&l, &e, (float)solve.step, (float)solve.weight, l.now, l.before, node);
    }
    (k == 0 ? first : last) = sqrt(missing);
    pbf_pressure_grid_solve_go_on(&solve, k);
    float *other = l.now;
    l.now = l.before;
    l.before = other;
  }
  if (!(last < 1e-3 * first)) fail_msg("%g is left of %g", last, first);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_first_level_is_that_of_the_grid),
      cmocka_unit_test(the_next_level_is_that_of_the_first),
      cmocka_unit_test(values_go_down_and_up),
      cmocka_unit_test(a_level_is_solved),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
