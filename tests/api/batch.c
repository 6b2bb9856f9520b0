/* Many worlds in one call: each as it would be alone. */
#include <dlpack/dlpack.h>
#include <pbf/batch.h>
#include <pthread.h>

#include "batch_scene.h"

/* ---- Worlds alone and in a batch --------------------------------------------------------------
 */

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
  };
  return TEST_RUN(tests);
}
