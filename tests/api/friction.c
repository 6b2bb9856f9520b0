/* Friction of walls and colliders, against a body on a slope and what a drum takes along. */
#include "load_scene.h"

static const double pi = 3.14159265358979323846;

/* A long bed. */
static pbf_collider bed_of(double kinetic, double at_rest) {
  pbf_collider bed = load_collider(PBF_COLLIDER_BOX, 4, 0, 0.5);
  bed.half_extents[0] = 5;
  bed.half_extents[1] = 0.25;
  bed.friction = kinetic;
  bed.static_friction = at_rest;
  return bed;
}

enum { ON_WALL, ON_BOX, ON_HULL, BEDS };

/* One particle on the floor of a long box, or on a bed there, which gravity makes a slope of this
 * angle. */
static load_scene slope(uint32_t dimension, uint32_t precision, double angle, double kinetic,
                        double at_rest, int on_collider) {
  const double domain[3] = {8, 1, 1};
  pbf_params params = load_params(dimension, domain);
  pbf_collider bed = bed_of(kinetic, at_rest);
  params.gravity[0] = load_gravity * sin(angle);
  params.gravity[1] = -load_gravity * cos(angle);
  params.wall_friction = on_collider ? 0 : kinetic;
  params.wall_static_friction = on_collider ? 0 : at_rest;
  load_scene s = {dimension, precision, 1, params, NULL, pow(load_spacing, dimension), NULL};
  const pbf_desc desc = test_desc(dimension, precision, 1);
  s.solver = test_create(&desc, &params);
  s.values = calloc(dimension, precision);
  test_put(s.values, 0, precision, 0.5);
  test_put(s.values, 1, precision, on_collider ? 0.2502 : 1e-4);
  if (dimension == 3) test_put(s.values, 2, precision, 0.5);
  if (on_collider == ON_HULL) load_make_hull(dimension, load_spacing, &bed);
  if (on_collider) assert_ok(pbf_set_colliders(s.solver, 1, &bed));
  if (on_collider == ON_HULL) pbf_release_shape(bed.geometry);
  assert_ok(pbf_add_particles(s.solver, 1, s.values, NULL, NULL));
  return s;
}

static double speed_along(load_scene *s) {
  assert_ok(pbf_get_velocities(s->solver, 0, 1, s->values));
  return test_value(s->values, 0, s->precision);
}

static double place_along(load_scene *s) {
  assert_ok(pbf_get_positions(s->solver, 0, 1, s->values));
  return test_value(s->values, 0, s->precision);
}

/* It slides with g (sin a - mu cos a), … */
static void check_sliding(uint32_t dimension, uint32_t precision) {
  for (int on_collider = ON_WALL; on_collider < BEDS; ++on_collider)
    for (double mu = 0; mu < 0.5; mu += 0.2) {
      const double angle = 30 * pi / 180;
      load_scene s = slope(dimension, precision, angle, mu, 0, on_collider);
      assert_ok(pbf_step(s.solver, 20));
      const double before = speed_along(&s);
      assert_ok(pbf_step(s.solver, 100));
      const double gained = (speed_along(&s) - before) / (100 * s.params.time_step);
      const double right = load_gravity * (sin(angle) - mu * cos(angle));
      if (!(fabs(gained - right) < 0.02 * load_gravity))
        fail_msg("mu %g, collider %d: %g, it must be %g", mu, on_collider, gained, right);
      load_end(&s);
    }
}

static void slopes_slow_what_slides(void **state) {
  (void)state;
  test_for_each_kind(check_sliding);
}

/* … or rests, where the slope is flatter than static friction holds; kinetic friction does not
 * tell. A wall gives back a part of the depth in which it finds what falls on it: between its
 * bounces a lone particle creeps, and the push of one may be half of what is to be held. */
static void check_rest(uint32_t dimension, uint32_t precision) {
  for (int on_collider = 0; on_collider < 2; ++on_collider) {
    const double angle = atan(on_collider ? 0.5 : 0.25);
    load_scene s = slope(dimension, precision, 0, 0.2, 0.55, on_collider);
    assert_ok(pbf_step(s.solver, 20)); /* it lies, … */
    s.params.gravity[0] = load_gravity * sin(angle);
    s.params.gravity[1] = -load_gravity * cos(angle);
    assert_ok(pbf_set_params(s.solver, &s.params)); /* … and then the bed is tilted */
    const double before = place_along(&s);
    assert_ok(pbf_step(s.solver, 200));
    const double crept = place_along(&s) - before;
    const double most = on_collider ? 0.02 * load_spacing : 1.5 * load_spacing;
    if (!(fabs(crept) < most)) fail_msg("collider %d: it has crept by %g", on_collider, crept);
    load_end(&s);
    s = slope(dimension, precision, atan(0.6), 0.2, 0.55, on_collider);
    assert_ok(pbf_step(s.solver, 100));
    assert_true(place_along(&s) - 0.5 > 10 * load_spacing);
    load_end(&s);
  }
}

static void slopes_hold_what_rests(void **state) {
  (void)state;
  test_for_each_kind(check_rest);
}

/* A belt that runs takes it along, up to its own speed and no further. */
static void check_belt(uint32_t dimension, uint32_t precision) {
  load_scene s = slope(dimension, precision, 0, 0.3, 0, 1);
  pbf_collider belt = bed_of(0.3, 0);
  belt.velocity[0] = 1;
  assert_ok(pbf_set_colliders(s.solver, 1, &belt));
  assert_ok(pbf_step(s.solver, 20));
  const double gained = speed_along(&s) / (20 * s.params.time_step);
  if (!(fabs(gained - 0.3 * load_gravity) < 0.05 * load_gravity)) fail_msg("it gains %g", gained);
  assert_ok(pbf_step(s.solver, 80));
  if (!(fabs(speed_along(&s) - 1) < 1e-3)) fail_msg("it ends at %g", speed_along(&s));
  load_end(&s);
}

/* A bed that stretches does as well, as fast as the place on it where the particle lies. */
static void check_stretching(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 100 };
  load_scene s = slope(dimension, precision, 0, 0.3, 0, ON_BOX);
  pbf_collider belt = bed_of(0.3, 0);
  belt.half_extents_rate[0] = 0.3;
  assert_ok(pbf_set_colliders(s.solver, 1, &belt));
  assert_ok(pbf_step(s.solver, STEPS));
  const double half = belt.half_extents[0] + 0.3 * STEPS * s.params.time_step;
  const double right = 0.3 * (place_along(&s) - belt.position[0]) / half;
  if (!(fabs(speed_along(&s) - right) < 0.02 * fabs(right)))
    fail_msg("it ends at %g, and the bed at %g", speed_along(&s), right);
  load_end(&s);
}

static void belts_take_along(void **state) {
  (void)state;
  test_for_each_kind(check_belt);
  test_for_each_kind(check_stretching);
}

/* What friction takes is in the load: along the slope mu times what is across. */
static void check_load(uint32_t dimension, uint32_t precision) {
  const double angle = 30 * pi / 180, mu = 0.3;
  load_scene s = slope(dimension, precision, angle, mu, 0, 1);
  pbf_collider_load load;
  assert_ok(pbf_step(s.solver, 20));
  load_colliders(&s, 1, &load);
  assert_ok(pbf_step(s.solver, 100));
  load_colliders(&s, 1, &load);
  const double weight = s.mass * load_gravity * cos(angle) * load.time_sum;
  if (!(fabs(load.impulse_sum[1] + weight) < 0.02 * weight) ||
      !(fabs(load.impulse_sum[0] - mu * weight) < 0.02 * weight))
    fail_msg("the load is %g, %g; it must be %g, %g", load.impulse_sum[0], load.impulse_sum[1],
             mu * weight, -weight);
  load_end(&s);
}

static void loads_have_friction(void **state) {
  (void)state;
  test_for_each_kind(check_load);
}

static int in_drum(const double x[3]) {
  return hypot(x[0] - 0.5, x[1] - 0.5) < 0.4 - 0.45 * load_spacing;
}

/* How fast the fluid in a drum turns once it has turned for a while, over the drum. */
static double spun_up(uint32_t precision, double no_slip) {
  const double domain[3] = {1, 1, 1}, size[3] = {1, 1, 1}, rate = 2;
  pbf_params params = load_params(2, domain);
  params.gravity[1] = 0;
  params.viscosity = 0.05;
  pbf_collider drum = load_collider(PBF_COLLIDER_SPHERE, 0.5, 0.5, 0);
  drum.inverted = 1;
  drum.radius = 0.4;
  drum.angular_velocity[2] = rate;
  drum.no_slip = no_slip;
  load_scene s = load_scene_of(2, precision, &params, size, in_drum, 1, &drum);
  assert_ok(pbf_step(s.solver, 400));
  char *x = calloc((size_t)s.count * 2, precision);
  assert_ok(pbf_get_positions(s.solver, 0, s.count, x));
  assert_ok(pbf_get_velocities(s.solver, 0, s.count, s.values));
  double turn = 0, inertia = 0;
  for (uint32_t i = 0; i < s.count; ++i) {
    const double rx = test_value(x, 2 * i, precision) - 0.5;
    const double ry = test_value(x, 2 * i + 1, precision) - 0.5;
    turn += rx * test_value(s.values, 2 * i + 1, precision) -
            ry * test_value(s.values, 2 * i, precision);
    inertia += rx * rx + ry * ry;
  }
  free(x);
  load_end(&s);
  return turn / inertia / rate;
}

/* 3 s are more than three times R² / (j² nu), j = 3.83: it turns as the drum does. */
static void check_drum(uint32_t dimension, uint32_t precision) {
  if (dimension != 2) return;
  const double with = spun_up(precision, 1), without = spun_up(precision, 0);
  if (!(fabs(with - 1) < 0.05)) fail_msg("the fluid turns %g times as fast as its drum", with);
  if (!(fabs(without) < 0.05)) fail_msg("without no_slip it turns at %g", without);
}

static void drums_take_fluid_along(void **state) {
  (void)state;
  test_for_long_kinds(check_drum);
}

static void check_misuse(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, 1);
  pbf_params params = test_params();
  pbf_collider box = load_collider(PBF_COLLIDER_BOX, 0.5, 0.5, 0.5);
  pbf_solver *solver = test_create(&desc, &params);
  box.friction = -1;
  assert_fails(pbf_set_colliders(solver, 1, &box), PBF_ERROR_INVALID_ARGUMENT,
               "colliders[0].friction is -1");
  box.friction = 0;
  box.no_slip = 1.5;
  assert_fails(pbf_set_colliders(solver, 1, &box), PBF_ERROR_INVALID_ARGUMENT,
               "colliders[0].no_slip is 1.5");
  params.wall_static_friction = NAN;
  assert_fails(pbf_set_params(solver, &params), PBF_ERROR_INVALID_ARGUMENT, "wall_static_friction");
  pbf_destroy(solver);
}

static void bad_friction_is_refused(void **state) {
  (void)state;
  test_for_each_kind(check_misuse);
}

/* The stub has none. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(slopes_slow_what_slides), cmocka_unit_test(slopes_hold_what_rests),
      cmocka_unit_test(belts_take_along),        cmocka_unit_test(loads_have_friction),
      cmocka_unit_test(drums_take_fluid_along),  cmocka_unit_test(bad_friction_is_refused),
  };
  return TEST_RUN(tests);
}
