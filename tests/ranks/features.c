/* Ranks give the bits of one solver where sums go over all of the fluid, where particles differ,
 * and where neighbours are across the domain: pressure grids, loads and friction, phases, periodic
 * axes. */
#include <math.h>
#include <stdlib.h>

#include <pbf/phases.h>
#include <pbf/shapes.h>

#include "scenes.h"

/* Whether the plan has, or has not, this stage. */
static void expect_stage(const scene *c, const char *name, int wanted) {
  pbf_desc desc = test_desc(c->dimension, c->precision, c->count + 400);
  pbf_solver *s = test_create(&desc, &c->params);
  pbf_plan plan = {.struct_size = sizeof plan};
  int has = 0;
  if (c->set_up) c->set_up(c, s);
  scene_fill(c, s, c->count, 0);
  assert_ok(pbf_get_plan(s, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k) has |= !strcmp(plan.stages[k].name, name);
  if (has != wanted) fail_msg("\"%s\" is %s the plan", name, has ? "in" : "not in");
  pbf_destroy(s);
}

/* ---- Pressure grids ------------------------------------------------------------------------ */

/* A plate that divides cells of the grid, and a ball on its way. */
static void set_plate(const scene *c, pbf_solver *s) {
  pbf_collider list[SCENE_COLLIDERS];
  (void)c;
  scene_colliders(list);
  list[1].half_extents[0] = 0.012;
  list[1].half_extents[1] = 0.4;
  list[1].half_extents[2] = 0.4;
  list[1].angular_velocity[2] = 0.4;
  EXPECT_OK(pbf_set_colliders(s, SCENE_COLLIDERS, list));
}

static void add_more(const scene *c, pbf_solver *s) {
  scene_fill(c, s, 300, 0.03);
  scene_accelerate(c, s);
}

static void check_grid(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.pressure_grid = 2;
  c.params.drag = 0.5; /* which the grid carries */
  c.params.drag_velocity[0] = 2;
  c.change = scene_accelerate;
  expect_stage(&c, "pressure grid", 1);
  scene_check("a pressure grid", &c);
  c.set_up = set_plate;
  c.change = add_more;
  scene_check("a pressure grid that a plate divides", &c);
}

/* Deep enough for a grid that the solver gives itself, with what else it then has. */
static void check_deep(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.pressure_grid = -1;
  c.params.domain_max[0] = dimension == 3 ? 0.72 : 3;
  c.params.domain_max[dimension - 1] = 6;
  if (dimension == 3) {
    c.count = 4000;
    c.params.domain_max[1] = 0.72;
    c.params.gravity[2] = c.params.gravity[1];
    c.params.gravity[1] = 0;
  }
  expect_stage(&c, "pressure grid", 1);
  expect_stage(&c, "shear stress", 1);
  scene_check("deep water", &c);
}

static void a_pressure_grid_is_the_same(void **state) {
  (void)state;
  test_for_long_kinds(check_grid);
}

static void so_is_deep_water(void **state) {
  (void)state;
  test_for_long_kinds(check_deep);
}

/* ---- Loads and friction -------------------------------------------------------------------- */

static void set_rough(const scene *c, pbf_solver *s) {
  pbf_collider list[SCENE_COLLIDERS];
  (void)c;
  scene_colliders(list);
  for (int k = 0; k < SCENE_COLLIDERS; ++k) list[k].friction = 0.4, list[k].static_friction = 0.6;
  EXPECT_OK(pbf_set_colliders(s, SCENE_COLLIDERS, list));
}

static void check_loads(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.colliders = SCENE_COLLIDERS;
  c.params.loads = 1;
  scene_check("loads", &c);
  c.params.pressure_grid = 2;
  c.params.viscosity = 0.002;
  c.params.wall_no_slip = 1;
  scene_check("loads of a pressure grid, and of fluid that sticks", &c);
  c.params.pressure_grid = 0;
  c.params.surface_tension = 0.002;
  c.params.wall_adhesion = 0.4;
  scene_check("loads of adhesion", &c);
}

static void check_friction(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.set_up = set_rough;
  c.params.wall_friction = 0.3;
  scene_check("friction", &c);
  c.params.loads = 1;
  c.params.pressure_grid = 2;
  scene_check("friction and its loads", &c);
}

static void loads_are_the_same(void **state) {
  (void)state;
  test_for_long_kinds(check_loads);
}

static void so_is_friction(void **state) {
  (void)state;
  test_for_long_kinds(check_friction);
}

/* ---- Shapes -------------------------------------------------------------------------------- */

/* A ball. Each rank makes one of its own, as processes do. */
static pbf_shape *make_ball(uint32_t dimension, double radius) {
  enum { NODES = 17 };
  static const double cell = 0.04;
  float *values = calloc((size_t)NODES * NODES * NODES, sizeof *values);
  pbf_grid_desc grid = {.struct_size = sizeof grid, .dimension = dimension, .cell = cell};
  pbf_shape *shape = NULL;
  if (!EXPECT(values)) return NULL;
  const int deep = dimension == 3 ? NODES : 1;
  for (int k = 0; k < NODES * NODES * deep; ++k) {
    const int at[3] = {k % NODES, k / NODES % NODES, k / NODES / NODES};
    double squares = 0;
    for (uint32_t i = 0; i < dimension; ++i)
      squares += pow(cell * (at[i] - NODES / 2), 2); /* NODES / 2 is the middle one */
    values[k] = (float)(sqrt(squares) - radius);
  }
  for (uint32_t i = 0; i < dimension; ++i) {
    grid.nodes[i] = NODES;
    grid.origin[i] = -cell * (NODES / 2);
  }
  grid.values = values;
  EXPECT_OK(pbf_shape_from_grid(&grid, &shape));
  free(values);
  return shape;
}

static void set_ball(pbf_solver *s, uint32_t dimension, double radius) {
  pbf_collider ball;
  EXPECT_OK(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SHAPE));
  ball.geometry = make_ball(dimension, radius);
  for (int k = 0; k < 3; ++k) ball.position[k] = 0.3;
  ball.velocity[0] = 0.5;
  EXPECT_OK(pbf_set_colliders(s, 1, &ball));
  pbf_release_shape(ball.geometry);
}

static void set_shape(const scene *c, pbf_solver *s) { set_ball(s, c->dimension, 0.2); }

static void check_shapes(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.set_up = set_shape;
  c.params.loads = 1;
  scene_check("a shape", &c);
}

/* Ranks of which one has a ball that is a little larger are told. */
static void have_other_shapes(const pbf_ranks *ranks, void *context) {
  const scene *c = context;
  pbf_desc desc = test_desc(c->dimension, c->precision, c->count);
  pbf_solver *s = NULL;
  desc.allocator = NULL;
  EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s));
  set_ball(s, c->dimension, ranks->rank == 1 ? 0.201 : 0.2);
  const float x[3] = {0.5f, 0.5f, 0.5f};
  EXPECT_FAILS(pbf_add_particles(s, 1, x, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "ranks 0 and 1 differ in the colliders");
  set_ball(s, c->dimension, 0.2);
  EXPECT_OK(pbf_add_particles(s, 1, x, NULL, NULL));
  EXPECT_OK(pbf_step(s, 1));
  pbf_destroy(s);
}

static void so_are_shapes(void **state) {
  (void)state;
  test_for_long_kinds(check_shapes);
  scene c = scene_plain(3, PBF_FLOAT32);
  thread_ranks_run(2, 0, NULL, NULL, have_other_shapes, &c);
  assert_int_equal(ranks_failures(), 0);
}

/* ---- Phases -------------------------------------------------------------------------------- */

static void set_fluids(const scene *c, pbf_solver *s) {
  pbf_phase phases[3];
  for (uint32_t k = 0; k < c->phases; ++k) EXPECT_OK(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = 0.6;
  phases[1].viscosity = 0.5;
  phases[2].rest_density = 3;
  EXPECT_OK(pbf_set_phases(s, c->phases, phases));
}

static void check_fluids(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.phases = 3;
  c.set_up = set_fluids;
  c.change = add_more;
  scene_check("phases", &c);
  c.colliders = SCENE_COLLIDERS;
  c.params.loads = 1;
  c.params.wall_friction = 0.3;
  c.params.viscosity = 0.002;
  c.params.damping_compensation = 1;
  c.params.angular_momentum_correction = 1;
  scene_check("phases, and stages that know of mass", &c);
}

static void so_are_phases(void **state) {
  (void)state;
  test_for_long_kinds(check_fluids);
}

/* Deep water, and a list with a light fluid that is still to come: a grid carries what there is. */
static void list_fluids(const scene *c, pbf_solver *s) {
  pbf_phase phases[2];
  (void)c;
  for (int k = 0; k < 2; ++k) EXPECT_OK(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = 0.5;
  EXPECT_OK(pbf_set_phases(s, 2, phases));
}

static void add_light(const scene *c, pbf_solver *s) {
  const uint32_t light[5] = {1, 1, 1, 1, 1};
  EXPECT_OK(pbf_set_particle_phases(s, c->count / 2, 5, light));
}

static void check_listed(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.set_up = list_fluids;
  c.params.pressure_grid = 2;
  scene_check("a fluid that is listed alone", &c);
  c.change = add_light;
  scene_check("a fluid that comes", &c);
}

static void so_are_fluids_that_are_not_there(void **state) {
  (void)state;
  test_for_long_kinds(check_listed);
}

/* ---- Sleep --------------------------------------------------------------------------------- */

/* Something falls into what has fallen asleep. */
static void wake_some(const scene *c, pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(stats.asleep > c->count / 10);
  EXPECT(stats.asleep < c->count);
  if (c->colliders) return;
  pbf_collider list[SCENE_COLLIDERS];
  scene_colliders(list);
  EXPECT_OK(pbf_set_colliders(s, SCENE_COLLIDERS, list));
  scene_fill(c, s, 30, 0.4);
}

static void check_sleep(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.sleep_speed = dimension == 3 ? 1 : 1.5;
  c.params.sleep_time = 0.02;
  c.change = wake_some;
  scene_check("sleep", &c);
  c.colliders = SCENE_COLLIDERS;
  c.params.loads = 1;
  c.params.pressure_grid = 2;
  scene_check("sleep around colliders", &c);
}

/* All sleep, until a collider comes. */
static void check_deep_sleep(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.sleep_speed = 100;
  c.params.sleep_time = 0.01;
  c.params.loads = 1;
  scene_check("all asleep", &c);
  assert_int_equal(c.stats.asleep, c.count);
  c.colliders = 1;
  scene_check("all asleep but near a ball", &c);
}

/* A box that stands in the middle of what sleeps, and is then removed. */
static void set_box(const scene *c, pbf_solver *s) {
  pbf_collider box;
  (void)c;
  EXPECT_OK(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  for (int k = 0; k < 3; ++k) box.position[k] = 0.3, box.half_extents[k] = 0.02;
  EXPECT_OK(pbf_set_colliders(s, 1, &box));
}

static void remove_box(const scene *c, pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(stats.asleep == c->count);
  EXPECT_OK(pbf_set_colliders(s, 0, NULL));
  if (c->asks) return; /* nor need what is asked come between */
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(stats.asleep == 0);
}

/* A collider that leaves the sleepers of one rank wakes those of all. */
static void check_left_sleepers(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.sleep_speed = 100;
  c.params.sleep_time = 0.01;
  c.set_up = set_box;
  c.change = remove_box;
  scene_check("a box leaves sleepers", &c);
  c.asks = 1;
  scene_check("a box leaves sleepers, and steps follow", &c);
}

static void so_is_sleep(void **state) {
  (void)state;
  test_for_long_kinds(check_sleep);
  test_for_long_kinds(check_deep_sleep);
  test_for_long_kinds(check_left_sleepers);
}

/* ---- Periodic axes ------------------------------------------------------------------------- */

/* Along which the block has no walls: in turns all, and those across which ranks are or are not
 * cut. */
static void check_periodic(uint32_t dimension, uint32_t precision) {
  static const uint32_t sets[] = {PBF_PERIODIC_X, PBF_PERIODIC_Y, PBF_PERIODIC_X | PBF_PERIODIC_Y,
                                  PBF_PERIODIC_X | PBF_PERIODIC_Y | PBF_PERIODIC_Z};
  for (uint32_t k = 0; k < (dimension == 3 ? 4 : 3); ++k) {
    scene c = scene_plain(dimension, precision);
    c.params.periodic = sets[k];
    c.params.gravity[0] = -30; /* across the face */
    c.asks = 1;
    scene_check("periodic axes", &c);
  }
}

static void so_are_periodic_axes(void **state) {
  (void)state;
  test_for_long_kinds(check_periodic);
}

/* ---- All at once --------------------------------------------------------------------------- */

static void set_all(const scene *c, pbf_solver *s) {
  list_fluids(c, s);
  set_plate(c, s);
}

static void change_all(const scene *c, pbf_solver *s) {
  scene_accelerate(c, s);
  scene_fill(c, s, 300, 0.03);
  pbf_params params = c->params;
  params.time_step /= 40; /* so short that little of an error at its start is undone */
  EXPECT_OK(pbf_set_params(s, &params));
}

/* A solver has a place for each array of them. */
static void check_all(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.phases = 2;
  c.set_up = set_all;
  c.change = change_all;
  c.params.loads = 1;
  c.params.wall_friction = 0.3;
  c.params.viscosity = 0.002;
  c.params.damping_compensation = 1;
  c.params.angular_momentum_correction = 1;
  c.params.pressure_grid = 2;
  c.params.periodic = PBF_PERIODIC_X;
  c.params.tolerance = 0.002;
  c.params.sleep_speed = 0.5;
  c.params.sleep_time = 0.02;
  scene_check("all at once", &c);
}

static void all_at_once_is_the_same(void **state) {
  (void)state;
  test_for_long_kinds(check_all);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pressure_grid_is_the_same),
      cmocka_unit_test(so_is_deep_water),
      cmocka_unit_test(loads_are_the_same),
      cmocka_unit_test(so_is_friction),
      cmocka_unit_test(so_are_shapes),
      cmocka_unit_test(so_are_phases),
      cmocka_unit_test(so_are_fluids_that_are_not_there),
      cmocka_unit_test(so_are_periodic_axes),
      cmocka_unit_test(so_is_sleep),
      cmocka_unit_test(all_at_once_is_the_same),
  };
  return TEST_RUN(tests);
}
