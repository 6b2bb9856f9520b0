/* The pressure grid's surface lies wherever the fluid's does, not where its cells end: waves lower
 * than a cell, pressure from the surface on, and drops above it. Cells are four spacings wide, six
 * in 2D. */
#include "support.h"

#include <math.h>

enum { WIDE = 40, THICK = 3, ROOM = WIDE * 48 * THICK };

static const double spacing = 0.05, gravity = 9.81;

/* Lattice water in a tank, layer on layer, with the velocities of a standing wave of one amplitude
 * in spacings: potential flow with a wall on each side of half a wavelength. */
typedef struct tank {
  uint32_t dimension, precision, wide, layers, count;
  double number, frequency; /* of the wave, over length and time */
  pbf_solver *solver;
} tank;

static tank tank_of(uint32_t dimension, uint32_t precision, uint32_t wide, uint32_t layers,
                    double amplitude) {
  const double pi = 3.141592653589793, depth = layers * spacing;
  tank t = {dimension,
            precision,
            wide,
            layers,
            wide * layers * (dimension == 3 ? THICK : 1),
            pi / (wide * spacing),
            0,
            NULL};
  t.frequency = sqrt(gravity * t.number * tanh(t.number * depth));
  pbf_desc desc = test_desc(dimension, precision, ROOM);
  pbf_params params = test_params();
  params.spacing = spacing;
  params.pressure_grid = 2;
  if (dimension == 2) params.smoothing_radius = 3 * spacing;
  params.domain_max[0] = wide * spacing;
  params.domain_max[1] = 2.5 * WIDE * spacing;
  params.domain_max[2] = THICK * spacing;
  t.solver = test_create(&desc, &params);
  void *x = calloc((size_t)t.count * dimension, precision);
  void *v = calloc((size_t)t.count * dimension, precision);
  assert_non_null(x);
  assert_non_null(v);
  double scale = amplitude * spacing * t.frequency / sinh(t.number * depth);
  for (uint32_t i = 0; i < t.count; ++i) {
    const uint32_t at[3] = {i % wide, i / wide % layers, i / wide / layers};
    const uint64_t first = (uint64_t)i * dimension;
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, first + k, precision, spacing * (at[k] + 0.5));
    double along = t.number * spacing * (at[0] + 0.5), up = t.number * spacing * (at[1] + 0.5);
    test_put(v, first, precision, -scale * cosh(up) * sin(along));
    test_put(v, first + 1, precision, scale * sinh(up) * cos(along));
  }
  assert_ok(pbf_add_particles(t.solver, t.count, x, v, NULL));
  free(x);
  free(v);
  return t;
}

static double *positions_of(const tank *t, uint32_t count) {
  void *x = calloc((size_t)count * t->dimension, t->precision);
  double *places = calloc((size_t)count * t->dimension, sizeof *places);
  assert_ok(pbf_get_positions(t->solver, 0, count, x));
  for (uint64_t i = 0; i < (uint64_t)count * t->dimension; ++i)
    places[i] = test_value(x, i, t->precision);
  free(x);
  return places;
}

/* The wave's height, in spacings. */
static double height_of(const tank *t) {
  double *x = positions_of(t, t->count), sum = 0;
  for (uint32_t i = 0; i < t->count; ++i) sum += cos(t->number * x[(size_t)i * t->dimension]);
  free(x);
  return 2 * sum * t->layers / t->count;
}

/* Its period over that of linear theory, and its height after half of it. */
static double period_of(const tank *t, double time_step, double *height) {
  const double pi = 3.141592653589793, expected = 2 * pi / t->frequency;
  double last = 0;
  *height = 0;
  for (int step = 1, crossed = 0; step * time_step < 1.5 * expected; ++step) {
    assert_ok(pbf_step(t->solver, 1));
    double now = height_of(t);
    if (crossed) *height = fmax(*height, fabs(now));
    if (step > 5 && (now < 0) != (last < 0) && ++crossed == 2)
      return (step - 1 + last / (last - now)) * time_step / expected;
    last = now;
  }
  return 1.5;
}

static void check_wave(uint32_t dimension, uint32_t precision) {
  tank t = tank_of(dimension, precision, WIDE, 40, 1);
  double height, period = period_of(&t, 1.0 / 120, &height);
  if (!(fabs(period - 1) < 0.1 && height > 0.7))
    fail_msg("%uD: period off by %g, %g high", dimension, period - 1, height);
  pbf_destroy(t.solver);
}

static void waves_lower_than_a_cell(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_wave);
}

/* Where the line through the pressures ends, in layers. */
static double pressure_begins(const tank *t) {
  double *x = positions_of(t, t->count), y1 = 0, y2 = 0, p1 = 0, yp = 0, n = t->count;
  void *pressures = calloc(t->count, t->precision);
  assert_ok(pbf_get_pressures(t->solver, 0, t->count, pressures));
  for (uint32_t i = 0; i < t->count; ++i) {
    double y = x[(size_t)i * t->dimension + 1], p = test_value(pressures, i, t->precision);
    y1 += y;
    y2 += y * y;
    p1 += p;
    yp += y * p;
  }
  free(x);
  free(pressures);
  double slope = (n * yp - y1 * p1) / (n * y2 - y1 * y1);
  return (y1 - p1 / slope) / n / spacing;
}

static void check_pressure(uint32_t dimension, uint32_t precision) {
  for (uint32_t layers = 38; layers <= 43; ++layers) {
    tank t = tank_of(dimension, precision, 8, layers, 0);
    assert_ok(pbf_step(t.solver, 120));
    double off = pressure_begins(&t) - layers;
    if (!(fabs(off) < 0.75))
      fail_msg("%uD, %u layers: pressure begins %g too high", dimension, layers, off);
    pbf_destroy(t.solver);
  }
}

static void pressure_begins_at_the_surface(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_pressure);
}

/* Out of reach of the fluid, but in a cell of the surface. */
static void check_drop(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 3 };
  for (uint32_t layers = 38; layers <= 43; ++layers) {
    tank t = tank_of(dimension, precision, 8, layers, 0);
    double reach = dimension == 2 ? 3 : 2, level[3];
    _Alignas(8) unsigned char x[3 * 8], v[3 * 8];
    assert_ok(pbf_step(t.solver, 30));
    for (uint32_t k = 0; k < dimension; ++k) {
      level[k] = spacing * (k == 1 ? layers + reach - 0.3 : k == 0 ? 4 : 0.5 * THICK);
      test_put(x, k, precision, level[k]);
      test_put(v, k, precision, 0);
    }
    assert_ok(pbf_add_particles(t.solver, 1, x, v, NULL));
    assert_ok(pbf_step(t.solver, STEPS));
    assert_ok(pbf_get_velocities(t.solver, t.count, 1, v));
    double fall = -test_value(v, 1, precision) / (gravity * STEPS / 120);
    if (!(fabs(fall - 1) < 1e-3))
      fail_msg("%uD, %u layers: a drop falls at %g g", dimension, layers, fall);
    pbf_destroy(t.solver);
  }
}

static void drops_above_it_fall(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_drop);
}

/* Gravity tilted by an angle, the surface across the cells: RMS speed after `seconds`, in
 * sqrt(g d). */
static double tilted(uint32_t dimension, uint32_t precision, double angle, double time_step,
                     double seconds) {
  tank t = tank_of(dimension, precision, 16, 24, 0);
  pbf_params params = {.struct_size = sizeof params};
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_params(t.solver, &params));
  params.gravity[0] = gravity * sin(angle);
  params.gravity[1] = -gravity * cos(angle);
  params.smoothing_radius = 2 * spacing;
  params.time_step = time_step;
  assert_ok(pbf_set_params(t.solver, &params));
  assert_ok(pbf_step(t.solver, (uint32_t)(seconds / time_step + 0.5)));
  assert_ok(pbf_get_stats(t.solver, &stats));
  pbf_destroy(t.solver);
  return sqrt(2 * stats.kinetic_energy / (gravity * spacing));
}

/* It comes to rest, and does not begin to stir itself: tilted by a degree it had reached 0.1, with
 * its surface at nodes. The other one still sloshes. */
static void check_tilted(uint32_t dimension, uint32_t precision) {
  const double angles[] = {0.0175, 0.25}, steps[] = {1. / 60, 1. / 120}, bounds[] = {0.03, 0.08};
  for (int k = 0; k < 2; ++k) {
    double speed = tilted(dimension, precision, angles[k], steps[k], 6);
    if (!(speed < bounds[k]))
      fail_msg("%uD, tilted by %g: it moves at %g sqrt(g d)", dimension, angles[k], speed);
  }
}

static void tilted_water_rests(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_tilted);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(waves_lower_than_a_cell),
      cmocka_unit_test(pressure_begins_at_the_surface),
      cmocka_unit_test(drops_above_it_fall),
      cmocka_unit_test(tilted_water_rests),
  };
  return TEST_RUN(tests);
}
