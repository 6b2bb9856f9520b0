/* Many worlds in one call: each as it would be alone. */
#include <dlpack/dlpack.h>
#include <pbf/batch.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "support.h"

enum { WORLDS = 5, COUNT = 40, CAPACITY = 64, STEPS = 12 };

/* ---- Worlds alone and in a batch --------------------------------------------------------------
 */

/* The counting allocator is for one thread. */
static pbf_desc desc_for(uint32_t dimension, uint32_t precision, uint32_t threads) {
  pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  desc.threads = threads;
  if (threads != 1) desc.allocator = NULL;
  return desc;
}

static uint32_t count_in(uint32_t world) { return COUNT - 3 * world; }

static pbf_collider ball_of(uint32_t world) {
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.1;
  ball.position[0] = 0.3 + 0.1 * world;
  ball.position[1] = 0.1;
  ball.position[2] = 0.5;
  return ball;
}

/* Each world has another number of particles, another collider and other parameters. */
static void furnish(pbf_solver *solver, const pbf_desc *desc, uint32_t world) {
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

static pbf_batch *batch_of(const pbf_desc *desc, uint32_t worlds) {
  pbf_batch *batch = NULL;
  assert_ok(pbf_batch_create(desc, NULL, worlds, &batch));
  assert_non_null(batch);
  return batch;
}

static pbf_solver *world_of(pbf_batch *batch, uint32_t world) {
  pbf_solver *solver = NULL;
  assert_ok(pbf_batch_get_world(batch, world, &solver));
  assert_non_null(solver);
  return solver;
}

static pbf_batch *furnished(const pbf_desc *desc) {
  pbf_batch *batch = batch_of(desc, WORLDS);
  for (uint32_t k = 0; k < WORLDS; ++k) furnish(world_of(batch, k), desc, k);
  return batch;
}

static uint64_t hash_alone(const pbf_desc *desc, uint32_t world, uint32_t steps) {
  pbf_solver *solver = test_create(desc, NULL);
  furnish(solver, desc, world);
  assert_ok(pbf_step(solver, steps));
  const uint64_t hash = test_hash(solver);
  pbf_destroy(solver);
  return hash;
}

static uint32_t threads_of(pbf_batch *batch) {
  pbf_batch_info info = {.struct_size = sizeof info};
  assert_ok(pbf_batch_get_info(batch, &info));
  assert_int_equal(info.worlds, WORLDS);
  return info.device_type == PBF_DEVICE_CPU ? info.threads : UINT32_MAX;
}

static void check_bits(uint32_t dimension, uint32_t precision) {
  static const uint32_t numbers[] = {1, 2, 3, 8, 0};
  uint64_t alone[WORLDS];
  for (uint32_t t = 0; t < sizeof numbers / sizeof numbers[0]; ++t) {
    const pbf_desc desc = desc_for(dimension, precision, numbers[t]);
    pbf_batch *batch = furnished(&desc);
    if (t == 0)
      for (uint32_t k = 0; k < WORLDS; ++k) alone[k] = hash_alone(&desc, k, STEPS);
    const uint32_t threads = threads_of(batch);
    if (numbers[t] && threads != UINT32_MAX)
      assert_int_equal(threads, numbers[t] < WORLDS ? numbers[t] : WORLDS);
    for (uint32_t k = 0; k < STEPS; ++k) assert_ok(pbf_batch_step(batch, NULL, 1));
    for (uint32_t k = 0; k < WORLDS; ++k) assert_true(test_hash(world_of(batch, k)) == alone[k]);
    pbf_batch_destroy(batch);
  }
}

static void bits_are_those_of_a_world_alone(void **state) {
  (void)state;
  test_for_each_kind(check_bits);
}

static void a_mask_chooses_worlds(void **state) {
  (void)state;
  const uint8_t mask[WORLDS] = {0, 1, 0, 0, 255};
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 2);
  pbf_batch *batch = furnished(&desc);
  assert_ok(pbf_batch_step(batch, mask, 3));
  for (uint32_t k = 0; k < WORLDS; ++k) {
    pbf_info info = {.struct_size = sizeof info};
    assert_ok(pbf_get_info(world_of(batch, k), &info));
    assert_int_equal(info.step, mask[k] ? 3 : 0);
  }
  pbf_batch_destroy(batch);
}

/* ---- The caller's task system ------------------------------------------------------------------
 */

typedef struct late_task {
  pbf_task_fn run;
  void *task;
  uint32_t items;
  pthread_t thread;
} late_task;

static uint32_t enqueued, finished;

static void *run_late(void *user) {
  late_task *t = user;
  t->run(t->task, 0, t->items);
  return NULL;
}

static void *enqueue_in_thread(void *user, pbf_task_fn run, void *task, uint32_t items,
                               uint32_t min_range) {
  static late_task there;
  (void)user, (void)min_range;
  ++enqueued;
  there = (late_task){.run = run, .task = task, .items = items};
  return pthread_create(&there.thread, NULL, run_late, &there) == 0 ? &there : NULL;
}

static void finish_thread(void *user, void *handle) {
  (void)user;
  ++finished;
  pthread_join(((late_task *)handle)->thread, NULL);
}

static void *enqueue_here(void *user, pbf_task_fn run, void *task, uint32_t items,
                          uint32_t min_range) {
  (void)user, (void)min_range;
  ++enqueued;
  run(task, 0, items);
  return NULL;
}

/* Not before all has been done by the caller. */
static void *enqueue_too_late(void *user, pbf_task_fn run, void *task, uint32_t items,
                              uint32_t min_range) {
  static late_task there;
  (void)user, (void)min_range;
  ++enqueued;
  there = (late_task){.run = run, .task = task, .items = items};
  return &there;
}

static void finish_here(void *user, void *handle) {
  late_task *t = handle;
  (void)user;
  ++finished;
  t->run(t->task, 0, t->items);
}

static void the_task_system_steps_worlds(void **state) {
  (void)state;
  const pbf_enqueue_task_fn ways[] = {enqueue_in_thread, enqueue_here, enqueue_too_late};
  const pbf_finish_task_fn ends[] = {finish_thread, finish_thread, finish_here};
  pbf_desc desc = desc_for(3, PBF_FLOAT32, 3);
  uint64_t alone[WORLDS];
  for (uint32_t k = 0; k < WORLDS; ++k) alone[k] = hash_alone(&desc, k, STEPS);
  for (int way = 0; way < 3; ++way) {
    desc.enqueue_task = ways[way];
    desc.finish_task = ends[way];
    enqueued = finished = 0;
    pbf_batch *batch = furnished(&desc);
    assert_ok(pbf_batch_step(batch, NULL, STEPS));
    if (threads_of(batch) != UINT32_MAX) {
      assert_int_equal(enqueued, 1);
      assert_int_equal(finished, way != 1);
    }
    for (uint32_t k = 0; k < WORLDS; ++k) assert_true(test_hash(world_of(batch, k)) == alone[k]);
    pbf_batch_destroy(batch);
  }
}

/* ---- Starts ------------------------------------------------------------------------------------
 */

static void check_reset(uint32_t dimension, uint32_t precision) {
  const uint8_t odd[WORLDS] = {0, 1, 0, 1, 0};
  const pbf_desc desc = desc_for(dimension, precision, 2);
  pbf_batch *batch = furnished(&desc);
  uint64_t first[WORLDS], later[WORLDS];
  assert_ok(pbf_batch_set_start(batch, NULL, NULL, 0));
  assert_ok(pbf_batch_step(batch, NULL, STEPS));
  for (uint32_t k = 0; k < WORLDS; ++k) first[k] = test_hash(world_of(batch, k));
  assert_ok(pbf_batch_step(batch, NULL, STEPS));
  for (uint32_t k = 0; k < WORLDS; ++k) later[k] = test_hash(world_of(batch, k));
  for (int round = 0; round < 2; ++round) {
    const double gravity[WORLDS][3] = {{0, 1, 0}};
    assert_ok(pbf_batch_set_gravity(batch, odd, gravity[0]));
    assert_ok(pbf_batch_reset(batch, odd));
    assert_ok(pbf_batch_step(batch, odd, STEPS));
    for (uint32_t k = 0; k < WORLDS; ++k)
      assert_true(test_hash(world_of(batch, k)) == (odd[k] ? first : later)[k]);
  }
  pbf_batch_destroy(batch);
}

static void reset_worlds_go_the_same_way(void **state) {
  (void)state;
  test_for_each_kind(check_reset);
}

static void one_start_serves_all_worlds(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  const uint8_t first[WORLDS] = {1, 0, 0, 0, 0};
  uint64_t size;
  pbf_solver *other = test_create(&desc, NULL);
  furnish(other, &desc, 2);
  void *saved = test_save(other, &size);
  assert_ok(pbf_step(other, STEPS));
  pbf_batch *batch = batch_of(&desc, WORLDS);
  const uint64_t before = test_count.live_bytes;
  assert_ok(pbf_batch_set_start(batch, NULL, saved, size));
  assert_in_range(test_count.live_bytes - before, size, size + 64);
  memset(saved, 0, size);
  free(saved);
  assert_ok(pbf_batch_reset(batch, NULL));
  assert_ok(pbf_batch_step(batch, NULL, STEPS));
  for (uint32_t k = 0; k < WORLDS; ++k)
    assert_true(test_hash(world_of(batch, k)) == test_hash(other));
  assert_ok(pbf_batch_set_start(batch, first, NULL, 0));
  assert_ok(pbf_batch_reset(batch, NULL));
  assert_true(test_hash(world_of(batch, 0)) == test_hash(other));
  pbf_destroy(other);
  pbf_batch_destroy(batch);
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- Actions -----------------------------------------------------------------------------------
 */

/* Where world k's ball is to be, in steps of its own. */
static void find_target(uint32_t world, double position[3], double orientation[4]) {
  const double angle = 0.2 * world;
  const double place[3] = {0.4, 0.2 + 0.05 * world, 0.5};
  const double turn[4] = {0, 0, sin(angle / 2), cos(angle / 2)};
  memcpy(position, place, sizeof place);
  memcpy(orientation, turn, sizeof turn);
}

static void check_targets(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = desc_for(dimension, precision, 2);
  pbf_batch *batch = furnished(&desc);
  double positions[WORLDS][1][3], orientations[WORLDS][1][4];
  const double duration = STEPS * test_params().time_step;
  for (uint32_t k = 0; k < WORLDS; ++k) find_target(k, positions[k][0], orientations[k][0]);
  assert_ok(
      pbf_batch_move_colliders(batch, NULL, 1, positions[0][0], orientations[0][0], duration));
  assert_ok(pbf_batch_step(batch, NULL, STEPS));
  for (uint32_t k = 0; k < WORLDS; ++k) {
    pbf_solver *alone = test_create(&desc, NULL);
    pbf_collider target = ball_of(k);
    furnish(alone, &desc, k);
    find_target(k, target.position, target.orientation);
    assert_ok(pbf_move_colliders(alone, 1, &target, duration));
    assert_ok(pbf_step(alone, STEPS));
    assert_true(test_hash(world_of(batch, k)) == test_hash(alone));
    pbf_collider there = {.struct_size = sizeof there};
    assert_ok(pbf_get_collider(world_of(batch, k), 0, &there));
    assert_true(fabs(there.position[1] - positions[k][0][1]) < 1e-12);
    pbf_destroy(alone);
  }
  assert_ok(pbf_batch_move_colliders(batch, NULL, 1, positions[0][0], NULL, duration));
  pbf_collider there = {.struct_size = sizeof there};
  assert_ok(pbf_get_collider(world_of(batch, 3), 0, &there));
  assert_true(fabs(fabs(there.orientation[3]) - fabs(orientations[3][0][3])) < 1e-12);
  pbf_batch_destroy(batch);
}

static void colliders_go_to_targets(void **state) {
  (void)state;
  test_for_each_kind(check_targets);
}

/* A particle alone in free fall has, after a step of length t, the velocity g t. */
static void check_gravity(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = desc_for(dimension, precision, 2);
  const double dt = test_params().time_step, rounding = precision == PBF_FLOAT32 ? 1e-6 : 1e-14;
  void *middle = test_lattice(dimension, precision, 1);
  double gravity[WORLDS][3], v[WORLDS][3];
  pbf_batch *batch = batch_of(&desc, WORLDS);
  for (uint32_t k = 0; k < WORLDS; ++k) {
    assert_ok(pbf_add_particles(world_of(batch, k), 1, middle, NULL, NULL));
    for (int c = 0; c < 3; ++c) gravity[k][c] = 0.25 * k - c;
  }
  free(middle);
  assert_ok(pbf_batch_set_gravity(batch, NULL, gravity[0]));
  assert_ok(pbf_batch_step(batch, NULL, 1));
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = PBF_FIELD_VELOCITY,
                              .count = 1,
                              .element_type = PBF_TYPE_FLOAT64,
                              .components = 3,
                              .data = v};
  assert_ok(pbf_batch_read(batch, NULL, &read, 0));
  for (uint32_t k = 0; k < WORLDS; ++k)
    for (uint32_t c = 0; c < dimension; ++c)
      assert_true(fabs(v[k][c] - gravity[k][c] * dt) <= rounding);
  pbf_batch_destroy(batch);
}

static void gravity_is_each_worlds_own(void **state) {
  (void)state;
  test_for_each_kind(check_gravity);
}

static void emitters_add_to_their_worlds(void **state) {
  (void)state;
  const uint32_t counts[WORLDS] = {2, 0, 1, 0, 3};
  float x[6][3], v[6][3], there[3];
  uint32_t now[WORLDS];
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 2);
  pbf_batch *batch = batch_of(&desc, WORLDS);
  for (int i = 0; i < 6; ++i)
    for (int c = 0; c < 3; ++c) {
      x[i][c] = 0.1F * (float)(i + 1) + 0.01F * (float)c;
      v[i][c] = (float)(i - c);
    }
  assert_ok(pbf_batch_add_particles(batch, counts, x, v));
  assert_ok(pbf_batch_get_counts(batch, now));
  assert_memory_equal(now, counts, sizeof now);
  assert_ok(pbf_get_positions(world_of(batch, 2), 0, 1, there));
  assert_memory_equal(there, x[2], sizeof there);
  assert_ok(pbf_get_velocities(world_of(batch, 4), 2, 1, there));
  assert_memory_equal(there, v[5], sizeof there);
  assert_ok(pbf_batch_add_particles(batch, counts, x, NULL));
  assert_ok(pbf_get_velocities(world_of(batch, 4), 5, 1, there));
  assert_true(there[0] == 0 && there[1] == 0 && there[2] == 0);
  pbf_batch_destroy(batch);
}

static void colliders_are_set_in_all_chosen(void **state) {
  (void)state;
  const uint8_t mask[WORLDS] = {1, 0, 1, 1, 1};
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 2);
  const pbf_collider balls[2] = {ball_of(0), ball_of(3)};
  pbf_batch *batch = batch_of(&desc, WORLDS);
  assert_ok(pbf_batch_set_colliders(batch, mask, 2, balls));
  for (uint32_t k = 0; k < WORLDS; ++k) {
    uint32_t count;
    assert_ok(pbf_get_collider_count(world_of(batch, k), &count));
    assert_int_equal(count, mask[k] ? 2 : 0);
  }
  pbf_batch_destroy(batch);
}

/* ---- Observations ------------------------------------------------------------------------------
 */

static void check_rows(uint32_t dimension, uint32_t precision) {
  enum { ROWS = COUNT + 2 };
  const pbf_desc desc = desc_for(dimension, precision, 3);
  const uint64_t bytes = (uint64_t)ROWS * dimension * precision;
  pbf_batch *batch = furnished(&desc);
  assert_ok(pbf_batch_step(batch, NULL, 5));
  char *all = malloc(WORLDS * bytes), *own = malloc(bytes);
  memset(all, 77, WORLDS * bytes);
  for (uint32_t field = PBF_FIELD_POSITION; field <= PBF_FIELD_VELOCITY; ++field) {
    const pbf_read_desc read = {
        .struct_size = sizeof read, .field = field, .count = ROWS, .data = all};
    assert_ok(pbf_batch_read(batch, NULL, &read, 0));
    for (uint32_t k = 0; k < WORLDS; ++k) {
      pbf_solver *world = world_of(batch, k);
      memset(own, 0, bytes);
      if (field == PBF_FIELD_POSITION)
        assert_ok(pbf_get_positions(world, 0, count_in(k), own));
      else
        assert_ok(pbf_get_velocities(world, 0, count_in(k), own));
      assert_memory_equal(all + k * bytes, own, bytes);
    }
  }
  free(all);
  free(own);
  pbf_batch_destroy(batch);
}

static void rows_are_those_of_the_worlds(void **state) {
  (void)state;
  test_for_each_kind(check_rows);
}

/* What lies between rows and worlds, and worlds that are not asked, stay as they are. */
static void gaps_stay(void **state) {
  (void)state;
  enum { ROWS = 3, ROW = 5, WORLD = 20 };
  const uint8_t mask[WORLDS] = {1, 1, 0, 1, 1};
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 2);
  pbf_batch *batch = furnished(&desc);
  double all[WORLDS][WORLD];
  for (uint32_t k = 0; k < WORLDS; ++k)
    for (uint32_t i = 0; i < WORLD; ++i) all[k][i] = -7;
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = PBF_FIELD_POSITION,
                              .first = count_in(4) - 2, /* the last world has two of the rows */
                              .count = ROWS,
                              .element_type = PBF_TYPE_FLOAT64,
                              .components = 4,
                              .stride = ROW * sizeof(double),
                              .data = all,
                              .w_value = 9};
  assert_ok(pbf_batch_read(batch, mask, &read, sizeof all[0]));
  for (uint32_t k = 0; k < WORLDS; ++k)
    for (uint32_t i = 0; i < WORLD; ++i) {
      const uint32_t row = i / ROW, c = i % ROW;
      const int is_gap = !mask[k] || row >= ROWS || c == 4, is_there = row < 2 || k < 4;
      float x[3];
      double expected = is_gap ? -7 : 0;
      if (!is_gap && is_there) {
        assert_ok(pbf_get_positions(world_of(batch, k), read.first + row, 1, x));
        expected = c == 3 ? 9 : (double)x[c];
      }
      assert_true(all[k][i] == expected);
    }
  pbf_batch_destroy(batch);
}

static void tensors_hold_what_was(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc);
  DLManagedTensor *x = NULL, *ids = NULL;
  float first[3];
  assert_ok(pbf_get_positions(world_of(batch, 1), 4, 1, first));
  assert_ok(pbf_batch_export_dlpack(batch, PBF_FIELD_POSITION, 0, &x));
  assert_ok(pbf_batch_export_dlpack(batch, PBF_FIELD_ID, 7, &ids));
  assert_int_equal(x->dl_tensor.ndim, 3);
  assert_int_equal(x->dl_tensor.shape[0], WORLDS);
  assert_int_equal(x->dl_tensor.shape[1], COUNT);
  assert_int_equal(x->dl_tensor.shape[2], 3);
  const int on_host = x->dl_tensor.device.device_type == kDLCPU;
  assert_int_equal(on_host, strcmp(test_backend(), "cuda") != 0);
  assert_int_equal(x->dl_tensor.dtype.code, kDLFloat);
  assert_int_equal(x->dl_tensor.dtype.bits, 32);
  assert_int_equal((uintptr_t)x->dl_tensor.data % 64, 0);
  assert_int_equal(ids->dl_tensor.shape[1], 7);
  assert_int_equal(ids->dl_tensor.shape[2], 1);
  assert_int_equal(ids->dl_tensor.dtype.code, kDLUInt);
  assert_ok(pbf_batch_step(batch, NULL, 3));
  pbf_batch_destroy(batch);
  if (on_host) {
    assert_memory_equal((float *)x->dl_tensor.data + (COUNT + 4) * 3, first, sizeof first);
    assert_int_equal(((uint32_t *)ids->dl_tensor.data)[2 * 7 + 6], 6);
    assert_int_equal(test_count.live_blocks, 2);
  }
  x->deleter(x);
  ids->deleter(ids);
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- Failures ----------------------------------------------------------------------------------
 */

/* Walls that meet in the world's third step. */
static void close_walls(pbf_solver *world) {
  pbf_params params = test_params();
  params.wall_velocity[PBF_WALL_X_MAX] = -1 / (2.5 * params.time_step);
  assert_ok(pbf_set_params(world, &params));
}

static void others_go_on(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 3);
  pbf_batch *batch = batch_of(&desc, WORLDS);
  pbf_status statuses[WORLDS];
  const char *sentence = NULL;
  for (uint32_t k = 0; k < WORLDS; ++k)
    if (k == 1 || k == 3)
      close_walls(world_of(batch, k));
    else
      furnish(world_of(batch, k), &desc, k);
  for (int round = 1; round <= 2; ++round) {
    assert_fails(pbf_batch_step(batch, NULL, STEPS), PBF_ERROR_STATE, "world 1: step ");
    assert_non_null(strstr(pbf_last_error(), "no room"));
    assert_ok(pbf_batch_get_statuses(batch, statuses));
    for (uint32_t k = 0; k < WORLDS; ++k) {
      pbf_info info = {.struct_size = sizeof info};
      const int fails = k == 1 || k == 3;
      assert_ok(pbf_batch_get_sentence(batch, k, &sentence));
      assert_int_equal(statuses[k], fails ? PBF_ERROR_STATE : PBF_OK);
      assert_true(fails ? strstr(sentence, "no room") != NULL : sentence[0] == 0);
      assert_ok(pbf_get_info(world_of(batch, k), &info));
      assert_int_equal(info.step, fails ? 2 : round * STEPS);
    }
  }
  for (uint32_t k = 0; k < WORLDS; ++k)
    if (statuses[k] == PBF_OK)
      assert_true(test_hash(world_of(batch, k)) == hash_alone(&desc, k, 2 * STEPS));
  const uint8_t good[WORLDS] = {1, 0, 1, 0, 1};
  assert_ok(pbf_batch_step(batch, good, 1));
  assert_ok(pbf_batch_get_statuses(batch, statuses));
  for (uint32_t k = 0; k < WORLDS; ++k) assert_int_equal(statuses[k], PBF_OK);
  pbf_batch_destroy(batch);
}

static void mistakes_have_sentences(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_desc bad = desc;
  pbf_batch *batch = NULL;
  pbf_solver *world = NULL;
  const char *sentence = NULL;
  assert_fails(pbf_batch_create(NULL, NULL, 1, &batch), PBF_ERROR_INVALID_ARGUMENT, "desc is null");
  assert_fails(pbf_batch_create(&desc, NULL, 1, NULL), PBF_ERROR_INVALID_ARGUMENT, "batch is null");
  assert_fails(pbf_batch_create(&desc, NULL, 0, &batch), PBF_ERROR_INVALID_ARGUMENT,
               "worlds is 0; it must be 1 … 65536");
  assert_fails(pbf_batch_create(&desc, NULL, 70000, &batch), PBF_ERROR_INVALID_ARGUMENT,
               "worlds is 70000");
  bad.dimension = 4;
  assert_fails(pbf_batch_create(&bad, NULL, 2, &batch), PBF_ERROR_INVALID_ARGUMENT,
               "desc.dimension is 4");
  bad = desc;
  bad.finish_task = finish_thread;
  assert_fails(pbf_batch_create(&bad, NULL, 2, &batch), PBF_ERROR_INVALID_ARGUMENT,
               "desc.enqueue_task is null");
  assert_null(batch);
  assert_int_equal(test_count.live_blocks, 0);
  assert_fails(pbf_batch_step(NULL, NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "batch is null");
  batch = furnished(&desc);
  pbf_batch_info info = {.struct_size = 3};
  assert_fails(pbf_batch_get_info(batch, NULL), PBF_ERROR_INVALID_ARGUMENT, "batch_info is null");
  assert_fails(pbf_batch_get_info(batch, &info), PBF_ERROR_STRUCT_SIZE, "pbf_batch_info");
  assert_fails(pbf_batch_get_world(batch, WORLDS, &world), PBF_ERROR_NOT_FOUND,
               "world is 5; the batch has 5 worlds");
  assert_fails(pbf_batch_get_world(batch, 0, NULL), PBF_ERROR_INVALID_ARGUMENT, "solver is null");
  assert_fails(pbf_batch_get_sentence(batch, 9, &sentence), PBF_ERROR_NOT_FOUND, "world is 9");
  assert_fails(pbf_batch_get_statuses(batch, NULL), PBF_ERROR_INVALID_ARGUMENT, "statuses is null");
  assert_fails(pbf_batch_get_counts(batch, NULL), PBF_ERROR_INVALID_ARGUMENT, "counts is null");
  assert_fails(pbf_batch_reset(batch, NULL), PBF_ERROR_STATE,
               "world 0: it has no start to go back to");
  assert_fails(pbf_batch_set_start(batch, NULL, NULL, 8), PBF_ERROR_INVALID_ARGUMENT,
               "state is null and size 8");
  assert_ok(pbf_batch_set_start(batch, NULL, "no state", 8));
  assert_fails(pbf_batch_reset(batch, NULL), PBF_ERROR_DATA, "world 0: ");
  pbf_batch_destroy(batch);
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_INVALID_ARGUMENT,
               "which pbf_batch_create did not give or pbf_batch_destroy has taken back");
  pbf_batch_destroy(batch);
  pbf_batch_destroy(NULL);
}

static void wrong_actions_have_sentences(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc);
  double numbers[WORLDS][2][3] = {{{0}}};
  uint32_t counts[WORLDS] = {0, 0, 0, 1, 0};
  float x[3] = {0.5F, 0.5F, 7};
  assert_fails(pbf_batch_set_gravity(batch, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "gravity is null");
  numbers[1][0][0] = NAN; /* gravity[2][0] */
  assert_fails(pbf_batch_set_gravity(batch, NULL, numbers[0][0]), PBF_ERROR_INVALID_ARGUMENT,
               "world 2: params.gravity[0] is NaN");
  assert_fails(pbf_batch_move_colliders(batch, NULL, 1, NULL, NULL, 1), PBF_ERROR_INVALID_ARGUMENT,
               "positions is null");
  assert_fails(pbf_batch_move_colliders(batch, NULL, 1, numbers[0][0], NULL, 1),
               PBF_ERROR_INVALID_ARGUMENT, "world 2: colliders[0].position[0] is NaN");
  assert_fails(pbf_batch_move_colliders(batch, NULL, 2, numbers[0][0], NULL, 1),
               PBF_ERROR_INVALID_ARGUMENT, "world 0: count is 2; the solver has 1 colliders");
  assert_fails(pbf_batch_move_colliders(batch, NULL, 1, numbers[0][0], NULL, 0),
               PBF_ERROR_INVALID_ARGUMENT, "world 0: duration is 0");
  assert_fails(pbf_batch_add_particles(batch, NULL, x, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "counts is null");
  assert_fails(pbf_batch_add_particles(batch, counts, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "world 3: positions is null");
  assert_fails(pbf_batch_add_particles(batch, counts, x, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "world 3: positions[0][2] is 7");
  counts[3] = CAPACITY;
  assert_fails(pbf_batch_add_particles(batch, counts, x, NULL), PBF_ERROR_CAPACITY,
               "world 3: count is 64");
  pbf_batch_destroy(batch);
}

static void wrong_observations_have_sentences(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc);
  DLManagedTensor *tensor = NULL;
  float x[WORLDS][3];
  pbf_read_desc read = {
      .struct_size = sizeof read, .field = PBF_FIELD_POSITION, .count = 1, .data = x};
  assert_fails(pbf_batch_read(batch, NULL, NULL, 0), PBF_ERROR_INVALID_ARGUMENT, "read is null");
  assert_fails(pbf_batch_read(batch, NULL, &read, 8), PBF_ERROR_INVALID_ARGUMENT,
               "world_stride is 8; it must be a multiple of 4 from 12 up");
  assert_fails(pbf_batch_read(batch, NULL, &read, 14), PBF_ERROR_INVALID_ARGUMENT,
               "world_stride is 14");
  read.field = 9;
  assert_fails(pbf_batch_read(batch, NULL, &read, 0), PBF_ERROR_INVALID_ARGUMENT,
               "world 0: read.field is 9");
  read.field = PBF_FIELD_POSITION;
  read.components = 9;
  assert_fails(pbf_batch_read(batch, NULL, &read, 0), PBF_ERROR_INVALID_ARGUMENT,
               "read.components is 9");
  read.components = 0;
  read.count = UINT32_MAX;
  assert_fails(pbf_batch_read(batch, NULL, &read, 0), PBF_ERROR_INVALID_ARGUMENT,
               "read.count is 4294967295");
  read.count = 1;
  read.data = NULL;
  assert_fails(pbf_batch_read(batch, NULL, &read, 0), PBF_ERROR_INVALID_ARGUMENT,
               "read.data is null");
  assert_fails(pbf_batch_export_dlpack(batch, PBF_FIELD_POSITION, 0, NULL),
               PBF_ERROR_INVALID_ARGUMENT, "tensor is null");
  assert_fails(pbf_batch_export_dlpack(batch, 0, 1, &tensor), PBF_ERROR_INVALID_ARGUMENT,
               "read.field is 0");
  assert_null(tensor);
  pbf_batch_destroy(batch);
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- Life --------------------------------------------------------------------------------------
 */

static void worlds_are_the_batchs(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc);
  pbf_solver *world = world_of(batch, 2);
  pbf_destroy(world);
  assert_ok(pbf_step(world, 1));
  assert_ok(pbf_begin_step(world, 1));
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_BUSY,
               "world 2: steps that pbf_begin_step");
  assert_ok(pbf_end_step(world));
  assert_ok(pbf_batch_step(batch, NULL, 1));
  pbf_batch_destroy(batch);
  assert_fails(pbf_step(world, 1), PBF_ERROR_INVALID_ARGUMENT, "pbf_destroy has taken back");
  assert_int_equal(test_count.live_blocks, 0);
}

/* What serves instead of a named backend serves all worlds, without the device of that one. */
static void all_worlds_fall_back(void **state) {
  (void)state;
  pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = NULL;
  pbf_solver *alone = NULL;
  pbf_info one = {.struct_size = sizeof one}, last = one;
  desc.backend = "cuda";
  desc.strict = 0;
  desc.device = 99;
  if (pbf_create(&desc, NULL, &alone) != PBF_OK) test_skip(pbf_last_error());
  assert_ok(pbf_get_info(alone, &one));
  assert_true(one.fell_back);
  pbf_destroy(alone);
  assert_ok(pbf_batch_create(&desc, NULL, WORLDS, &batch));
  assert_ok(pbf_get_info(world_of(batch, WORLDS - 1), &last));
  assert_string_equal(last.backend, one.backend);
  pbf_batch_destroy(batch);
}

/* Whatever call of the allocator gets nothing. */
static void memory_may_run_out(void **state) {
  (void)state;
  pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = NULL;
  pbf_status status = PBF_ERROR_OUT_OF_MEMORY;
  for (uint64_t k = 1; status != PBF_OK && k < 1000; ++k) {
    test_count.calls = 0;
    test_count.failing_call = k;
    status = pbf_batch_create(&desc, NULL, 2, &batch);
    test_count.failing_call = 0;
    if (status == PBF_OK) break;
    assert_int_equal(status, PBF_ERROR_OUT_OF_MEMORY);
    assert_int_equal(test_count.live_blocks, 0);
    assert_null(batch);
  }
  assert_int_equal(status, PBF_OK);
  pbf_batch_destroy(batch);
  assert_int_equal(test_count.live_blocks, 0);
}

static void a_thousand_batches_leave_nothing(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  const uint32_t counts[3] = {1, 1, 1};
  const float x[3][3] = {{0.5F, 0.5F, 0.5F}, {0.4F, 0.5F, 0.5F}, {0.3F, 0.5F, 0.5F}};
  for (int round = 0; round < 1000; ++round) {
    pbf_batch *batch = batch_of(&desc, 3);
    assert_ok(pbf_batch_add_particles(batch, counts, x, NULL));
    assert_ok(pbf_batch_set_start(batch, NULL, NULL, 0));
    assert_ok(pbf_batch_step(batch, NULL, 1));
    assert_ok(pbf_batch_reset(batch, NULL));
    pbf_batch_destroy(batch);
    assert_int_equal(test_count.live_blocks, 0);
  }
}

/* A child of a fork has none of the threads, and starts its own. */
static void a_child_goes_on(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("ThreadSanitizer has no threads in a child of threads");
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 3);
  pbf_batch *batch = furnished(&desc), *unused = furnished(&desc);
  if (threads_of(batch) == UINT32_MAX) test_skip("a device is its parent's");
  assert_ok(pbf_batch_step(batch, NULL, STEPS));
  assert_ok(pbf_batch_step(unused, NULL, 1));
  const pid_t child = fork();
  if (child == 0) {
    alarm(100);
    pbf_batch_destroy(unused);
    int same = pbf_batch_step(batch, NULL, STEPS) == PBF_OK;
    for (uint32_t k = 0; k < WORLDS; ++k)
      same = same && test_hash(world_of(batch, k)) == hash_alone(&desc, k, 2 * STEPS);
    pbf_batch_destroy(batch);
    _exit(same ? 0 : 1);
  }
  int how = -1;
  assert_int_equal(waitpid(child, &how, 0), child);
  assert_int_equal(how, 0);
  assert_ok(pbf_batch_step(batch, NULL, 1));
  pbf_batch_destroy(batch);
  pbf_batch_destroy(unused);
}

/* ---- From inside a step, where the stub lets the test in ----------------------------------------
 */

typedef struct visitor {
  pbf_batch *batch;
  pbf_status step, world;
  int named;
} visitor;

static void visit(void *user) {
  visitor *v = user;
  pbf_solver *world = NULL;
  v->step = pbf_batch_step(v->batch, NULL, 1);
  v->named = strstr(pbf_last_error(), "another call is inside this batch") != NULL;
  v->world = pbf_batch_get_world(v->batch, 0, &world);
}

static void destroy(void *user) { pbf_batch_destroy(((visitor *)user)->batch); }

static void a_second_call_is_refused(void **state) {
  (void)state;
  if (!test_is_stub()) return;
  ballistic_control *control = test_stub_control();
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc);
  visitor v = {.batch = batch};
  control->user = &v;
  control->inside_step = visit;
  assert_ok(pbf_batch_step(batch, NULL, 1));
  assert_int_equal(v.step, PBF_ERROR_BUSY);
  assert_int_equal(v.world, PBF_ERROR_BUSY);
  assert_true(v.named);
  control->inside_step = destroy;
  assert_ok(pbf_batch_step(batch, NULL, 1));
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "taken back");
  assert_int_equal(test_count.live_blocks, 0);
  test_stub_control();
}

/* With as many threads as worlds each waits a while for all the others: they are at once. */
static _Atomic uint32_t inside;

static void wait_for_all(void *user) {
  const struct timespec nap = {0, 1000000};
  (void)user;
  atomic_fetch_add(&inside, 1);
  for (int k = 0; k < 10000 && atomic_load(&inside) < WORLDS; ++k) nanosleep(&nap, NULL);
  if (atomic_load(&inside) < WORLDS) atomic_store(&inside, 2 * WORLDS); /* the others go, too */
}

static void worlds_are_stepped_at_once(void **state) {
  (void)state;
  if (!test_is_stub()) return;
  ballistic_control *control = test_stub_control();
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, WORLDS);
  pbf_batch *batch = furnished(&desc);
  control->inside_step = wait_for_all;
  assert_ok(pbf_batch_step(batch, NULL, 1));
  assert_int_equal(atomic_load(&inside), WORLDS);
  test_stub_control();
  pbf_batch_destroy(batch);
}

static void backends_are_told_of_worlds(void **state) {
  (void)state;
  if (!test_is_stub()) return;
  ballistic_control *control = test_stub_control();
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch_destroy(batch_of(&desc, WORLDS));
  assert_int_equal(control->worlds, WORLDS);
  pbf_destroy(test_create(&desc, NULL));
  assert_int_equal(control->worlds, 0);
}

static void fields_stay_where_the_backend_has_them(void **state) {
  (void)state;
  enum { ROWS = COUNT + 2 };
  if (!test_is_stub()) return;
  ballistic_control *control = test_stub_control();
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc);
  static float expected[WORLDS][ROWS][3];
  DLManagedTensor *x = NULL, *none = NULL;
  const pbf_read_desc read = {
      .struct_size = sizeof read, .field = PBF_FIELD_POSITION, .count = ROWS, .data = expected};
  assert_ok(pbf_batch_step(batch, NULL, 3));
  assert_ok(pbf_batch_read(batch, NULL, &read, 0));
  assert_ok(pbf_batch_export_dlpack(batch, PBF_FIELD_POSITION, ROWS, &x));
  assert_int_equal(control->arrays, 1);
  assert_int_equal(x->dl_tensor.shape[1], ROWS);
  for (int failing = 1; failing <= WORLDS + 1; ++failing) {
    control->calls_until_failure = failing;
    control->failure_status = PBF_ERROR_DEVICE;
    assert_fails(pbf_batch_export_dlpack(batch, PBF_FIELD_VELOCITY, ROWS, &none), PBF_ERROR_DEVICE,
                 failing > 1 ? "world " : "the test ordered");
    assert_null(none);
    assert_int_equal(control->arrays, 1);
  }
  pbf_batch_destroy(batch);
  assert_memory_equal(x->dl_tensor.data, expected, sizeof expected);
  x->deleter(x);
  assert_int_equal(control->arrays, 0);
  assert_int_equal(test_count.live_blocks, 0);
}

/* A thread that is cancelled in a call ends after it: with asynchronous cancellation, at once. */
static void *step_and_be_cancelled(void *user) {
  visitor *v = user;
  pthread_setcanceltype(PTHREAD_CANCEL_ASYNCHRONOUS, NULL);
  v->step = pbf_batch_step(v->batch, NULL, 1);
  pthread_testcancel();
  v->named = 1;
  return NULL;
}

static void cancel_caller(void *user) { pthread_cancel(*(pthread_t *)user); }

static void a_call_is_done_before_its_thread_is_cancelled(void **state) {
  (void)state;
  if (!test_is_stub() || TEST_INSTRUMENTED) return;
  ballistic_control *control = test_stub_control();
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  visitor v = {.batch = furnished(&desc), .step = PBF_ERROR_STATE};
  static pthread_t caller;
  control->user = &caller;
  control->inside_step = cancel_caller;
  assert_int_equal(pthread_create(&caller, NULL, step_and_be_cancelled, &v), 0);
  assert_int_equal(pthread_join(caller, NULL), 0);
  test_stub_control();
  assert_int_equal(v.named, 0);
  assert_ok(pbf_batch_step(v.batch, NULL, 1));
  for (uint32_t k = 0; k < WORLDS; ++k) {
    pbf_info info = {.struct_size = sizeof info};
    assert_ok(pbf_get_info(world_of(v.batch, k), &info));
    assert_int_equal(info.step, 2);
  }
  pbf_batch_destroy(v.batch);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bits_are_those_of_a_world_alone),
      cmocka_unit_test(a_mask_chooses_worlds),
      cmocka_unit_test(the_task_system_steps_worlds),
      cmocka_unit_test(reset_worlds_go_the_same_way),
      cmocka_unit_test(one_start_serves_all_worlds),
      cmocka_unit_test(colliders_go_to_targets),
      cmocka_unit_test(gravity_is_each_worlds_own),
      cmocka_unit_test(emitters_add_to_their_worlds),
      cmocka_unit_test(colliders_are_set_in_all_chosen),
      cmocka_unit_test(rows_are_those_of_the_worlds),
      cmocka_unit_test(gaps_stay),
      cmocka_unit_test(tensors_hold_what_was),
      cmocka_unit_test(others_go_on),
      cmocka_unit_test(mistakes_have_sentences),
      cmocka_unit_test(wrong_actions_have_sentences),
      cmocka_unit_test(wrong_observations_have_sentences),
      cmocka_unit_test(worlds_are_the_batchs),
      cmocka_unit_test(all_worlds_fall_back),
      cmocka_unit_test(memory_may_run_out),
      cmocka_unit_test(a_thousand_batches_leave_nothing),
      cmocka_unit_test(a_child_goes_on),
      cmocka_unit_test(a_second_call_is_refused),
      cmocka_unit_test(worlds_are_stepped_at_once),
      cmocka_unit_test(backends_are_told_of_worlds),
      cmocka_unit_test(fields_stay_where_the_backend_has_them),
      cmocka_unit_test(a_call_is_done_before_its_thread_is_cancelled),
  };
  return TEST_RUN(tests);
}
