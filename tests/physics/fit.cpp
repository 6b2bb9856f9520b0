/* The line through numbers of the particles around, against normal equations solved another way,
 * and where it is known. */
#include "physics/passes/pressure_fit.h"
#include "support.h"

enum { TERMS = PBF_DIM + 1 };

static pbf_constants constants(void) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  return pbf_constants_of(&p);
}

static pbf_real fit_at(const pbf_constants *c, const pbf_vec *x, const pbf_real *numbers, int count,
                       int i) {
  const pressure_fit_pass pass = {c};
  auto sums = pass.begin<pbf_real>();
  for (int j = 0; j < count; ++j) {
    pbf_vec x_ij = pbf_sub(x[i], x[j]);
    if (j != i) pass.pair(&sums, {}, {lanes_of(x_ij), pbf_dot(x_ij, x_ij), numbers[j], {}});
  }
  pass.end(&sums);
  return pass.finish(pass.line(sums, numbers[i]), numbers[i]);
}

/* The first unknown of a symmetric system, by Gauss and Jordan with the largest pivot. */
static double first_unknown(double a[TERMS][TERMS + 1]) {
  for (int k = 0; k < TERMS; ++k) {
    int pivot = k;
    for (int r = k; r < TERMS; ++r)
      if (fabs(a[r][k]) > fabs(a[pivot][k])) pivot = r;
    for (int n = 0; n <= TERMS; ++n) {
      double kept = a[k][n];
      a[k][n] = a[pivot][n];
      a[pivot][n] = kept;
    }
    for (int r = 0; r < TERMS; ++r)
      for (int n = TERMS; r != k && n >= k; --n) a[r][n] -= a[r][k] / a[k][k] * a[k][n];
  }
  return a[0][TERMS] / a[0][0];
}

/* Least squares over those that have a number, in units of h; the slopes count a thousandth more.
 */
static double fit_by_hand(double h, const pbf_vec *x, const pbf_real *numbers, int i) {
  double a[TERMS][TERMS + 1] = {{0}};
  for (int k = 1; k < TERMS; ++k) a[k][k] = 1e-3;
  for (int j = 0; j < CLOUD; ++j) {
    double q = sqrt(pbf_dot(pbf_sub(x[j], x[i]), pbf_sub(x[j], x[i]))) / h, term[TERMS + 1] = {1};
    if (q >= 1 || numbers[j] == 0) continue;
    for (int k = 0; k < PBF_DIM; ++k) term[k + 1] = (x[j].c[k] - x[i].c[k]) / h;
    term[TERMS] = numbers[j];
    for (int r = 0; r < TERMS; ++r)
      for (int n = 0; n <= TERMS; ++n) a[r][n] += pow(1 - q, 4) * (4 * q + 1) * term[r] * term[n];
  }
  return first_unknown(a);
}

static void is_least_squares(void **state) {
  (void)state;
  pbf_constants c = constants();
  pbf_vec x[CLOUD];
  pbf_real numbers[CLOUD];
  uint32_t random = 7;
  fill_cloud(x, 1.5);
  for (int i = 0; i < CLOUD; ++i) numbers[i] = i % 5 ? -1 - next_random(&random) : 0;
  for (int i = 0; i < CLOUD; ++i) {
    double expected = numbers[i] == 0 ? 0 : fit_by_hand(c.h, x, numbers, i);
    assert_near(fit_at(&c, x, numbers, CLOUD, i), expected, 1e-12);
  }
}

/* Also where all neighbours are on one side, and for either sign. */
static void a_straight_line_is_read_as_it_is(void **state) {
  (void)state;
  pbf_constants c = constants();
  pbf_vec x[CLOUD];
  pbf_real numbers[CLOUD];
  fill_cloud(x, 1.2);
  for (int sign = -1; sign <= 1; sign += 2) {
    for (int i = 0; i < CLOUD; ++i) numbers[i] = sign * (3 + x[i].c[0] - 1.5 * x[i].c[PBF_DIM - 1]);
    for (int i = 0; i < CLOUD; ++i)
      assert_near(fit_at(&c, x, numbers, CLOUD, i), numbers[i], 0.02 * c.h);
  }
}

static void who_is_alone_keeps_its_own(void **state) {
  (void)state;
  pbf_constants c = constants();
  pbf_vec x[3] = {{{0}}};
  x[1].c[0] = 1.01 * c.h; /* out of reach */
  x[2].c[1] = 0.3 * c.h;  /* without a number */
  const pbf_real numbers[3] = {-0.25, -7, 0};
  assert_near(fit_at(&c, x, numbers, 3, 0), -0.25, 1e-15);
  assert_near(fit_at(&c, x, numbers, 3, 2), 0, 0);
}

/* Neighbours in one row, in one place, and a line that falls below none before it comes here. */
static void what_leaves_doubt(void **state) {
  (void)state;
  pbf_constants c = constants();
  pbf_vec x[4] = {{{0}}};
  for (int j = 1; j < 4; ++j) x[j].c[0] = 0.2 * j * c.h;
  const pbf_real row[4] = {-1, -1.2, -1.4, -1.6};
  assert_near(fit_at(&c, x, row, 4, 0), -1, 0.01);
  const pbf_real steep[4] = {-1e-6, -0.5, -1, -1.5};
  assert_near(fit_at(&c, x, steep, 4, 0), 0, 0.05);
  const pbf_real steeper[4] = {-1e-6, -0.1, -1, -9};
  assert_near(fit_at(&c, x, steeper, 4, 0), 0, 0);
  for (int j = 1; j < 4; ++j) x[j] = x[0];
  assert_near(fit_at(&c, x, row, 4, 0), -1.3, 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(is_least_squares),
      cmocka_unit_test(a_straight_line_is_read_as_it_is),
      cmocka_unit_test(who_is_alone_keeps_its_own),
      cmocka_unit_test(what_leaves_doubt),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
