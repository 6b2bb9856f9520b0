/* Viscosity: a shear wave decays as theory says, at any step and support; momenta are kept, and
 * solid rotation is not damped; no viscosity makes a fluid faster. */
#include "support.h"

#include <math.h>

static const double spacing = 0.05, pi = 3.14159265358979323846;

typedef struct fluid {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
  double *x, *v; /* read back */
} fluid;

static pbf_params params_of(double support, double viscosity, double time_step) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = support * spacing;
  params.viscosity = viscosity;
  params.time_step = time_step;
  params.prestabilization = params.attraction = 0;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = -4;
    params.domain_max[k] = 4;
  }
  return params;
}

/* A cube of `side` particles about the origin, `apart` from each other, each at the velocity that
 * it is given at its place. */
static fluid fluid_of(uint32_t dimension, uint32_t precision, const pbf_params *params,
                      uint32_t side, double apart,
                      void (*velocity)(const double x[3], double v[3])) {
  fluid f = {.dimension = dimension, .precision = precision};
  f.count = side * side * (dimension == 3 ? side : 1);
  const pbf_desc desc = test_desc(dimension, precision, f.count);
  f.solver = test_create(&desc, params);
  f.x = calloc((size_t)f.count * dimension, sizeof *f.x);
  f.v = calloc((size_t)f.count * dimension, sizeof *f.v);
  char *positions = calloc((size_t)f.count * dimension, precision);
  char *velocities = calloc((size_t)f.count * dimension, precision);
  assert_true(f.x && f.v && positions && velocities);
  for (uint32_t i = 0; i < f.count; ++i) {
    const uint32_t at[3] = {i % side, i / side % side, i / side / side};
    double x[3] = {0}, v[3];
    for (uint32_t k = 0; k < dimension; ++k) x[k] = apart * (at[k] + 0.5 - 0.5 * side);
    velocity(x, v);
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(positions, (uint64_t)i * dimension + k, precision, x[k]);
      test_put(velocities, (uint64_t)i * dimension + k, precision, v[k]);
    }
  }
  assert_ok(pbf_add_particles(f.solver, f.count, positions, velocities, NULL));
  free(positions);
  free(velocities);
  return f;
}

static void look(fluid *f) {
  test_read(f->solver, f->dimension, f->precision, f->count, f->x, f->v);
}

static void destroy(fluid *f) {
  pbf_destroy(f->solver);
  free(f->x);
  free(f->v);
}

/* ---- Decay ----------------------------------------------------------------------------------- */

enum { SIDE = 24 };

static double wave_number(void) { return 2 * pi / (SIDE * spacing); }

static void shear(const double x[3], double v[3]) {
  v[0] = 0.01 * cos(wave_number() * x[1]);
  v[1] = v[2] = 0;
}

/* How much of the wave, a length of it, is left in the middle, over so much without viscosity. */
static double left_of_wave(uint32_t dimension, uint32_t precision, double support, double viscosity,
                           double dt, uint32_t steps) {
  double sums[2] = {0, 0};
  for (int viscous = 0; viscous < 2; ++viscous) {
    const pbf_params params = params_of(support, viscous ? viscosity : 0, dt);
    fluid f = fluid_of(dimension, precision, &params, SIDE, spacing, shear);
    assert_ok(pbf_step(f.solver, steps));
    look(&f);
    for (uint32_t i = 0; i < f.count; ++i) {
      const double *x = f.x + i * dimension;
      int inside = 1;
      for (uint32_t k = 0; k < dimension; ++k)
        inside &= k == 1 || fabs(x[k]) < 0.25 * SIDE * spacing;
      if (inside) sums[viscous] += f.v[i * dimension] * cos(wave_number() * x[1]);
    }
    destroy(&f);
  }
  return sums[1] / sums[0];
}

/* Of the implicit Euler method a wave is 1 / (1 + nu k² dt) after a step, and so exp(-nu k² t)
 * where that is little: in one stage, in several, and in many (in 2D). */
static void check_decay(uint32_t dimension, uint32_t precision, double support) {
  const double viscosities[] = {2e-3, 2e-2, 0.1}, time = 1.0 / 60, accuracy = 0.03;
  for (int k = 0; k < 3; ++k) {
    if (dimension == 3 && k != 1) continue;
    for (uint32_t steps = 1; steps <= 4; steps += 3) {
      const double dt = time / steps, rate = viscosities[k] * wave_number() * wave_number();
      const double decay =
          -log(left_of_wave(dimension, precision, support, viscosities[k], dt, steps));
      const double right = steps * log1p(rate * dt);
      if (!(fabs(decay / right - 1) < accuracy))
        fail_msg("%uD, h = %g spacings, viscosity %g, %u steps: decays by exp(-%g), it must be %g",
                 dimension, support, viscosities[k], steps, decay, right);
    }
  }
}

static void shear_decays(void **state) {
  (void)state;
  check_decay(2, PBF_FLOAT64, 2);
  check_decay(2, PBF_FLOAT64, 3);
  check_decay(3, PBF_FLOAT32, 2);
}

/* ---- Momentum -------------------------------------------------------------------------------- */

/* Any velocity, from the place, and not its opposite at the opposite place. */
static void whirl(const double x[3], double v[3]) {
  for (int k = 0; k < 3; ++k) v[k] = sin(29 * x[k] + 13 * x[(k + 1) % 3] - 41 * x[(k + 2) % 3] + 1);
}

/* Sums of v, and of x × v, in units of their largest possible values. */
static void momenta(const fluid *f, double sums[6]) {
  for (int k = 0; k < 6; ++k) sums[k] = 0;
  for (uint32_t i = 0; i < f->count; ++i)
    test_add_momenta(sums, f->dimension, 1.0 / f->count, f->x + i * f->dimension,
                     f->v + i * f->dimension);
}

/* Places so far apart are too thin for pressure: what changes momenta is viscosity alone, and the
 * way of a step along the velocity does not change x × v. In crowds pressure changes that. */
static void check_momenta_of(uint32_t dimension, uint32_t precision, double apart,
                             int momenta_kept) {
  const pbf_params params = params_of(3, 2, 1e-3);
  double rounding = precision == PBF_FLOAT32 ? 1e-6 : 1e-14;
  if (apart < 1 && strcmp(test_backend(), "cuda") == 0)
    rounding = fmax(rounding, dimension == 2 ? 1e-10 : 5e-7); /* docs/limits.md: crowds */
  fluid f = fluid_of(dimension, precision, &params, 10, apart * spacing, whirl);
  double before[6], after[6], change = 0;
  look(&f);
  momenta(&f, before);
  double *start = f.v;
  f.v = calloc((size_t)f.count * dimension, sizeof *f.v);
  assert_non_null(f.v);
  assert_ok(pbf_step(f.solver, 1));
  look(&f);
  momenta(&f, after);
  for (uint32_t i = 0; i < f.count * dimension; ++i)
    change += fabs(f.v[i] - start[i]) / (f.count * dimension);
  free(start);
  for (int k = 0; k < momenta_kept; ++k)
    if (!(fabs(after[k] - before[k]) < rounding * change))
      fail_msg(
          "%uD, float%u, %g spacings apart: momentum %d changes by %g of the velocities' change",
          dimension, 8 * precision, apart, k, (after[k] - before[k]) / change);
  assert_true(change > 0.1); /* it does act */
  destroy(&f);
}

static void check_momenta(uint32_t dimension, uint32_t precision) {
  check_momenta_of(dimension, precision, 1.6, 6);
  check_momenta_of(dimension, precision, 0.6, 3);
}

static void momenta_are_kept(void **state) {
  (void)state;
  test_for_each_kind(check_momenta);
}

static void turn(const double x[3], double v[3]) {
  v[0] = -x[1];
  v[1] = x[0];
  v[2] = 0;
}

/* In a step of dt a body that turns grows by dt²/2 along its radii: no more than that is shear. */
static void check_rotation(uint32_t dimension, uint32_t precision) {
  const double dt = 1e-4;
  const pbf_params params = params_of(3, 0.5, dt);
  fluid f = fluid_of(dimension, precision, &params, 10, 1.6 * spacing, turn);
  look(&f);
  double *start = f.v, change = 0;
  f.v = calloc((size_t)f.count * dimension, sizeof *f.v);
  assert_non_null(f.v);
  assert_ok(pbf_step(f.solver, 1));
  look(&f);
  for (uint32_t i = 0; i < f.count * dimension; ++i) change = fmax(change, fabs(f.v[i] - start[i]));
  if (!(change < 2 * dt)) fail_msg("%uD: a velocity changes by %g", dimension, change);
  free(start);
  destroy(&f);
}

static void solid_rotation_goes_on(void **state) {
  (void)state;
  test_for_each_kind(check_rotation);
}

/* ---- Any viscosity ----------------------------------------------------------------------------
 */

static double energy(const fluid *f) {
  double sum = 0;
  for (uint32_t i = 0; i < f->count * f->dimension; ++i) sum += f->v[i] * f->v[i];
  return sum;
}

/* From a hundredth of water's to what no time step has stages enough for: nothing becomes faster,
 * and of what is thicker no more is left. */
static void check_range(uint32_t dimension, uint32_t precision) {
  double before = 0;
  for (double viscosity = 1e-8; viscosity < 1e13; viscosity *= 1e4) {
    const pbf_params params = params_of(2, viscosity, 1.0 / 60);
    fluid f = fluid_of(dimension, precision, &params, 8, 0.9 * spacing, whirl);
    look(&f);
    const double start = energy(&f);
    assert_ok(pbf_step(f.solver, 3));
    look(&f);
    const double left = energy(&f) / start;
    if (!(left < 2 && (before == 0 || left < 1.2 * before)))
      fail_msg("%uD, viscosity %g: energy times %g, before %g", dimension, viscosity, left, before);
    before = left;
    destroy(&f);
  }
}

static void any_viscosity_is_stable(void **state) {
  (void)state;
  test_for_each_kind(check_range);
}

/* The stub has no viscosity. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shear_decays),
      cmocka_unit_test(momenta_are_kept),
      cmocka_unit_test(solid_rotation_goes_on),
      cmocka_unit_test(any_viscosity_is_stable),
  };
  return TEST_RUN(tests);
}
