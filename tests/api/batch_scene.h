/* Worlds that differ, for the tests of batches. */
#ifndef PBF_TESTS_API_BATCH_SCENE_H
#define PBF_TESTS_API_BATCH_SCENE_H

#include <pbf/batch.h>

#include "support.h"

enum { WORLDS = 5, COUNT = 40, CAPACITY = 64, STEPS = 12 };

/* The counting allocator is for one thread. */
static inline pbf_desc desc_for(uint32_t dimension, uint32_t precision, uint32_t threads) {
  pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  desc.threads = threads;
  if (threads != 1) desc.allocator = NULL;
  return desc;
}

static inline uint32_t count_in(uint32_t world) { return COUNT - 3 * world; }

static inline pbf_collider ball_of(uint32_t world) {
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.1;
  ball.position[0] = 0.3 + 0.1 * world;
  ball.position[1] = 0.1;
  ball.position[2] = 0.5;
  return ball;
}

/* Each world has another number of particles, another collider and other parameters. */
static inline void furnish(pbf_solver *solver, const pbf_desc *desc, uint32_t world) {
  void *x = test_lattice(desc->dimension, desc->precision, count_in(world));
  const pbf_collider ball = ball_of(world);
  pbf_params params = test_params();
  params.gravity[0] = 0.5 * world;
  params.viscosity = world % 2 ? 0.001 : 0;
  assert_ok(pbf_set_params(solver, &params));
  assert_ok(pbf_set_colliders(solver, 1, &ball));
  assert_ok(pbf_add_particles(solver, count_in(world), x, NULL, NULL));
  free(x);
}

static inline pbf_batch *batch_of(const pbf_desc *desc, uint32_t worlds) {
  pbf_batch *batch = NULL;
  assert_ok(pbf_batch_create(desc, NULL, worlds, &batch));
  assert_non_null(batch);
  return batch;
}

static inline pbf_solver *world_of(pbf_batch *batch, uint32_t world) {
  pbf_solver *solver = NULL;
  assert_ok(pbf_batch_get_world(batch, world, &solver));
  assert_non_null(solver);
  return solver;
}

static inline pbf_batch *furnished(const pbf_desc *desc) {
  pbf_batch *batch = batch_of(desc, WORLDS);
  for (uint32_t k = 0; k < WORLDS; ++k) furnish(world_of(batch, k), desc, k);
  return batch;
}

static inline uint64_t hash_alone(const pbf_desc *desc, uint32_t world, uint32_t steps) {
  pbf_solver *solver = test_create(desc, NULL);
  furnish(solver, desc, world);
  assert_ok(pbf_step(solver, steps));
  const uint64_t hash = test_hash(solver);
  pbf_destroy(solver);
  return hash;
}

static inline uint32_t threads_of(pbf_batch *batch) {
  pbf_batch_info info = {.struct_size = sizeof info};
  assert_ok(pbf_batch_get_info(batch, &info));
  assert_int_equal(info.worlds, WORLDS);
  return info.device_type == PBF_DEVICE_CPU ? info.threads : UINT32_MAX;
}

#endif
