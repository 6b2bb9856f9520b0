/* Several fluids: layers press with their own weights, light fluid rises in heavy fluid, momentum
 * is kept whatever the masses, an interface that is the wrong way up grows as linear theory says;
 * and phases follow their particles wherever these go. */
#include "support.h"

#include <math.h>

#include <pbf/emit.h>
#include <pbf/phases.h>

static const double spacing = 0.05, gravity = 9.81, pi = 3.14159265358979323846;

typedef struct fluid {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
  uint32_t size[3]; /* particles along each axis */
  double density[2];
  uint32_t *phase;
  double *x, *v; /* read back */
} fluid;

/* Of a place in the block, 0 or 1. */
typedef uint32_t (*phase_of)(const fluid *f, const double x[3]);

static pbf_params params_of(const uint32_t size[3], double height) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = 1.0 / 120;
  params.gravity[0] = params.gravity[2] = 0;
  params.gravity[1] = -gravity;
  for (int k = 0; k < 3; ++k) {
    params.domain_min[k] = 0;
    params.domain_max[k] = spacing * size[k];
  }
  params.domain_max[1] = height;
  return params;
}

static void set_phases(pbf_solver *solver, double lower, double upper, double viscosity) {
  pbf_phase phases[2];
  for (int k = 0; k < 2; ++k) {
    assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
    phases[k].rest_density = k ? upper : lower;
    phases[k].viscosity = viscosity;
  }
  assert_ok(pbf_set_phases(solver, 2, phases));
}

/* The places of a lattice that fills the block from the origin, shaken by so many spacings. */
static fluid fluid_of(uint32_t dimension, uint32_t precision, const pbf_params *params,
                      const uint32_t size[3], double shaken, const double density[2],
                      phase_of which) {
  fluid f = {.dimension = dimension, .precision = precision, .density = {density[0], density[1]}};
  memcpy(f.size, size, sizeof f.size);
  f.count = size[0] * size[1] * (dimension == 3 ? size[2] : 1);
  const pbf_desc desc = test_desc(dimension, precision, f.count + 8);
  f.solver = test_create(&desc, params);
  f.phase = calloc(f.count, sizeof *f.phase);
  f.x = calloc((size_t)f.count * dimension, sizeof *f.x);
  f.v = calloc((size_t)f.count * dimension, sizeof *f.v);
  char *values = calloc((size_t)f.count * dimension, precision);
  assert_true(f.phase && f.x && f.v && values);
  uint32_t random = 1;
  for (uint32_t i = 0; i < f.count; ++i) {
    const uint32_t at[3] = {i % size[0], i / size[0] % size[1], i / size[0] / size[1]};
    double x[3] = {0};
    for (uint32_t k = 0; k < dimension; ++k) x[k] = spacing * (at[k] + 0.5);
    f.phase[i] = which(&f, x);
    for (uint32_t k = 0; k < dimension; ++k) {
      random = 1664525 * random + 1013904223;
      x[k] += shaken * spacing * (random / 4294967296.0 - 0.5);
      test_put(values, (uint64_t)i * dimension + k, precision, x[k]);
    }
  }
  assert_ok(pbf_add_particles(f.solver, f.count, values, NULL, NULL));
  free(values);
  set_phases(f.solver, density[0], density[1], 1);
  assert_ok(pbf_set_particle_phases(f.solver, 0, f.count, f.phase));
  return f;
}

static void look(fluid *f) {
  const uint32_t numbers = f->count * f->dimension;
  char *raw = calloc(numbers, f->precision);
  assert_non_null(raw);
  assert_ok(pbf_get_positions(f->solver, 0, f->count, raw));
  for (uint32_t i = 0; i < numbers; ++i) f->x[i] = test_value(raw, i, f->precision);
  assert_ok(pbf_get_velocities(f->solver, 0, f->count, raw));
  for (uint32_t i = 0; i < numbers; ++i) f->v[i] = test_value(raw, i, f->precision);
  free(raw);
}

static void destroy(fluid *f) {
  pbf_destroy(f->solver);
  free(f->phase);
  free(f->x);
  free(f->v);
}

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

static uint32_t ball(const fluid *f, const double x[3]) {
  double r2 = 0;
  for (uint32_t k = 0; k < f->dimension; ++k) {
    const double middle = (k == 1 ? 0.3 : 0.5) * spacing * f->size[k];
    r2 += (x[k] - middle) * (x[k] - middle);
  }
  return r2 < 9 * spacing * spacing;
}

static uint32_t mixed(const fluid *f, const double x[3]) {
  (void)f;
  return sin(29 * x[0] + 13 * x[1] - 41 * x[2] + 7 * sin(50 * x[1])) > 0;
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
  check_layers_of(dimension, precision, 0.1);
  check_layers_of(dimension, precision, 0.001);
}

static void layers_weigh_what_they_weigh(void **state) {
  (void)state;
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
  test_for_long_kinds(check_rise);
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
    double x[3] = {0}, v[3] = {0};
    for (uint32_t k = 0; k < f->dimension; ++k) {
      x[k] = f->x[i * f->dimension + k];
      v[k] = f->v[i * f->dimension + k];
      *scale += mass(f, i) * fabs(v[k]);
    }
    for (int k = 0; k < 3; ++k) {
      sums[k] += mass(f, i) * v[k];
      sums[3 + k] +=
          mass(f, i) * (x[(k + 1) % 3] * v[(k + 2) % 3] - x[(k + 2) % 3] * v[(k + 1) % 3]);
    }
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

/* ---- Bits ------------------------------------------------------------------------------------ */

static void *state_of(pbf_solver *solver, uint32_t count, uint32_t dimension, uint32_t precision) {
  const size_t bytes = (size_t)count * dimension * precision;
  char *values = calloc(2, bytes);
  assert_non_null(values);
  assert_ok(pbf_get_positions(solver, 0, count, values));
  assert_ok(pbf_get_velocities(solver, 0, count, values + bytes));
  return values;
}

/* `phases` 0: none; 1: alike, which the backend is not told; 2: of one mass but not one viscosity,
 * of which there is none, so that all goes by masses, each 1. */
static void *state_with(uint32_t dimension, uint32_t precision, int phases) {
  const uint32_t size[3] = {8, 12, dimension == 3 ? 6 : 1};
  const double density[2] = {1, 1};
  pbf_params params = params_of(size, 1);
  params.domain_max[0] += 0.3;
  params.shear_stress_correction = 0.5;
  params.pressure_grid = 0;
  params.damping_compensation = 0.5;
  params.loads = 1;
  fluid f = fluid_of(dimension, precision, &params, size, 0.2, density, mixed);
  if (phases == 2) {
    set_phases(f.solver, 1, 1, 0.5);
  } else if (phases == 0) {
    memset(f.phase, 0, f.count * sizeof *f.phase);
    assert_ok(pbf_set_particle_phases(f.solver, 0, f.count, f.phase));
    assert_ok(pbf_set_phases(f.solver, 0, NULL));
  }
  assert_ok(pbf_step(f.solver, 30));
  void *values = state_of(f.solver, f.count, dimension, precision);
  destroy(&f);
  return values;
}

static void check_bits(uint32_t dimension, uint32_t precision) {
  const size_t bytes = (size_t)2 * 8 * 12 * (dimension == 3 ? 6 : 1) * dimension * precision;
  void *without = state_with(dimension, precision, 0);
  for (int phases = 1; phases <= 2; ++phases) {
    if (phases == 2 && strcmp(test_backend(), "cuda") == 0) continue; /* another kernel may serve */
    void *with = state_with(dimension, precision, phases);
    if (memcmp(with, without, bytes) != 0)
      fail_msg("%uD, float%u: other bits with phases %d", dimension, 8 * precision, phases);
    free(with);
  }
  free(without);
}

static void one_fluid_keeps_its_bits(void **state) {
  (void)state;
  test_for_each_kind(check_bits);
}

/* ---- In and out ------------------------------------------------------------------------------ */

static void expect_phases(pbf_solver *solver, uint32_t count, const uint32_t *expected) {
  uint32_t phases[16], there;
  assert_ok(pbf_get_count(solver, &there));
  assert_int_equal(there, count);
  assert_ok(pbf_get_particle_phases(solver, 0, count, phases));
  for (uint32_t i = 0; i < count; ++i) assert_int_equal(phases[i], expected[i]);
}

/* Eight particles of the phases 0, 1, 0, 1, … */
static pbf_solver *eight(uint32_t dimension, uint32_t precision) {
  const uint32_t phases[8] = {0, 1, 0, 1, 0, 1, 0, 1};
  pbf_solver *solver = test_filled(dimension, precision, 8, 16);
  set_phases(solver, 1, 0.1, 1);
  assert_ok(pbf_set_particle_phases(solver, 0, 8, phases));
  expect_phases(solver, 8, phases);
  return solver;
}

/* Phases stay with particles that others are removed between, new ones are of phase 0, and a state
 * that is saved goes on with the same bits. */
static void check_rows(uint32_t dimension, uint32_t precision) {
  pbf_solver *solver = eight(dimension, precision), *other;
  const uint32_t removed[3] = {0, 3, 6}, left[5] = {1, 0, 0, 1, 1}, more[6] = {1, 0, 0, 1, 1, 0};
  const uint32_t one = 1;
  uint64_t size;
  assert_ok(pbf_step(solver, 3));
  assert_ok(pbf_remove_particles(solver, 3, removed));
  expect_phases(solver, 5, left);
  void *place = test_lattice(dimension, precision, 1);
  assert_ok(pbf_add_particles(solver, 1, place, NULL, NULL));
  free(place);
  expect_phases(solver, 6, more);
  assert_ok(pbf_set_particle_phases(solver, 5, 1, &one));
  void *saved = test_save(solver, &size);
  other = test_filled(dimension, precision, 2, 16);
  assert_ok(pbf_load(other, saved, size));
  assert_true(test_hash(other) == test_hash(solver));
  uint32_t count;
  assert_ok(pbf_get_phase_count(other, &count));
  assert_int_equal(count, 2);
  assert_ok(pbf_step(solver, 20));
  assert_ok(pbf_step(other, 20));
  assert_true(test_hash(other) == test_hash(solver));
  assert_ok(pbf_set_particle_phases(other, 0, 1, (const uint32_t[]){0}));
  assert_false(test_hash(other) == test_hash(solver));
  free(saved);
  pbf_destroy(other);
  pbf_destroy(solver);
}

/* Where they press on each other, the backend's are the same as those of a state that is loaded. */
static void check_pressed(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {6, 6, dimension == 3 ? 6 : 1};
  const double density[2] = {1, 0.1};
  const pbf_params params = params_of(size, 1);
  fluid f = fluid_of(dimension, precision, &params, size, 0.2, density, mixed);
  uint32_t removed[216], count = 0;
  uint64_t bytes;
  for (uint32_t id = 0; id < f.count; id += 3) removed[count++] = id;
  assert_ok(pbf_step(f.solver, 2));
  assert_ok(pbf_remove_particles(f.solver, count, removed));
  void *saved = test_save(f.solver, &bytes);
  const pbf_desc desc = test_desc(dimension, precision, f.count);
  pbf_solver *other = test_create(&desc, &params);
  assert_ok(pbf_load(other, saved, bytes));
  assert_ok(pbf_step(f.solver, 20));
  assert_ok(pbf_step(other, 20));
  assert_true(test_hash(other) == test_hash(f.solver));
  free(saved);
  pbf_destroy(other);
  destroy(&f);
}

static void phases_follow_their_particles(void **state) {
  (void)state;
  test_for_each_kind(check_rows);
  test_for_each_kind(check_pressed);
}

/* What an emitter emits is of its phase, and weighs as much as that. */
static void check_emitter(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {12, 4, dimension == 3 ? 12 : 1};
  const double density[2] = {1, 0.1};
  pbf_emitter emitter;
  pbf_collider_load walls[6];
  pbf_params params = params_of(size, 1);
  params.loads = 1;
  const pbf_desc desc = test_desc(dimension, precision, 2000);
  pbf_solver *solver = test_create(&desc, &params);
  set_phases(solver, density[0], density[1], 1);
  assert_ok(pbf_emitter_init(&emitter, sizeof emitter, PBF_EMITTER_RECTANGLE));
  emitter.position[0] = 0.3;
  emitter.position[1] = 0.8;
  emitter.position[2] = dimension == 3 ? 0.3 : 0;
  emitter.half_width = emitter.half_height = 2 * spacing;
  emitter.phase = 1;
  assert_ok(pbf_set_emitters(solver, 1, &emitter));
  assert_ok(pbf_step(solver, 60));
  emitter.rate = 1e-9;
  assert_ok(pbf_set_emitters(solver, 1, &emitter));
  assert_ok(pbf_step(solver, 240));
  uint32_t count, phases[2000];
  assert_ok(pbf_get_count(solver, &count));
  assert_true(count > 20 && count < 2000);
  assert_ok(pbf_get_particle_phases(solver, 0, count, phases));
  for (uint32_t i = 0; i < count; ++i) assert_int_equal(phases[i], 1);
  for (int k = 0; k < 6; ++k) walls[k].struct_size = sizeof walls[k];
  assert_ok(pbf_get_wall_loads(solver, 2 * dimension, walls));
  assert_ok(pbf_step(solver, 120));
  assert_ok(pbf_get_wall_loads(solver, 2 * dimension, walls));
  const double weight = count * density[1] * pow(spacing, dimension) * gravity;
  const double carried = -walls[PBF_WALL_Y_MIN].impulse_sum[1] / walls[PBF_WALL_Y_MIN].time_sum;
  if (!(fabs(carried / weight - 1) < 0.01))
    fail_msg("%uD, float%u: the floor carries %g of what has been emitted", dimension,
             8 * precision, carried / weight);
  pbf_destroy(solver);
}

static void emitters_have_phases(void **state) {
  (void)state;
  test_for_each_kind(check_emitter);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static void refuse_phase(pbf_solver *solver, double density, double viscosity, pbf_status status,
                         const char *words) {
  pbf_phase phases[2];
  for (int k = 0; k < 2; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = density;
  phases[1].viscosity = viscosity;
  assert_fails(pbf_set_phases(solver, 2, phases), status, words);
}

static void refuse_param(pbf_solver *solver, size_t offset, double value, const char *words) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(solver, &params));
  memcpy((char *)&params + offset, &value, sizeof value);
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_UNSUPPORTED, words);
}

/* And nothing changes. */
static void refusals(void **state) {
  pbf_solver *solver = eight(3, PBF_FLOAT32);
  const uint32_t two = 2;
  const uint64_t before = test_hash(solver);
  pbf_phase phase, many[9];
  (void)state;
  assert_fails(pbf_phase_init(NULL, sizeof phase), PBF_ERROR_INVALID_ARGUMENT, "phase is null");
  assert_fails(pbf_phase_init(&phase, 3), PBF_ERROR_STRUCT_SIZE, "pbf_phase");
  for (int k = 0; k < 9; ++k) assert_ok(pbf_phase_init(&many[k], sizeof many[k]));
  assert_fails(pbf_set_phases(solver, 9, many), PBF_ERROR_INVALID_ARGUMENT, "at most 8");
  assert_fails(pbf_set_phases(solver, 2, NULL), PBF_ERROR_INVALID_ARGUMENT, "phases is null");
  assert_fails(pbf_set_phases(solver, 1, many), PBF_ERROR_INVALID_ARGUMENT, "id 1 is of phase 1");
  assert_fails(pbf_set_phases(solver, 0, NULL), PBF_ERROR_INVALID_ARGUMENT, "of phase 1");
  many[1].struct_size = 40;
  assert_fails(pbf_set_phases(solver, 2, many), PBF_ERROR_STRUCT_SIZE, "that of phases[0]");
  refuse_phase(solver, 0, 1, PBF_ERROR_INVALID_ARGUMENT, "phases[1].rest_density");
  refuse_phase(solver, NAN, 1, PBF_ERROR_INVALID_ARGUMENT, "phases[1].rest_density");
  refuse_phase(solver, 1001, 1, PBF_ERROR_INVALID_ARGUMENT, "0.001 … 1000");
  refuse_phase(solver, 1, 1.5, PBF_ERROR_INVALID_ARGUMENT, "phases[1].viscosity");
  many[0].rest_density = 0.5;
  many[1].struct_size = sizeof many[1];
  many[1].rest_density = 600;
  assert_fails(pbf_set_phases(solver, 2, many), PBF_ERROR_INVALID_ARGUMENT, "1000 times as heavy");
  assert_fails(pbf_set_particle_phases(solver, 0, 1, &two), PBF_ERROR_INVALID_ARGUMENT,
               "below the number of phases, 2");
  assert_fails(pbf_set_particle_phases(solver, 8, 1, &two), PBF_ERROR_INVALID_ARGUMENT, "first is");
  assert_fails(pbf_set_particle_phases(solver, 0, 1, NULL), PBF_ERROR_INVALID_ARGUMENT, "phases");
  phase.struct_size = sizeof phase;
  assert_fails(pbf_get_phase(solver, 2, &phase), PBF_ERROR_NOT_FOUND, "2 phases");
  assert_ok(pbf_get_phase(solver, 1, &phase));
  assert_true(phase.rest_density == 0.1);
  refuse_param(solver, offsetof(pbf_params, pressure_grid), 2, "pressure_grid is 2 and phases");
  refuse_param(solver, offsetof(pbf_params, surface_tension), 1e-4, "and phases differ");
  pbf_emitter emitter;
  assert_ok(pbf_emitter_init(&emitter, sizeof emitter, PBF_EMITTER_DISC));
  for (int k = 0; k < 3; ++k) emitter.position[k] = 0.5;
  emitter.radius = 0.1;
  emitter.phase = 2;
  assert_fails(pbf_set_emitters(solver, 1, &emitter), PBF_ERROR_INVALID_ARGUMENT,
               "emitters[0].phase is 2");
  assert_true(test_hash(solver) == before);
  pbf_destroy(solver);
}

/* Each byte of a saved state's phases, changed: what is not refused is another sound state. */
static void forged(void **state) {
  pbf_solver *solver = eight(3, PBF_FLOAT32);
  const uint64_t before = test_hash(solver);
  uint64_t size;
  unsigned char *saved = test_save(solver, &size);
  uint32_t refused = 0;
  (void)state;
  for (uint64_t at = size - 80; at < size - 8; ++at) {
    for (int bit = 0; bit < 8; bit += 7) {
      saved[at] ^= (unsigned char)(1 << bit);
      test_seal(saved, size);
      pbf_solver *other = test_filled(3, PBF_FLOAT32, 3, 16);
      if (pbf_load(other, saved, size) == PBF_OK)
        assert_ok(pbf_step(other, 1));
      else
        ++refused;
      pbf_destroy(other);
      saved[at] ^= (unsigned char)(1 << bit);
    }
  }
  assert_true(refused > 20 && test_hash(solver) == before);
  free(saved);
  pbf_destroy(solver);
}

/* The stub knows no masses: phases that are alike need none, others it refuses. */
static void backends_without(void **state) {
  pbf_solver *solver = test_filled(2, PBF_FLOAT32, 4, 8);
  pbf_phase phases[2];
  const uint32_t numbers[4] = {1, 0, 1, 0};
  (void)state;
  for (int k = 0; k < 2; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  assert_ok(pbf_set_phases(solver, 2, phases));
  assert_ok(pbf_set_particle_phases(solver, 0, 4, numbers));
  expect_phases(solver, 4, numbers);
  phases[0].rest_density = 2;
  assert_fails(pbf_set_phases(solver, 2, phases), PBF_ERROR_UNSUPPORTED,
               "has no phases that differ");
  expect_phases(solver, 4, numbers);
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest of_stub[] = {cmocka_unit_test(backends_without)};
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layers_weigh_what_they_weigh),
      cmocka_unit_test(light_fluid_rises),
      cmocka_unit_test(oil_rises),
      cmocka_unit_test(momenta_are_kept),
      cmocka_unit_test(the_centre_of_mass_falls),
      cmocka_unit_test(interfaces_grow),
      cmocka_unit_test(phases_have_viscosities),
      cmocka_unit_test(one_fluid_keeps_its_bits),
      cmocka_unit_test(phases_follow_their_particles),
      cmocka_unit_test(emitters_have_phases),
      cmocka_unit_test(refusals),
      cmocka_unit_test(forged),
  };
  return test_is_stub() ? TEST_RUN(of_stub) : TEST_RUN(tests);
}
