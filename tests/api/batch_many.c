/* Batches of so many worlds that a GPU steps them together: each has the bits that it has alone. */
#include <math.h>

#include "batch_scene.h"

enum { MANY = 48, KINDS = 6, MANY_COUNT = 150, FIRST_STEPS = 2, MORE_STEPS = 19 };

/* Worlds of six kinds: walls alone, colliders that move, a wall that moves, another kernel and
 * solver, too many particles in a cell, and too many for a list. */
enum { PLAIN, COLLIDERS, WALLS, JACOBI, CROWDED, DENSE };

static uint32_t many_in(uint32_t world) { return MANY_COUNT - world % KINDS; }

static pbf_params params_of(uint32_t world) {
  pbf_params params = test_params();
  params.gravity[0] = 0.5 * (world % KINDS);
  params.pressure_grid = 0;
  if (world % KINDS == WALLS) {
    params.wall_amplitude[PBF_WALL_X_MAX] = 0.05;
    params.wall_frequency[PBF_WALL_X_MAX] = 12;
  }
  if (world % KINDS == JACOBI) {
    params.solver = PBF_SOLVER_JACOBI;
    params.kernel = PBF_KERNEL_POLY6_SPIKY;
    params.wall_density = 0;
    params.scorr_k = 0.001;
  }
  return params;
}

static void add_lattice(pbf_solver *solver, const pbf_desc *desc, uint32_t world) {
  const uint32_t kind = world % KINDS, count = many_in(world), dimension = desc->dimension;
  const double spacing = kind == CROWDED ? 0.002 : kind == DENSE ? 0.02 : 0.05;
  const uint32_t side = dimension == 3 ? 6 : 13;
  void *x = calloc((size_t)count * dimension, desc->precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0, rest = i; k < dimension; ++k, rest /= side)
      test_put(
          x, (uint64_t)i * dimension + k, desc->precision,
          0.2 + spacing * (k + 1 < dimension ? rest % side : rest) + 1e-4 * ((i * 7 + k) % 13));
  assert_ok(pbf_add_particles(solver, count, x, NULL, NULL));
  free(x);
}

static void furnish_one(pbf_solver *solver, const pbf_desc *desc, uint32_t world) {
  const pbf_params params = params_of(world);
  assert_ok(pbf_set_params(solver, &params));
  if (world % KINDS == COLLIDERS) {
    pbf_collider ball = ball_of(world % KINDS);
    ball.velocity[0] = 0.3;
    assert_ok(pbf_set_colliders(solver, 1, &ball));
  }
  add_lattice(solver, desc, world);
}

static pbf_batch *furnished_many(const pbf_desc *desc) {
  pbf_batch *batch = batch_of(desc, MANY);
  for (uint32_t k = 0; k < MANY; ++k) furnish_one(world_of(batch, k), desc, k);
  return batch;
}

static pbf_desc desc_of_many(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = desc_for(dimension, precision, 2);
  desc.capacity = MANY_COUNT + 10;
  return desc;
}

static void check_many(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = desc_of_many(dimension, precision);
  pbf_batch *batch = furnished_many(&desc);
  assert_ok(pbf_batch_step(batch, NULL, FIRST_STEPS));
  assert_ok(pbf_batch_step(batch, NULL, MORE_STEPS));
  for (uint32_t kind = 0; kind < KINDS; ++kind) {
    pbf_solver *alone = test_create(&desc, NULL);
    furnish_one(alone, &desc, kind);
    assert_ok(pbf_step(alone, FIRST_STEPS + MORE_STEPS));
    const uint64_t hash = test_hash(alone);
    pbf_destroy(alone);
    for (uint32_t k = kind; k < MANY; k += KINDS)
      assert_true(test_hash(world_of(batch, k)) == hash);
  }
  pbf_batch_destroy(batch);
}

static void bits_are_those_of_a_world_alone(void **state) {
  (void)state;
  test_for_long_kinds(check_many);
}

/* What is done to a world between the batch's steps comes after those before it, and before those
 * after it. */
static void change(pbf_solver *solver, const pbf_desc *desc) {
  const float more[2][3] = {{0.6f, 0.9f, 0.5f}, {0.7f, 0.9f, 0.5f}};
  pbf_params params = params_of(PLAIN);
  params.gravity[0] = -2;
  assert_ok(pbf_set_params(solver, &params));
  assert_ok(pbf_step(solver, 1));
  if (desc->dimension == 3 && desc->precision == PBF_FLOAT32)
    assert_ok(pbf_add_particles(solver, 2, more, NULL, NULL));
}

static void check_changes(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = desc_of_many(dimension, precision);
  uint8_t mask[MANY];
  pbf_batch *batch = furnished_many(&desc);
  pbf_solver *alone = test_create(&desc, NULL);
  furnish_one(alone, &desc, PLAIN);
  for (uint32_t k = 0; k < MANY; ++k) mask[k] = k != KINDS;
  assert_ok(pbf_batch_step(batch, NULL, 3));
  change(world_of(batch, 0), &desc);
  change(world_of(batch, KINDS), &desc);
  assert_ok(pbf_batch_step(batch, mask, 2));
  assert_ok(pbf_step(world_of(batch, KINDS), 2));
  assert_ok(pbf_batch_step(batch, NULL, 2));
  assert_ok(pbf_synchronize(world_of(batch, 0)));
  assert_ok(pbf_step(alone, 3));
  change(alone, &desc);
  assert_ok(pbf_step(alone, 4));
  const uint64_t hash = test_hash(alone);
  assert_true(test_hash(world_of(batch, 0)) == hash);
  assert_true(test_hash(world_of(batch, KINDS)) == hash);
  pbf_destroy(alone);
  pbf_batch_destroy(batch);
}

static void changes_come_in_their_turn(void **state) {
  (void)state;
  test_for_long_kinds(check_changes);
}

/* A batch may end while its steps are under way. */
static void batches_end_at_any_time(void **state) {
  (void)state;
  const pbf_desc desc = desc_of_many(3, PBF_FLOAT32);
  if (!test_has_kind(3, PBF_FLOAT32)) test_skip("it is about 3D in float32");
  if (strcmp(test_backend(), "reference") == 0) test_skip_if_watched();
  for (uint32_t round = 0; round < 2; ++round) {
    pbf_batch *batch = furnished_many(&desc);
    assert_ok(pbf_batch_step(batch, NULL, 40));
    pbf_batch_destroy(batch);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bits_are_those_of_a_world_alone),
      cmocka_unit_test(changes_come_in_their_turn),
      cmocka_unit_test(batches_end_at_any_time),
  };
  return TEST_RUN(tests);
}
