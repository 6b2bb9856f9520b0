/* Fluid that sticks to solids, by closed forms: Poiseuille's flow between walls, from its start on;
 * Couette's between cylinders that turn; a plate that slides along the fluid before it. Without it
 * fluid slides. */
#include "support.h"

#include <math.h>

static const double spacing = 0.05, pi = 3.14159265358979323846;

typedef struct fluid {
  pbf_solver *solver;
  uint32_t count;
  double *x, *v; /* read back */
} fluid;

/* Up to 3,000 places in 2D. */
typedef struct places {
  uint32_t count;
  double x[6000];
} places;

static void place(places *p, double x, double y) {
  assert_true(2 * p->count + 2 <= sizeof p->x / sizeof p->x[0]);
  p->x[2 * p->count] = x;
  p->x[2 * p->count + 1] = y;
  ++p->count;
}

static pbf_params params_of(double viscosity, double dt) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.viscosity = viscosity;
  params.time_step = dt;
  params.prestabilization = params.attraction = 0;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = -8;
    params.domain_max[k] = 8;
  }
  return params;
}

static fluid fluid_at(const places *p, const pbf_params *params) {
  fluid f = {.count = p->count};
  const pbf_desc desc = test_desc(2, PBF_FLOAT64, p->count);
  f.solver = test_create(&desc, params);
  f.x = calloc(2 * (size_t)p->count, sizeof *f.x);
  f.v = calloc(2 * (size_t)p->count, sizeof *f.v);
  assert_true(f.x && f.v);
  assert_ok(pbf_add_particles(f.solver, p->count, p->x, NULL, NULL));
  return f;
}

static void look(fluid *f) {
  assert_ok(pbf_get_positions(f->solver, 0, f->count, f->x));
  assert_ok(pbf_get_velocities(f->solver, 0, f->count, f->v));
}

static void destroy(fluid *f) {
  pbf_destroy(f->solver);
  free(f->x);
  free(f->v);
}

/* ---- Poiseuille --------------------------------------------------------------------------------
 */

/* A channel of width 1 along x, with a body force: the velocity at y after a time (Schlichting,
 * Boundary-layer theory). */
static double poiseuille(double g, double viscosity, double y, double time) {
  double u = 0.5 * g / viscosity * y * (1 - y);
  for (int m = 1; m < 200; m += 2)
    u -= 4 * g / (viscosity * pow(m * pi, 3)) * sin(m * pi * y) *
         exp(-pow(m * pi, 2) * viscosity * time);
  return u;
}

/* The flow in the middle of a slug of fluid over that, by least squares. */
static double of_poiseuille(double viscosity, double dt, double time, double no_slip) {
  enum { LENGTH = 6 };
  const double g = 8 * viscosity * viscosity;
  static places p;
  p.count = 0;
  for (double x = 0.5 * spacing - 0.5 * LENGTH; x < 0.5 * LENGTH; x += spacing)
    for (double y = 0.5 * spacing; y < 1; y += spacing) place(&p, x, y);
  pbf_params params = params_of(viscosity, dt);
  params.gravity[0] = g;
  params.domain_min[1] = 0;
  params.domain_max[1] = 1;
  params.wall_no_slip = no_slip;
  fluid f = fluid_at(&p, &params);
  assert_ok(pbf_step(f.solver, (uint32_t)(time / dt + 0.5)));
  look(&f);
  double center = 0, product = 0, square = 0;
  for (uint32_t i = 0; i < f.count; ++i) center += f.x[2 * i] / f.count;
  for (uint32_t i = 0; i < f.count; ++i) {
    const double right = poiseuille(g, viscosity, f.x[2 * i + 1], time);
    if (fabs(f.x[2 * i] - center) > 0.15 * LENGTH) continue;
    product += f.v[2 * i] * right;
    square += right * right;
  }
  destroy(&f);
  return product / square;
}

/* Half developed and developed; steps of which a hundred, and few, are as long as it takes. */
static void a_channel_has_a_parabola(void **state) {
  (void)state;
  const struct {
    double viscosity, dt, time, accuracy;
  } rows[] = {{0.1, 1.0 / 60, 1, 0.03},
              {0.1, 1.0 / 60, 4, 0.03},
              {0.01, 0.1, 20, 0.03},
              {1, 1.0 / 60, 0.5, 0.03}};
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; ++k) {
    const double of = of_poiseuille(rows[k].viscosity, rows[k].dt, rows[k].time, 1);
    if (!(fabs(of - 1) < rows[k].accuracy))
      fail_msg("viscosity %g, step %g, after %g: %g of the velocity", rows[k].viscosity, rows[k].dt,
               rows[k].time, of);
  }
}

/* Free fall by comparison: g t. */
static void fluid_slides_by_default(void **state) {
  (void)state;
  const double viscosity = 0.1, time = 1, g = 8 * viscosity * viscosity;
  const double of = of_poiseuille(viscosity, 1.0 / 60, time, 0);
  assert_true(of * poiseuille(g, viscosity, 0.5, time) > 0.9 * g * time);
}

/* ---- Couette -----------------------------------------------------------------------------------
 */

/* Rings of fluid between cylinders of these radii. */
static void place_rings(places *p, double inner, double outer) {
  const int rings = (int)((outer - inner) / spacing + 0.5);
  const double apart = (outer - inner) / rings;
  p->count = 0;
  for (int k = 0; k < rings; ++k) {
    const double r = inner + apart * (k + 0.5);
    const int n = (int)(2 * pi * r * apart / (spacing * spacing) + 0.5);
    for (int j = 0; j < n; ++j) place(p, r * cos(2 * pi * j / n + k), r * sin(2 * pi * j / n + k));
  }
}

/* The velocity around between cylinders that turn, over v = A r + B / r, by least squares. */
static double of_couette(const double radii[2], const double rates[2], double viscosity, double dt,
                         double time) {
  static places p;
  place_rings(&p, radii[0], radii[1]);
  const pbf_params params = params_of(viscosity, dt);
  fluid f = fluid_at(&p, &params);
  pbf_collider cylinders[2];
  for (int k = 0; k < 2; ++k) {
    assert_ok(pbf_collider_init(&cylinders[k], sizeof cylinders[k], PBF_COLLIDER_SPHERE));
    cylinders[k].radius = radii[k];
    cylinders[k].inverted = k == 1;
    cylinders[k].angular_velocity[2] = rates[k];
    cylinders[k].no_slip = 1;
  }
  assert_ok(pbf_set_colliders(f.solver, 2, cylinders));
  assert_ok(pbf_step(f.solver, (uint32_t)(time / dt + 0.5)));
  look(&f);
  const double a2 = radii[0] * radii[0], b2 = radii[1] * radii[1];
  const double solid = (rates[1] * b2 - rates[0] * a2) / (b2 - a2);
  const double vortex = (rates[0] - rates[1]) * a2 * b2 / (b2 - a2);
  double product = 0, square = 0;
  for (uint32_t i = 0; i < f.count; ++i) {
    const double *x = f.x + 2 * i, *v = f.v + 2 * i, r = sqrt(x[0] * x[0] + x[1] * x[1]);
    const double right = solid * r + vortex / r;
    product += (x[0] * v[1] - x[1] * v[0]) / r * right;
    square += right * right;
  }
  destroy(&f);
  return product / square;
}

static void cylinders_take_fluid_along(void **state) {
  (void)state;
  test_skip_if_watched();
  const double radii[2] = {0.4, 1}, inner[2] = {1, 0}, outer[2] = {0, 1}, both[2] = {1, 1};
  const double within = fabs(of_couette(radii, inner, 0.1, 1.0 / 60, 3) - 1);
  const double without = fabs(of_couette(radii, outer, 0.1, 1.0 / 60, 3) - 1);
  const double solid = fabs(of_couette(radii, both, 0.1, 1.0 / 60, 4) - 1);
  const double short_steps = fabs(of_couette(radii, inner, 1, 1.0 / 240, 0.5) - 1);
  if (!(within < 0.03 && without < 0.03 && solid < 0.01 && short_steps < 0.03))
    fail_msg(
        "velocities are off by %g where the inner one turns, %g the outer one, %g both, %g in "
        "short steps",
        within, without, solid, short_steps);
}

/* ---- A part of it ------------------------------------------------------------------------------
 */

/* A particle alone before a plane that slides: in a step it goes a part of the way to the plane's
 * velocity, which grows with `no_slip`, and not across. */
static double taken_along(double no_slip, double across) {
  pbf_params params = params_of(0.1, 1.0 / 60);
  pbf_solver *solver;
  const pbf_desc desc = test_desc(2, PBF_FLOAT64, 1);
  const double x[2] = {0, 0.5 * spacing}, v[2] = {0, across};
  double after[2], at[2];
  pbf_collider plane;
  solver = test_create(&desc, &params);
  assert_ok(pbf_add_particles(solver, 1, x, v, NULL));
  assert_ok(pbf_collider_init(&plane, sizeof plane, PBF_COLLIDER_PLANE));
  plane.velocity[0] = 1;
  plane.no_slip = no_slip;
  assert_ok(pbf_set_colliders(solver, 1, &plane));
  assert_ok(pbf_step(solver, 1));
  assert_ok(pbf_get_velocities(solver, 0, 1, after));
  assert_true(fabs(after[1] - across) < 1e-12);
  assert_ok(pbf_get_positions(solver, 0, 1, at));
  assert_true(fabs(at[0] - after[0] * params.time_step) < 1e-12); /* it goes by what it gets */
  pbf_destroy(solver);
  return after[0];
}

static void no_slip_is_a_fraction(void **state) {
  (void)state;
  const double none = taken_along(0, 0.1), half = taken_along(0.5, 0.1), all = taken_along(1, 0.1);
  assert_true(none == 0);
  assert_true(half > 0.1 && all > half && all < 1);
  /* v = m / (1 + m), and m is in proportion; stages leave a fiftieth */
  assert_true(fabs(all / (1 - all) / (half / (1 - half)) - 2) < 0.25);
}

/* The stub has no viscosity. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_channel_has_a_parabola),
      cmocka_unit_test(fluid_slides_by_default),
      cmocka_unit_test(cylinders_take_fluid_along),
      cmocka_unit_test(no_slip_is_a_fraction),
  };
  return TEST_RUN(tests);
}
