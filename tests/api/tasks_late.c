/* Task systems that do not keep to desc.h: items that run after their task has ended, and waits
 * that end before the task has. Neither may touch what is there no more, or change a result. */
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "batch_scene.h"

/* ---- Items that come after the call -----------------------------------------------------------
 */

enum { MOST_TASKS = 64 };

static struct {
  pbf_task_fn run;
  void *task;
  uint32_t items;
} kept[MOST_TASKS];
static uint32_t kept_count;

static void *keep(void *user, pbf_task_fn run, void *task, uint32_t items, uint32_t min_range) {
  (void)user, (void)min_range;
  assert_true(kept_count < MOST_TASKS);
  kept[kept_count].run = run;
  kept[kept_count].task = task;
  kept[kept_count].items = items;
  return &kept[kept_count++];
}

static void wait_for_nothing(void *user, void *handle) { (void)user, (void)handle; }

/* Where the call was, numbers that get smaller. */
static void overwrite_stack(void) {
  volatile uint32_t below[32 << 10];
  for (uint32_t k = 0; k < sizeof below / sizeof *below; ++k) below[k] = UINT32_MAX / 2 - k;
}

static void run_all_kept(void) {
  overwrite_stack();
  for (uint32_t k = 0; k < kept_count; ++k) kept[k].run(kept[k].task, 0, kept[k].items);
}

static pbf_desc desc_of_tasks(pbf_enqueue_task_fn enqueue, pbf_finish_task_fn finish) {
  pbf_desc desc = desc_for(3, PBF_FLOAT32, 4);
  desc.enqueue_task = enqueue;
  desc.finish_task = finish;
  return desc;
}

static void after_a_solvers_call(void **state) {
  (void)state;
  const pbf_desc desc = desc_of_tasks(keep, wait_for_nothing);
  pbf_desc alone = desc_for(3, PBF_FLOAT32, 1);
  pbf_solver *solver = NULL;
  const pbf_status status = pbf_create(&desc, NULL, &solver);
  if (status == PBF_ERROR_UNAVAILABLE) test_skip(pbf_last_error()); /* "openmp" takes none */
  assert_ok(status);
  kept_count = 0;
  furnish(solver, &desc, 0);
  for (int k = 0; k < STEPS; ++k) {
    assert_ok(pbf_step(solver, 1));
    run_all_kept();
  }
  assert_true(test_hash(solver) == hash_alone(&alone, 0, STEPS));
  pbf_destroy(solver);
  run_all_kept();
}

/* Worlds of a device have no tasks: the caller's thread alone feeds them. */
static int is_of_cpu(pbf_batch *batch) {
  pbf_batch_info info = {.struct_size = sizeof info};
  assert_ok(pbf_batch_get_info(batch, &info));
  return info.device_type == PBF_DEVICE_CPU;
}

static void after_a_batchs_call(void **state) {
  (void)state;
  const pbf_desc desc = desc_of_tasks(keep, wait_for_nothing);
  pbf_desc alone = desc_for(3, PBF_FLOAT32, 1);
  kept_count = 0;
  pbf_batch *batch = furnished(&desc);
  assert_ok(pbf_batch_step(batch, NULL, STEPS));
  assert_int_equal(kept_count > 0, is_of_cpu(batch));
  run_all_kept();
  for (uint32_t k = 0; k < WORLDS; ++k)
    assert_true(test_hash(world_of(batch, k)) == hash_alone(&alone, k, STEPS));
  pbf_batch_destroy(batch);
  run_all_kept();
}

/* ---- A batch's call that was left ---------------------------------------------------------------
 */

static jmp_buf back;

static void *leave(void *user, pbf_task_fn run, void *task, uint32_t items, uint32_t min_range) {
  (void)user, (void)run, (void)task, (void)items, (void)min_range;
  longjmp(back, 1);
}

/* A batch forbids it (batch.h), and is lost by it; others are not. */
static void leave_a_batch(void) {
  const pbf_desc desc = desc_of_tasks(leave, wait_for_nothing);
  pbf_batch *lost = furnished(&desc);
  if (setjmp(back) == 0) pbf_batch_step(lost, NULL, 1);
}

static void after_a_batch_was_left(void **state) {
  leave_a_batch();
  overwrite_stack();
  after_a_batchs_call(state);
}

/* ---- Waits that end before the task -----------------------------------------------------------
 */

/* A batch of two worlds: a worker steps the first one, and the caller the other. */
typedef struct early {
  pbf_solver *worlds[2];
  pthread_t worker, canceller;
  pbf_task_fn run;
  void *task;
  atomic_int has_finished, has_returned;
} early;

static void pause_ms(long milliseconds) {
  nanosleep(&(struct timespec){.tv_nsec = milliseconds * 1000000}, NULL);
}

static void *run_item(void *user) {
  early *it = user;
  it->run(it->task, 0, 1);
  return NULL;
}

/* Ends the caller's world, and the worker's once the caller no longer waits for it by the task
 * system. */
static void *cancel_in_turn(void *user) {
  early *it = user;
  while (!atomic_load(&it->has_finished)) {
    pbf_cancel(it->worlds[1]);
    pause_ms(1);
  }
  pause_ms(50);
  while (!atomic_load(&it->has_returned)) {
    pbf_cancel(it->worlds[0]);
    pause_ms(1);
  }
  return NULL;
}

static int is_busy(pbf_solver *world) {
  uint32_t count;
  return pbf_get_count(world, &count) == PBF_ERROR_BUSY;
}

static void *begin_in_a_worker(void *user, pbf_task_fn run, void *task, uint32_t items,
                               uint32_t min_range) {
  early *it = user;
  (void)items, (void)min_range;
  it->run = run;
  it->task = task;
  pthread_create(&it->worker, NULL, run_item, it);
  while (!is_busy(it->worlds[0])) pause_ms(1);
  pthread_create(&it->canceller, NULL, cancel_in_turn, it);
  return it;
}

static void finish_too_soon(void *user, void *handle) {
  (void)handle;
  atomic_store(&((early *)user)->has_finished, 1);
}

static void before_the_worker_has_ended(void **state) {
  (void)state;
  early it = {.run = NULL};
  pbf_desc desc = desc_of_tasks(begin_in_a_worker, finish_too_soon);
  pbf_status statuses[2];
  desc.task_user = &it;
  pbf_batch *batch = batch_of(&desc, 2);
  if (!is_of_cpu(batch)) {
    pbf_batch_destroy(batch);
    test_skip("worlds of a device have no tasks");
  }
  for (uint32_t k = 0; k < 2; ++k) {
    it.worlds[k] = world_of(batch, k);
    furnish(it.worlds[k], &desc, k);
  }
  const pbf_status status = pbf_batch_step(batch, NULL, UINT32_MAX);
  const int one_is_inside = is_busy(it.worlds[0]);
  atomic_store(&it.has_returned, 1);
  assert_false(one_is_inside);
  assert_int_equal(status, PBF_ERROR_CANCELLED);
  assert_ok(pbf_batch_get_statuses(batch, statuses));
  for (uint32_t k = 0; k < 2; ++k) assert_int_equal(statuses[k], PBF_ERROR_CANCELLED);
  pthread_join(it.worker, NULL);
  pthread_join(it.canceller, NULL);
  pbf_batch_destroy(batch);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(after_a_solvers_call),
      cmocka_unit_test(after_a_batchs_call),
      cmocka_unit_test(before_the_worker_has_ended),
      cmocka_unit_test(after_a_batch_was_left),
  };
  return TEST_RUN(tests);
}
