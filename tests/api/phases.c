/* Several fluids: layers press with their own weights, light fluid rises in heavy fluid, momentum
 * is kept whatever the masses, and an interface that is the wrong way up grows as linear theory
 * says. */
#include "phase_scene.h"

static const double pi = 3.14159265358979323846;

static double mass(const fluid *f, uint32_t i) {
  return f->density[f->phase[i]] * pow(spacing, f->dimension);
}

static double speed2(const fluid *f, uint32_t i) {
  double sum = 0;
  for (uint32_t k = 0; k < f->dimension; ++k)
    sum += f->v[i * f->dimension + k] * f->v[i * f->dimension + k];
  return sum;
}

static double mean_height(const fluid *f, uint32_t phase) {
  double sum = 0, count = 0;
  for (uint32_t i = 0; i < f->count; ++i)
    if (f->phase[i] == phase) sum += f->x[i * f->dimension + 1], count += 1;
  return sum / count;
}

/* Kinetic and potential. */
static double energy(const fluid *f) {
  double sum = 0;
  for (uint32_t i = 0; i < f->count; ++i)
    sum += mass(f, i) * (0.5 * speed2(f, i) + gravity * f->x[i * f->dimension + 1]);
  return sum;
}

/* ---- Places ---------------------------------------------------------------------------------- */

static uint32_t upper_half(const fluid *f, const double x[3]) {
  return x[1] > 0.5 * spacing * f->size[1];
}

static uint32_t lower_half(const fluid *f, const double x[3]) { return !upper_half(f, x); }

static uint32_t ball(const fluid *f, const double x[3]) {
  double r2 = 0;
  for (uint32_t k = 0; k < f->dimension; ++k) {
    const double middle = (k == 1 ? 0.3 : 0.5) * spacing * f->size[k];
    r2 += (x[k] - middle) * (x[k] - middle);
  }
  return r2 < 9 * spacing * spacing;
}

static uint32_t waved(const fluid *f, const double x[3]) {
  const double width = spacing * f->size[0];
  return x[1] > 0.5 * spacing * f->size[1] + spacing * cos(pi * x[0] / width);
}

/* ---- Weight ---------------------------------------------------------------------------------- */

/* The floor carries both layers, and in each the pressure grows with its own density. */
static void check_layers_of(uint32_t dimension, uint32_t precision, double upper) {
  const uint32_t size[3] = {10, 12, dimension == 3 ? 6 : 1};
  const double density[2] = {1, upper};
  pbf_params params = params_of(size, 1.5);
  params.loads = 1;
  fluid f = fluid_of(dimension, precision, &params, size, 0, density, upper_half);
  pbf_collider_load walls[6] = {{.struct_size = sizeof walls[0]}};
  double weight = 0, rows[2] = {0, 0}, counts[2] = {0, 0};
  assert_ok(pbf_step(f.solver, 240));
  for (int k = 0; k < 6; ++k) walls[k].struct_size = sizeof walls[k];
  assert_ok(pbf_get_wall_loads(f.solver, 2 * dimension, walls));
  assert_ok(pbf_step(f.solver, 240));
  assert_ok(pbf_get_wall_loads(f.solver, 2 * dimension, walls));
  char *pressures = calloc(f.count, precision);
  assert_non_null(pressures);
  assert_ok(pbf_get_pressures(f.solver, 0, f.count, pressures));
  look(&f);
  for (uint32_t i = 0; i < f.count; ++i) {
    const double y = f.x[i * dimension + 1], p = test_value(pressures, i, precision);
    const double surface = spacing * size[1], middle = 0.5 * surface;
    const double right = y > middle ? upper * gravity * (surface - y)
                                    : gravity * (upper * (surface - middle) + middle - y);
    weight += mass(&f, i) * gravity;
    if (f.phase[i]) continue;
    rows[0] += p, counts[0] += 1, rows[1] += right, counts[1] += 1;
  }
  free(pressures);
  const double carried = -walls[PBF_WALL_Y_MIN].impulse_sum[1] / walls[PBF_WALL_Y_MIN].time_sum;
  if (!(fabs(carried / weight - 1) < 2e-3))
    fail_msg("%uD, float%u, 1 : %g: the floor carries %g of the weight", dimension, 8 * precision,
             upper, carried / weight);
  if (!(fabs(rows[0] / rows[1] - 1) < 0.06))
    fail_msg("%uD, float%u, 1 : %g: the lower layer's pressure is %g of the layers' weight",
             dimension, 8 * precision, upper, rows[0] / rows[1]);
  if (!(mean_height(&f, 1) > mean_height(&f, 0) + 0.4 * spacing * size[1]))
    fail_msg("%uD, 1 : %g: the layers have mixed", dimension, upper);
  destroy(&f);
}

static void check_layers(uint32_t dimension, uint32_t precision) {
  check_layers_of(dimension, precision, 0.6);
  check_layers_of(dimension, precision, 0.1);
  check_layers_of(dimension, precision, 0.001);
}

static void layers_weigh_what_they_weigh(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_layers);
}

/* ---- Rise ------------------------------------------------------------------------------------ */

/* A ball of light fluid comes up, and what it sets free is no more than it had. A thousandth of the
 * weight above it is more than a few iterations hold: it gives way at first, and what that throws
 * may have a third more energy, but no speed beyond it, and is at rest again in the end. */
static void check_rise_of(uint32_t dimension, uint32_t precision, double light) {
  const uint32_t size[3] = {12, 16, dimension == 3 ? 10 : 1};
  const double density[2] = {1, light}, height = spacing * size[1];
  const double room = light < 0.01 ? 1.35 : 1.01;
  const pbf_params params = params_of(size, 1.6);
  fluid f = fluid_of(dimension, precision, &params, size, 0, density, ball);
  look(&f);
  const double before = energy(&f), start = mean_height(&f, 1);
  double most = 0, fastest = 0;
  for (int k = 0; k < 36; ++k) {
    assert_ok(pbf_step(f.solver, 10));
    look(&f);
    most = fmax(most, energy(&f));
    fastest = 0;
    for (uint32_t i = 0; i < f.count; ++i)
      if (!f.phase[i]) fastest = fmax(fastest, speed2(&f, i));
    if (light > 0.01 && !(fastest < 2 * gravity * height))
      fail_msg("%uD, float%u, 1 : %g: heavy fluid flies at %g", dimension, 8 * precision, light,
               sqrt(fastest));
  }
  if (!(mean_height(&f, 1) > start + 0.3 * height))
    fail_msg("%uD, float%u, 1 : %g: light fluid rises from %g to %g", dimension, 8 * precision,
             light, start, mean_height(&f, 1));
  if (!(most < room * before))
    fail_msg("%uD, float%u, 1 : %g: energy grows to %g", dimension, 8 * precision, light,
             most / before);
  if (!(fastest < 0.2 * gravity * height))
    fail_msg("%uD, float%u, 1 : %g: heavy fluid is not at rest, but at %g", dimension,
             8 * precision, light, sqrt(fastest));
  destroy(&f);
}

static void check_rise(uint32_t dimension, uint32_t precision) {
  check_rise_of(dimension, precision, 0.5);
  check_rise_of(dimension, precision, 0.1);
  check_rise_of(dimension, precision, 0.001);
}

static void light_fluid_rises(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_rise);
}

/* ---- Layers ---------------------------------------------------------------------------------- */

/* How much higher the lighter fluid is in the mean, over that of two layers: 1 where it lies upon
 * the other, -1 where it lies under it. */
static double parted(const fluid *f) {
  return (mean_height(f, 1) - mean_height(f, 0)) / (0.5 * spacing * f->size[1]);
}

/* Fluid of 0.5 on the floor comes up, all but a seventh, and three tenths of its lowest layer,
 * which has 16 particles in 2D: walls that hold a layer by its distance alone, and pairs that carry
 * the whole pressure, leave nine tenths of that. In 3D 0.8 turns over, which they would not let
 * move. */
static void check_sort_of(uint32_t dimension, uint32_t precision, double light, uint32_t steps) {
  const uint32_t size[3] = {dimension == 3 ? 8 : 16, 8, dimension == 3 ? 8 : 1};
  const double density[2] = {1, light};
  const pbf_params params = params_of(size, 0.8);
  fluid f = fluid_of(dimension, precision, &params, size, 0.4, density, lower_half);
  uint32_t left = 0;
  look(&f);
  if (!(parted(&f) < -0.95)) fail_msg("the lighter fluid is below at first: %g", parted(&f));
  assert_ok(pbf_step(f.solver, steps));
  look(&f);
  for (uint32_t i = 0; i < f.count; ++i)
    left += f.phase[i] && f.x[i * dimension + 1] < 0.8 * spacing;
  const double least = light > 0.6 ? 0.7 : 0.85;
  if (!(parted(&f) > least) || !(left < 0.3 * size[0] * size[2]))
    fail_msg("%uD, float%u, 1 : %g: parted by %g, %u particles of %u left on the floor", dimension,
             8 * precision, light, parted(&f), left, size[0] * size[2]);
  destroy(&f);
}

static void check_sort(uint32_t dimension, uint32_t precision) {
  check_sort_of(dimension, precision, 0.5, 720);
  if (dimension == 3) check_sort_of(dimension, precision, 0.8, 1920);
}

static void light_layers_leave_the_floor(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_sort);
}

/* A lighter layer on a heavier one, off its lattice: after five seconds it is at rest. */
static void check_rest_of(uint32_t dimension, uint32_t precision, double upper) {
  const uint32_t size[3] = {dimension == 3 ? 12 : 24, 16, dimension == 3 ? 12 : 1};
  const double density[2] = {1, upper};
  const pbf_params params = params_of(size, 1.2);
  fluid f = fluid_of(dimension, precision, &params, size, 0.4, density, upper_half);
  double sum = 0, samples = 0;
  assert_ok(pbf_step(f.solver, 600));
  for (int k = 0; k < 10; ++k) {
    assert_ok(pbf_step(f.solver, 12));
    look(&f);
    for (uint32_t i = 0; i < f.count; ++i) sum += speed2(&f, i), samples += 1;
  }
  if (!(sqrt(sum / samples) < 0.02 * sqrt(gravity * spacing)))
    fail_msg("%uD, float%u, 1 : %g: moves at %g sqrt(g d)", dimension, 8 * precision, upper,
             sqrt(sum / samples / (gravity * spacing)));
  destroy(&f);
}

static void check_rest(uint32_t dimension, uint32_t precision) {
  check_rest_of(dimension, precision, 0.9);
  check_rest_of(dimension, precision, 0.5);
}

static void layers_come_to_rest(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_rest);
}

/* Oil of 0.9 under water: what pressed fluid resists of shear would hold it there. */
static void oil_rises(void **state) {
  const uint32_t size[3] = {20, 24, 1};
  const double density[2] = {1, 0.9};
  const pbf_params params = params_of(size, 2);
  (void)state;
  if (!test_has_kind(2, PBF_FLOAT32)) return;
  fluid f = fluid_of(2, PBF_FLOAT32, &params, size, 0, density, ball);
  look(&f);
  const double start = mean_height(&f, 1);
  assert_ok(pbf_step(f.solver, 300));
  look(&f);
  if (!(mean_height(&f, 1) > start + 6 * spacing))
    fail_msg("oil has come from %g to %g", start, mean_height(&f, 1));
  destroy(&f);
}

/* ---- Momentum -------------------------------------------------------------------------------- */

static void momenta(const fluid *f, double sums[6], double *scale) {
  for (int k = 0; k < 6; ++k) sums[k] = 0;
  *scale = 0;
  for (uint32_t i = 0; i < f->count; ++i) {
    const double *v = f->v + i * f->dimension;
    test_add_momenta(sums, f->dimension, mass(f, i), f->x + i * f->dimension, v);
    for (uint32_t k = 0; k < f->dimension; ++k) *scale += mass(f, i) * fabs(v[k]);
  }
}

/* Fluids mixed particle by particle, stirred, and touched by nothing: with and without viscosity,
 * and by all corrections of velocities. */
static void check_momenta_of(uint32_t dimension, uint32_t precision, double light, int kind) {
  const uint32_t size[3] = {9, 9, dimension == 3 ? 9 : 1};
  const double density[2] = {1, light};
  const double rounding = precision == PBF_FLOAT32 ? 2e-5 : 1e-13;
  pbf_params params = params_of(size, 1);
  params.gravity[1] = params.prestabilization = 0;
  for (int k = 0; k < 3; ++k) params.domain_min[k] = -40, params.domain_max[k] = 40;
  if (kind == 1) params.viscosity = 0.01;
  if (kind == 2) params.damping_compensation = 1;
  if (kind == 3) params.shear_stress_correction = 0.75, params.angular_momentum_correction = 0;
  fluid f = fluid_of(dimension, precision, &params, size, 0.3, density, mixed);
  char *values = calloc((size_t)f.count * dimension, precision);
  assert_non_null(values);
  for (uint32_t i = 0; i < f.count * dimension; ++i)
    test_put(values, i, precision, sin(1.7 * i * i + 1) + (i % dimension == 0 ? 0.3 : 0));
  assert_ok(pbf_set_velocities(f.solver, 0, f.count, values));
  free(values);
  double before[6], after[6], scale, later, change = 0;
  look(&f);
  momenta(&f, before, &scale);
  double *start = f.v;
  f.v = calloc((size_t)f.count * dimension, sizeof *f.v);
  assert_non_null(f.v);
  assert_ok(pbf_step(f.solver, 20));
  look(&f);
  momenta(&f, after, &later);
  for (uint32_t i = 0; i < f.count * dimension; ++i)
    change += mass(&f, i / dimension) * fabs(f.v[i] - start[i]);
  free(start);
  if (!(change > 0.1 * scale)) fail_msg("nothing meets: %g", change / scale);
  for (int k = 0; k < (kind == 0 ? 6 : 3); ++k)
    if (!(fabs(after[k] - before[k]) <
          (dimension == 3 && k > 2 ? fmax(rounding, 1e-7) : rounding) * scale))
      fail_msg("%uD, float%u, 1 : %g, kind %d: momentum %d changes by %g", dimension, 8 * precision,
               light, kind, k, (after[k] - before[k]) / scale);
  destroy(&f);
}

static void check_momenta(uint32_t dimension, uint32_t precision) {
  for (int kind = 0; kind < 4; ++kind) {
    check_momenta_of(dimension, precision, 0.1, kind);
    check_momenta_of(dimension, precision, 0.001, kind);
  }
}

static void momenta_are_kept(void **state) {
  (void)state;
  test_for_each_kind(check_momenta);
}

/* In free fall all of it has fallen by g t²/2 and a step's share, its parts whatever they do. */
static void check_fall(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {8, 8, dimension == 3 ? 8 : 1}, steps = 24;
  const double density[2] = {3, 0.03};
  pbf_params params = params_of(size, 1);
  for (int k = 0; k < 3; ++k) params.domain_min[k] = -4, params.domain_max[k] = 4;
  fluid f = fluid_of(dimension, precision, &params, size, 0.3, density, mixed);
  double sums[2] = {0, 0}, all = 0;
  const double dt = params.time_step, rounding = precision == PBF_FLOAT32 ? 1e-5 : 1e-12;
  for (int after = 0; after < 2; ++after) {
    look(&f);
    for (uint32_t i = 0; i < f.count; ++i) {
      sums[after] += mass(&f, i) * f.x[i * dimension + 1];
      if (!after) all += mass(&f, i);
    }
    if (!after) assert_ok(pbf_step(f.solver, steps));
  }
  const double fallen = (sums[0] - sums[1]) / all;
  const double right = 0.5 * gravity * dt * dt * steps * (steps + 1);
  if (!(fabs(fallen - right) < rounding))
    fail_msg("%uD, float%u: the centre of mass has fallen by %.9g, it must be %.9g", dimension,
             8 * precision, fallen, right);
  destroy(&f);
}

static void the_centre_of_mass_falls(void **state) {
  (void)state;
  test_for_each_kind(check_fall);
}

/* ---- Instability ----------------------------------------------------------------------------- */

static double amplitude(const fluid *f) {
  const double width = spacing * f->size[0];
  double sum = 0;
  for (uint32_t i = 0; i < f->count; ++i)
    if (!f->phase[i]) sum += 2 / width * spacing * spacing * cos(pi * f->x[2 * i] / width);
  return sum;
}

/* Heavy fluid over light fluid in a box, both of the same height H: a wave of the length 2 pi / k
 * grows as cosh(s t), s² = A g k tanh(k H), A = (3 - 1) / (3 + 1) (Rayleigh 1882, Taylor 1950). So
 * long as it is no steeper than k a = 1/4 it does so within 15 %. */
static void interfaces_grow(void **state) {
  const uint32_t size[3] = {40, 40, 1};
  const double density[2] = {1, 3}, k = pi / (spacing * size[0]);
  const double rate = sqrt(0.5 * k * tanh(0.5 * k * spacing * size[1]));
  double best = INFINITY, found = 0, times[64], amplitudes[64];
  int count = 0;
  (void)state;
  if (!test_has_kind(2, PBF_FLOAT64)) return;
  pbf_params params = params_of(size, spacing * size[1]);
  params.gravity[1] = -1;
  params.iterations = 10;
  params.prestabilization = 0;
  fluid f = fluid_of(2, PBF_FLOAT64, &params, size, 0, density, waved);
  for (; count < 64; ++count) {
    look(&f);
    times[count] = 16 * count * params.time_step;
    amplitudes[count] = amplitude(&f);
    if (k * amplitudes[count] > 0.25) break;
    assert_ok(pbf_step(f.solver, 16));
  }
  for (double s = 0.3 * rate; s < 1.7 * rate; s += 0.005 * rate) {
    double error = 0;
    for (int n = 0; n < count; ++n)
      error += pow(amplitudes[n] - amplitudes[0] * cosh(s * times[n]), 2);
    if (error < best) best = error, found = s / rate;
  }
  if (!(found > 0.85 && found < 1.15)) fail_msg("it grows %g times as fast as it should", found);
  destroy(&f);
}

/* ---- Viscosity ------------------------------------------------------------------------------- */

/* A fluid all of one phase has its part of the viscosity, whatever it weighs: a shear wave is
 * 1 / (1 + nu k² dt) after a step (tests/api/viscosity.c). */
static double left_of_wave(double density, double part, double viscosity) {
  const uint32_t size[3] = {24, 24, 1};
  const double densities[2] = {density, 1}, k = 2 * pi / (size[1] * spacing);
  pbf_params params = params_of(size, 1);
  params.gravity[1] = params.prestabilization = 0;
  params.time_step = 1.0 / 60;
  params.viscosity = viscosity;
  for (int axis = 0; axis < 3; ++axis) params.domain_min[axis] = -4, params.domain_max[axis] = 4;
  fluid f = fluid_of(2, PBF_FLOAT64, &params, size, 0, densities, mixed);
  double *v = calloc((size_t)f.count * 2, sizeof *v), sum = 0;
  assert_non_null(v);
  memset(f.phase, 0, f.count * sizeof *f.phase);
  assert_ok(pbf_set_particle_phases(f.solver, 0, f.count, f.phase));
  pbf_phase phases[2];
  for (int n = 0; n < 2; ++n) assert_ok(pbf_phase_init(&phases[n], sizeof phases[n]));
  phases[0].rest_density = density;
  phases[0].viscosity = part;
  assert_ok(pbf_set_phases(f.solver, 2, phases));
  look(&f);
  for (uint32_t i = 0; i < f.count; ++i) v[2 * i] = 0.01 * cos(k * f.x[2 * i + 1]);
  assert_ok(pbf_set_velocities(f.solver, 0, f.count, v));
  assert_ok(pbf_step(f.solver, 1));
  look(&f);
  for (uint32_t i = 0; i < f.count; ++i)
    if (fabs(f.x[2 * i] - 0.6) < 0.3) sum += f.v[2 * i] * cos(k * f.x[2 * i + 1]);
  free(v);
  destroy(&f);
  return sum;
}

static void phases_have_viscosities(void **state) {
  const double viscosity = 0.02, k = 2 * pi / (24 * spacing), cases[][2] = {{5, 1}, {0.2, 0.25}};
  (void)state;
  if (!test_has_kind(2, PBF_FLOAT64)) return;
  for (int n = 0; n < 2; ++n) {
    const double decay = -log(left_of_wave(cases[n][0], cases[n][1], viscosity) /
                              left_of_wave(cases[n][0], cases[n][1], 0));
    const double right = log1p(cases[n][1] * viscosity * k * k / 60);
    if (!(fabs(decay / right - 1) < 0.03))
      fail_msg("density %g, part %g: decays by exp(-%g), it must be %g", cases[n][0], cases[n][1],
               decay, right);
  }
}

/* The stub knows no masses. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layers_weigh_what_they_weigh),
      cmocka_unit_test(light_fluid_rises),
      cmocka_unit_test(light_layers_leave_the_floor),
      cmocka_unit_test(layers_come_to_rest),
      cmocka_unit_test(oil_rises),
      cmocka_unit_test(momenta_are_kept),
      cmocka_unit_test(the_centre_of_mass_falls),
      cmocka_unit_test(interfaces_grow),
      cmocka_unit_test(phases_have_viscosities),
  };
  return TEST_RUN(tests);
}
