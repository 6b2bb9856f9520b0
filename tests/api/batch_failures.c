/* Batches of which something fails, is refused, is cancelled or ends. */
#include <dlpack/dlpack.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "batch_scene.h"

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

static void finish_nothing(void *user, void *handle) { (void)user, (void)handle; }

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
  bad.finish_task = finish_nothing;
  assert_fails(pbf_batch_create(&bad, NULL, 2, &batch), PBF_ERROR_INVALID_ARGUMENT,
               "desc.enqueue_task is null");
  assert_null(batch);
  assert_int_equal(test_count.live_blocks, 0);
  assert_fails(pbf_batch_step(NULL, NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "batch is null");
  batch = furnished(&desc);
  pbf_batch_info info = {.struct_size = 3};
  assert_fails(pbf_batch_get_info(batch, NULL), PBF_ERROR_INVALID_ARGUMENT, "info is null");
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
  pbf_batch_destroy(batch);
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_INVALID_ARGUMENT,
               "which pbf_batch_create did not give or pbf_batch_destroy has taken back");
  pbf_batch_destroy(batch);
  pbf_batch_destroy(NULL);
}

/* A start is lost neither by what is no state nor by a size that no memory has. */
static void starts_outlive_what_is_no_state(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 2), flat = desc_for(2, PBF_FLOAT32, 1);
  pbf_batch *batch = furnished(&desc), *other = furnished(&flat);
  const uint64_t before = test_hash(world_of(batch, 3));
  uint64_t size = 0, flat_size = 0;
  assert_ok(pbf_save(world_of(batch, 3), NULL, &size));
  assert_ok(pbf_save(world_of(other, 3), NULL, &flat_size));
  char *saved = malloc(size), *plane = malloc(flat_size);
  assert_ok(pbf_save(world_of(batch, 3), saved, &size));
  assert_ok(pbf_save(world_of(other, 3), plane, &flat_size));
  assert_ok(pbf_batch_set_start(batch, NULL, saved, size));
  assert_ok(pbf_batch_step(batch, NULL, 2));
  assert_fails(pbf_batch_set_start(batch, NULL, "no state", 8), PBF_ERROR_DATA, "is cut short");
  assert_fails(pbf_batch_set_start(batch, NULL, saved, 0), PBF_ERROR_DATA, "is cut short");
  assert_fails(pbf_batch_set_start(batch, NULL, saved, size - 1), PBF_ERROR_DATA, "is cut short");
  assert_fails(pbf_batch_set_start(batch, NULL, saved, UINT64_MAX), PBF_ERROR_DATA, "is cut short");
  assert_fails(pbf_batch_set_start(batch, NULL, plane, flat_size), PBF_ERROR_DATA,
               "the saved state is 2D");
  saved[size / 2] ^= 1;
  assert_fails(pbf_batch_set_start(batch, NULL, saved, size), PBF_ERROR_DATA, "is damaged");
  assert_ok(pbf_batch_reset(batch, NULL));
  for (uint32_t k = 0; k < WORLDS; ++k) assert_true(test_hash(world_of(batch, k)) == before);
  free(saved);
  free(plane);
  pbf_batch_destroy(other);
  pbf_batch_destroy(batch);
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
               PBF_ERROR_INVALID_ARGUMENT, "world 2: targets[0].position[0] is NaN");
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

/* What a world lacks is written as 0: by a layout that is checked before. */
static void rows_that_worlds_lack_are_checked(void **state) {
  (void)state;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_batch *batch = batch_of(&desc, WORLDS);
  float x[WORLDS][2][3];
  memset(x, 0x7f, sizeof x);
  pbf_read_desc read = {
      .struct_size = sizeof read, .field = PBF_FIELD_POSITION, .count = 2, .data = x};
  static const uint64_t strides[] = {4, 14, UINT64_C(1) << 33, UINT64_C(1) << 63};
  for (int k = 0; k < 4; ++k) {
    read.stride = strides[k];
    assert_fails(pbf_batch_read(batch, NULL, &read, 0), PBF_ERROR_INVALID_ARGUMENT,
                 "read.stride is ");
  }
  read.stride = 0;
  assert_fails(pbf_batch_read(batch, NULL, &read, UINT64_C(1) << 61), PBF_ERROR_INVALID_ARGUMENT,
               "world_stride is 2305843009213693952; it must be a multiple of 4 from 24 up to "
               "281474976710656");
  for (uint32_t k = 0; k < WORLDS; ++k) assert_true(x[k][1][2] > 1e38F);
  assert_ok(pbf_batch_read(batch, NULL, &read, 0));
  for (uint32_t k = 0; k < WORLDS; ++k) assert_true(x[k][1][2] == 0);
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

typedef struct owner {
  pbf_batch *_Atomic batch;
  atomic_uint logs;
  atomic_uint logs_after; /* that began once the batch was destroyed */
  atomic_bool destroyed;
} owner;

static void destroy_it(void *user, int32_t level, const char *message) {
  owner *own = user;
  (void)level, (void)message;
  if (own->destroyed) atomic_fetch_add(&own->logs_after, 1);
  atomic_fetch_add(&own->logs, 1);
  pbf_batch *batch = atomic_exchange(&own->batch, NULL);
  pbf_batch_destroy(batch);
  if (batch) own->destroyed = true;
}

/* Each world's step is too long for two causes, each of which it would log. */
static void a_log_destroys(uint32_t threads) {
  pbf_desc desc = desc_for(3, PBF_FLOAT32, threads);
  owner own = {NULL, 0, 0, false};
  desc.log = destroy_it, desc.log_user = &own;
  pbf_batch *batch = furnished(&desc);
  pbf_params params = test_params();
  params.time_step = 1;
  params.attraction = 20;
  for (uint32_t k = 0; k < WORLDS; ++k) assert_ok(pbf_set_params(world_of(batch, k), &params));
  own.logs = 0;
  own.batch = batch;
  assert_ok(pbf_batch_step(batch, NULL, 2));
  assert_true(own.destroyed);
  if (threads == 1) assert_int_equal(own.logs, 1);
  /* Each other thread may be on its way into one of its own. */
  assert_in_range(own.logs_after, 0, threads - 1);
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "has taken back");
  assert_int_equal(test_count.live_blocks, 0);
}

static void a_batch_is_destroyed_in_its_log(void **state) {
  (void)state;
  a_log_destroys(1);
  a_log_destroys(3);
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
  for (int k = 0; k < 100000 && atomic_load(&inside) < WORLDS; ++k) nanosleep(&nap, NULL);
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

/* A backend that steps worlds together only notes their steps, until all are known. */
static void worlds_step_together(void **state) {
  (void)state;
  if (!test_is_stub()) return;
  const uint8_t mask[WORLDS] = {1, 0, 1, 1};
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  uint64_t alone[WORLDS];
  for (uint32_t k = 0; k < WORLDS; ++k) alone[k] = hash_alone(&desc, k, mask[k] ? 7 : 4);
  ballistic_control *control = test_stub_control();
  control->steps_together = 1;
  pbf_batch *batch = furnished(&desc);
  assert_ok(pbf_batch_step(batch, NULL, 3));
  assert_int_equal(control->runs, 1);
  assert_int_equal(control->run_worlds, WORLDS);
  assert_ok(pbf_batch_step(batch, mask, 3));
  assert_int_equal(control->runs, 2);
  assert_int_equal(control->run_worlds, 3);
  for (uint32_t k = 0; k < WORLDS; ++k) assert_ok(pbf_step(world_of(batch, k), 1));
  assert_int_equal(control->runs, 2);
  for (uint32_t k = 0; k < WORLDS; ++k) assert_true(test_hash(world_of(batch, k)) == alone[k]);
  pbf_batch_destroy(batch);
  assert_int_equal(test_count.live_blocks, 0);
  test_stub_control();
}

static void what_fails_together_fails_in_all(void **state) {
  (void)state;
  if (!test_is_stub()) return;
  const pbf_desc desc = desc_for(3, PBF_FLOAT32, 1);
  pbf_status statuses[WORLDS];
  ballistic_control *control = test_stub_control();
  control->steps_together = 1;
  pbf_batch *batch = furnished(&desc);
  control->failure_status = PBF_ERROR_DEVICE;
  control->calls_until_failure = 2; /* a world's step */
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_DEVICE, "world 1: the test ordered");
  assert_ok(pbf_batch_get_statuses(batch, statuses));
  for (uint32_t k = 0; k < WORLDS; ++k)
    assert_int_equal(statuses[k], k == 1 ? PBF_ERROR_DEVICE : PBF_OK);
  control->calls_until_failure = WORLDS + 1; /* the run */
  assert_fails(pbf_batch_step(batch, NULL, 1), PBF_ERROR_DEVICE, "the test ordered");
  assert_ok(pbf_batch_get_statuses(batch, statuses));
  for (uint32_t k = 0; k < WORLDS; ++k) assert_int_equal(statuses[k], PBF_ERROR_DEVICE);
  assert_ok(pbf_batch_step(batch, NULL, 1));
  pbf_batch_destroy(batch);
  assert_int_equal(test_count.live_blocks, 0);
  test_stub_control();
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
      cmocka_unit_test(others_go_on),
      cmocka_unit_test(mistakes_have_sentences),
      cmocka_unit_test(starts_outlive_what_is_no_state),
      cmocka_unit_test(wrong_actions_have_sentences),
      cmocka_unit_test(rows_that_worlds_lack_are_checked),
      cmocka_unit_test(wrong_observations_have_sentences),
      cmocka_unit_test(worlds_are_the_batchs),
      cmocka_unit_test(a_batch_is_destroyed_in_its_log),
      cmocka_unit_test(all_worlds_fall_back),
      cmocka_unit_test(memory_may_run_out),
      cmocka_unit_test(a_thousand_batches_leave_nothing),
      cmocka_unit_test(a_child_goes_on),
      cmocka_unit_test(a_second_call_is_refused),
      cmocka_unit_test(worlds_are_stepped_at_once),
      cmocka_unit_test(backends_are_told_of_worlds),
      cmocka_unit_test(worlds_step_together),
      cmocka_unit_test(what_fails_together_fails_in_all),
      cmocka_unit_test(fields_stay_where_the_backend_has_them),
      cmocka_unit_test(a_call_is_done_before_its_thread_is_cancelled),
  };
  return TEST_RUN(tests);
}
