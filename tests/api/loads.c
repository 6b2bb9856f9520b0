/* What the fluid does to walls and colliders, against what it must be: the weight of water, the
 * momentum that the fluid loses, buoyancy, the push of a jet. */
#include "load_scene.h"

#include <stdio.h>

enum { WALLS = 6 };

static double force(const pbf_collider_load *load, int k) {
  return load->impulse_sum[k] / load->time_sum;
}

static double turn(const pbf_collider_load *load, int k) {
  return load->angular_impulse_sum[k] / load->time_sum;
}

static void check_near(const char *what, double is, double right, double part) {
  if (!(fabs(is - right) <= part * fabs(right)))
    fail_msg("%s is %.9g, it must be %.9g to %g", what, is, right, part);
}

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
  check_near("the weight on the floor", -force(&walls[PBF_WALL_Y_MIN], 1), weight, 0.01);
  check_near("its torque", -turn(&walls[PBF_WALL_Y_MIN], 2), weight * width / 2, 0.02);
  const double side = 0.5 * load_gravity * high * high * (dimension == 3 ? width : 1);
  check_near("the push on a side", force(&walls[PBF_WALL_X_MAX], 0), side, 0.08);
  check_near("the push on the other", -force(&walls[PBF_WALL_X_MIN], 0), side, 0.08);
  assert_true(fabs(force(&walls[PBF_WALL_Y_MAX], 1)) < 1e-6 * weight);
  const double floor_area = dimension == 3 ? width * width : width;
  check_near("the wet floor", walls[PBF_WALL_Y_MIN].wetted_area, floor_area, 0.05);
  assert_int_equal(walls[PBF_WALL_Y_MAX].contacts, 0);
  assert_true(walls[PBF_WALL_Y_MIN].contacts > 0);
  check_near("the time", walls[0].time_sum, LOOKS * params.time_step, 1e-9);
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
  check_near("the weight on the left half", -force(&loads[0], 1), weight / 2, 0.02);
  check_near("the weight on the right half", -force(&loads[1], 1), weight / 2, 0.02);
  check_near("the sum", -force(&loads[0], 1) - force(&loads[1], 1), weight, 0.01);
  assert_true(fabs(turn(&loads[0], 2)) < 0.05 * weight / 2 * width / 4);
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
  check_near("buoyancy", force(&load, 1), lift, part);
  assert_true(fabs(force(&load, 0)) < 0.02 * lift);
  assert_true(fabs(turn(&load, 2)) < 0.02 * lift * body_size);
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
  print_message("a raft turned by %g: lift %.3f, aside %.3f\n", angle, force(&load, 1) / lift,
                force(&load, 0) / lift);
  if (!(force(&load, 1) > 0.9 * lift && force(&load, 1) < lift + skin))
    fail_msg("the lift is %g, it must be %g to %g", force(&load, 1), 0.9 * lift, lift + skin);
  if (!(fabs(force(&load, 0)) < 0.03 * lift))
    fail_msg("it is pushed aside by %g of %g", force(&load, 0), lift);
  load_end(&s);
}

static const double ball_radius = 5 * 0.05, ball_at[3] = {0.365, 0.56, 0.355};

static int outside_ball(const double x[3]) {
  double r2 = 0;
  for (int k = 0; k < 3; ++k) r2 += (x[k] - ball_at[k]) * (x[k] - ball_at[k]);
  return sqrt(r2) > ball_radius + 0.49 * load_spacing;
}

/* A ball in the middle of a tank not much wider. What is missing of the fluid's momentum, some
 * hundredths of its weight, is no lift of the ball's, which pressures ten times its weight press
 * on. */
static void check_ball(uint32_t precision) {
  const double domain[3] = {0.7, 2.2, 0.7}, size[3] = {0.7, 1.15, 0.7};
  pbf_params params = load_params(3, domain);
  params.pressure_grid = 2;
  params.time_step = 1.0 / 40;
  pbf_collider body = load_collider(PBF_COLLIDER_SPHERE, ball_at[0], ball_at[1], ball_at[2]);
  body.radius = ball_radius;
  load_scene s = load_scene_of(3, precision, &params, size, outside_ball, 1, &body);
  pbf_collider_load load, walls[WALLS];
  assert_ok(pbf_step(s.solver, 100));
  load_colliders(&s, 1, &load);
  load_walls(&s, walls);
  assert_ok(pbf_step(s.solver, 60));
  load_colliders(&s, 1, &load);
  load_walls(&s, walls);
  const double lift = load_gravity * 4.0 / 3 * acos(-1) * pow(ball_radius, 3);
  const double weight = s.count * s.mass * load_gravity;
  check_near("a ball's lift", force(&load, 1), lift, 0.05);
  assert_true(fabs(force(&load, 0)) < 0.03 * lift && fabs(force(&load, 2)) < 0.03 * lift);
  check_near("what the floor carries", -force(&walls[PBF_WALL_Y_MIN], 1), weight + lift, 0.01);
  load_end(&s);
}

static const double crate = 12 * 0.05, crate_bottom = 21 * 0.05;

static int outside_crate(const double x[3]) {
  return fabs(x[0] - 1) > crate / 2 || x[1] < crate_bottom;
}

/* A box that is held three spacings deep, with a quarter of its height. That the fluid ends some
 * tenths of a spacing below where the grid's pressure does lifts it by nothing. */
static void check_crate(uint32_t precision) {
  const double domain[3] = {2, 2.64, 1}, size[3] = {2, 1.2, 1};
  pbf_params params = load_params(2, domain);
  params.pressure_grid = 2;
  params.time_step = 1.0 / 85;
  pbf_collider body = load_collider(PBF_COLLIDER_BOX, 1, crate_bottom + crate / 2, 0);
  for (int k = 0; k < 2; ++k) body.half_extents[k] = crate / 2;
  load_scene s = load_scene_of(2, precision, &params, size, outside_crate, 1, &body);
  pbf_collider_load load;
  const double below = crate * (1.2 - crate_bottom);
  assert_ok(pbf_step(s.solver, 140));
  load_colliders(&s, 1, &load);
  assert_ok(pbf_step(s.solver, 100));
  load_colliders(&s, 1, &load);
  print_message("a crate: lift %.4f\n", force(&load, 1) / (load_gravity * below));
  check_near("a crate's lift", force(&load, 1), load_gravity * below, 0.04);
  load_end(&s);
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
                part * (force(&dam, 0) - force(&dam, 1)) / across,
                part * (force(&dam, 0) + force(&dam, 1)) / across, -force(&walls[0], 0) / side);
  check_near("across a dam", part * (force(&dam, 0) - force(&dam, 1)), across, 0.04);
  check_near("on a wall", -force(&walls[0], 0), side, 0.09);
  assert_true(fabs(part * (force(&dam, 0) + force(&dam, 1))) < 0.06 * across);
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
  check_near("the weight on the upper plate", -force(&loads[0], 1), weight, 0.01);
  assert_true(fabs(force(&loads[1], 1)) < 0.01 * weight);
  load_end(&s);
}

static void check_rafts(uint32_t dimension, uint32_t precision) {
  if (dimension == 3) {
    check_ball(precision);
    return;
  }
  check_covered(precision);
  check_crate(precision);
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
  check_near("the pressure at the bottom", sum, load_gravity * depths, 0.05);
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
  const double top = force(&walls[PBF_WALL_Y_MAX], 1), lid = force(&lids[1], 1);
  print_message("under lids: the wall bears %.3f, the box %.3f of the weight\n", top / weight,
                lid / weight);
  check_near("the wall above", weight + top, weight, 0.02);
  check_near("the box above", weight + lid, weight, 0.02);
  check_near("all that bears", -force(&walls[PBF_WALL_Y_MIN], 1) - force(&lids[0], 1), weight,
             0.02);
  check_pressure(&s, 0, HIGH_LAYERS);
  check_pressure(&s, (ROOM_WIDTH + 1) * load_spacing, LOW_LAYERS);
  load_end(&s);
}

static void lids_bear_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_each_kind(check_lids);
}

/* What comes at a plate and flows off along it leaves all of its momentum across: rho Q v each time
 * unit, all of it in the end. */
/* ---- A jet ---------------------------------------------------------------------------------- */

static int in_jet(const double x[3]) { return x[1] > 0.8 && x[1] < 1.2; }

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
  check_near("the force of the jet", force(&load, 0), 0.4 * speed * speed, 0.1);
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
    const double floor = force(&walls[PBF_WALL_Y_MIN], 0), ceiling = force(&load, 0);
    if (slides) { /* the slug shears, and its momentum swings */
      check_near("the drag on the floor", floor, all, 0.05);
      assert_true(fabs(ceiling) < 0.01 * all);
    } else {
      check_near("the drag on the floor", floor, all / 2, 0.02);
      check_near("the drag on the plate", ceiling, all / 2, 0.02);
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
  check_near("five steps", loads[0].time_sum, 5 * params.time_step, 1e-9);
  sum = loads[2].impulse_sum[1];
  assert_ok(pbf_step(s.solver, 1));
  load_walls(&s, loads);
  assert_true(loads[2].impulse[1] == loads[2].impulse_sum[1]);
  assert_true(sum != loads[2].impulse_sum[1]);
  load_colliders(&s, 3, solids);
  check_near("seven steps", solids[2].time_sum, 7 * params.time_step, 1e-9);
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
      cmocka_unit_test(halves_of_a_floor_share_it),
      cmocka_unit_test(bodies_are_buoyant),
      cmocka_unit_test(bodies_are_buoyant_under_a_grid),
      cmocka_unit_test(lids_bear_nothing),
      cmocka_unit_test(a_jet_pushes_a_plate),
      cmocka_unit_test(a_channel_drags_its_walls_along),
      cmocka_unit_test(solids_get_what_the_fluid_loses),
      cmocka_unit_test(threads_change_no_bit),
      cmocka_unit_test(loads_change_no_bit),
      cmocka_unit_test(loads_are_read),
  };
  return TEST_RUN(tests);
}
