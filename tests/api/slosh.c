/* Waves that slosh to and fro in shallow water, as `shear_stress_correction` lets them. */
#include "support.h"

#include <math.h>

enum { LAYERS = 10, COLUMNS = 40, CAPACITY = 2 * LAYERS * COLUMNS, PERIODS = 4 };

static const double gravity = 9.81, depth = 1.0, amplitude = 0.25, pi = 3.14159265358979323846;

/* The first mode of a tank four times as wide as deep: its surface stands at
 * depth + amplitude cos(pi x / width), and in each column are as many particles as fit. */
static pbf_solver *wave(uint32_t precision, double rate) {
  const double d = depth / LAYERS, width = COLUMNS * d;
  pbf_params p = test_params();
  p.spacing = d;
  p.smoothing_radius = 2 * d;
  p.time_step = 1 / rate;
  p.gravity[1] = -gravity;
  p.shear_stress_correction = 0.5;
  p.domain_max[0] = width;
  p.domain_max[1] = 3 * depth;
  const pbf_desc desc = test_desc(2, precision, CAPACITY);
  pbf_solver *s = test_create(&desc, &p);
  void *x = calloc(2 * CAPACITY, precision);
  uint32_t count = 0;
  for (int column = 0; column < COLUMNS; ++column) {
    const double at = (column + 0.5) * d, height = depth + amplitude * cos(pi * at / width);
    const int fit = (int)lround(height / d);
    for (int k = 0; k < fit; ++k, ++count) {
      test_put(x, 2 * count, precision, at);
      test_put(x, 2 * count + 1, precision, (k + 0.5) * height / fit);
    }
  }
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

static double offset(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats.center_of_mass[0] - COLUMNS * depth / LAYERS / 2;
}

/* omega² = g k tanh(k H) (Lamb, Hydrodynamics, art. 228); without viscosity it would not end. */
static void check(uint32_t precision, double rate) {
  const double width = COLUMNS * depth / LAYERS, k = pi / width;
  const double period = 2 * pi / sqrt(gravity * k * tanh(k * depth));
  pbf_solver *s = wave(precision, rate);
  double before = offset(s), start = fabs(before), first = 0, last = 0, left = 0;
  uint32_t crossings = 0;
  const uint32_t steps = (uint32_t)(PERIODS * period * rate);
  for (uint32_t n = 0; n < steps; ++n) {
    assert_ok(pbf_step(s, 1));
    const double now = offset(s);
    if ((now > 0) != (before > 0)) {
      last = (n + before / (before - now)) / rate;
      if (crossings++ == 0) first = last;
    }
    if (n > steps - period * rate) left = fmax(left, fabs(now));
    before = now;
  }
  pbf_destroy(s);
  assert_true(crossings > 2 * PERIODS - 2);
  const double measured = 2 * (last - first) / (crossings - 1);
  if (!(fabs(measured / period - 1) < 0.03))
    fail_msg("f%u, 1/%g s: a period takes %g s; right are %g", 8 * precision, rate, measured,
             period);
  if (!(left > 0.35 * start))
    fail_msg("f%u, 1/%g s: %g of a wave is left after %d periods; right were 1", 8 * precision,
             rate, left / start, PERIODS - 1);
}

static void waves_slosh_on(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no fluid");
  test_skip_if_watched();
  for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4)
    for (double rate = 60; rate < 250 && test_has_kind(2, precision); rate *= 2)
      check(precision, rate);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(waves_slosh_on)};
  return TEST_RUN(tests);
}
