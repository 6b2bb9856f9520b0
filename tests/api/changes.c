/* What is set over a solver is what it would have been created with: nothing of the parameters and
 * colliders before it is left, whatever of them is known from before. */
#include "param_table.h"
#include "support.h"

enum { SIDE = 6, ROOM = 4000 };

static uint32_t block_count(uint32_t dimension) {
  return dimension == 3 ? SIDE * SIDE * SIDE : SIDE * SIDE;
}

/* A block in a corner of the domain: it meets walls and falls. */
static uint64_t hash_of_fall(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  const uint32_t count = block_count(dimension);
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0, rest = i; k < dimension; ++k, rest /= SIDE)
      test_put(x, (uint64_t)i * dimension + k, precision, 0.02 + 0.049 * (rest % SIDE));
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  free(x);
  assert_ok(pbf_step(s, 4));
  return test_hash(s);
}

static uint64_t hash_as_created(const pbf_desc *desc, const pbf_params *params) {
  pbf_solver *s = test_create(desc, params);
  const uint64_t hash = hash_of_fall(s, desc->dimension, desc->precision);
  pbf_destroy(s);
  return hash;
}

static uint64_t hash_as_set(const pbf_desc *desc, const pbf_params *before,
                            const pbf_params *params) {
  pbf_solver *s = test_create(desc, before);
  assert_ok(pbf_set_params(s, params));
  const uint64_t hash = hash_of_fall(s, desc->dimension, desc->precision);
  pbf_destroy(s);
  return hash;
}

static void check_change(const char *name, const pbf_desc *desc, const pbf_params *before,
                         const pbf_params *after) {
  const uint64_t created = hash_as_created(desc, after);
  if (hash_as_set(desc, before, after) != created || hash_as_set(desc, after, after) != created)
    fail_msg("%uD, float%u: with another %s set steps are not as with it from the start",
             desc->dimension, 8 * desc->precision, name);
}

/* Everything acts in it. */
static pbf_params busy_params(void) {
  pbf_params p = test_params();
  p.scorr_k = 1e-4;
  p.viscosity = p.vorticity = 0.01;
  return p;
}

static void check_numbers(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, ROOM);
  const pbf_params before = busy_params();
  for (int k = 0; k < TABLE_PARAMS; ++k) {
    const table_param *param = &table_params[k];
    pbf_params after = before;
    double value;
    memcpy(&value, (const char *)&before + param->offset, sizeof value);
    if (param->usual != 0)
      table_turn_on(&after, param);
    else
      table_put(&after, param, 0, value != 0 ? 0.95 * value : 0.01);
    if (strcmp(param->name, "spacing") == 0) after.spacing = 0.045;
    if (strcmp(param->name, "particle_volume") == 0)
      after.particle_volume = dimension == 3 ? 1.1e-4 : 2.4e-3;
    if (strcmp(param->name, "search_cell_width") == 0) after.search_cell_width = 0.15;
    if (strcmp(param->name, "domain_min") == 0) after.domain_min[0] = -0.3;
    check_change(param->name, &desc, &before, &after);
  }
}

static void numbers_are_as_from_the_start(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_numbers);
}

static void check_kinds(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, ROOM);
  pbf_params before = busy_params(), after = before;
  after.kernel = PBF_KERNEL_POLY6_SPIKY;
  check_change("kernel", &desc, &before, &after);
  check_change("kernel", &desc, &after, &before);
  after = before;
  after.solver = PBF_SOLVER_JACOBI;
  check_change("solver", &desc, &before, &after);
  check_change("solver", &desc, &after, &before);
  after = before;
  after.iterations = 7;
  check_change("number of iterations", &desc, &before, &after);
}

static void kinds_are_as_from_the_start(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_kinds);
}

/* ---- Where colliders hold deep water --------------------------------------------------------- */

static int has_grid(pbf_solver *s) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(s, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k)
    if (strcmp(plan.stages[k].name, "pressure grid") == 0) return 1;
  return 0;
}

static pbf_collider box(double left, double bottom, double right, double top) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, PBF_COLLIDER_BOX));
  c.position[0] = 0.5 * (left + right);
  c.position[1] = 0.5 * (bottom + top);
  c.half_extents[0] = 0.5 * (right - left);
  c.half_extents[1] = 0.5 * (top - bottom);
  return c;
}

/* A pool half a metre wide and three deep, that there is water for; of a domain so wide that the
 * same is shallow there. Each change undoes the one before it, or makes another. */
static void pools_come_and_go(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  const pbf_desc desc = test_desc(2, PBF_FLOAT64, 500);
  pbf_params params = test_params();
  params.domain_min[0] = -20;
  params.domain_max[0] = 20;
  params.domain_max[1] = 4;
  pbf_collider walls[3] = {box(-0.5, 0.1, 1, 0.5), box(-0.5, 0.1, 0, 3.6), box(0.5, 0.1, 1, 3.6)};
  pbf_solver *s = test_create(&desc, &params);
  void *x = test_lattice(2, PBF_FLOAT64, 400);
  assert_ok(pbf_add_particles(s, 400, x, NULL, NULL));
  free(x);
  assert_false(has_grid(s));
  assert_ok(pbf_set_colliders(s, 3, walls));
  assert_true(has_grid(s));
  params.gravity[0] = 0.1;
  assert_ok(pbf_set_params(s, &params));
  assert_true(has_grid(s));
  params.gravity[1] = 9.81; /* up: it holds nothing */
  assert_ok(pbf_set_params(s, &params));
  assert_false(has_grid(s));
  params.gravity[1] = -9.81;
  assert_ok(pbf_set_params(s, &params));
  assert_true(has_grid(s));
  walls[2].position[0] += 2;
  assert_ok(pbf_set_colliders(s, 3, walls));
  assert_false(has_grid(s));
  walls[2].position[0] -= 2;
  assert_ok(pbf_set_colliders(s, 3, walls));
  assert_true(has_grid(s));
  assert_ok(pbf_set_colliders(s, 2, walls));
  assert_false(has_grid(s));
  params.domain_max[0] = 0.6; /* the domain's wall instead */
  assert_ok(pbf_set_params(s, &params));
  assert_true(has_grid(s));
  pbf_destroy(s);
}

/* ---- Pressures outlive what is set ------------------------------------------------------------
 */

/* They are of the last step, whatever time step, gravity and colliders the next one is to have. */
static void check_pressures(uint32_t dimension, uint32_t precision) {
  const uint32_t count = block_count(dimension);
  const pbf_desc desc = test_desc(dimension, precision, ROOM);
  pbf_params params = test_params();
  pbf_collider ball;
  double before[SIDE * SIDE * SIDE], after[SIDE * SIDE * SIDE];
  params.pressure_grid = 2;
  params.iterations = 1; /* which carry little */
  params.time_step = 1.0 / 60;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.1;
  for (int k = 0; k < 3; ++k) ball.position[k] = 0.8;
  for (int changes = 0; changes < 2; ++changes) {
    pbf_solver *s = test_create(&desc, &params);
    pbf_params next = params;
    assert_ok(pbf_set_colliders(s, 1, &ball));
    hash_of_fall(s, dimension, precision);
    next.time_step *= 0.25;
    next.gravity[0] = 3;
    if (changes) {
      assert_ok(pbf_set_params(s, &next));
      assert_ok(pbf_set_colliders(s, 0, NULL));
      next.pressure_grid = 0;
      assert_ok(pbf_set_params(s, &next));
    }
    assert_ok(pbf_get_pressures(s, 0, count, changes ? after : before));
    pbf_destroy(s);
  }
  assert_memory_equal(before, after, (size_t)count * precision);
}

static void pressures_are_of_the_last_step(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_pressures);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(numbers_are_as_from_the_start),
      cmocka_unit_test(kinds_are_as_from_the_start),
      cmocka_unit_test(pools_come_and_go),
      cmocka_unit_test(pressures_are_of_the_last_step),
  };
  return TEST_RUN(tests);
}
