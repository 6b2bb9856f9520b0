/* Fluid that an attraction weighs, around a solid as an ocean on a planet, or within a container as
 * in a centrifuge, is as deep as under gravity, and no more compressed. */
#include <math.h>
#include <stdio.h>

#include "support.h"

static const double spacing = 0.02, pi = 3.14159265358979323846;

/* In steps of 1/60 s the iterations alone would leave 4 to 9 % of density error at the floor. */
typedef struct vessel {
  uint32_t dimension, precision;
  double attraction;   /* below 0: away from the centre */
  double inner, outer; /* radii of the fluid, in spacings; the solid has one of them */
} vessel;

static double radius_of(const vessel *v) { return (v->attraction > 0 ? v->inner : v->outer); }

static double middle_of(const vessel *v) { return (v->outer + 4) * spacing; }

static pbf_params params_of(const vessel *v) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = 1.0 / 60;
  params.iterations = 4;
  params.pressure_grid = -1;
  params.attraction = v->attraction;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.attraction_center[k] = middle_of(v);
    params.domain_min[k] = 0;
    params.domain_max[k] = 2 * middle_of(v);
  }
  return params;
}

/* A lattice between the radii. */
static pbf_solver *fluid_of(const vessel *v) {
  const int side = (int)(2 * v->outer + 8);
  const uint32_t most = (uint32_t)(v->dimension == 3 ? side * side * side : side * side);
  char *x = malloc((size_t)most * 3 * sizeof(double));
  uint32_t count = 0;
  assert_non_null(x);
  for (uint32_t n = 0; n < most; ++n) {
    const int at[3] = {(int)n % side, (int)n / side % side, (int)n / side / side};
    double place[3], r2 = 0;
    for (uint32_t k = 0; k < v->dimension; ++k) {
      place[k] = at[k] + 0.5;
      r2 += (place[k] - side / 2.0) * (place[k] - side / 2.0);
    }
    if (r2 < v->inner * v->inner || r2 > v->outer * v->outer) continue;
    for (uint32_t k = 0; k < v->dimension; ++k)
      test_put(x, (uint64_t)count * v->dimension + k, v->precision, spacing * place[k]);
    ++count;
  }
  const pbf_params params = params_of(v);
  pbf_desc desc = test_desc(v->dimension, v->precision, count);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

static void set_ball(pbf_solver *s, const vessel *v, double aside) {
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.inverted = v->attraction < 0;
  ball.radius = radius_of(v) * spacing;
  for (int k = 0; k < 3; ++k) ball.position[k] = middle_of(v) + (k == 0 ? aside : 0);
  assert_ok(pbf_set_colliders(s, 1, &ball));
}

static int has_grid(pbf_solver *s) { return test_has_stage(s, "pressure grid"); }

/* The mean of r² about the centre, and of the pressure over what the fluid between it and the level
 * weighs. */
typedef struct means {
  double r2, pressure;
} means;

static means means_of(pbf_solver *s, const vessel *v, double level) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  void *x = malloc((size_t)stats.count * v->dimension * v->precision);
  void *pressure = malloc((size_t)stats.count * v->precision);
  double r2_sum = 0, p = 0, weight = 0;
  assert_true(x && pressure);
  assert_ok(pbf_get_positions(s, 0, stats.count, x));
  assert_ok(pbf_get_pressures(s, 0, stats.count, pressure));
  for (uint32_t i = 0; i < stats.count; ++i) {
    double r2 = 0;
    for (uint32_t k = 0; k < v->dimension; ++k) {
      const double at = test_value(x, (uint64_t)i * v->dimension + k, v->precision) - middle_of(v);
      r2 += at * at;
    }
    r2_sum += r2;
    p += test_value(pressure, i, v->precision);
    weight += 0.5 * v->attraction * (level * level - r2);
  }
  free(x);
  free(pressure);
  return (means){r2_sum / stats.count, p / weight};
}

/* Of fluid between two radii. */
static double mean_r2(uint32_t dimension, double a, double b) {
  return dimension == 3 ? 0.6 * (pow(b, 5) - pow(a, 5)) / (pow(b, 3) - pow(a, 3))
                        : 0.5 * (a * a + b * b);
}

static void check_rest(pbf_solver *s, const vessel *v) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_step(s, 120));
  assert_ok(pbf_get_stats(s, &stats));
  const uint32_t n = v->dimension;
  const double volume = stats.count * pow(spacing, n) / (n == 3 ? 4 * pi / 3 : pi);
  const double floor = radius_of(v) * spacing;
  const double level = pow(pow(floor, n) + (v->attraction > 0 ? volume : -volume), 1.0 / n);
  const means is = means_of(s, v, level);
  const double r2 = is.r2 / mean_r2(n, fmin(floor, level), fmax(floor, level));
  if (!(fabs(r2 - 1) < 0.035)) fail_msg("%uD: mean r² is %.4f of that of its volume", n, r2);
  if (!(fabs(is.pressure - 1) < 0.05))
    fail_msg("%uD: pressures are %.3f of the weight", n, is.pressure);
}

/* In 3D the choice alone: so many layers are 30,000 particles. */
static void check_vessel(const vessel *v, int deep) {
  pbf_solver *s = fluid_of(v);
  assert_false(has_grid(s));
  set_ball(s, v, 1.1 * radius_of(v) * spacing); /* which is not around the centre */
  assert_false(has_grid(s));
  set_ball(s, v, 0);
  assert_int_equal(has_grid(s), deep);
  if (deep && v->dimension == 2) check_rest(s, v);
  pbf_destroy(s);
}

static void check_ocean(uint32_t dimension, uint32_t precision) {
  const vessel deep = {dimension, precision, 20, 3, dimension == 3 ? 19.5 : 23};
  const vessel shallow = {dimension, precision, 20, 3, 14};
  check_vessel(&deep, 1);
  check_vessel(&shallow, 0);
}

static void oceans_are_deep(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_ocean);
}

static void check_centrifuge(uint32_t dimension, uint32_t precision) {
  const vessel deep = {dimension, precision, -8, dimension == 3 ? 3 : 10, dimension == 3 ? 20 : 28};
  const vessel shallow = {dimension, precision, -8, 8, 16};
  check_vessel(&deep, 1);
  check_vessel(&shallow, 0);
}

static void centrifuges_are_deep(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_centrifuge);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(oceans_are_deep),
      cmocka_unit_test(centrifuges_are_deep),
  };
  return TEST_RUN(tests);
}
