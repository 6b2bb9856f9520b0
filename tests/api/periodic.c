/* Periodic axes: fluid at a face is as fluid anywhere; flows with a closed form. */
#include "support.h"

#include <math.h>

#include <pbf/query.h>

static const double spacing = 0.05, pi = 3.14159265358979323846, gravity = 9.81;

typedef struct fluid {
  pbf_solver *solver;
  pbf_params params;
  uint32_t dimension, precision, count;
  double *x, *v; /* read back */
} fluid;

/* A box of so many spacings along each axis, with faces at no round number. */
static pbf_params params_of(double support, uint32_t periodic, const double sizes[3]) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = support * spacing;
  params.periodic = periodic;
  params.attraction = 0;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = -0.3;
    params.domain_max[k] = -0.3 + sizes[k] * spacing;
  }
  return params;
}

static double length_of(const pbf_params *params, uint32_t axis) {
  return params->domain_max[axis] - params->domain_min[axis];
}

/* The image inside the domain. */
static double inside(const pbf_params *params, uint32_t axis, double x) {
  const double low = params->domain_min[axis], length = length_of(params, axis);
  return params->periodic >> axis & 1 ? x - length * floor((x - low) / length) : x;
}

/* A lattice of counts[k] particles from `corner` on, in spacings from the lower faces, each at the
 * velocity that it is given at its place; and all of it shifted. */
static fluid fluid_of(uint32_t dimension, uint32_t precision, const pbf_params *params,
                      const uint32_t counts[3], double corner, const double shift[3],
                      void (*velocity)(const double x[3], double v[3])) {
  fluid f = {.dimension = dimension, .precision = precision, .params = *params};
  f.count = counts[0] * counts[1] * (dimension == 3 ? counts[2] : 1);
  const pbf_desc desc = test_desc(dimension, precision, f.count);
  const size_t numbers = (size_t)f.count * dimension;
  f.solver = test_create(&desc, params);
  f.x = calloc(numbers, sizeof *f.x);
  f.v = calloc(numbers, sizeof *f.v);
  char *positions = calloc(numbers, precision), *velocities = calloc(numbers, precision);
  assert_true(f.x && f.v && positions && velocities);
  for (uint32_t i = 0; i < f.count; ++i) {
    const uint32_t at[3] = {i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]};
    double x[3] = {0}, v[3] = {0};
    for (uint32_t k = 0; k < dimension; ++k)
      x[k] = params->domain_min[k] + spacing * (corner + at[k] + 0.5);
    velocity(x, v);
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(positions, (uint64_t)i * dimension + k, precision,
               inside(params, k, x[k] + shift[k]));
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

static double mean_velocity(const fluid *f, uint32_t axis) {
  double sum = 0;
  for (uint32_t i = 0; i < f->count; ++i) sum += f->v[i * f->dimension + axis];
  return sum / f->count;
}

static const double nowhere[3] = {0, 0, 0};

static void still(const double x[3], double v[3]) {
  (void)x;
  v[0] = v[1] = v[2] = 0;
}

/* Any velocity, from the place, and not its opposite at the opposite place. */
static void whirl(const double x[3], double v[3]) {
  for (int k = 0; k < 3; ++k)
    v[k] = 0.1 * sin(29 * x[k] + 13 * x[(k + 1) % 3] - 41 * x[(k + 2) % 3] + 1);
}

/* ---- What is the same anywhere --------------------------------------------------------------- */

static const double stream[3] = {1, 0.375, -0.25}; /* numbers of any precision */

static void flow(const double x[3], double v[3]) {
  (void)x;
  for (int k = 0; k < 3; ++k) v[k] = stream[k];
}

/* At faces, in a corner, and beyond them. */
static void check_samples(fluid *f) {
  enum { POINTS = 4 };
  static const double at[POINTS][3] = {
      {0, 0.5, 0.5}, {0.5, 1, 0.3}, {0.02, 0.97, 0}, {1.51, -0.48, 0.01}};
  double points[POINTS * 3], densities[POINTS], velocities[POINTS * 3];
  const pbf_samples samples = {.struct_size = sizeof samples,
                               .count = POINTS,
                               .points = points,
                               .densities = densities,
                               .velocities = velocities};
  for (uint32_t i = 0; i < POINTS * f->dimension; ++i) {
    const uint32_t k = i % f->dimension;
    points[i] = f->params.domain_min[k] + at[i / f->dimension][k] * length_of(&f->params, k);
  }
  assert_ok(pbf_sample(f->solver, &samples));
  for (uint32_t i = 0; i < POINTS; ++i) assert_true(fabs(densities[i] - 1) < 0.02);
  for (uint32_t i = 0; i < POINTS * f->dimension; ++i)
    assert_true(fabs(velocities[i] - stream[i % f->dimension]) < 1e-5);
}

/* Fluid that fills the box and moves as one goes on so, and comes by where it has been. */
static void check_uniform(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 1000, SIDE = 8 };
  const double sizes[3] = {SIDE, SIDE, SIDE}, rounding = precision == PBF_FLOAT32 ? 1e-6 : 1e-13;
  const uint32_t counts[3] = {SIDE, SIDE, SIDE};
  const pbf_params params = params_of(2, 7, sizes);
  fluid f = fluid_of(dimension, precision, &params, counts, 0, nowhere, flow);
  look(&f);
  double *start = f.x;
  f.x = calloc((size_t)f.count * dimension, sizeof *f.x);
  assert_non_null(f.x);
  assert_ok(pbf_step(f.solver, STEPS));
  look(&f);
  for (uint32_t i = 0; i < f.count * dimension; ++i) {
    const uint32_t k = i % dimension;
    const double way = STEPS * params.time_step * stream[k], length = length_of(&params, k);
    const double off = f.x[i] - start[i] - way;
    assert_true(f.x[i] >= params.domain_min[k] - 1e-7 && f.x[i] <= params.domain_max[k] + 1e-7);
    if (!(fabs(f.v[i] - stream[k]) < rounding))
      fail_msg("%uD, float%u: velocity %.9g, it must be %g", dimension, 8 * precision, f.v[i],
               stream[k]);
    assert_true(fabs(off - length * round(off / length)) < 100 * rounding);
  }
  check_samples(&f);
  free(start);
  destroy(&f);
}

static void flow_through_faces_stays_uniform(void **state) {
  (void)state;
  test_for_long_kinds(check_uniform);
}

static void with_all_passes(pbf_params *params) {
  params->viscosity = 0.01;
  params->surface_tension = 0.001;
  params->damping_compensation = params->angular_momentum_correction = 1;
  params->shear_stress_correction = 0.75;
  params->vorticity = 0.001;
  params->gravity[0] = -1;
  params->gravity[1] = -2;
}

static void with_the_papers_passes(pbf_params *params) {
  params->solver = PBF_SOLVER_JACOBI;
  params->kernel = PBF_KERNEL_POLY6_SPIKY;
  params->viscosity = 0.1;
  params->vorticity = 0.01;
  params->scorr_k = 1e-5;
  params->cohesion = 1;
  params->gravity[1] = -2;
}

static void with_wide_kernels(pbf_params *params) {
  with_all_passes(params);
  params->smoothing_radius = 3.1 * spacing;
}

/* A block in the middle of the box, away from faces, and the same one at them. No pair of its is at
 * h: one that comes nearer in a step is one for the reference where their cells meet. */
static void check_shift(uint32_t dimension, uint32_t precision, uint32_t side,
                        const double sizes[3], void (*set)(pbf_params *params)) {
  static const double shifts[2][3] = {{-0.325, 0.011, -0.31}, {-0.317, -0.29, 0.009}};
  const double rounding = precision == PBF_FLOAT32 ? 1e-4 : 1e-11;
  const uint32_t counts[3] = {side, side + 1, side}, steps = 4;
  pbf_params params = params_of(2.1, 7, sizes);
  set(&params);
  params.prestabilization = 0;
  fluid right = fluid_of(dimension, precision, &params, counts, 4, nowhere, whirl);
  assert_ok(pbf_step(right.solver, steps));
  look(&right);
  for (int s = 0; s < 2; ++s) {
    fluid f = fluid_of(dimension, precision, &params, counts, 4, shifts[s], whirl);
    assert_ok(pbf_step(f.solver, steps));
    look(&f);
    for (uint32_t i = 0; i < f.count * dimension; ++i) {
      const uint32_t k = i % dimension;
      const double length = length_of(&params, k), off = f.x[i] - right.x[i] - shifts[s][k];
      if (!(fabs(off - length * round(off / length)) < rounding) ||
          !(fabs(f.v[i] - right.v[i]) < 100 * rounding))
        fail_msg("%uD, float%u, shift %d: particle %u is off by %g and %g", dimension,
                 8 * precision, s, i / dimension, off - length * round(off / length),
                 f.v[i] - right.v[i]);
    }
    destroy(&f);
  }
  destroy(&right);
}

static void check_shifts(uint32_t dimension, uint32_t precision) {
  const double near[3] = {14, 13, 13}, vast[3] = {400, 13, 300};
  check_shift(dimension, precision, 5, near, with_all_passes);
  check_shift(dimension, precision, 5, near, with_the_papers_passes);
  check_shift(dimension, precision, 5, near, with_wide_kernels);
  check_shift(dimension, precision, 5, vast,
              with_all_passes); /* more cells than there is room for */
}

/* Many lie between neighbours at opposite faces. */
static void check_shift_of_many(uint32_t dimension, uint32_t precision) {
  const double sizes[3] = {35, 33, 31}, flat[3] = {110, 100, 0};
  check_shift(dimension, precision, dimension == 3 ? 19 : 78, dimension == 3 ? sizes : flat,
              with_the_papers_passes);
}

static void fluid_at_faces_moves_as_anywhere(void **state) {
  (void)state;
  test_for_each_kind(check_shift_of_many);
  test_for_each_kind(check_shifts);
}

static void check_inside(const fluid *f) {
  for (uint32_t i = 0; i < f->count * f->dimension; ++i) {
    const uint32_t k = i % f->dimension;
    assert_true(f->x[i] >= f->params.domain_min[k] - 1e-7);
    assert_true(f->x[i] <= f->params.domain_max[k] + 1e-7);
  }
}

/* A full box has no free surface, and nothing to push off from. */
static void check_momentum(uint32_t dimension, uint32_t precision) {
  enum { SIDE = 8, LOOKS = 10 };
  const double sizes[3] = {SIDE, SIDE, SIDE}, rounding = precision == PBF_FLOAT32 ? 1e-7 : 1e-15;
  const uint32_t counts[3] = {SIDE, SIDE, SIDE};
  pbf_params params = params_of(2, 7, sizes);
  params.viscosity = 0.001;
  params.surface_tension = 0.001;
  fluid f = fluid_of(dimension, precision, &params, counts, 0, nowhere, whirl);
  double before[3];
  look(&f);
  for (uint32_t k = 0; k < dimension; ++k) before[k] = mean_velocity(&f, k);
  for (int k = 0; k < LOOKS; ++k) {
    assert_ok(pbf_step(f.solver, 10));
    look(&f);
    check_inside(&f);
  }
  for (uint32_t k = 0; k < dimension; ++k)
    if (!(fabs(mean_velocity(&f, k) - before[k]) < rounding))
      fail_msg("%uD, float%u: momentum %u changes by %g", dimension, 8 * precision, k,
               mean_velocity(&f, k) - before[k]);
  destroy(&f);
}

static void momentum_is_kept(void **state) {
  (void)state;
  test_for_each_kind(check_momentum);
}

/* What the solve pushes through a face comes in by the other one: a dense block at the lower one.
 */
static void check_pushed_through(uint32_t dimension, uint32_t precision) {
  const double sizes[3] = {12, 12, 12};
  const uint32_t counts[3] = {5, 5, 5};
  pbf_params params = params_of(2, 7, sizes);
  params.prestabilization = 0;
  params.particle_volume = 2 * pow(spacing, dimension);
  fluid f = fluid_of(dimension, precision, &params, counts, -0.49, nowhere, still);
  assert_ok(pbf_step(f.solver, 1));
  look(&f);
  check_inside(&f);
  for (uint32_t k = 0; k < dimension; ++k)
    assert_true(f.x[k] > params.domain_max[k] - 3 * spacing); /* the first one has gone through */
  destroy(&f);
}

static void pushed_through_faces(void **state) {
  (void)state;
  test_for_each_kind(check_pushed_through);
}

/* A lattice that fills the box is at rest, and dense by 1 everywhere, at any support. */
static void check_rest(uint32_t dimension, uint32_t precision) {
  enum { SIDE = 13, STEPS = 20 };
  static const double supports[] = {1.6, 2, 3};
  const double sizes[3] = {SIDE, SIDE, SIDE}, rounding = precision == PBF_FLOAT32 ? 2e-6 : 1e-13;
  const uint32_t counts[3] = {SIDE, SIDE, SIDE};
  for (int s = 0; s < 3; ++s) {
    const pbf_params params = params_of(supports[s], 7, sizes);
    fluid f = fluid_of(dimension, precision, &params, counts, 0, nowhere, still);
    char *densities = calloc(f.count, precision);
    assert_non_null(densities);
    assert_ok(pbf_get_densities(f.solver, 0, f.count, densities));
    for (uint32_t i = 0; i < f.count; ++i)
      if (!(fabs(test_value(densities, i, precision) - 1) < rounding))
        fail_msg("%uD, h = %g spacings: density %.9g", dimension, supports[s],
                 test_value(densities, i, precision));
    assert_ok(pbf_step(f.solver, STEPS));
    look(&f);
    for (uint32_t i = 0; i < f.count * dimension; ++i) assert_true(fabs(f.v[i]) < 1e-3 * rounding);
    free(densities);
    destroy(&f);
  }
}

static void full_boxes_rest(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_rest);
}

/* ---- Flows ----------------------------------------------------------------------------------- */

enum { BOX = 32 };

static double wave_number(void) { return 2 * pi / (BOX * spacing); }

static void shear_layer(const double x[3], double v[3]) {
  v[0] = 0.2 * cos(wave_number() * (x[1] + 0.3));
  v[1] = v[2] = 0;
}

static void vortices(const double x[3], double v[3]) {
  const double k = wave_number();
  v[0] = 0.5 * sin(k * (x[0] + 0.3)) * cos(k * (x[1] + 0.3));
  v[1] = -0.5 * cos(k * (x[0] + 0.3)) * sin(k * (x[1] + 0.3));
  v[2] = 0;
}

/* How much of such a flow is left. */
static double left_of(fluid *f, void (*velocity)(const double x[3], double v[3])) {
  double product = 0, square = 0;
  look(f);
  for (uint32_t i = 0; i < f->count; ++i) {
    double x[3] = {0}, v[3];
    memcpy(x, f->x + i * f->dimension, f->dimension * sizeof *x);
    velocity(x, v);
    for (uint32_t k = 0; k < f->dimension; ++k) {
      product += v[k] * f->v[i * f->dimension + k];
      square += v[k] * v[k];
    }
  }
  return product / square;
}

/* A wave of shear decays as exp(-viscosity k² t), and lives on without. */
static void check_shear_layer(uint32_t precision, double viscosity) {
  const double sizes[3] = {BOX, BOX, BOX}, time = 1, k = wave_number();
  const uint32_t counts[3] = {BOX, BOX, 1}, steps = 120;
  pbf_params params = params_of(2, 3, sizes);
  params.viscosity = viscosity;
  params.time_step = time / steps;
  fluid f = fluid_of(2, precision, &params, counts, 0, nowhere, shear_layer);
  assert_ok(pbf_step(f.solver, steps));
  const double left = left_of(&f, shear_layer), right = exp(-viscosity * k * k * time);
  if (!(fabs(left / right - 1) < 0.01))
    fail_msg("float%u, viscosity %g: %g is left, it must be %g", 8 * precision, viscosity, left,
             right);
  destroy(&f);
}

/* Taylor and Green's vortices, exp(-2 viscosity k² t), while particles go by three spacings:
 * afterwards a full box of fluid that is stirred resists (docs/validation.md). */
static void check_vortices(uint32_t precision) {
  const double sizes[3] = {BOX, BOX, BOX}, time = 0.3, viscosity = 0.05, k = wave_number();
  const uint32_t counts[3] = {BOX, BOX, 1}, steps = 36;
  pbf_params params = params_of(3, 3, sizes);
  params.viscosity = viscosity;
  params.shear_stress_correction = 0.75;
  params.time_step = time / steps;
  fluid f = fluid_of(2, precision, &params, counts, 0, nowhere, vortices);
  assert_ok(pbf_step(f.solver, steps));
  const double left = left_of(&f, vortices), right = exp(-2 * viscosity * k * k * time);
  if (!(fabs(left / right - 1) < 0.04))
    fail_msg("float%u: %g of the vortices is left, it must be %g", 8 * precision, left, right);
  destroy(&f);
}

static void check_decays(uint32_t dimension, uint32_t precision) {
  if (dimension != 2) return;
  check_shear_layer(precision, 0);
  check_shear_layer(precision, 0.02);
  check_vortices(precision);
}

static void flows_decay(void **state) {
  (void)state;
  test_for_each_kind(check_decays);
}

/* Between plates that it sticks to fluid that is pushed along has the parabola of Poiseuille; it
 * starts from rest, and has come within exp(-pi² viscosity t / H²), 0.7 %, of it. */
static void check_channel(uint32_t dimension, uint32_t precision) {
  enum { ROWS = 16, STEPS = 480 };
  const double sizes[3] = {ROWS, ROWS, ROWS}, viscosity = 0.1, push = 0.5;
  const uint32_t counts[3] = {ROWS, ROWS, 1};
  pbf_params params = params_of(2, PBF_PERIODIC_X, sizes);
  if (dimension != 2) return;
  params.viscosity = viscosity;
  params.wall_no_slip = 1;
  params.gravity[0] = push;
  params.time_step = 1.0 / 150;
  const double height = ROWS * spacing, fastest = push * height * height / (8 * viscosity);
  fluid f = fluid_of(dimension, precision, &params, counts, 0, nowhere, still);
  assert_ok(pbf_step(f.solver, STEPS));
  look(&f);
  double sum = 0;
  for (uint32_t i = 0; i < f.count; ++i) {
    const double y = f.x[2 * i + 1] - params.domain_min[1], v = f.v[2 * i];
    const double right = 4 * fastest * y * (height - y) / (height * height);
    sum += v / f.count;
    if (!(fabs(v - right) < 0.04 * fastest))
      fail_msg("float%u: %g at %g of the height, it must be %g", 8 * precision, v, y / height,
               right);
  }
  if (!(fabs(sum / fastest - 2.0 / 3) < 0.02))
    fail_msg("float%u: %g of the largest in the mean", 8 * precision, sum / fastest);
  destroy(&f);
}

static void channels_have_parabolas(void **state) {
  (void)state;
  test_for_each_kind(check_channel);
}

/* A tank without side walls is at rest, with the weight above as its pressure, in each column. */
static void check_tank(uint32_t dimension, uint32_t precision, double support) {
  enum { WIDE = 12, LAYERS = 10, STEPS = 100 };
  const double sizes[3] = {WIDE, 2 * LAYERS, WIDE};
  const uint32_t counts[3] = {WIDE, LAYERS, WIDE};
  pbf_params params = params_of(support, PBF_PERIODIC_X | PBF_PERIODIC_Z, sizes);
  params.gravity[1] = -gravity;
  fluid f = fluid_of(dimension, precision, &params, counts, 0, nowhere, still);
  char *pressures = calloc(f.count, precision);
  double columns[WIDE] = {0}, sum = 0, error = 0, square = 0;
  assert_non_null(pressures);
  assert_ok(pbf_step(f.solver, STEPS));
  look(&f);
  assert_ok(pbf_get_pressures(f.solver, 0, f.count, pressures));
  for (uint32_t i = 0; i < f.count; ++i) {
    const double *x = f.x + i * dimension, p = test_value(pressures, i, precision);
    const double right = gravity * (params.domain_min[1] + LAYERS * spacing - x[1]);
    for (uint32_t k = 0; k < dimension; ++k)
      assert_true(fabs(f.v[i * dimension + k]) < 0.02 * sqrt(gravity * spacing));
    columns[i % WIDE] += p;
    sum += p / WIDE;
    error += (p - right) * (p - right);
    square += right * right;
  }
  if (!(error < 0.1 * 0.1 * square))
    fail_msg("%uD: the pressure is off by %g", dimension, sqrt(error / square));
  for (int k = 0; k < WIDE; ++k) assert_true(fabs(columns[k] / sum - 1) < 1e-3);
  free(pressures);
  destroy(&f);
}

/* With wide kernels the floor mirrors the fluid. */
static void check_tanks(uint32_t dimension, uint32_t precision) {
  check_tank(dimension, precision, 2);
  check_tank(dimension, precision, 3);
}

static void tanks_rest(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_tanks);
}

/* ---- Sleep ----------------------------------------------------------------------------------- */

static void towards_lower_face(const double x[3], double v[3]) {
  v[0] = x[0] < 0 ? -1 : 0;
  v[1] = v[2] = 0;
}

/* Two columns that go towards the lower face, and three at the upper one, which sleep; all of them
 * shifted. */
static fluid sleepers(uint32_t dimension, uint32_t precision, const double shift[3]) {
  enum { WIDE = 20, ACROSS = 9 };
  const double sizes[3] = {WIDE, ACROSS, ACROSS};
  const uint32_t counts[3] = {WIDE, ACROSS, ACROSS};
  pbf_params params = params_of(2.1, 7, sizes);
  fluid f = fluid_of(dimension, precision, &params, counts, 0, shift, towards_lower_face);
  uint32_t *gone = calloc(f.count, sizeof *gone), removed = 0;
  assert_non_null(gone);
  for (uint32_t i = 0; i < f.count; ++i) {
    const uint32_t column = i % WIDE;
    if (column != 2 && column != 3 && column < WIDE - 3) gone[removed++] = i;
  }
  assert_ok(pbf_remove_particles(f.solver, removed, gone));
  free(gone);
  f.count -= removed;
  params.sleep_speed = 0.05;
  params.sleep_time = 0.01;
  assert_ok(pbf_set_params(f.solver, &params));
  return f;
}

/* What comes through a face wakes what sleeps at the other one, as it does anywhere. */
static void check_waking(uint32_t dimension, uint32_t precision) {
  static const double middle[3] = {0.5, 0, 0};
  const double rounding = precision == PBF_FLOAT32 ? 1e-4 : 1e-11;
  fluid f = sleepers(dimension, precision, nowhere), right = sleepers(dimension, precision, middle);
  pbf_stats stats = {.struct_size = sizeof stats}, right_stats = stats;
  uint32_t least = f.count;
  assert_ok(pbf_step(f.solver, 4));
  assert_ok(pbf_step(right.solver, 4));
  assert_ok(pbf_get_stats(f.solver, &stats));
  assert_int_equal(stats.asleep * 5, stats.count * 3);
  for (int k = 0; k < 16; ++k) {
    assert_ok(pbf_step(f.solver, 1));
    assert_ok(pbf_step(right.solver, 1));
    assert_ok(pbf_get_stats(f.solver, &stats));
    assert_ok(pbf_get_stats(right.solver, &right_stats));
    assert_int_equal(stats.asleep, right_stats.asleep);
    least = stats.asleep < least ? stats.asleep : least;
  }
  assert_true(least * 5 <= stats.count * 2);
  look(&f);
  look(&right);
  for (uint32_t i = 0; i < f.count * dimension; ++i)
    assert_true(fabs(f.v[i] - right.v[i]) < rounding);
  destroy(&right);
  destroy(&f);
}

static void neighbors_across_faces_wake(void **state) {
  (void)state;
  test_for_each_kind(check_waking);
}

/* ---- Refusals -------------------------------------------------------------------------------- */

static void what_cannot_be_is_refused(void **state) {
  const double sizes[3] = {10, 10, 10}, narrow[3] = {10, 7.9, 10};
  (void)state;
  pbf_solver *solver = test_solver(3, PBF_FLOAT32, 10);
  pbf_params params = params_of(2, 8, sizes);
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_INVALID_ARGUMENT, "params.periodic is 8");
  params = params_of(2, PBF_PERIODIC_Y, narrow);
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_INVALID_ARGUMENT,
               "params.periodic has axis 1, along which the domain is 0.395 long");
  params = params_of(2, PBF_PERIODIC_X, narrow);
  assert_ok(pbf_set_params(solver, &params));
  params = params_of(2, PBF_PERIODIC_Z, sizes);
  params.wall_velocity[PBF_WALL_X_MIN] = 0.1;
  assert_ok(pbf_set_params(solver, &params));
  params.wall_velocity[PBF_WALL_Z_MAX] = 0.1;
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_INVALID_ARGUMENT,
               "params.wall_velocity[5] is 0.1; it must be 0");
  pbf_destroy(solver);
}

/* The stub has no neighbours. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flow_through_faces_stays_uniform),
      cmocka_unit_test(fluid_at_faces_moves_as_anywhere),
      cmocka_unit_test(momentum_is_kept),
      cmocka_unit_test(pushed_through_faces),
      cmocka_unit_test(full_boxes_rest),
      cmocka_unit_test(flows_decay),
      cmocka_unit_test(channels_have_parabolas),
      cmocka_unit_test(tanks_rest),
      cmocka_unit_test(neighbors_across_faces_wake),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return TEST_RUN(tests);
}
