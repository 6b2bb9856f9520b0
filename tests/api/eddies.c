/* Slow eddies in fluid under pressure, and what `shear_stress_correction` does for them. A
 * Taylor-Green cell is a steady flow of Euler's equations: its angular momentum is to stay. */
#include "support.h"

#include <math.h>

static const double spacing = 0.025, speed = 0.2, pi = 3.14159265358979323846;

/* A tank that is as wide as it is deep, and the particles in it. */
typedef struct tank {
  uint32_t dimension, precision, count;
  int across, thick;
  pbf_solver *solver;
  void *x, *v;
} tank;

static double length(const tank *t, int axis) {
  return spacing * (axis < 2 ? t->across : t->thick);
}

static pbf_params params_of(const tank *t, double correction) {
  pbf_params p = test_params();
  p.spacing = spacing;
  p.smoothing_radius = 2 * spacing;
  p.time_step = 1.0 / 60;
  p.shear_stress_correction = correction;
  for (int k = 0; k < 3; ++k) p.domain_max[k] = k == 1 ? 1.4 * length(t, k) : length(t, k);
  return p;
}

static void fill(tank *t) {
  uint32_t i = 0;
  for (int k = 0; k < t->thick; ++k)
    for (int row = 0; row < t->across; ++row)
      for (int column = 0; column < t->across; ++column, ++i) {
        const double at[3] = {(column + 0.5) * spacing, (row + 0.5) * spacing, (k + 0.5) * spacing};
        const double x = pi * at[0] / length(t, 0), y = pi * at[1] / length(t, 1);
        const double v[3] = {speed * sin(x) * cos(y), -speed * cos(x) * sin(y), 0};
        for (uint32_t a = 0; a < t->dimension; ++a) {
          test_put(t->x, (uint64_t)i * t->dimension + a, t->precision, at[a]);
          test_put(t->v, (uint64_t)i * t->dimension + a, t->precision, v[a]);
        }
      }
}

static tank tank_across(int across, uint32_t dimension, uint32_t precision, double correction) {
  tank t = {dimension, precision, 0, across, dimension == 2 ? 1 : 4, 0, 0, 0};
  t.count = (uint32_t)(t.across * t.across * t.thick);
  const pbf_params params = params_of(&t, correction);
  pbf_desc desc = test_desc(dimension, precision, t.count);
  t.solver = test_create(&desc, &params);
  t.x = calloc((size_t)t.count * dimension, precision);
  t.v = calloc((size_t)t.count * dimension, precision);
  fill(&t);
  assert_ok(pbf_add_particles(t.solver, t.count, t.x, t.v, NULL));
  return t;
}

static tank tank_of(uint32_t dimension, uint32_t precision, double correction) {
  return tank_across(dimension == 2 ? 32 : 18, dimension, precision, correction);
}

static void destroy(tank *t) {
  pbf_destroy(t->solver);
  free(t->x);
  free(t->v);
}

/* About the cell's axis. */
static double angular_momentum(tank *t) {
  double sum = 0;
  assert_ok(pbf_get_positions(t->solver, 0, t->count, t->x));
  assert_ok(pbf_get_velocities(t->solver, 0, t->count, t->v));
  for (uint32_t i = 0; i < t->count; ++i) {
    double x[2], v[2];
    for (uint32_t k = 0; k < 2; ++k) {
      x[k] = test_value(t->x, (uint64_t)i * t->dimension + k, t->precision) - length(t, 0) / 2;
      v[k] = test_value(t->v, (uint64_t)i * t->dimension + k, t->precision);
    }
    sum += x[0] * v[1] - x[1] * v[0];
  }
  return sum;
}

/* After a second, in three dimensions half a second, over that at first; and the kinetic energy. */
static double kept(uint32_t dimension, uint32_t precision, double correction, uint32_t steps,
                   double *energy) {
  tank t = tank_of(dimension, precision, correction);
  pbf_params params = params_of(&t, correction);
  pbf_stats first = {.struct_size = sizeof first}, last = first;
  const double before = angular_momentum(&t);
  params.time_step = (dimension == 2 ? 1.0 : 0.5) / steps;
  assert_ok(pbf_set_params(t.solver, &params));
  assert_ok(pbf_get_stats(t.solver, &first));
  assert_ok(pbf_step(t.solver, steps));
  assert_ok(pbf_get_stats(t.solver, &last));
  *energy = last.kinetic_energy / first.kinetic_energy;
  const double left = angular_momentum(&t) / before;
  destroy(&t);
  return left;
}

/* In three dimensions the tank is small, and what is left takes more of so small an eddy. */
static void an_eddy_lives(uint32_t dimension, uint32_t precision) {
  const uint32_t steps = dimension == 2 ? 60 : 30;
  double energy[2];
  const double without = kept(dimension, precision, 0, steps, &energy[0]);
  const double with = kept(dimension, precision, 0.7, steps, &energy[1]);
  const double least = dimension == 2 ? 0.9 : 0.8, most = dimension == 2 ? 0.85 : 0.7;
  if (!(without < most && with > least && energy[1] > least && energy[1] < 1.02))
    fail_msg("%uD: angular momentum left %g, with the correction %g, energy %g and %g", dimension,
             without, with, energy[0], energy[1]);
}

/* Where pairs would carry all of the weight, by which they resist shear. */
static void in_short_steps_too(void **state) {
  (void)state;
  double energy, left = kept(2, PBF_FLOAT32, 0.7, 240, &energy);
  if (!(left > 0.85 && energy < 1.02))
    fail_msg("angular momentum left %g, energy %g", left, energy);
}

/* A closed box that is full, without gravity, by default: pressed by its walls alone. */
static double kept_in_a_full_box(uint32_t dimension, uint32_t precision, double time_step,
                                 double *energy) {
  tank t = tank_across(40, dimension, precision, -1);
  pbf_params params = params_of(&t, -1);
  pbf_stats first = {.struct_size = sizeof first}, last = first;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = length(&t, k);
  params.gravity[1] = 0;
  params.time_step = time_step;
  assert_ok(pbf_set_params(t.solver, &params));
  const double before = angular_momentum(&t);
  assert_ok(pbf_get_stats(t.solver, &first));
  assert_ok(pbf_step(t.solver, (uint32_t)lround((dimension == 2 ? 2 : 1) / time_step)));
  assert_ok(pbf_get_stats(t.solver, &last));
  *energy = last.kinetic_energy / first.kinetic_energy;
  const double left = angular_momentum(&t) / before;
  destroy(&t);
  return left;
}

static void eddies_live_in_full_boxes(void **state) {
  (void)state;
  const double steps[] = {1.0 / 60, 1.0 / 240};
  for (uint32_t dimension = 2; dimension <= 3; ++dimension)
    for (int k = 0; k < 2; ++k) {
      double energy, left = kept_in_a_full_box(dimension, PBF_FLOAT32, steps[k], &energy);
      if (!(left > 0.9 && energy > 0.8 && energy < 1.02))
        fail_msg("%uD, steps of %g s: angular momentum left %g, energy %g", dimension, steps[k],
                 left, energy);
    }
}

static void eddies_live(void **state) {
  (void)state;
  test_for_long_kinds(an_eddy_lives);
}

/* Pairs alone carry the weight, in short steps, where the correction has most noise: the
 * root mean square speed over √(g d) in the fourth second. What it pushes boils without an
 * exchange, at 0.2. */
static void still_water(uint32_t precision) {
  enum { SECOND = 240, LOOKS = 24 };
  tank t = tank_of(2, precision, 0.7);
  pbf_params params = params_of(&t, 0.7);
  pbf_stats stats = {.struct_size = sizeof stats};
  double sum = 0;
  params.time_step = 1.0 / SECOND;
  params.pressure_grid = 0;
  memset(t.v, 0, (size_t)t.count * t.dimension * precision);
  assert_ok(pbf_set_params(t.solver, &params));
  assert_ok(pbf_set_velocities(t.solver, 0, t.count, t.v));
  assert_ok(pbf_step(t.solver, 3 * SECOND));
  for (int k = 0; k < LOOKS; ++k) {
    assert_ok(pbf_step(t.solver, SECOND / LOOKS));
    assert_ok(pbf_get_stats(t.solver, &stats));
    sum += 2 * stats.kinetic_energy / LOOKS;
  }
  destroy(&t);
  if (!(sqrt(sum / (9.81 * spacing)) < 0.04))
    fail_msg("water at rest moves by %g of sqrt(g d)", sqrt(sum / (9.81 * spacing)));
}

static void water_stays_still(void **state) {
  (void)state;
  test_skip_if_watched();
  still_water(PBF_FLOAT32);
  if (test_is_long()) still_water(PBF_FLOAT64);
}

/* In long steps, where the weight of a few layers has to stay with the iterations. */
static void water_does_not_swell(void **state) {
  (void)state;
  tank t = tank_across(20, 2, PBF_FLOAT32, 0.7);
  pbf_params params = params_of(&t, 0.7);
  pbf_stats stats = {.struct_size = sizeof stats};
  params.time_step = 1.0 / 40;
  assert_ok(pbf_set_params(t.solver, &params));
  assert_ok(pbf_step(t.solver, 240));
  assert_ok(pbf_get_stats(t.solver, &stats));
  const double height = 2 * stats.center_of_mass[1] / length(&t, 1);
  destroy(&t);
  if (!(height > 0.96 && height < 1.02)) fail_msg("water stands %g times as high", height);
}

/* Not every step corrects: which ones do is a matter of time, not of calls. */
static void calls_may_be_divided(void **state) {
  (void)state;
  tank one = tank_of(2, PBF_FLOAT32, 0.7), many = tank_of(2, PBF_FLOAT32, 0.7);
  assert_ok(pbf_step(one.solver, 13));
  const uint32_t calls[] = {1, 4, 6, 2};
  for (int k = 0; k < 4; ++k) assert_ok(pbf_step(many.solver, calls[k]));
  assert_true(test_hash(one.solver) == test_hash(many.solver));
  destroy(&one);
  destroy(&many);
}

/* Without anything outside, a shear in a pressed body leaves its linear momentum at 0. */
static void check_momentum(uint32_t dimension, uint32_t precision) {
  tank t = tank_of(dimension, precision, 1);
  pbf_params params = params_of(&t, 1);
  double p[3] = {0, 0, 0}, speeds = 0;
  params.attraction = 20;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.attraction_center[k] = length(&t, k) / 2;
    params.domain_min[k] = -3;
    params.domain_max[k] = 3;
  }
  assert_ok(pbf_set_params(t.solver, &params));
  assert_ok(pbf_step(t.solver, 60));
  assert_ok(pbf_get_velocities(t.solver, 0, t.count, t.v));
  for (uint32_t i = 0; i < t.count * dimension; ++i) {
    const double v = test_value(t.v, i, precision);
    p[i % dimension] += v;
    speeds += fabs(v);
  }
  destroy(&t);
  for (uint32_t k = 0; k < dimension; ++k)
    if (!(fabs(p[k]) < (precision == PBF_FLOAT32 ? 1e-5 : 1e-13) * speeds))
      fail_msg("%uD: linear momentum %g of %g", dimension, p[k], speeds);
}

static void momentum_stays(void **state) {
  (void)state;
  test_for_long_kinds(check_momentum);
}

/* At 0 there are no stages and no arrays for it. */
static void unused_costs_nothing(void **state) {
  (void)state;
  tank t = tank_of(2, PBF_FLOAT32, 0);
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_step(t.solver, 20));
  assert_ok(pbf_get_plan(t.solver, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k)
    assert_null(strstr(plan.stages[k].name, "deviator"));
  for (uint32_t k = 0; k < plan.array_count; ++k)
    assert_null(strstr(plan.arrays[k].name, "deviator"));
  destroy(&t);
}

/* After so many steps, of every other one `shorter` times as long. */
static uint64_t hash_of(tank t, pbf_params params, uint32_t steps, double shorter) {
  uint64_t hash;
  const double dt = params.time_step;
  for (uint32_t k = 0; k < steps; ++k) {
    params.time_step = k % 2 ? dt : shorter * dt;
    assert_ok(pbf_set_params(t.solver, &params));
    assert_ok(pbf_step(t.solver, 1));
  }
  assert_ok(pbf_hash(t.solver, &hash));
  destroy(&t);
  return hash;
}

static uint64_t hash_after(int across, double correction, double gravity, double grid) {
  tank t = tank_across(across, 2, PBF_FLOAT32, 0);
  pbf_params params = params_of(&t, correction);
  params.gravity[1] = -gravity;
  params.pressure_grid = grid;
  return hash_of(t, params, 20, 1);
}

/* -1: 0.75 in water of 18 layers and more that may have a pressure grid (params.h). */
static void the_default_depends_on_depth(void **state) {
  (void)state;
  assert_int_equal(hash_after(18, -1, 9.81, -1), hash_after(18, 0.75, 9.81, -1));
  assert_true(hash_after(18, -1, 9.81, -1) != hash_after(18, 0, 9.81, -1));
  assert_int_equal(hash_after(17, -1, 9.81, -1), hash_after(17, 0, 9.81, -1));
  assert_int_equal(hash_after(32, -1, 0, -1), hash_after(32, 0, 0, -1));
  assert_int_equal(hash_after(32, -1, 9.81, 0), hash_after(32, 0, 9.81, 0));
}

/* Wider kernels resist shear less. */
static uint64_t hash_of_wide_kernels(double correction) {
  tank t = tank_across(18, 2, PBF_FLOAT32, 0);
  pbf_params params = params_of(&t, correction);
  params.smoothing_radius = 2.5 * spacing;
  return hash_of(t, params, 20, 1);
}

static void the_default_depends_on_the_kernel(void **state) {
  (void)state;
  assert_int_equal(hash_of_wide_kernels(-1), hash_of_wide_kernels(0.25));
  assert_true(hash_of_wide_kernels(-1) != hash_of_wide_kernels(0.5));
}

/* Without a pressure grid, which the correction wants. */
static uint64_t hash_with(double correction, double time_step, double shorter) {
  tank t = tank_of(2, PBF_FLOAT32, 0);
  pbf_params params = params_of(&t, correction);
  params.pressure_grid = 0;
  if (time_step > 0) params.time_step = time_step;
  return hash_of(t, params, 20, shorter);
}

/* A correction stands for three steps that are alike: of others the size of it does not show. */
static void steps_that_alternate_have_none(void **state) {
  (void)state;
  /* Small scenes without it are one launch there, whose sums are in another order. */
  if (strcmp(test_backend(), "cuda") == 0) test_skip("with and without are other launches on cuda");
  assert_int_equal(hash_with(0.75, 0, 0.9), hash_with(0.5, 0, 0.9));
  assert_true(hash_with(0.75, 0, 1) != hash_with(0.5, 0, 1));
}

/* What weighs down by more than half a spacing in a step has none. */
static void long_steps_have_none(void **state) {
  (void)state;
  const double longest = sqrt(0.5 * spacing / 9.81);
  if (strcmp(test_backend(), "cuda") == 0) test_skip("with and without are other launches on cuda");
  assert_int_equal(hash_with(0.75, 1.01 * longest, 1), hash_with(0, 1.01 * longest, 1));
  assert_true(hash_with(0.75, 0.99 * longest, 1) != hash_with(0, 0.99 * longest, 1));
}

/* The stub has no fluid. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {cmocka_unit_test(eddies_live),
                                     cmocka_unit_test(in_short_steps_too),
                                     cmocka_unit_test(eddies_live_in_full_boxes),
                                     cmocka_unit_test(water_stays_still),
                                     cmocka_unit_test(water_does_not_swell),
                                     cmocka_unit_test(calls_may_be_divided),
                                     cmocka_unit_test(momentum_stays),
                                     cmocka_unit_test(unused_costs_nothing),
                                     cmocka_unit_test(the_default_depends_on_depth),
                                     cmocka_unit_test(the_default_depends_on_the_kernel),
                                     cmocka_unit_test(steps_that_alternate_have_none),
                                     cmocka_unit_test(long_steps_have_none)};
  return TEST_RUN(tests);
}
