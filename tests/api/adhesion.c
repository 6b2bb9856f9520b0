/* Adhesion: a particle in closed form, contact angles against Young's, a drop that hangs and one
 * that falls, one that runs down a plane, fluid that rises between plates, and what solids take. */
#include "load_scene.h"

static const double pi = 3.14159265358979323846, spacing = 0.05, tension = 1e-3;

/* sqrt(spacing³ / tension) */
static double capillary_time(void) { return sqrt(pow(spacing, 3) / tension); }

/* Weightless, on a floor, between walls that are far away. */
static pbf_params params_of(uint32_t dimension) {
  const double domain[3] = {4, 4, 4};
  pbf_params params = load_params(dimension, domain);
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.shear_stress_correction = -1;
  params.loads = 0;
  params.surface_tension = tension;
  params.time_step = 0.1 * capillary_time();
  params.viscosity = 0.3 * tension * capillary_time() / spacing;
  for (int k = 0; k < 3; ++k) params.gravity[k] = 0;
  return params;
}

/* Once in each dimension: precision changes no angle. */
static void test_for_dimensions(void (*function)(uint32_t dimension, uint32_t precision)) {
  const int is_reference = strcmp(test_backend(), "reference") == 0;
  if (test_has_kind(2, PBF_FLOAT64)) function(2, PBF_FLOAT64);
  if (!is_reference && test_has_kind(3, PBF_FLOAT32)) function(3, PBF_FLOAT32);
}

/* ---- A particle ----------------------------------------------------------------------------- */

enum { ON_WALL, UNDER_WALL, ON_PLANE, ON_BOX, ON_HULL, SOLIDS };

static pbf_collider solid_of(int kind, uint32_t dimension) {
  pbf_collider c = load_collider(kind == ON_PLANE ? PBF_COLLIDER_PLANE : PBF_COLLIDER_BOX, 2, 1, 2);
  c.half_extents[0] = c.half_extents[2] = kind == ON_HULL ? 0.4 : 1;
  c.half_extents[1] = 0.2;
  if (kind == ON_BOX || kind == ON_HULL) c.position[1] = 0.8;
  if (kind == ON_HULL) load_make_hull(dimension, spacing / 2, &c);
  return c;
}

/* The velocity that a solid gives a particle alone at this distance from it, to itself; the
 * momentum of that is in its load. */
static double pulled(uint32_t dimension, uint32_t precision, int kind, double adhesion,
                     double distance) {
  pbf_params params = params_of(dimension);
  params.loads = 1;
  params.viscosity = 0;
  const int on_wall = kind == ON_WALL || kind == UNDER_WALL;
  params.wall_adhesion = on_wall ? adhesion : 0;
  const double up = kind == UNDER_WALL ? -1 : 1;
  const double floor = on_wall ? (kind == UNDER_WALL ? 4 : 0) : 1;
  const pbf_desc desc = test_desc(dimension, precision, 1);
  pbf_solver *s = test_create(&desc, &params);
  pbf_collider c = solid_of(kind, dimension);
  pbf_collider_load loads[6];
  char values[3 * sizeof(double)];
  c.adhesion = adhesion;
  if (!on_wall) assert_ok(pbf_set_colliders(s, 1, &c));
  if (kind == ON_HULL) pbf_release_shape(c.geometry);
  for (uint32_t k = 0; k < dimension; ++k)
    test_put(values, k, precision, k == 1 ? floor + up * distance : 2);
  assert_ok(pbf_add_particles(s, 1, values, NULL, NULL));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_velocities(s, 0, 1, values));
  const double v = -up * test_value(values, 1, precision);
  for (int k = 0; k < 6; ++k) loads[k].struct_size = sizeof loads[k];
  if (on_wall)
    assert_ok(pbf_get_wall_loads(s, 2 * dimension, loads));
  else
    assert_ok(pbf_get_collider_loads(s, 1, loads));
  const int wall = kind == UNDER_WALL ? PBF_WALL_Y_MAX : kind == ON_WALL ? PBF_WALL_Y_MIN : 0;
  const double taken = up * loads[wall].impulse_sum[1] / pow(spacing, dimension);
  if (!(fabs(taken - v) <= 1e-5 * fabs(v) + 1e-9 * spacing / capillary_time()))
    fail_msg("%uD, solid %d: it is pulled with %g, and pulls with %g", dimension, kind, v, taken);
  pbf_destroy(s);
  return v;
}

/* The potential K b cos(angle) (1 - d/h)², K being 21 tensions over the spacing, in 2D 13, is what
 * solids of other adhesions than a half have beside the pull of what is missing. */
static void check_particle(uint32_t dimension, uint32_t precision) {
  const double dt = 0.1 * capillary_time(), h = 2 * spacing;
  const double pull = (dimension == 3 ? 21 : 13) * tension / spacing;
  const double wetting = dimension == 3 ? 0.03 : 0.07, dewetting = dimension == 3 ? 0.052 : 0.075;
  for (int kind = 0; kind < SOLIDS; ++kind) {
    /* A hull's distances are those of a grid that ends before its second place. */
    const double near = kind == ON_HULL ? 2e-2 : 1e-3, last = kind == ON_HULL ? spacing : h;
    for (double d = 0.6 * spacing; d < last; d += 0.6 * spacing) {
      const double slope = dt * pull * 2 * (1 - d / h) / h;
      const double half = pulled(dimension, precision, kind, 0.5, d);
      const double more = pulled(dimension, precision, kind, 1, d) - half;
      const double less = pulled(dimension, precision, kind, 0.25, d) - half;
      if (!(fabs(more - slope * wetting) < near * slope) ||
          !(fabs(less + slope * dewetting / 2) < near * slope))
        fail_msg("%uD, solid %d, %g: %g and %g, they must be %g and %g", dimension, kind, d, more,
                 less, slope * wetting, -slope * dewetting / 2);
      if (d < 1.5 * spacing) assert_true(half > 0);
      assert_true(pulled(dimension, precision, kind, 0, d) == 0);
    }
    if (kind != ON_HULL) assert_true(pulled(dimension, precision, kind, 1, 1.1 * h) == 0);
  }
}

static void a_particle_is_pulled(void **state) {
  (void)state;
  test_for_each_kind(check_particle);
}

/* What a solid's neighbours pull with is the slope of the energy that missing them has: between two
 * places the pull does what m² K/2 changes by, once the wall's part of it is known. A particle
 * alone lacks 0.95 less that part, so the work w gives the part, and the part the work: at half a
 * spacing it is what a lattice has on the other side of a plane there. */
static void check_work(uint32_t dimension, uint32_t precision) {
  enum { PARTS = 60 };
  const double pull = (dimension == 3 ? 21 : 13) * tension / spacing, dt = 0.1 * capillary_time();
  /* Weights (1 - r²/h²)² at h of two spacings, as in the tests of surface tension. */
  const double beyond = dimension == 3 ? 9. / 16 + 4. / 4 + 4. / 16 : 9. / 16 + 2. / 4;
  const double all = dimension == 3 ? 6 * 9. / 16 + 12 / 4. + 8 / 16. : 4 * 9. / 16 + 4 / 4.;
  double work = 0;
  for (int k = 0; k < PARTS; ++k) {
    const double d = spacing * (0.5 + 1.5 * (k + 0.5) / PARTS);
    work += pulled(dimension, precision, ON_PLANE, 0.5, d) / dt * 1.5 * spacing / PARTS;
  }
  const double part = beyond / all;
  const double right = pull / 2 * (0.95 * 0.95 - (0.95 - part) * (0.95 - part));
  if (!(fabs(work - right) < 0.01 * right))
    fail_msg("%uD: work %g, the energy is %g", dimension, work, right);
}

static void its_pull_has_an_energy(void **state) {
  (void)state;
  test_for_each_kind(check_work);
}

/* Between two planes, of which one or both pull: each has its own part in its load, whatever the
 * particle has of the sum. */
static void check_share(uint32_t dimension, uint32_t precision, double other) {
  pbf_params params = params_of(dimension);
  params.loads = 1;
  params.viscosity = 0;
  const pbf_desc desc = test_desc(dimension, precision, 1);
  pbf_solver *s = test_create(&desc, &params);
  pbf_collider planes[2] = {load_collider(PBF_COLLIDER_PLANE, 2, 2 - 0.8 * spacing, 2),
                            load_collider(PBF_COLLIDER_PLANE, 2, 2 + 0.8 * spacing, 2)};
  pbf_collider_load loads[2];
  char values[3 * sizeof(double)];
  planes[0].adhesion = 0.5;
  planes[1].adhesion = other;
  planes[1].axis[1] = -1;
  assert_ok(pbf_set_colliders(s, 2, planes));
  for (uint32_t k = 0; k < dimension; ++k) test_put(values, k, precision, 2);
  assert_ok(pbf_add_particles(s, 1, values, NULL, NULL));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_velocities(s, 0, 1, values));
  const double all = -pow(spacing, dimension) * test_value(values, 1, precision);
  for (int k = 0; k < 2; ++k) loads[k].struct_size = sizeof loads[k];
  assert_ok(pbf_get_collider_loads(s, 2, loads));
  const double lower = loads[0].impulse[1], upper = loads[1].impulse[1];
  const double near = 1e-3 * lower;
  if (!(lower > 0) || !(fabs(lower + upper - all) < near) ||
      !(fabs(upper + (other > 0 ? lower : 0)) < near))
    fail_msg("%uD, %g: they get %g and %g, and the particle %g", dimension, other, lower, upper,
             all);
  pbf_destroy(s);
}

static void check_shares(uint32_t dimension, uint32_t precision) {
  check_share(dimension, precision, 0);
  check_share(dimension, precision, 0.5);
}

static void what_pulls_has_the_load(void **state) {
  (void)state;
  test_for_each_kind(check_shares);
}

/* ---- Drops ---------------------------------------------------------------------------------- */

/* Particles of a lattice within r of a point, of those on one side of a plane through the origin,
 * each moved by up to a quarter of a spacing; y is `up` times the distance from the plane. */
static pbf_solver *cap(uint32_t dimension, uint32_t precision, const pbf_params *params, double r,
                       double center, const double origin[3], double up) {
  const int side = (int)(r + fabs(center)) + 2;
  const int deep = dimension == 3 ? side : 1;
  char *x = malloc((size_t)8 * side * side * deep * 3 * sizeof(double));
  uint32_t count = 0, random = 1;
  assert_non_null(x);
  for (int j = 0; j < 2 * side; ++j)
    for (int i = -side; i < side; ++i)
      for (int k = dimension == 3 ? -side : 0; k < deep; ++k) {
        const double at[3] = {i + 0.5, j + 0.5, dimension == 3 ? k + 0.5 : 0};
        const double y = at[1] - center;
        if (at[0] * at[0] + y * y + at[2] * at[2] > r * r) continue;
        for (uint32_t a = 0; a < dimension; ++a, random = random * 1664525u + 1013904223u) {
          double place = at[a] + 0.5 * ((random >> 8) / 16777216.0 - 0.5);
          if (a == 1) place = up * fmax(place, 0.25);
          test_put(x, (uint64_t)count * dimension + a, precision, origin[a] + spacing * place);
        }
        ++count;
      }
  const pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, params);
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  return s;
}

/* The height of the centre of mass of a spherical cap over the root mean square of x. */
static double shape_of_cap(uint32_t dimension, double angle) {
  enum { SLICES = 400 };
  double all = 0, height = 0, width = 0;
  for (int k = 0; k < SLICES; ++k) {
    const double y = (1 - cos(angle)) * (k + 0.5) / SLICES, z = y + cos(angle), r2 = 1 - z * z;
    const double area = dimension == 3 ? r2 : sqrt(r2);
    all += area;
    height += area * y;
    width += area * r2 / (dimension == 3 ? 4 : 3);
  }
  return height / all / sqrt(width / all);
}

static double angle_of_cap(uint32_t dimension, double shape) {
  double low = 0.05, high = pi;
  for (int k = 0; k < 40; ++k) {
    const double middle = (low + high) / 2;
    if (shape_of_cap(dimension, middle) < shape)
      low = middle;
    else
      high = middle;
  }
  return low * 180 / pi;
}

static double shape_of(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  char *x = malloc((size_t)stats.count * dimension * precision);
  double width = 0;
  assert_non_null(x);
  assert_ok(pbf_get_positions(s, 0, stats.count, x));
  for (uint32_t i = 0; i < stats.count; ++i)
    for (uint32_t k = 0; k < dimension; k += 2)
      width +=
          pow(test_value(x, (uint64_t)i * dimension + k, precision) - stats.center_of_mass[k], 2);
  free(x);
  return stats.center_of_mass[1] / sqrt(width / stats.count / (dimension - 1));
}

/* The contact angle of a drop that lies on the floor with `start` at first. */
static double angle_of_drop(uint32_t dimension, uint32_t precision, double angle, double start) {
  const double volume = dimension == 3 ? 4 * pi / 3 * 216 : pi * 100, a = start * pi / 180;
  const double unit =
      dimension == 3 ? pi / 3 * (2 + cos(a)) * pow(1 - cos(a), 2) : a - sin(a) * cos(a);
  const double r = pow(volume / unit, 1.0 / dimension), origin[3] = {2, 0, 2};
  pbf_params params = params_of(dimension);
  params.wall_adhesion = (1 + cos(angle * pi / 180)) / 2;
  pbf_solver *s = cap(dimension, precision, &params, r, -r * cos(a), origin, 1);
  double shape = 0;
  assert_ok(pbf_step(s, dimension == 3 ? 800 : 2000));
  for (int k = 0; k < 20; ++k) {
    assert_ok(pbf_step(s, 20));
    shape += shape_of(s, dimension, precision) / 20;
  }
  pbf_destroy(s);
  return angle_of_cap(dimension, shape);
}

/* A drop keeps some ten degrees of the angle that it starts with, to either side. */
static void check_angles(uint32_t dimension, uint32_t precision) {
  const double next = test_is_long() ? 30 : dimension == 2 ? 60 : 90;
  for (double angle = 60; angle < 130; angle += next) {
    const double receding = angle_of_drop(dimension, precision, angle, angle - 20);
    const double advancing = angle_of_drop(dimension, precision, angle, angle + 20);
    if (!(fabs((receding + advancing) / 2 - angle) < 10))
      fail_msg("%uD: %.1f and %.1f degrees, the mean must be %g", dimension, receding, advancing,
               angle);
  }
}

static void drops_have_the_contact_angle(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_dimensions(check_angles);
}

/* Where a drop under the ceiling, half a disc or ball at first, is after a while, in spacings. The
 * largest one that hangs at 90 degrees has a Bond number of 0.86 in 2D and 0.87 in 3D, by the
 * radius of a disc or ball of its volume: the equation of Young and Laplace, integrated from the
 * apex on. */
static double depth_of_pendant(uint32_t dimension, uint32_t precision, double adhesion,
                               double bond) {
  const double radius = dimension == 3 ? 5 : 8, origin[3] = {2, 4, 2};
  pbf_params params = params_of(dimension);
  const double gravity = bond * tension / pow(radius * spacing, 2);
  params.wall_adhesion = adhesion;
  pbf_solver *s =
      cap(dimension, precision, &params, radius * pow(2, 1.0 / dimension), 0, origin, -1);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_step(s, 300));
  for (int k = 1; k <= 10; ++k) {
    params.gravity[1] = -gravity * k / 10;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 100));
  }
  assert_ok(pbf_step(s, 1000));
  assert_ok(pbf_get_stats(s, &stats));
  pbf_destroy(s);
  return (4 - stats.center_of_mass[1]) / spacing;
}

static void check_pendant(uint32_t dimension, uint32_t precision) {
  const double hangs = depth_of_pendant(dimension, precision, 0.5, 0.4);
  const double falls = depth_of_pendant(dimension, precision, 0.5, 1.8);
  const double without = depth_of_pendant(dimension, precision, 0, 0.4);
  if (!(hangs < 8)) fail_msg("%uD: a small drop is %.1f spacings below", dimension, hangs);
  if (!(falls > 20)) fail_msg("%uD: a large drop hangs at %.1f spacings", dimension, falls);
  if (!(without > 20)) fail_msg("%uD: without adhesion %.1f", dimension, without);
}

static void small_drops_hang(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_dimensions(check_pendant);
}

/* Along a plane nothing holds it: it gains g sin(slope), and stays on the plane, upside down. */
static void check_slope(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 400 };
  const double radius = dimension == 3 ? 5 : 8, origin[3] = {1, 4, 2};
  const double gravity = 0.3 * tension / pow(radius * spacing, 2), slope = pi / 6;
  pbf_params params = params_of(dimension);
  params.wall_adhesion = 0.5;
  pbf_solver *s =
      cap(dimension, precision, &params, radius * pow(2, 1.0 / dimension), 0, origin, -1);
  pbf_stats before = {.struct_size = sizeof before}, after = before;
  assert_ok(pbf_step(s, 300));
  assert_ok(pbf_get_stats(s, &before));
  params.gravity[0] = gravity * sin(slope);
  params.gravity[1] = -gravity * cos(slope);
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, STEPS));
  assert_ok(pbf_get_stats(s, &after));
  const double right = gravity * sin(slope) * STEPS * params.time_step;
  const double gained = (after.momentum[0] - before.momentum[0]) / right;
  if (!(fabs(gained - 1) < 0.05)) fail_msg("%uD: it gains %g of g sin a", dimension, gained);
  if (!((4 - after.center_of_mass[1]) / spacing < 8)) fail_msg("%uD: it has fallen", dimension);
  pbf_destroy(s);
}

static void drops_run_down_planes(void **state) {
  (void)state;
  test_for_dimensions(check_slope);
}

/* ---- Plates --------------------------------------------------------------------------------- */

/* How much higher fluid stands between two plates than far from them, over what Jurin's law gives
 * for them: 2 tension / (g width). */
static double rise(uint32_t precision, double adhesion) {
  enum { GAP = 8, THICK = 4, SIDE = 16, TOP = 40, DEPTH = 12 };
  const double gravity = 2 * tension / (10 * spacing * GAP * spacing);
  const double half = GAP / 2 + THICK + SIDE;
  pbf_params params = params_of(2);
  params.gravity[1] = -gravity;
  params.wall_adhesion = 0.5;
  params.domain_max[0] = 2 * half * spacing;
  pbf_collider plates[2];
  char *x = malloc((size_t)(2 * half * DEPTH) * 2 * precision);
  uint32_t count = 0;
  assert_non_null(x);
  for (int k = 0; k < 2; ++k) {
    plates[k] =
        load_collider(PBF_COLLIDER_BOX, spacing * (half + (k ? 1 : -1) * (GAP + THICK) / 2.),
                      spacing * (TOP + 6) / 2, 0);
    plates[k].half_extents[0] = THICK / 2. * spacing;
    plates[k].half_extents[1] = (TOP - 6) / 2. * spacing;
    plates[k].adhesion = adhesion;
  }
  for (int i = 0; i < (int)(2 * half); ++i)
    for (int j = 0; j < DEPTH; ++j) {
      const double from_middle = fabs(i + 0.5 - half);
      if (j >= 6 && from_middle > GAP / 2 && from_middle < GAP / 2 + THICK) continue;
      test_put(x, (uint64_t)count * 2, precision, spacing * (i + 0.5));
      test_put(x, (uint64_t)count++ * 2 + 1, precision, spacing * (j + 0.5));
    }
  const pbf_desc desc = test_desc(2, precision, count);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, 2, plates));
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  assert_ok(pbf_step(s, 3000));
  assert_ok(pbf_get_positions(s, 0, count, x));
  double between = 0, far = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const double from_middle = fabs(test_value(x, (uint64_t)i * 2, precision) / spacing - half);
    between += from_middle < GAP / 2;
    far += from_middle > half - 8;
  }
  free(x);
  pbf_destroy(s);
  return (between / GAP - far / 16) / 10;
}

/* So far as the tension of a surface of particles is that of its energy, cos(angle) of it. */
static void check_rise(uint32_t dimension, uint32_t precision) {
  if (dimension == 3) return;
  const double wets = rise(precision, 1), sinks = rise(precision, 0.25);
  if (!(wets > 0.4 && wets < 1.1)) fail_msg("it rises to %.2f of Jurin's height", wets);
  if (!(sinks < -0.15 && sinks > -0.6)) fail_msg("120 degrees: %.2f", sinks);
  if (!test_is_long()) return;
  const double most = rise(precision, 0.75), none = rise(precision, 0.5);
  if (!(fabs(most / wets - 0.5) < 0.2)) fail_msg("60 degrees: %.2f of 0 degrees", most / wets);
  if (!(fabs(none) < 0.15)) fail_msg("90 degrees: %.2f", none);
}

static void fluid_rises_between_plates(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_dimensions(check_rise);
}

/* ---- Momentum ------------------------------------------------------------------------------- */

/* All that fluid loses solids get, step by step, to rounding; and a collider that it clings to is
 * pulled to it. */
static void check_momentum(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 30 };
  const double size[3] = {0.5, 0.4, 0.5};
  const double rounding = precision == PBF_FLOAT32 ? 1e-5 : 1e-12;
  pbf_params params = params_of(dimension);
  pbf_collider solids[2] = {load_collider(PBF_COLLIDER_SPHERE, 0.25, 0.5, 0.25),
                            load_collider(PBF_COLLIDER_BOX, 0.9, 0.3, 0.25)};
  pbf_collider_load loads[2], walls[6];
  double before[3], after[3];
  solids[0].radius = 0.1;
  solids[1].half_extents[0] = 0.35;
  solids[1].velocity[0] = 0.01;
  for (int k = 0; k < 2; ++k) solids[k].adhesion = 0.9;
  params.loads = 1;
  params.wall_adhesion = 0.3;
  params.wall_friction = 0.2;
  load_scene s = load_scene_of(dimension, precision, &params, size, load_everywhere, 2, solids);
  for (int step = 0; step < STEPS; ++step) {
    double all[3] = {0, 0, 0}, sum = 0;
    load_momentum(&s, before);
    assert_ok(pbf_step(s.solver, 1));
    load_momentum(&s, after);
    load_colliders(&s, 2, loads);
    load_walls(&s, walls);
    for (uint32_t k = 0; k < dimension; ++k) {
      for (int c = 0; c < 2; ++c) all[k] += loads[c].impulse_sum[k];
      for (uint32_t c = 0; c < 2 * dimension; ++c) all[k] += walls[c].impulse_sum[k];
      sum += fabs(all[k]) + s.count * s.mass * 1e-3;
    }
    for (uint32_t k = 0; k < dimension; ++k)
      if (!(fabs(before[k] - after[k] - all[k]) < rounding * sum))
        fail_msg("%uD, step %d: the fluid loses %g along %u, solids get %g", dimension, step,
                 before[k] - after[k], k, all[k]);
  }
  load_end(&s);
}

static void solids_get_what_fluid_loses(void **state) {
  (void)state;
  test_for_each_kind(check_momentum);
}

/* ---- Values --------------------------------------------------------------------------------- */

static uint64_t hash_after(pbf_solver *s, uint32_t steps) {
  uint64_t hash = 0;
  assert_ok(pbf_step(s, steps));
  assert_ok(pbf_hash(s, &hash));
  return hash;
}

/* Without a tension nothing adheres, and nothing of it is run or held. */
static void check_unused(uint32_t dimension, uint32_t precision) {
  const double origin[3] = {2, 0, 2};
  uint64_t hashes[2];
  pbf_plan plans[2];
  for (int k = 0; k < 2; ++k) {
    pbf_params params = params_of(dimension);
    params.surface_tension = 0;
    params.shear_stress_correction = 0;
    params.gravity[1] = -1;
    params.wall_adhesion = k ? 0.7 : 0;
    pbf_solver *s = cap(dimension, precision, &params, 5, 0, origin, 1);
    pbf_collider c = load_collider(PBF_COLLIDER_SPHERE, 2.3, 0.1, 2);
    c.radius = 0.2;
    c.adhesion = k ? 0.7 : 0;
    assert_ok(pbf_set_colliders(s, 1, &c));
    hashes[k] = hash_after(s, 20);
    plans[k].struct_size = sizeof plans[k];
    assert_ok(pbf_get_plan(s, &plans[k]));
    pbf_destroy(s);
  }
  assert_true(hashes[0] == hashes[1]);
  assert_int_equal(plans[0].stage_count, plans[1].stage_count);
  assert_true(plans[0].bytes == plans[1].bytes);
}

static void without_tension_nothing_adheres(void **state) {
  (void)state;
  test_for_each_kind(check_unused);
}

/* A state has it, of walls and colliders: what goes on from one has the same bits. */
static void check_state(uint32_t dimension, uint32_t precision) {
  const double origin[3] = {2, 0, 2};
  pbf_params params = params_of(dimension);
  params.wall_adhesion = 0.7;
  pbf_solver *s = cap(dimension, precision, &params, 5, 0, origin, 1);
  pbf_collider c = load_collider(PBF_COLLIDER_SPHERE, 2.3, 0.1, 2), found;
  uint64_t size = 0;
  c.radius = 0.2;
  c.adhesion = 0.6;
  assert_ok(pbf_set_colliders(s, 1, &c));
  assert_ok(pbf_step(s, 5));
  assert_ok(pbf_save(s, NULL, &size));
  void *state = malloc(size);
  assert_non_null(state);
  assert_ok(pbf_save(s, state, &size));
  const uint64_t right = hash_after(s, 5);
  c.adhesion = params.wall_adhesion = 0;
  assert_ok(pbf_set_colliders(s, 1, &c));
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_load(s, state, size));
  found.struct_size = sizeof found;
  assert_ok(pbf_get_collider(s, 0, &found));
  assert_true(found.adhesion == 0.6);
  params.struct_size = sizeof params;
  assert_ok(pbf_get_params(s, &params));
  assert_true(params.wall_adhesion == 0.7);
  assert_true(hash_after(s, 5) == right);
  assert_ok(pbf_load(s, state, size));
  params.wall_adhesion = 0.2;
  assert_ok(pbf_set_params(s, &params));
  assert_true(hash_after(s, 5) != right);
  free(state);
  pbf_destroy(s);
}

static void states_have_it(void **state) {
  (void)state;
  test_for_each_kind(check_state);
}

static void bad_values_are_refused(void **state) {
  (void)state;
  pbf_params params = params_of(3);
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 1);
  pbf_solver *s = NULL;
  const double bad[] = {-0.1, 1.1, NAN};
  for (int k = 0; k < 3; ++k) {
    params.wall_adhesion = bad[k];
    assert_fails(pbf_create(&desc, &params, &s), PBF_ERROR_INVALID_ARGUMENT,
                 "params.wall_adhesion");
  }
  params.wall_adhesion = 1;
  s = test_create(&desc, &params);
  pbf_collider c = load_collider(PBF_COLLIDER_SPHERE, 1, 1, 1);
  for (int k = 0; k < 3; ++k) {
    c.adhesion = bad[k];
    assert_fails(pbf_set_colliders(s, 1, &c), PBF_ERROR_INVALID_ARGUMENT, "colliders[0].adhesion");
  }
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_particle_is_pulled),
      cmocka_unit_test(its_pull_has_an_energy),
      cmocka_unit_test(what_pulls_has_the_load),
      cmocka_unit_test(drops_have_the_contact_angle),
      cmocka_unit_test(small_drops_hang),
      cmocka_unit_test(drops_run_down_planes),
      cmocka_unit_test(fluid_rises_between_plates),
      cmocka_unit_test(solids_get_what_fluid_loses),
      cmocka_unit_test(without_tension_nothing_adheres),
      cmocka_unit_test(states_have_it),
      cmocka_unit_test(bad_values_are_refused),
  };
  if (test_is_stub()) return TEST_SKIPPED;
  return TEST_RUN(tests);
}
