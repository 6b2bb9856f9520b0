/* What the fluid does to walls and colliders, against what it must be: the weight of water, the
 * momentum that the fluid loses, the push of a jet. Buoyancy is in buoyancy.c. */
#include "load_scene.h"

#include <stdio.h>

enum { WALLS = 6 };

/* ---- Water at rest -------------------------------------------------------------------------- */

/* Its weight, which is known, and the torque that has about the origin; walls press each other
 * apart. */
static void check_tank(uint32_t dimension, uint32_t precision, uint32_t layers, double grid) {
  enum { SETTLES = 150, LOOKS = 60 };
  const double width = 0.4, high = load_spacing * layers, domain[3] = {width, 2 * high, width};
  const double size[3] = {width, high, width};
  pbf_params params = load_params(dimension, domain);
  params.pressure_grid = grid;
  load_scene s = load_scene_of(dimension, precision, &params, size, load_everywhere, 0, NULL);
  const double weight = s.count * s.mass * load_gravity;
  pbf_collider_load walls[WALLS];
  assert_ok(pbf_step(s.solver, SETTLES));
  load_walls(&s, walls);
  assert_ok(pbf_step(s.solver, LOOKS));
  load_walls(&s, walls);
  load_expect("the weight on the floor", -load_force(&walls[PBF_WALL_Y_MIN], 1), weight, 0.01);
  load_expect("its torque", -load_torque(&walls[PBF_WALL_Y_MIN], 2), weight * width / 2, 0.02);
  const double side = 0.5 * load_gravity * high * high * (dimension == 3 ? width : 1);
  load_expect("the push on a side", load_force(&walls[PBF_WALL_X_MAX], 0), side, 0.08);
  load_expect("the push on the other", -load_force(&walls[PBF_WALL_X_MIN], 0), side, 0.08);
  assert_true(fabs(load_force(&walls[PBF_WALL_Y_MAX], 1)) < 1e-6 * weight);
  const double floor_area = dimension == 3 ? width * width : width;
  load_expect("the wet floor", walls[PBF_WALL_Y_MIN].wetted_area, floor_area, 0.05);
  assert_int_equal(walls[PBF_WALL_Y_MAX].contacts, 0);
  assert_true(walls[PBF_WALL_Y_MIN].contacts > 0);
  load_expect("the time", walls[0].time_sum, LOOKS * params.time_step, 1e-9);
  load_end(&s);
}

static void check_tanks(uint32_t dimension, uint32_t precision) {
  check_tank(dimension, precision, 8, 0);
  check_tank(dimension, precision, dimension == 3 ? 16 : 30, 2);
}

static void water_weighs_on_its_floor(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_tanks);
}

/* ---- Floors that go faster and slower ------------------------------------------------------- */

enum { LIFT_LAYERS = 24, LIFT_SETTLES = 90 };

/* A column of water under a pressure grid, in long steps, on the domain's floor or on a box. */
static load_scene column(uint32_t dimension, uint32_t precision, const pbf_collider *box) {
  const double width = 0.4, high = LIFT_LAYERS * load_spacing;
  const double domain[3] = {width, 2 * high, width}, size[3] = {width, high, width};
  pbf_params params = load_params(dimension, domain);
  params.domain_min[1] = box ? -0.5 : 0;
  params.pressure_grid = 2;
  params.time_step = 1.0 / 60;
  load_scene s =
      load_scene_of(dimension, precision, &params, size, load_everywhere, box != NULL, box);
  pbf_collider_load settling;
  assert_ok(pbf_step(s.solver, LIFT_SETTLES));
  if (box) load_colliders(&s, 1, &settling);
  return s;
}

/* What weighs on the floor goes by its acceleration at once: m (g + a). */
static void check_swing(uint32_t dimension, uint32_t precision) {
  enum { PERIOD = 30 };
  load_scene s = column(dimension, precision, NULL);
  const double dt = s.params.time_step, frequency = 2 * 3.14159265358979 / (PERIOD * dt);
  const double weight = s.count * s.mass * load_gravity, part = 0.3;
  const double quarter = 0.5 * 3.14159265358979,
               amplitude = part * load_gravity / (frequency * frequency);
  double sine = 0, cosine = 0;
  s.params.domain_min[1] = -amplitude; /* from its highest place, where it is and stands */
  s.params.wall_amplitude[PBF_WALL_Y_MIN] = amplitude;
  s.params.wall_frequency[PBF_WALL_Y_MIN] = frequency;
  s.params.wall_phase[PBF_WALL_Y_MIN] = quarter - frequency * LIFT_SETTLES * dt;
  assert_ok(pbf_set_params(s.solver, &s.params));
  for (int k = 0; k < 2 * PERIOD; ++k) {
    pbf_collider_load walls[WALLS];
    assert_ok(pbf_step(s.solver, 1));
    load_walls(&s, walls);
    if (k < PERIOD) continue;
    sine -= 2 * load_force(&walls[PBF_WALL_Y_MIN], 1) * sin(frequency * k * dt) / PERIOD;
    cosine -= 2 * load_force(&walls[PBF_WALL_Y_MIN], 1) * cos(frequency * k * dt) / PERIOD;
  }
  load_expect("what a floor's swing adds", cosine, -part * weight, 0.1);
  if (!(fabs(sine) < 0.1 * part * weight)) fail_msg("%g of it comes late", sine / weight);
  load_end(&s);
}

static pbf_collider box_below(void) {
  pbf_collider box = load_collider(PBF_COLLIDER_BOX, 0.2, -0.4, 0.2);
  for (int k = 0; k < 3; ++k) box.half_extents[k] = k == 1 ? 0.4 : 0.5;
  return box;
}

/* A box that is set anew, or moved, for each step. */
static void check_lift(uint32_t dimension, uint32_t precision, int is_moved) {
  enum { STEPS = 6 };
  pbf_collider box = box_below();
  load_scene s = column(dimension, precision, &box);
  const double dt = s.params.time_step, lift = 0.3 * load_gravity;
  const double weight = s.count * s.mass * load_gravity;
  double force = 0;
  for (int k = 0; k < STEPS; ++k) {
    pbf_collider_load load;
    const double velocity = lift * (k + 1) * dt;
    if (is_moved) {
      box.position[1] += velocity * dt;
      assert_ok(pbf_move_colliders(s.solver, 1, &box, 0.9999 * dt)); /* and has come there */
    } else {
      box.velocity[1] = velocity;
      assert_ok(pbf_set_colliders(s.solver, 1, &box));
      box.position[1] += velocity * dt;
    }
    assert_ok(pbf_step(s.solver, 1));
    load_colliders(&s, 1, &load);
    force -= load_force(&load, 1) / STEPS;
  }
  load_expect("the weight on a lift that starts", force, 1.3 * weight, 0.05);
  load_end(&s);
}

/* One that rises evenly bears the weight in each step, wherever its face is in a cell. */
static void check_rise(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 60 };
  pbf_collider box = box_below();
  load_scene s = column(dimension, precision, &box);
  const double weight = s.count * s.mass * load_gravity;
  box.velocity[1] = 0.1;
  assert_ok(pbf_set_colliders(s.solver, 1, &box));
  for (int k = 0; k < STEPS; ++k) {
    pbf_collider_load load;
    s.params.time_step = k == 0 ? 1.0 / 240 : 1.0 / 60; /* what began in a short one is no news */
    if (k < 2) assert_ok(pbf_set_params(s.solver, &s.params));
    assert_ok(pbf_step(s.solver, 1));
    load_colliders(&s, 1, &load);
    if (k > 0)
      load_expect("the weight on a box that rises", -load_force(&load, 1), weight,
                  k < 4 ? 0.3 : 0.2);
  }
  load_end(&s);
}

static void check_lifts(uint32_t dimension, uint32_t precision) {
  check_swing(dimension, precision);
  check_rise(dimension, precision);
  check_lift(dimension, precision, 0);
  check_lift(dimension, precision, 1);
}

static void water_weighs_more_on_a_lift(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_lifts);
}

/* Two boxes side by side, one of them a hull or not, are the floor: each carries half, and no more
 * because of the seam. */
static void check_halves_of(uint32_t dimension, uint32_t precision, int has_hull) {
  const double width = 0.4, domain[3] = {width, 1, width}, size[3] = {width, 0.6, width};
  const pbf_params params = load_params(dimension, domain);
  pbf_collider halves[2] = {load_collider(PBF_COLLIDER_BOX, width / 4, 0, width / 2),
                            load_collider(PBF_COLLIDER_BOX, 3 * width / 4, 0, width / 2)};
  for (int k = 0; k < 2; ++k) {
    halves[k].half_extents[0] = width / 4;
    halves[k].half_extents[1] = 0.1;
    halves[k].half_extents[2] = width / 2;
  }
  pbf_params raised = params;
  raised.domain_min[1] = -0.1;
  for (int k = 0; k < 2; ++k) halves[k].position[1] = -0.1;
  if (has_hull) load_make_hull(dimension, 0.25 * load_spacing, &halves[0]);
  load_scene s = load_scene_of(dimension, precision, &raised, size, load_everywhere, 2, halves);
  if (has_hull) pbf_release_shape(halves[0].geometry);
  const double weight = s.count * s.mass * load_gravity;
  pbf_collider_load loads[2];
  assert_ok(pbf_step(s.solver, 200));
  load_colliders(&s, 2, loads);
  assert_ok(pbf_step(s.solver, 60));
  load_colliders(&s, 2, loads);
  load_expect("the weight on the left half", -load_force(&loads[0], 1), weight / 2, 0.02);
  load_expect("the weight on the right half", -load_force(&loads[1], 1), weight / 2, 0.02);
  load_expect("the sum", -load_force(&loads[0], 1) - load_force(&loads[1], 1), weight, 0.01);
  assert_true(fabs(load_torque(&loads[0], 2)) < 0.05 * weight / 2 * width / 4);
  load_end(&s);
}

static void check_halves(uint32_t dimension, uint32_t precision) {
  check_halves_of(dimension, precision, 0);
  check_halves_of(dimension, precision, 1);
}

static void halves_of_a_floor_share_it(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_halves);
}

/* ---- A jet ---------------------------------------------------------------------------------- */

static int in_jet(const double x[3]) { return x[1] > 0.8 && x[1] < 1.2; }

/* What comes at a plate and flows off along it leaves all of its momentum across: rho Q v each time
 * unit, all of it in the end. */
static void check_jet(uint32_t dimension, uint32_t precision) {
  if (dimension != 2) return;
  const double speed = 2, domain[3] = {3, 2, 1}, size[3] = {1, 2, 1};
  pbf_params params = load_params(2, domain);
  for (int k = 0; k < 3; ++k) params.gravity[k] = 0;
  pbf_collider plate = load_collider(PBF_COLLIDER_BOX, 1.3, 1, 0);
  plate.half_extents[0] = 0.05;
  plate.half_extents[1] = 1;
  load_scene s = load_scene_of(2, precision, &params, size, in_jet, 1, &plate);
  char *v = calloc((size_t)s.count * 2, precision);
  for (uint32_t i = 0; i < s.count; ++i) test_put(v, 2 * i, precision, speed);
  assert_ok(pbf_set_velocities(s.solver, 0, s.count, v));
  pbf_collider_load load;
  assert_ok(pbf_step(s.solver, 24)); /* the jet meets the plate */
  load_colliders(&s, 1, &load);
  assert_ok(pbf_step(s.solver, 30));
  load_colliders(&s, 1, &load);
  load_expect("the force of the jet", load_force(&load, 0), 0.4 * speed * speed, 0.1);
  free(v);
  load_end(&s);
}

static void a_jet_pushes_a_plate(void **state) {
  (void)state;
  test_for_long_kinds(check_jet);
}

/* ---- Fluid that sticks ---------------------------------------------------------------------- */

static int in_channel(const double x[3]) { return x[0] > 2 && x[0] < 4; }

/* A force along a channel moves fluid until the solids that it sticks to take it up: a wall and a
 * plate half of it each, or the wall alone all of it. Steady after H² / (pi² nu), four times that
 * with one side: 0.65. */
static void check_channel(uint32_t dimension, uint32_t precision) {
  if (dimension != 2) return;
  enum { SETTLES = 180, LOOKS = 30 };
  const double high = 0.4, domain[3] = {6, 0.6, 1}, size[3] = {6, high, 1}, g = 0.25;
  for (int slides = 0; slides < 2; ++slides) {
    pbf_params params = load_params(2, domain);
    for (int k = 0; k < 3; ++k) params.gravity[k] = k == 0 ? g : 0;
    params.viscosity = 0.1;
    params.wall_no_slip = 1;
    params.time_step = 1.0 / 60;
    pbf_collider plate = load_collider(PBF_COLLIDER_BOX, 3, high + 0.1, 0);
    plate.half_extents[0] = 3;
    plate.half_extents[1] = 0.1;
    plate.no_slip = !slides;
    load_scene s = load_scene_of(2, precision, &params, size, in_channel, 1, &plate);
    const double all = g * s.count * s.mass;
    pbf_collider_load walls[WALLS], load;
    assert_ok(pbf_step(s.solver, SETTLES));
    load_walls(&s, walls);
    load_colliders(&s, 1, &load);
    assert_ok(pbf_step(s.solver, LOOKS));
    load_walls(&s, walls);
    load_colliders(&s, 1, &load);
    const double floor = load_force(&walls[PBF_WALL_Y_MIN], 0), ceiling = load_force(&load, 0);
    if (slides) { /* the slug shears, and its momentum swings */
      load_expect("the drag on the floor", floor, all, 0.05);
      assert_true(fabs(ceiling) < 0.01 * all);
    } else {
      load_expect("the drag on the floor", floor, all / 2, 0.02);
      load_expect("the drag on the plate", ceiling, all / 2, 0.02);
    }
    load_end(&s);
  }
}

static void a_channel_drags_its_walls_along(void **state) {
  (void)state;
  test_for_long_kinds(check_channel);
}

/* ---- Balance -------------------------------------------------------------------------------- */

static int in_drop(const double x[3]) { return x[1] < 0.3 || (x[1] > 0.5 && x[0] < 0.4); }

static void sum_up(const pbf_collider_load *loads, uint32_t count, double sum[3]) {
  for (uint32_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) sum[k] += loads[i].impulse_sum[k];
}

/* A drop falls into a pool, through which a box sweeps and in which a ball turns and grows. */
static load_scene splash(uint32_t dimension, uint32_t precision, const pbf_params *params) {
  const double size[3] = {0.8, 0.8, 0.4};
  pbf_collider solids[3] = {load_collider(PBF_COLLIDER_BOX, 0.2, 0.15, 0.2),
                            load_collider(PBF_COLLIDER_SPHERE, 0.6, 0.2, 0.2),
                            load_collider(PBF_COLLIDER_PLANE, 0.8, 0, 0)};
  for (int k = 0; k < 3; ++k) solids[0].half_extents[k] = 0.06;
  solids[0].velocity[0] = 0.7;
  solids[0].angular_velocity[2] = 2;
  solids[1].radius = 0.08;
  solids[1].radius_rate = 0.05;
  solids[2].axis[0] = -1;
  solids[2].axis[1] = 0.5;
  for (int k = 0; k < 3; ++k) solids[k].no_slip = 1; /* where there is viscosity */
  return load_scene_of(dimension, precision, params, size, in_drop, 3, solids);
}

static pbf_params splash_params(uint32_t dimension) {
  const double domain[3] = {0.8, 1.2, 0.4};
  return load_params(dimension, domain);
}

/* To a part of the momentum that gravity gives in a step, or that solids get in one. */
static void check_balance(uint32_t dimension, uint32_t precision, const pbf_params *params) {
  enum { STEPS = 60 };
  load_scene s = splash(dimension, precision, params);
  const double weight = s.count * s.mass * load_gravity;
  pbf_collider_load walls[WALLS], solids[3];
  double before[3], after[3], moved = weight * params->time_step;
  load_momentum(&s, before);
  for (int step = 0; step < STEPS; ++step) {
    double given[3] = {0};
    assert_ok(pbf_step(s.solver, 1));
    load_walls(&s, walls);
    load_colliders(&s, 3, solids);
    load_momentum(&s, after);
    sum_up(walls, 2 * dimension, given);
    sum_up(solids, 3, given);
    for (uint32_t k = 0; k < dimension; ++k) {
      const double lost = before[k] - after[k] - (k == 1 ? weight * params->time_step : 0);
      moved = fmax(moved, fabs(lost));
      if (!(fabs(given[k] - lost) <= 1e-6 * moved))
        fail_msg("step %d, axis %u: solids got %.9g, the fluid lost %.9g", step, k, given[k], lost);
      before[k] = after[k];
    }
  }
  assert_true(moved > 1.5 * weight * params->time_step);
  load_end(&s);
}

static void check_balances(uint32_t dimension, uint32_t precision) {
  pbf_params params = splash_params(dimension);
  check_balance(dimension, precision, &params);
  params.pressure_grid = 2;
  params.shear_stress_correction = 0.75;
  check_balance(dimension, precision, &params);
  params = splash_params(dimension);
  params.wall_density = 0;
  params.collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_AFTER_SOLVE;
  check_balance(dimension, precision, &params);
  params = splash_params(dimension);
  params.smoothing_radius = 3 * load_spacing;
  params.solver = PBF_SOLVER_JACOBI;
  params.tolerance = 1e-3;
  check_balance(dimension, precision, &params);
  params = splash_params(dimension);
  params.viscosity = 0.02;
  params.wall_no_slip = 1;
  check_balance(dimension, precision, &params);
}

static void solids_get_what_the_fluid_loses(void **state) {
  (void)state;
  test_for_long_kinds(check_balances);
}

/* ---- Bits ----------------------------------------------------------------------------------- */

static void loads_with_threads(uint32_t dimension, uint32_t precision, uint32_t threads,
                               pbf_collider_load loads[WALLS + 3]) {
  const pbf_params params = splash_params(dimension);
  const double size[3] = {0.8, 0.8, 0.4};
  load_scene s = {dimension, precision, load_count(size, dimension, in_drop), params, NULL,
                  0,         NULL};
  load_scene other = splash(dimension, precision, &params);
  uint64_t bytes;
  void *state = test_save(other.solver, &bytes);
  pbf_desc desc = test_desc(dimension, precision, s.count);
  desc.threads = threads;
  s.solver = test_create(&desc, &params);
  assert_ok(pbf_load(s.solver, state, bytes));
  assert_ok(pbf_step(s.solver, 40));
  load_walls(&s, loads);
  load_colliders(&s, 3, loads + 2 * dimension);
  free(state);
  load_end(&s);
  load_end(&other);
}

static void check_threads(uint32_t dimension, uint32_t precision) {
  pbf_collider_load one[WALLS + 3] = {{0}}, three[WALLS + 3] = {{0}};
  loads_with_threads(dimension, precision, 1, one);
  loads_with_threads(dimension, precision, 3, three);
  assert_memory_equal(one, three, sizeof one);
  assert_true(one[0].impulse[0] != 0);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  test_for_each_kind(check_threads);
}

/* Not a bit of the fluid changes with loads, and without them there is no stage and no array. On
 * cuda scenes as small as this have other bits in their kernel of one launch, which drag is not in.
 */
static void check_cost(uint32_t dimension, uint32_t precision) {
  pbf_params params = splash_params(dimension);
  if (strcmp(test_backend(), "cuda") == 0) params.drag = 0.1;
  uint64_t hash[2], bytes[2];
  for (uint32_t loads = 0; loads < 2; ++loads) {
    params.loads = loads;
    load_scene s = splash(dimension, precision, &params);
    pbf_plan plan = {.struct_size = sizeof plan};
    assert_ok(pbf_step(s.solver, 30));
    hash[loads] = test_hash(s.solver);
    assert_ok(pbf_get_plan(s.solver, &plan));
    bytes[loads] = plan.bytes;
    uint32_t stages = 0;
    for (uint32_t k = 0; k < plan.stage_count; ++k)
      stages += strcmp(plan.stages[k].name, "loads") == 0;
    assert_int_equal(stages, loads);
    load_end(&s);
  }
  assert_true(hash[0] == hash[1]);
  assert_true(bytes[0] < bytes[1]);
}

static void loads_change_no_bit(void **state) {
  (void)state;
  test_for_each_kind(check_cost);
}

/* ---- Reading -------------------------------------------------------------------------------- */

static void check_reading(uint32_t dimension, uint32_t precision) {
  pbf_params params = splash_params(dimension);
  load_scene s = splash(dimension, precision, &params);
  pbf_collider_load loads[WALLS], solids[3];
  double sum = 0;
  for (int step = 0; step < 10; ++step) {
    assert_ok(pbf_step(s.solver, 1));
    if (step == 3) load_colliders(&s, 3, solids);
    for (int k = 0; k < WALLS; ++k) loads[k].struct_size = sizeof loads[k];
    if (step < 5) load_walls(&s, loads);
  }
  load_walls(&s, loads);
  load_expect("five steps", loads[0].time_sum, 5 * params.time_step, 1e-9);
  sum = loads[2].impulse_sum[1];
  assert_ok(pbf_step(s.solver, 1));
  load_walls(&s, loads);
  assert_true(loads[2].impulse[1] == loads[2].impulse_sum[1]);
  assert_true(sum != loads[2].impulse_sum[1]);
  load_colliders(&s, 3, solids);
  load_expect("seven steps", solids[2].time_sum, 7 * params.time_step, 1e-9);
  assert_fails(pbf_get_collider_loads(s.solver, 2, solids), PBF_ERROR_INVALID_ARGUMENT,
               "count is 2; the solver has 3 colliders");
  assert_fails(pbf_get_wall_loads(s.solver, 5, loads), PBF_ERROR_INVALID_ARGUMENT,
               "count is 5; the solver has");
  assert_fails(pbf_get_collider_loads(s.solver, 3, NULL), PBF_ERROR_INVALID_ARGUMENT, "null");
  solids[1].struct_size = 8;
  assert_fails(pbf_get_collider_loads(s.solver, 3, solids), PBF_ERROR_STRUCT_SIZE,
               "loads[1].struct_size is 8");
  assert_ok(pbf_set_colliders(s.solver, 0, NULL));
  assert_ok(pbf_get_collider_loads(s.solver, 0, NULL));
  params.loads = 2;
  assert_fails(pbf_set_params(s.solver, &params), PBF_ERROR_INVALID_ARGUMENT, "loads is 2");
  params.loads = 0;
  assert_ok(pbf_set_params(s.solver, &params));
  assert_fails(pbf_get_wall_loads(s.solver, 2 * dimension, loads), PBF_ERROR_STATE,
               "params.loads is 0");
  load_end(&s);
}

static void loads_are_read(void **state) {
  (void)state;
  test_for_each_kind(check_reading);
}

/* The stub finds none. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_weighs_on_its_floor),
      cmocka_unit_test(water_weighs_more_on_a_lift),
      cmocka_unit_test(halves_of_a_floor_share_it),
      cmocka_unit_test(a_jet_pushes_a_plate),
      cmocka_unit_test(a_channel_drags_its_walls_along),
      cmocka_unit_test(solids_get_what_the_fluid_loses),
      cmocka_unit_test(threads_change_no_bit),
      cmocka_unit_test(loads_change_no_bit),
      cmocka_unit_test(loads_are_read),
  };
  return TEST_RUN(tests);
}
