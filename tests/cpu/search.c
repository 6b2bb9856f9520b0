/* The neighbour search against all pairs: numbers of neighbours, and densities, in which one lost
 * or doubled neighbour shows. */
#include "cpu_support.h"

enum { MOST = 4000 };

typedef struct cloud {
  uint32_t dimension, precision, count;
  double h;
  double lower, upper[3]; /* the domain */
  double x[3 * MOST];
} cloud;

static double distance2(const cloud *c, uint32_t i, uint32_t j) {
  double r2 = 0;
  for (uint32_t k = 0; k < c->dimension; ++k) {
    double d = c->x[i * c->dimension + k] - c->x[j * c->dimension + k];
    r2 += d * d;
  }
  return r2;
}

/* Wendland C2 (1995) with unit volume. */
static double kernel(const cloud *c, double r) {
  double q = r / c->h, u = 1 - q;
  double norm =
      c->dimension == 2 ? 7 / (acos(-1) * c->h * c->h) : 21 / (2 * acos(-1) * c->h * c->h * c->h);
  return q < 1 ? norm * u * u * u * u * (4 * q + 1) : 0;
}

/* What the solver holds: positions rounded to its precision. */
static void round_positions(cloud *c) {
  for (uint32_t i = 0; i < c->count * c->dimension && c->precision == PBF_FLOAT32; ++i)
    c->x[i] = (float)c->x[i];
}

static pbf_params params_for(const cloud *c) {
  pbf_params params = test_params();
  params.smoothing_radius = c->h;
  params.spacing = 0.5 * c->h;
  params.particle_volume = pow(c->h, c->dimension);
  params.wall_density = 0;
  for (uint32_t k = 0; k < c->dimension; ++k) {
    params.domain_min[k] = c->lower;
    params.domain_max[k] = c->upper[k];
  }
  return params;
}

static void check(cloud *c, const char *backend, uint32_t threads) {
  round_positions(c);
  pbf_params params = params_for(c);
  pbf_desc desc = cpu_desc(backend, c->dimension, c->precision, MOST, threads);
  pbf_solver *solver = test_create(&desc, &params);
  cpu_add(solver, c->precision, c->dimension, c->count, c->x, NULL);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(solver, &stats));
  double *densities = cpu_get(solver, PBF_FIELD_DENSITY);
  const double epsilon = c->precision == PBF_FLOAT32 ? 3e-5 : 1e-11;
  uint64_t sure = 0, unsure = 0; /* pairs clearly within h; pairs at h to rounding */
  uint32_t most = 0;
  for (uint32_t i = 0; i < c->count; ++i) {
    double density = 0;
    uint32_t neighbors = 0;
    for (uint32_t j = 0; j < c->count; ++j) {
      double r = sqrt(distance2(c, i, j));
      density += kernel(c, r);
      if (j == i) continue;
      neighbors += r < c->h;
      sure += r < c->h * (1 - 1e-6);
      unsure += fabs(r - c->h) <= 1e-6 * c->h;
    }
    if (neighbors > most) most = neighbors;
    density *= params.particle_volume;
    assert_true(fabs(densities[i] - density) <= epsilon * density);
  }
  double found = stats.neighbors_mean * c->count;
  assert_true(found > (double)sure - 0.5 && found < (double)(sure + unsure) + 0.5);
  if (!unsure) assert_int_equal(stats.neighbors_max, most);
  free(densities);
  pbf_destroy(solver);
}

static cloud *new_cloud(uint32_t dimension, uint32_t precision, double h, double lower, double x,
                        double y, double z) {
  cloud *c = calloc(1, sizeof *c);
  assert_non_null(c);
  *c = (cloud){
      .dimension = dimension, .precision = precision, .h = h, .lower = lower, .upper = {x, y, z}};
  return c;
}

static void put(cloud *c, double x, double y, double z) {
  const double at[3] = {x, y, z};
  assert_true(c->count < MOST);
  for (uint32_t k = 0; k < c->dimension; ++k) c->x[c->count * c->dimension + k] = at[k];
  ++c->count;
}

static void scatter(cloud *c, uint32_t count, double x0, double y0, double z0, double size) {
  uint64_t seed = 3 + c->count;
  for (uint32_t i = 0; i < count; ++i) {
    double x = cpu_random(&seed), y = cpu_random(&seed), z = cpu_random(&seed);
    put(c, x0 + size * x, y0 + size * y, z0 + size * z);
  }
}

static void check_all_ways(cloud *c) {
  check(c, "reference", 1);
  check(c, "serial", 1);
  check(c, "openmp", 3);
  check(c, "threads", 3);
  free(c);
}

static void random_cloud(uint32_t dimension, uint32_t precision) {
  cloud *c = new_cloud(dimension, precision, dimension == 2 ? 0.04 : 0.15, 0, 1, 1, 1);
  scatter(c, 2500, 0, 0, 0, 1);
  check_all_ways(c);
}

/* Two clusters with nothing between them, and loners. */
static void empty_cells(uint32_t dimension, uint32_t precision) {
  cloud *c = new_cloud(dimension, precision, 0.1, 0, 10, 10, 10);
  scatter(c, 300, 0.1, 0.2, 0.3, 0.5);
  scatter(c, 300, 9, 9, 9, 0.7);
  scatter(c, 60, 0, 0, 0, 10);
  check_all_ways(c);
}

/* A lattice whose points lie on cell borders; its distances include h itself. */
static void cell_borders(uint32_t dimension, uint32_t precision) {
  cloud *c = new_cloud(dimension, precision, 0.25, 0, 4, 4, 4);
  uint32_t side = dimension == 2 ? 33 : 13;
  for (uint32_t k = 0; k < (dimension == 2 ? 1 : side); ++k)
    for (uint32_t j = 0; j < side; ++j)
      for (uint32_t i = 0; i < side; ++i) put(c, 0.125 * i, 0.125 * j, 0.125 * k);
  check_all_ways(c);
}

static void far_from_origin(uint32_t dimension, uint32_t precision) {
  double origin = precision == PBF_FLOAT32 ? 250 : 1e9;
  cloud *c = new_cloud(dimension, precision, 0.25, origin, origin + 4, origin + 4, origin + 4);
  scatter(c, 1500, origin, origin, origin, 3);
  check_all_ways(c);
}

/* So many cells that rows share them: every pair still counts once. */
static void huge_domain(uint32_t dimension, uint32_t precision) {
  cloud *c = new_cloud(dimension, precision, 0.05, 0, 3000, 3000, 3000);
  scatter(c, 200, 0, 0, 0, 0.2);
  scatter(c, 200, 2999.5, 2999.5, 2999.5, 0.2);
  scatter(c, 200, 1500, 2999, 17, 0.2);
  scatter(c, 200, 0.1, 2999, 2999, 0.2);
  for (int i = 0; i < 600; ++i) put(c, 5 * i, 4.99 * i, 5 - 0.005 * i);
  for (int i = 0; i < 300; ++i) put(c, 1000 + 0.01 * i, 7, 7);
  check_all_ways(c);
}

static void one_cell_thick(uint32_t dimension, uint32_t precision) {
  cloud *c = new_cloud(dimension, precision, 0.1, 0, 5, 0.1, 0.1);
  uint64_t seed = 1;
  for (int i = 0; i < 900; ++i)
    put(c, 5 * cpu_random(&seed), 0.1 * cpu_random(&seed), 0.1 * cpu_random(&seed));
  check_all_ways(c);
  c = new_cloud(dimension, precision, 0.1, 0, 0.1, 5, 0.1);
  for (int i = 0; i < 900; ++i)
    put(c, 0.1 * cpu_random(&seed), 5 * cpu_random(&seed), 0.1 * cpu_random(&seed));
  check_all_ways(c);
}

/* Each particle is a neighbour of all others; some coincide. */
static void one_cell(uint32_t dimension, uint32_t precision) {
  cloud *c = new_cloud(dimension, precision, 1, 0, 1, 1, 1);
  scatter(c, 700, 0.4, 0.4, 0.4, 0.2);
  for (int i = 0; i < 40; ++i) put(c, 0.5 + 1e-3 * i, 0.5, 0.5);
  check_all_ways(c);
}

static void few(uint32_t dimension, uint32_t precision) {
  for (uint32_t count = 1; count < 40; count += 3) {
    cloud *c = new_cloud(dimension, precision, 0.2, 0, 1, 1, 1);
    scatter(c, count, 0.3, 0.3, 0.3, 0.4);
    check_all_ways(c);
  }
}

#define TEST(name)                        \
  static void test_##name(void **state) { \
    (void)state;                          \
    test_for_each_kind(name);             \
  }

TEST(random_cloud)
TEST(empty_cells)
TEST(cell_borders)
TEST(far_from_origin)
TEST(huge_domain)
TEST(one_cell_thick)
TEST(one_cell)
TEST(few)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_cloud), cmocka_unit_test(test_empty_cells),
      cmocka_unit_test(test_cell_borders), cmocka_unit_test(test_far_from_origin),
      cmocka_unit_test(test_huge_domain),  cmocka_unit_test(test_one_cell_thick),
      cmocka_unit_test(test_one_cell),     cmocka_unit_test(test_few),
  };
  return TEST_RUN(tests);
}
