/* Vorticity confinement and its curl, on a lattice where the sums have closed forms;
 * damping_compensation at the end of a wall's reach. */
#include "support.h"

#include "physics/passes/damping_compensation.h"

static void set_params_on_lattice(pbf_constants *c, double *spacing) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.spacing = 0.1;
  *spacing = p.spacing;
  *c = pbf_constants_of(&p);
}

typedef pbf_vec (*velocity_field)(pbf_vec x);

/* A turn with angular velocity 1.5 about z: its curl is 3 everywhere. */
static pbf_vec rigid_rotation(pbf_vec x) {
  pbf_vec v = {{0}};
  v.c[0] = -1.5 * x.c[1];
  v.c[1] = 1.5 * x.c[0];
  return v;
}

#if PBF_DIM == 3
/* The same with angular velocity (0.5, -1, 1.5): curl (1, -2, 3). */
static pbf_vec tilted_rotation(pbf_vec x) {
  pbf_vec v = {
      {-1.0 * x.c[2] - 1.5 * x.c[1], 1.5 * x.c[0] - 0.5 * x.c[2], 0.5 * x.c[1] + 1.0 * x.c[0]}};
  return v;
}
#endif

static pbf_vec at_rest_or_uniform(pbf_vec x) {
  (void)x;
  pbf_vec v = {{0}};
  v.c[0] = 7;
  return v;
}

/* Of the particle at the origin, whose neighbours are from row `first` of the lattice on. */
static pbf_curl curl_from_row(int first, velocity_field field) {
  pbf_constants c;
  double d;
  set_params_on_lattice(&c, &d);
  int n = (int)ceil(c.h / d), nz = PBF_DIM == 3 ? n : 0;
  const curl_pass<int> pass = {&c, 0};
  const pbf_vec zero = {{0}};
  auto sums = pass.begin<pbf_real>();
  for (int i = -n; i <= n; ++i)
    for (int j = first > -n ? first : -n; j <= n; ++j)
      for (int k = -nz; k <= nz; ++k) {
        double at[3] = {d * i, d * j, d * k};
        pbf_vec x = {{0}}, x_ij;
        for (int a = 0; a < PBF_DIM; ++a) x.c[a] = at[a], x_ij.c[a] = -at[a];
        pbf_real r2 = pbf_dot(x, x);
        if (r2 == 0) continue;
        pass.pair(&sums, {lanes_of(field(zero))}, {lanes_of(x_ij), r2, 0, lanes_of(field(x))});
      }
  pass.end(&sums);
  return pass.finish(sums);
}

static pbf_curl lattice_curl(velocity_field field) { return curl_from_row(-1000, field); }

/* sum V x grad W = -1 up to the quadrature error of the lattice, so the curl comes out as curl v
 * with eq. 15's sign. */
static void curl_of_a_rigid_rotation(void **state) {
  (void)state;
  pbf_curl curl = lattice_curl(rigid_rotation);
  assert_near(curl.c[PBF_CURL_DIM - 1], 3, 0.03);
  for (int k = 0; k + 1 < PBF_CURL_DIM; ++k) assert_near(curl.c[k], 0, 1e-12);
  assert_near(pbf_curl_size(curl), 3, 0.03);
}

#if PBF_DIM == 3
static void curl_of_a_tilted_rotation(void **state) {
  (void)state;
  const double expected[3] = {1, -2, 3};
  pbf_curl curl = lattice_curl(tilted_rotation);
  for (int k = 0; k < 3; ++k) assert_near(curl.c[k], expected[k], 0.03);
}

/* N x curl with N = (3, 4, 12) / 13 and curl (13, 26, -13): (-28, 15, 2) by hand. */
static void confinement_along_no_axis(void **state) {
  (void)state;
  const double expected[3] = {-364 / 13.0, 195 / 13.0, 26 / 13.0};
  pbf_vec eta = {{3, 4, 12}};
  pbf_curl curl = {{13, 26, -13}};
  pbf_vec dv = pbf_confine(1, eta, curl);
  for (int k = 0; k < 3; ++k) assert_near(dv.c[k], expected[k], 1e-12);
}
#endif

static void curl_of_a_uniform_flow_is_zero(void **state) {
  (void)state;
  assert_near(pbf_curl_size(lattice_curl(at_rest_or_uniform)), 0, 0);
  assert_near(pbf_curl_size(curl_from_row(0, at_rest_or_uniform)), 0, 0);
}

/* Outside a vortex eta points to its core; the confinement pushes along the swirl. */
static void confinement_spins_a_vortex_up(void **state) {
  (void)state;
  pbf_vec eta = {{0}};
  pbf_curl curl = {{0}};
  eta.c[0] = -4; /* the core is in -x */
  curl.c[PBF_CURL_DIM - 1] = 2;
  pbf_vec dv = pbf_confine(0.5, eta, curl);
  assert_near(dv.c[0], 0, 0);
  assert_near(dv.c[1], 0.5 * 2, 1e-15); /* N x curl = (-1,0,0) x (0,0,2) = (0,2,0) */
}

/* A share of the way to the others' mean, and never beyond it. */
static void viscosity_ends_at_the_mean(void **state) {
  (void)state;
  const struct {
    pbf_real viscosity, weight, share;
  } rows[] = {{0, 0.8, 0},  {0.1, 0.8, 0.1}, {1, 0.8, 1}, {PBF_TO_MEAN, 0.8, 1.25},
              {1, 4, 0.25}, {0.1, 4, 0.1},   {5, 0, 5},   {PBF_TO_MEAN, 100, 0.01}};
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; ++k) {
    pbf_vec v, sum;
    for (int a = 0; a < PBF_DIM; ++a) v.c[a] = 3 - a, sum.c[a] = 4 + 4 * a;
    v = pbf_smooth(rows[k].viscosity, v, sum, rows[k].weight);
    for (int a = 0; a < PBF_DIM; ++a)
      assert_near(v.c[a], 3 - a + (4 + 4 * a) * rows[k].share, 1e-12);
  }
}

static void confinement_without_a_gradient_is_none(void **state) {
  (void)state;
  pbf_vec eta = {{0}};
  pbf_curl curl = {{0}};
  curl.c[PBF_CURL_DIM - 1] = 2;
  pbf_vec dv = pbf_confine(0.5, eta, curl);
  for (int k = 0; k < PBF_DIM; ++k) assert_near(dv.c[k], 0, 0);
}

static void redirected_keeps_its_length(void **state) {
  (void)state;
  const pbf_vec from = {{0.6, 0.8}}, other = {{0, -0.01}}, none = {{0}};
  const pbf_vec faint = {{sizeof(pbf_real) == 4 ? 1e-22 : 1e-160}}; /* its square is denormal */
  pbf_vec turned = redirected(from, other);
  assert_true(fabs(turned.c[0]) < 1e-15 && fabs(turned.c[1] + 1) < 1e-6);
  assert_true(pbf_dot(faint, faint) > 0);
  for (int k = 0; k < PBF_DIM; ++k) {
    assert_true(redirected(from, none).c[k] == from.c[k]);
    assert_true(redirected(from, faint).c[k] == from.c[k]);
    assert_true(redirected(none, from).c[k] == 0);
    assert_true(redirected(none, none).c[k] == 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(curl_of_a_rigid_rotation),
#if PBF_DIM == 3
    cmocka_unit_test(curl_of_a_tilted_rotation),
    cmocka_unit_test(confinement_along_no_axis),
#endif
    cmocka_unit_test(viscosity_ends_at_the_mean),
    cmocka_unit_test(redirected_keeps_its_length),
    cmocka_unit_test(curl_of_a_uniform_flow_is_zero),
    cmocka_unit_test(confinement_spins_a_vortex_up),
    cmocka_unit_test(confinement_without_a_gradient_is_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
