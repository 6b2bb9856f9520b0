/* Smoothed positions and anisotropies, against sums over lattices that were added up elsewhere:
 * with r = 4 spacings, the weights 1 - (distance / r)³ and the squares of distances along an axis.
 */
#include "support.h"

/* Places of a lattice in units of its spacing. */
enum { REACH = 4, WIDTH = 2 * REACH + 1, MOST = WIDTH * WIDTH * WIDTH };

/* Sum of w x² over sum of w, in units of spacing²: on a line (1240 / 376), in a square lattice, in
 * a cubic one. */
static const double variance[] = {0, 3.297872340425532, 2.81137791224509, 2.409136691994446};

/* At the surface of half of a lattice, 2D and 3D: the mean along the outward normal, in spacings,
 * and the variances along it and across. */
static const double half_mean[] = {0, 0, -1.1523572345045945, -1.0258809475743667};
static const double half_along[] = {0, 0, 1.0224031252842698, 0.9186803802256509};
static const double half_across[] = {0, 0, 2.8911598167670065, 2.4822714159157058};

static const double spacing = 0.05, middle = 0.5;

typedef struct points {
  uint32_t dimension, precision, count;
  double x[MOST * 3]; /* or twice as many floats */
} points;

static void add_point(points *p, double x, double y, double z) {
  const double place[] = {x, y, z};
  for (uint32_t k = 0; k < p->dimension; ++k)
    test_put(p->x, (uint64_t)p->count * p->dimension + k, p->precision,
             middle + spacing * place[k]);
  ++p->count;
}

/* The first one is the middle's. Along the last axis from -4 to `upper` spacings. */
static void add_lattice(points *p, int upper) {
  const int depth = p->dimension == 3 ? REACH : 0;
  add_point(p, 0, 0, 0);
  for (int i = -REACH; i <= REACH; ++i)
    for (int j = -REACH; j <= REACH; ++j)
      for (int k = -depth; k <= depth; ++k)
        if ((p->dimension == 3 ? k : j) <= upper && (i != 0 || j != 0 || k != 0))
          add_point(p, i, j, k);
}

static pbf_solver *solver_of(const points *p, double side) {
  const pbf_desc desc = test_desc(p->dimension, p->precision, MOST + 1);
  pbf_params params = test_params();
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = side;
  pbf_solver *solver = test_create(&desc, &params);
  assert_ok(pbf_add_particles(solver, p->count, p->x, NULL, NULL));
  return solver;
}

/* Of row `row`. */
typedef struct result {
  double x[3], a[3][3];
} result;

static result result_of(pbf_solver *solver, const points *p, pbf_anisotropy_desc desc,
                        uint32_t row) {
  const uint32_t n = p->dimension;
  double x[3], a[9]; /* or floats */
  result r = {{0}, {{0}}};
  desc.struct_size = sizeof desc;
  desc.first = row;
  desc.count = 1;
  desc.positions = x;
  desc.stretches = a;
  assert_ok(pbf_get_anisotropies(solver, &desc));
  for (uint32_t i = 0; i < n; ++i) {
    r.x[i] = test_value(x, i, p->precision);
    for (uint32_t j = 0; j < n; ++j) r.a[i][j] = test_value(a, i * n + j, p->precision);
  }
  return r;
}

static double accuracy(const points *p) { return p->precision == PBF_FLOAT32 ? 2e-5 : 1e-10; }

static void check_place(const points *p, const result *r, const double *right) {
  for (uint32_t k = 0; k < p->dimension; ++k)
    if (!(fabs(r->x[k] - right[k]) < accuracy(p)))
      fail_msg("%uD: x[%u] is %.12g, it must be %.12g", p->dimension, k, r->x[k], right[k]);
}

/* A = across I + (along - across) axis axisᵀ. */
static void check_axis(const points *p, const result *r, const double axis[3], double along,
                       double across) {
  for (uint32_t i = 0; i < p->dimension; ++i) {
    for (uint32_t j = 0; j < p->dimension; ++j) {
      const double right = (i == j ? across : 0) + (along - across) * axis[i] * axis[j];
      if (!(fabs(r->a[i][j] - right) < 10 * accuracy(p)))
        fail_msg("%uD: A[%u][%u] is %.12g, it must be %.12g", p->dimension, i, j, r->a[i][j],
                 right);
    }
  }
}

static const double any_axis[3] = {1, 0, 0}, centre[3] = {0.5, 0.5, 0.5};

/* ---- Shapes ---------------------------------------------------------------------------------- */

static void check_lattice(uint32_t dimension, uint32_t precision) {
  points p = {.dimension = dimension, .precision = precision};
  add_lattice(&p, REACH);
  pbf_solver *solver = solver_of(&p, 1);
  const result r = result_of(solver, &p, (pbf_anisotropy_desc){.smoothing = 0.9}, 0);
  check_place(&p, &r, centre);
  check_axis(&p, &r, any_axis, 1, 1);
  pbf_destroy(solver);
}

static void a_lattice_is_isotropic(void **state) {
  (void)state;
  test_for_each_kind(check_lattice);
}

static void check_surface(uint32_t dimension, uint32_t precision) {
  points p = {.dimension = dimension, .precision = precision};
  const double normal[3] = {0, dimension == 2, dimension == 3}, v = variance[dimension];
  add_lattice(&p, 0);
  pbf_solver *solver = solver_of(&p, 1);
  const result r = result_of(solver, &p, (pbf_anisotropy_desc){.smoothing = 0.9}, 0);
  double right[3];
  for (uint32_t k = 0; k < 3; ++k)
    right[k] = centre[k] + 0.9 * half_mean[dimension] * spacing * normal[k];
  check_place(&p, &r, right);
  check_axis(&p, &r, normal, half_along[dimension] / v, half_across[dimension] / v);
  pbf_destroy(solver);
}

static void a_surface_lies_flat_and_moves_inwards(void **state) {
  (void)state;
  test_for_each_kind(check_surface);
}

static void check_sheet(uint32_t dimension, uint32_t precision) {
  if (dimension == 2) return;
  points p = {.dimension = dimension, .precision = precision};
  const double normal[3] = {0, 0, 1}, flat = variance[2] / variance[3];
  add_point(&p, 0, 0, 0);
  for (int i = -REACH; i <= REACH; ++i)
    for (int j = -REACH; j <= REACH; ++j)
      if (i != 0 || j != 0) add_point(&p, i, j, 0);
  pbf_solver *solver = solver_of(&p, 1);
  result r = result_of(solver, &p, (pbf_anisotropy_desc){0}, 0);
  check_place(&p, &r, centre);
  check_axis(&p, &r, normal, flat / 4, flat); /* 4: the ratio where none is given */
  r = result_of(solver, &p, (pbf_anisotropy_desc){.max_ratio = 10}, 0);
  check_axis(&p, &r, normal, flat / 10, flat);
  pbf_destroy(solver);
}

static void a_sheet_is_flat(void **state) {
  (void)state;
  test_for_each_kind(check_sheet);
}

/* Aslant, so that the axes have to be found. */
static void check_line(uint32_t dimension, uint32_t precision) {
  points p = {.dimension = dimension, .precision = precision};
  const double axis[3] = {0.6, -0.8, 0}, space[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3};
  const double *along = dimension == 3 ? space : axis;
  const double length = variance[1] / variance[dimension];
  add_point(&p, 0, 0, 0);
  for (int i = -3; i <= 3; ++i) /* the fourth is at the radius */
    if (i != 0) add_point(&p, i * along[0], i * along[1], i * along[2]);
  pbf_solver *solver = solver_of(&p, 1);
  result r = result_of(solver, &p, (pbf_anisotropy_desc){.smoothing = 1, .min_neighbors = 6}, 0);
  check_place(&p, &r, centre);
  check_axis(&p, &r, along, length, length / 4);
  r = result_of(solver, &p, (pbf_anisotropy_desc){.min_neighbors = 7}, 0); /* it has six */
  check_axis(&p, &r, along, 0.5, 0.5);
  pbf_destroy(solver);
}

static void a_line_is_long(void **state) {
  (void)state;
  test_for_each_kind(check_line);
}

/* Far away, so that the cells between the two are many. */
static void check_lone(uint32_t dimension, uint32_t precision) {
  points p = {.dimension = dimension, .precision = precision};
  add_lattice(&p, REACH);
  const double far[3] = {900.25, 900.5, 900.75};
  pbf_solver *solver = solver_of(&p, 1000);
  double x[3];
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, far[k]);
  assert_ok(pbf_add_particles(solver, 1, x, NULL, NULL));
  result r = result_of(solver, &p, (pbf_anisotropy_desc){.smoothing = 1}, p.count);
  check_place(&p, &r, far);
  check_axis(&p, &r, any_axis, 0.5, 0.5);
  r = result_of(solver, &p, (pbf_anisotropy_desc){.lone_scale = 0.25}, p.count);
  check_axis(&p, &r, any_axis, 0.25, 0.25);
  r = result_of(solver, &p, (pbf_anisotropy_desc){.min_neighbors = 1}, p.count);
  check_axis(&p, &r, any_axis, 0.5, 0.5);
  r = result_of(solver, &p, (pbf_anisotropy_desc){.smoothing = 1}, 0);
  check_axis(&p, &r, any_axis, 1, 1);
  pbf_destroy(solver);
}

static void a_lone_particle_is_a_ball(void **state) {
  (void)state;
  test_for_each_kind(check_lone);
}

/* ---- Calls ----------------------------------------------------------------------------------- */

static pbf_anisotropy_desc all_of(const points *p, void *x, void *a) {
  return (pbf_anisotropy_desc){.struct_size = sizeof(pbf_anisotropy_desc),
                               .count = p->count,
                               .smoothing = 0.5,
                               .positions = x,
                               .stretches = a};
}

/* Some rows get what they get among all, and nothing else is written to or changed. */
static void check_rows(uint32_t dimension, uint32_t precision) {
  static points p;
  static double places[2][MOST * 3], shapes[2][MOST * 9];
  char *x[2] = {(char *)places[0], (char *)places[1]};
  char *a[2] = {(char *)shapes[0], (char *)shapes[1]};
  p = (points){.dimension = dimension, .precision = precision};
  add_lattice(&p, 1);
  pbf_solver *solver = solver_of(&p, 1);
  const uint64_t hash = test_hash(solver), row = (uint64_t)dimension * precision;
  pbf_anisotropy_desc desc = all_of(&p, x[0], a[0]);
  assert_ok(pbf_get_anisotropies(solver, &desc));
  memset(x[1], 0x5b, sizeof places[1]);
  memset(a[1], 0x5b, sizeof shapes[1]);
  desc = all_of(&p, x[1], a[1]);
  desc.first = 5;
  desc.count = 30;
  assert_ok(pbf_get_anisotropies(solver, &desc));
  assert_memory_equal(x[1], x[0] + 5 * row, 30 * row);
  assert_memory_equal(a[1], a[0] + 5 * row * dimension, 30 * row * dimension);
  for (uint64_t i = 30 * row; i < sizeof places[1]; ++i) assert_int_equal(x[1][i], 0x5b);
  for (uint64_t i = 30 * row * dimension; i < sizeof shapes[1]; ++i)
    assert_int_equal(a[1][i], 0x5b);
  desc.stretches = NULL;
  assert_ok(pbf_get_anisotropies(solver, &desc));
  assert_int_equal(test_hash(solver), hash);
  pbf_destroy(solver);
}

static void rows_get_what_they_get_among_all(void **state) {
  (void)state;
  test_for_each_kind(check_rows);
}

static void what_is_wrong_is_said(void **state) {
  (void)state;
  static points p;
  static double x[MOST * 3];
  p = (points){.dimension = 3, .precision = PBF_FLOAT32};
  add_lattice(&p, 0);
  pbf_solver *solver = solver_of(&p, 1);
#define REFUSED(member, value, words)                                                     \
  do {                                                                                    \
    pbf_anisotropy_desc desc = all_of(&p, x, NULL);                                       \
    desc.member = value;                                                                  \
    assert_fails(pbf_get_anisotropies(solver, &desc), PBF_ERROR_INVALID_ARGUMENT, words); \
  } while (0)
  REFUSED(first, 1, "the solver holds");
  REFUSED(radius, 0.05, "anisotropy.radius is 0.05");
  REFUSED(radius, 0.41, "at most 4 h");
  REFUSED(radius, (double)NAN, "anisotropy.radius is NaN");
  REFUSED(smoothing, 1.5, "anisotropy.smoothing is 1.5");
  REFUSED(max_ratio, 0.5, "anisotropy.max_ratio is 0.5");
  REFUSED(max_ratio, (double)INFINITY, "anisotropy.max_ratio");
  REFUSED(lone_scale, -1, "anisotropy.lone_scale is -1");
  REFUSED(positions, NULL, "at least one");
  REFUSED(stretches, (char *)x + 1, "anisotropy.stretches is");
#undef REFUSED
  pbf_anisotropy_desc desc = all_of(&p, x, NULL);
  desc.struct_size = 4;
  assert_fails(pbf_get_anisotropies(solver, &desc), PBF_ERROR_STRUCT_SIZE, "pbf_anisotropy_desc");
  assert_fails(pbf_get_anisotropies(solver, NULL), PBF_ERROR_INVALID_ARGUMENT, "null");
  desc = all_of(&p, NULL, NULL);
  desc.count = 0;
  assert_ok(pbf_get_anisotropies(solver, &desc));
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_lattice_is_isotropic),
      cmocka_unit_test(a_surface_lies_flat_and_moves_inwards),
      cmocka_unit_test(a_sheet_is_flat),
      cmocka_unit_test(a_line_is_long),
      cmocka_unit_test(a_lone_particle_is_a_ball),
      cmocka_unit_test(rows_get_what_they_get_among_all),
      cmocka_unit_test(what_is_wrong_is_said),
  };
  return TEST_RUN(tests);
}
