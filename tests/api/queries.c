/* Density, velocity and pressure at points and on grids, against closed forms of lattices. */
#include "query_scene.h"

/* From the floor to a spacing above the surface: fields go on as they are, density is 1 inside. */
static void check_points(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, slope, 1);
  double x[POINTS * 3], density[POINTS], v[POINTS * 3];
  uint8_t wet[POINTS];
  uint32_t seed = 7;
  for (uint32_t i = 0; i < POINTS * dimension; ++i)
    x[i] =
        i % dimension == 1 ? random_in(&seed, 0, level + 0.5 * d) : random_in(&seed, 0, SIDE * d);
  const pbf_samples samples = {.struct_size = sizeof samples,
                               .count = POINTS,
                               .points = x,
                               .densities = density,
                               .velocities = v,
                               .wet = wet};
  assert_ok(pbf_sample(p.solver, &samples));
  for (uint32_t i = 0; i < POINTS; ++i) {
    double inside = INFINITY; /* how far from where the lattice ends */
    for (uint32_t k = 0; k < dimension; ++k) {
      const double end = k == 1 ? level : SIDE * d, at = x[i * dimension + k];
      inside = fmin(inside, fmin(at, end - at));
      const double right = linear(k, x + i * dimension, dimension, slope);
      if (!(fabs(v[i * dimension + k] - right) < (precision == PBF_FLOAT64 ? 1e-9 : 1e-4)))
        fail_msg("velocity %u[%u] is %.9g, not %.9g", i, k, v[i * dimension + k], right);
    }
    if (inside >= 3 * d && !(fabs(density[i] - 1) < 0.01))
      fail_msg("density %u is %.9g, not 1", i, density[i]);
    assert_int_equal(wet[i], density[i] >= 0.5);
  }
  pbf_destroy(p.solver);
}

static void linear_fields_and_density(void **state) {
  (void)state;
  test_for_each_kind(check_points);
}

/* Wendland's C2 of 2D and 3D as its paper has it, summed over two particles and one. */
static void check_sparse(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, 8);
  pbf_params params = test_params();
  params.domain_max[0] = 8000;
  pbf_solver *s = test_create(&desc, &params);
  double raw[9] = {0}, density[4], v[12], raw_v[9] = {0};
  const double places[3][3] = {{0.5, 0.5, 0.5}, {0.5625, 0.5, 0.5}, {4096, 0.5, 0.5}};
  for (uint32_t i = 0; i < 3 * dimension; ++i) {
    test_put(raw, i, precision, places[i / dimension][i % dimension]);
    test_put(raw_v, i, precision, i / dimension + 1);
  }
  assert_ok(pbf_add_particles(s, 3, raw, raw_v, NULL));
  const double points[4][3] = {
      {0.53125, 0.5, 0.5}, {4096, 0.53125, 0.5}, {0.7, 0.7, 0.5}, {3000, 0.5, 0.5}};
  double x[12];
  for (uint32_t i = 0; i < 4 * dimension; ++i) x[i] = points[i / dimension][i % dimension];
  assert_ok(pbf_sample(s, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                         .count = 4,
                                         .points = x,
                                         .densities = density,
                                         .velocities = v}));
  const double pi = acos(-1.0), r = 3 * d, q = 0.03125 / r;
  const double norm = dimension == 3 ? 21 / (2 * pi * r * r * r) : 7 / (pi * r * r);
  const double w = pow(d, dimension) * norm * pow(1 - q, 4) * (1 + 4 * q);
  assert_true(fabs(density[0] - 2 * w) < 1e-9 && fabs(density[1] - w) < 1e-9);
  assert_true(density[2] == 0 && density[3] == 0);
  assert_true(fabs(v[0] - 1.5) < 1e-9 && fabs(v[dimension] - 3) < 1e-9);
  assert_true(v[2 * dimension] == 0 && v[3 * dimension] == 0);
  pbf_destroy(s);
}

static void few_and_far(void **state) {
  (void)state;
  test_for_each_kind(check_sparse);
}

/* The same numbers as at the same points given one by one. */
static void check_grid(uint32_t dimension, uint32_t precision) {
  enum { N0 = 5, N1 = 6, N2 = 4 };
  const pool p = pool_of(dimension, precision, slope, 1);
  const pbf_sample_grid grid = {
      sizeof grid, {N0, N1, dimension == 3 ? N2 : 77}, {0.1, 0.2, 0.15}, {0.1, 0.075, 0.05}};
  const uint32_t depth = dimension == 3 ? N2 : 1, count = N0 * N1 * depth;
  double x[N0 * N1 * N2 * 3], density[2][N0 * N1 * N2], v[2][N0 * N1 * N2 * 3];
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i / depth / N1, i / depth % N1, i % depth};
    for (uint32_t k = 0; k < dimension; ++k)
      x[i * dimension + k] = grid.origin[k] + at[k] * grid.step[k];
  }
  pbf_samples samples = {.struct_size = sizeof samples,
                         .count = count,
                         .points = x,
                         .densities = density[0],
                         .velocities = v[0]};
  assert_ok(pbf_sample(p.solver, &samples));
  samples.points = NULL;
  samples.densities = density[1];
  samples.velocities = v[1];
  assert_ok(pbf_sample_on_grid(p.solver, &grid, &samples));
  assert_memory_equal(density[0], density[1], count * sizeof **density);
  assert_memory_equal(v[0], v[1], count * dimension * sizeof **v);
  pbf_destroy(p.solver);
}

static void grids(void **state) {
  (void)state;
  test_for_each_kind(check_grid);
}

/* rho g depth below the surface, and the height that the volume has over the floor. */
static void check_settled(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return; /* without a fluid */
  enum { DEPTHS = 5 };
  const pool p = pool_of(dimension, precision, still, 1);
  pbf_params params = {.struct_size = sizeof params};
  double x[DEPTHS * 3], pressure[DEPTHS], surface;
  assert_ok(pbf_get_params(p.solver, &params));
  params.time_step = 1.0 / 480;
  params.iterations = 8;
  params.viscosity = 0.02;
  params.shear_stress_correction =
      0; /* with it pressures themselves are short by 0.65 d of depth */
  assert_ok(pbf_set_params(p.solver, &params));
  assert_ok(pbf_step(p.solver, 960));
  for (uint32_t i = 0; i < DEPTHS * dimension; ++i)
    x[i] = i % dimension == 1 ? (3.5 + 1.5 * (i / dimension)) * d : (6 + 0.3 * (i / dimension)) * d;
  assert_ok(pbf_get_levels(p.solver, 1, x, &surface));
  assert_near(surface, level, 0.5 * d, "the level");
  assert_ok(pbf_sample(p.solver, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                                .count = DEPTHS,
                                                .points = x,
                                                .pressures = pressure}));
  for (uint32_t i = 0; i < DEPTHS; ++i)
    assert_near(pressure[i], 9.81 * (level - x[i * dimension + 1]),
                0.02 * 9.81 * (level - x[i * dimension + 1]), "pressure");
  pbf_destroy(p.solver);
}

static void a_settled_tank(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_settled);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_fields_and_density),
      cmocka_unit_test(few_and_far),
      cmocka_unit_test(grids),
      cmocka_unit_test(a_settled_tank),
  };
  return TEST_RUN(tests);
}
