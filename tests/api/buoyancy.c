/* What water at rest does to bodies in it, with a pressure grid and without, and under lids: the
 * weight of the water that they take the place of, and what presses on them. */
#include "load_scene.h"

#include <stdio.h>

enum { WALLS = 6 };

/* ---- Buoyancy ------------------------------------------------------------------------------- */

static const double body_size = 0.3, body_at[3] = {0.8, 0.65, 0.8};
static uint32_t body_shape, body_dimension;

static int outside_body(const double x[3]) {
  double r2 = 0, far = 0;
  for (uint32_t k = 0; k < body_dimension; ++k) {
    r2 += (x[k] - body_at[k]) * (x[k] - body_at[k]);
    far = fmax(far, fabs(x[k] - body_at[k]));
  }
  const double distance = body_shape == PBF_COLLIDER_BOX ? far : sqrt(r2);
  return distance > body_size + 0.49 * load_spacing;
}

/* The ball as distances on a grid. */
static pbf_shape *ball_of_grid(void) {
  enum { NODES = 80 };
  const double cell = 0.5 * load_spacing, first = -0.5 * cell * (NODES - 1);
  float *values = calloc(NODES * NODES, sizeof *values);
  pbf_shape *shape = NULL;
  for (int n = 0; n < NODES * NODES; ++n) {
    const double x = first + cell * (n % NODES), y = first + cell * (n / NODES);
    values[n] = (float)(hypot(x, y) - body_size);
  }
  const pbf_grid_desc grid = {.struct_size = sizeof grid,
                              .dimension = 2,
                              .nodes = {NODES, NODES, 1},
                              .origin = {first, first, 0},
                              .cell = cell,
                              .values = values};
  assert_ok(pbf_shape_from_grid(&grid, &shape));
  free(values);
  return shape;
}

/* A body that is held under water is lifted by the weight of its own volume: particles keep half a
 * spacing before it, which is where fluid that fills a lattice ends. */
static void check_body(uint32_t precision, uint32_t shape, double volume, double part) {
  const double domain[3] = {1.6, 2, 1}, size[3] = {1.6, 1.3, 1};
  const pbf_params params = load_params(2, domain);
  pbf_collider body = load_collider(shape, body_at[0], body_at[1], 0);
  for (int k = 0; k < 3; ++k) body.half_extents[k] = body_size;
  body.radius = body_size;
  if (shape == PBF_COLLIDER_SHAPE) body.geometry = ball_of_grid();
  body_shape = shape;
  body_dimension = 2;
  load_scene s = load_scene_of(2, precision, &params, size, outside_body, 1, &body);
  pbf_collider_load load;
  assert_ok(pbf_step(s.solver, 400));
  load_colliders(&s, 1, &load);
  assert_ok(pbf_step(s.solver, 200));
  load_colliders(&s, 1, &load);
  const double lift = load_gravity * volume;
  load_expect("buoyancy", load_force(&load, 1), lift, part);
  assert_true(fabs(load_force(&load, 0)) < 0.02 * lift);
  assert_true(fabs(load_torque(&load, 2)) < 0.02 * lift * body_size);
  load_end(&s);
  if (body.geometry) pbf_release_shape(body.geometry);
}

static void check_bodies(uint32_t dimension, uint32_t precision) {
  if (dimension != 2) return;
  check_body(precision, PBF_COLLIDER_BOX, 4 * body_size * body_size, 0.03);
  check_body(precision, PBF_COLLIDER_SPHERE, acos(-1) * body_size * body_size, 0.02);
  check_body(precision, PBF_COLLIDER_SHAPE, acos(-1) * body_size * body_size, 0.02);
}

static void bodies_are_buoyant(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_bodies);
}

/* ---- Under a pressure grid ------------------------------------------------------------------- */

static const double raft[2] = {0.3, 0.2}, raft_at[2] = {1.5, 0.75};
static double raft_angle;

static int outside_raft(const double x[3]) {
  const double c = cos(raft_angle), s = sin(raft_angle);
  const double u = x[0] - raft_at[0], w = x[1] - raft_at[1], margin = load_spacing / 4;
  return fabs(c * u + s * w) > raft[0] + margin || fabs(c * w - s * u) > raft[1] + margin;
}

/* What of it is below a level, by strips along x. */
static double raft_below(double level) {
  enum { STRIPS = 4000 };
  const double c = cos(raft_angle), s = sin(raft_angle), wide = 0.4;
  double area = 0;
  for (int i = 0; i < STRIPS; ++i) {
    const double u = wide * (2 * (i + 0.5) / STRIPS - 1);
    double lower = -1, upper = level - raft_at[1];
    const double from_sides[2] = {fabs(s) > 0 ? raft[0] / s - u * c / s : 1,
                                  fabs(s) > 0 ? -raft[0] / s - u * c / s : -1};
    if (!(fabs(s) > 0) && fabs(u) > raft[0]) continue;
    lower = fmax(lower, fmax(from_sides[1], (-raft[1] + s * u) / c));
    upper = fmin(upper, fmin(from_sides[0], (raft[1] + s * u) / c));
    area += fmax(upper - lower, 0) * 2 * wide / STRIPS;
  }
  return area;
}

/* A raft that is held in water which a grid carries. The first layer below it may hang up to a
 * spacing off, which counts as the raft's volume. */
static void check_raft(uint32_t precision, double angle, double time_step) {
  const double domain[3] = {3, 3, 1}, size[3] = {3, 0.8, 1};
  pbf_params params = load_params(2, domain);
  params.pressure_grid = 2;
  params.time_step = time_step;
  pbf_collider body = load_collider(PBF_COLLIDER_BOX, raft_at[0], raft_at[1], 0);
  for (int k = 0; k < 2; ++k) body.half_extents[k] = raft[k];
  body.orientation[2] = sin(angle / 2);
  body.orientation[3] = cos(angle / 2);
  raft_angle = angle;
  load_scene s = load_scene_of(2, precision, &params, size, outside_raft, 1, &body);
  pbf_collider_load load;
  double low = 0, high = 2;
  for (int i = 0; i < 50; ++i) {
    const double level = 0.5 * (low + high);
    if (level * domain[0] - raft_below(level) < s.count * s.mass)
      low = level;
    else
      high = level;
  }
  const double lift = load_gravity * raft_below(low),
               skin = load_gravity * 2 * raft[0] * load_spacing;
  assert_ok(pbf_step(s.solver, (uint32_t)(4 / time_step)));
  load_colliders(&s, 1, &load);
  assert_ok(pbf_step(s.solver, (uint32_t)(4 / time_step)));
  load_colliders(&s, 1, &load);
  print_message("a raft turned by %g: lift %.3f, aside %.3f\n", angle, load_force(&load, 1) / lift,
                load_force(&load, 0) / lift);
  if (!(load_force(&load, 1) > 0.9 * lift && load_force(&load, 1) < lift + skin))
    fail_msg("the lift is %g, it must be %g to %g", load_force(&load, 1), 0.9 * lift, lift + skin);
  if (!(fabs(load_force(&load, 0)) < 0.03 * lift))
    fail_msg("it is pushed aside by %g of %g", load_force(&load, 0), lift);
  load_end(&s);
}

static const double ball_radius = 5 * 0.05, cube_half = 4 * 0.05, ball_at[3] = {0.365, 0.56, 0.355};

static int outside_ball(const double x[3]) {
  double r2 = 0;
  for (int k = 0; k < 3; ++k) r2 += (x[k] - ball_at[k]) * (x[k] - ball_at[k]);
  return sqrt(r2) > ball_radius + 0.49 * load_spacing;
}

static int outside_cube(const double x[3]) {
  double far = 0;
  for (int k = 0; k < 3; ++k) far = fmax(far, fabs(x[k] - ball_at[k]));
  return far > cube_half + 0.3 * load_spacing;
}

/* A ball or a cube in a tank not much wider, some two or three spacings from its walls. What is
 * missing of the fluid's momentum, some hundredths of its weight, is no lift of theirs, which
 * pressures ten times their weight press on; and on both sides of them these are the same. */
static void check_ball(uint32_t precision, uint32_t shape) {
  const double domain[3] = {0.7, 2.2, 0.7}, size[3] = {0.7, 1.15, 0.7};
  pbf_params params = load_params(3, domain);
  params.pressure_grid = 2;
  params.time_step = 1.0 / 40;
  pbf_collider body = load_collider(shape, ball_at[0], ball_at[1], ball_at[2]);
  body.radius = ball_radius;
  for (int k = 0; k < 3; ++k) body.half_extents[k] = cube_half;
  const int is_ball = shape == PBF_COLLIDER_SPHERE;
  load_scene s =
      load_scene_of(3, precision, &params, size, is_ball ? outside_ball : outside_cube, 1, &body);
  pbf_collider_load load, walls[WALLS];
  assert_ok(pbf_step(s.solver, 100));
  load_colliders(&s, 1, &load);
  load_walls(&s, walls);
  assert_ok(pbf_step(s.solver, 60));
  load_colliders(&s, 1, &load);
  load_walls(&s, walls);
  const double lift =
      load_gravity * (is_ball ? 4.0 / 3 * acos(-1) * pow(ball_radius, 3) : 8 * pow(cube_half, 3));
  const double weight = s.count * s.mass * load_gravity;
  print_message("a %s: lift %.3f, aside %.3f, %.3f\n", is_ball ? "ball" : "cube",
                load_force(&load, 1) / lift, load_force(&load, 0) / lift,
                load_force(&load, 2) / lift);
  load_expect("the lift", load_force(&load, 1), lift, 0.05);
  assert_true(fabs(load_force(&load, 0)) < 0.03 * lift && fabs(load_force(&load, 2)) < 0.03 * lift);
  load_expect("what the floor carries", -load_force(&walls[PBF_WALL_Y_MIN], 1), weight + lift,
              0.01);
  load_end(&s);
}

static const double crate = 12 * 0.05, crate_bottom = 21 * 0.05;

static int outside_crate(const double x[3]) {
  return fabs(x[0] - 1) > crate / 2 || x[1] < crate_bottom;
}

/* A box that is held three spacings deep, with a quarter of its height. That the fluid ends some
 * tenths of a spacing below where the grid's pressure does lifts it by nothing. As a hull, of which
 * distances are known to some cells from it alone, it has the same lift: `cell` is that of a hull,
 * and 0 of a box. */
static void check_crate(uint32_t precision, double cell) {
  const double domain[3] = {2, 2.64, 1}, size[3] = {2, 1.2, 1};
  pbf_params params = load_params(2, domain);
  params.pressure_grid = 2;
  params.time_step = 1.0 / 85;
  pbf_collider body = load_collider(PBF_COLLIDER_BOX, 1, crate_bottom + crate / 2, 0);
  for (int k = 0; k < 2; ++k) body.half_extents[k] = crate / 2;
  if (cell > 0) load_make_hull(2, cell, &body);
  load_scene s = load_scene_of(2, precision, &params, size, outside_crate, 1, &body);
  pbf_collider_load load;
  const double below = crate * (1.2 - crate_bottom);
  assert_ok(pbf_step(s.solver, 140));
  load_colliders(&s, 1, &load);
  assert_ok(pbf_step(s.solver, 100));
  load_colliders(&s, 1, &load);
  print_message("a crate%s: lift %.4f\n", cell > 0 ? " of a hull" : "",
                load_force(&load, 1) / (load_gravity * below));
  load_expect("a crate's lift", load_force(&load, 1), load_gravity * below, 0.04);
  load_end(&s);
  if (body.geometry) pbf_release_shape(body.geometry);
}

static const double dam_foot = 30 * 0.05, dam_water = 12 * 0.05;

static int before_dam(const double x[3]) { return x[0] - x[1] < dam_foot - 0.7 * load_spacing; }

/* A dam that leans away from the water by 45 degrees, in steps after which the grid's pressure ends
 * somewhat above or below the water: that presses on the dam along its normal, and on the wall
 * across from it by as much. */
static void check_dam(uint32_t precision) {
  const double domain[3] = {60 * 0.05, 22 * 0.05, 1},
               size[3] = {dam_foot + dam_water, dam_water, 1};
  const double half = 16 * 0.05, thick = 3 * 0.05, part = sqrt(0.5);
  pbf_params params = load_params(2, domain);
  params.pressure_grid = 2;
  params.time_step = 1.0 / 38;
  pbf_collider body = load_collider(PBF_COLLIDER_BOX, 0, 0, 0);
  body.position[0] = dam_foot + part * (half - 10 * load_spacing + thick);
  body.position[1] = part * (half - 10 * load_spacing - thick);
  body.orientation[2] = sin(acos(-1) / 8), body.orientation[3] = cos(acos(-1) / 8);
  body.half_extents[0] = half, body.half_extents[1] = thick;
  load_scene s = load_scene_of(2, precision, &params, size, before_dam, 1, &body);
  pbf_collider_load dam, walls[6];
  assert_ok(pbf_step(s.solver, 150));
  load_colliders(&s, 1, &dam), load_walls(&s, walls);
  assert_ok(pbf_step(s.solver, 150));
  load_colliders(&s, 1, &dam), load_walls(&s, walls);
  const double area = s.count * s.mass, h = sqrt(dam_foot * dam_foot + 2 * area) - dam_foot;
  const double side = load_gravity * h * h / 2, across = side / part;
  print_message("a dam: %.3f, along it %.3f, the wall %.3f\n",
                part * (load_force(&dam, 0) - load_force(&dam, 1)) / across,
                part * (load_force(&dam, 0) + load_force(&dam, 1)) / across,
                -load_force(&walls[0], 0) / side);
  load_expect("across a dam", part * (load_force(&dam, 0) - load_force(&dam, 1)), across, 0.04);
  load_expect("on a wall", -load_force(&walls[0], 0), side, 0.09);
  assert_true(fabs(part * (load_force(&dam, 0) + load_force(&dam, 1))) < 0.06 * across);
  load_end(&s);
}

/* A plate a spacing thick lies on another one: that has no water at it. */
static void check_covered(uint32_t precision) {
  const double domain[3] = {0.4, 3, 1}, size[3] = {0.4, 1.5, 1};
  pbf_params params = load_params(2, domain);
  pbf_collider plates[2] = {load_collider(PBF_COLLIDER_BOX, 0.2, -load_spacing / 2, 0),
                            load_collider(PBF_COLLIDER_BOX, 0.2, -0.1 - load_spacing, 0)};
  params.pressure_grid = 2;
  params.domain_min[1] = -0.2 - load_spacing;
  for (int k = 0; k < 2; ++k) {
    plates[k].half_extents[0] = 0.3;
    plates[k].half_extents[1] = k == 0 ? load_spacing / 2 : 0.1;
  }
  load_scene s = load_scene_of(2, precision, &params, size, load_everywhere, 2, plates);
  const double weight = s.count * s.mass * load_gravity;
  pbf_collider_load loads[2];
  assert_ok(pbf_step(s.solver, 200));
  load_colliders(&s, 2, loads);
  assert_ok(pbf_step(s.solver, 100));
  load_colliders(&s, 2, loads);
  load_expect("the weight on the upper plate", -load_force(&loads[0], 1), weight, 0.01);
  assert_true(fabs(load_force(&loads[1], 1)) < 0.01 * weight);
  load_end(&s);
}

static const double vessel_half[3] = {10 * 0.05, 15 * 0.05, 1}, vessel_angle = 0.3;

static int in_vessel(const double x[3]) {
  const double c = cos(vessel_angle), s = sin(vessel_angle), a = x[0] - 1, b = x[1] - 1;
  const double u = c * a + s * b, w = c * b - s * a;
  return fabs(u) < vessel_half[0] - load_spacing / 2 && w > load_spacing / 2 - vessel_half[1] &&
         w < 0.7 * vessel_half[1];
}

/* A vessel of a hull that leans by 17 degrees. Cells of the grid beyond its walls, farther than its
 * distances go, have no room: fluid that they were thought to have room for was compressed by eight
 * times as much as in a box. */
static void check_leaning_vessel(uint32_t precision) {
  const double size[3] = {2, 2, 1};
  pbf_params params = load_params(2, size);
  params.pressure_grid = 2;
  params.time_step = 1.0 / 60;
  pbf_collider vessel = load_collider(PBF_COLLIDER_BOX, 1, 1, 0);
  for (int k = 0; k < 3; ++k) vessel.half_extents[k] = vessel_half[k];
  vessel.orientation[2] = sin(vessel_angle / 2), vessel.orientation[3] = cos(vessel_angle / 2);
  vessel.inverted = 1;
  load_make_hull(2, 0.4 * load_spacing, &vessel);
  load_scene s = load_scene_of(2, precision, &params, size, in_vessel, 1, &vessel);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_step(s.solver, 180));
  assert_ok(pbf_get_stats(s.solver, &stats));
  print_message("in a leaning vessel: compressed by %.4f\n", stats.density_error_mean);
  assert_true(stats.density_error_mean < 0.003);
  load_end(&s);
  pbf_release_shape(vessel.geometry);
}

static void check_rafts(uint32_t dimension, uint32_t precision) {
  if (dimension == 3) {
    check_ball(precision, PBF_COLLIDER_SPHERE);
    check_ball(precision, PBF_COLLIDER_BOX);
    return;
  }
  check_leaning_vessel(precision);
  check_covered(precision);
  check_crate(precision, 0);
  check_crate(precision, load_spacing / 4);
  check_crate(precision, load_spacing / 2);
  check_dam(precision);
  check_raft(precision, 0.35, 1.0 / 60);
  check_raft(precision, 0, 1.0 / 30);
}

static void bodies_are_buoyant_under_a_grid(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_rafts);
}

/* ---- Under lids ----------------------------------------------------------------------------- */

enum { HIGH_LAYERS = 20, LOW_LAYERS = 13, ROOM_WIDTH = 8 };

/* Two rooms, with a wall between them that is thinner than a cell of the pressure grid. */
static int load_in_rooms(const double x[3]) {
  if (x[0] < ROOM_WIDTH * load_spacing) return 1;
  return x[0] > (ROOM_WIDTH + 1) * load_spacing && x[1] < LOW_LAYERS * load_spacing;
}

/* Of the lowest particles of a room from x on that is so many layers deep. */
static void check_pressure(load_scene *s, double x, uint32_t layers) {
  char *pressures = calloc(s->count, s->precision);
  double sum = 0, depths = 0;
  assert_ok(pbf_get_positions(s->solver, 0, s->count, s->values));
  assert_ok(pbf_get_pressures(s->solver, 0, s->count, pressures));
  for (uint32_t i = 0; i < s->count; ++i) {
    const double from = test_value(s->values, (uint64_t)i * s->dimension, s->precision) - x;
    const double y = test_value(s->values, (uint64_t)i * s->dimension + 1, s->precision);
    if (from < 0 || from > ROOM_WIDTH * load_spacing || y > load_spacing) continue;
    sum += test_value(pressures, i, s->precision);
    depths += layers * load_spacing - y;
  }
  load_expect("the pressure at the bottom", sum, load_gravity * depths, 0.05);
  free(pressures);
}

/* Both are full: one up to the domain's wall, the other up to a box, where cells do not end. Lids
 * that fluid only just comes up to bear nothing, and all of it is on the floor. */
static void check_lids(uint32_t dimension, uint32_t precision) {
  const double wide = ROOM_WIDTH * load_spacing, deep = 4 * load_spacing;
  const double size[3] = {2 * wide + load_spacing, HIGH_LAYERS * load_spacing, deep};
  const double low = LOW_LAYERS * load_spacing, room = 0.5 * (size[1] - low);
  pbf_params params = load_params(dimension, size);
  pbf_collider solids[2] = {
      load_collider(PBF_COLLIDER_BOX, wide + 0.5 * load_spacing, 0.5 * size[1], 0.5 * deep),
      load_collider(PBF_COLLIDER_BOX, 1.5 * wide + load_spacing, low + room, 0.5 * deep)};
  pbf_collider_load walls[6], lids[2];
  params.pressure_grid = 2;
  params.time_step = 1.0 / 60;
  for (int k = 0; k < 3; ++k) solids[0].half_extents[k] = k ? 2 * size[k] : 0.5 * load_spacing;
  for (int k = 0; k < 3; ++k) solids[1].half_extents[k] = k == 1 ? room : size[k];
  solids[1].half_extents[0] = 0.5 * wide;
  load_scene s = load_scene_of(dimension, precision, &params, size, load_in_rooms, 2, solids);
  const double weight = s.count * s.mass * load_gravity;
  assert_ok(pbf_step(s.solver, 120));
  load_walls(&s, walls);
  load_colliders(&s, 2, lids);
  assert_ok(pbf_step(s.solver, 60));
  load_walls(&s, walls);
  load_colliders(&s, 2, lids);
  const double top = load_force(&walls[PBF_WALL_Y_MAX], 1), lid = load_force(&lids[1], 1);
  print_message("under lids: the wall bears %.3f, the box %.3f of the weight\n", top / weight,
                lid / weight);
  load_expect("the wall above", weight + top, weight, 0.02);
  load_expect("the box above", weight + lid, weight, 0.02);
  load_expect("all that bears", -load_force(&walls[PBF_WALL_Y_MIN], 1) - load_force(&lids[0], 1),
              weight, 0.02);
  check_pressure(&s, 0, HIGH_LAYERS);
  check_pressure(&s, (ROOM_WIDTH + 1) * load_spacing, LOW_LAYERS);
  load_end(&s);
}

static void lids_bear_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_each_kind(check_lids);
}

/* The stub finds none. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bodies_are_buoyant),
      cmocka_unit_test(bodies_are_buoyant_under_a_grid),
      cmocka_unit_test(lids_bear_nothing),
  };
  return TEST_RUN(tests);
}
