/* A long call of pbf_step that another thread cancels: it ends between two steps, and what it has
 * done stands. */
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "support.h"

enum { COUNT = 60, CAPACITY = 64, FOREVER = 2000000000 };

static uint64_t steps_of(pbf_solver *s) {
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  return info.step;
}

/* Cancels until the call has ended: one that has not begun is not meant. The first time not before
 * the calling thread has worked for some time: where processors are busy, it has had little of what
 * has gone by. */
typedef struct canceller {
  pbf_solver *solver;
  clockid_t clock;    /* of that thread */
  double begin, time; /* seconds of it */
  atomic_int over, wrong;
} canceller;

static double seconds_of(clockid_t clock) {
  struct timespec now = {0, 0};
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void *cancel(void *user) {
  enum { LONGEST = 60 }; /* seconds, should it sleep */
  canceller *c = user;
  const struct timespec nap = {0, 1000000};
  const double begin = seconds_of(CLOCK_MONOTONIC);
  while (!atomic_load(&c->over)) {
    nanosleep(&nap, NULL);
    if (seconds_of(c->clock) - c->begin < c->time && seconds_of(CLOCK_MONOTONIC) - begin < LONGEST)
      continue;
    if (pbf_cancel(c->solver) != PBF_OK) atomic_fetch_add(&c->wrong, 1);
  }
  return NULL;
}

static void step_until_cancelled(pbf_solver *s, double time) {
  canceller c = {.solver = s, .time = time};
  pthread_t thread;
  assert_int_equal(pthread_getcpuclockid(pthread_self(), &c.clock), 0);
  c.begin = seconds_of(c.clock);
  assert_int_equal(pthread_create(&thread, NULL, cancel, &c), 0);
  pbf_status status = pbf_step(s, FOREVER);
  atomic_store(&c.over, 1);
  assert_int_equal(pthread_join(thread, NULL), 0);
  assert_int_equal(status, PBF_ERROR_CANCELLED);
  assert_non_null(strstr(pbf_last_error(), "of 2000000000 steps"));
  assert_int_equal(atomic_load(&c.wrong), 0);
}

static void check_cancelled(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_filled(dimension, precision, COUNT, CAPACITY);
  pbf_solver *other = test_filled(dimension, precision, COUNT, CAPACITY);
  step_until_cancelled(s, 0.002);
  const uint64_t done = steps_of(s);
  assert_true(done < FOREVER);
  assert_ok(pbf_step(other, (uint32_t)done));
  assert_true(test_hash(s) == test_hash(other));
  assert_ok(pbf_step(s, 3)); /* the next call is not cancelled */
  assert_ok(pbf_step(other, 3));
  assert_true(test_hash(s) == test_hash(other));
  assert_int_equal(steps_of(s), done + 3);
  pbf_destroy(s);
  pbf_destroy(other);
}

static void steps_done_stand(void **state) {
  (void)state;
  test_for_long_kinds(check_cancelled);
}

static void parts_of_steps_are_completed(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_params params = test_params();
  params.time_step = 1.0 / 20;
  params.max_substeps = 8;
  assert_ok(pbf_set_params(s, &params));
  step_until_cancelled(s, 0.002);
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  assert_true(fabs(info.time - (double)info.step * params.time_step) < 1e-9 * info.time + 1e-12);
  pbf_destroy(s);
}

/* Of a call that is cancelled there is a snapshot, and no step before the last one is known. */
static void readers_see_what_was_done(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_snapshot snapshot = {.struct_size = sizeof snapshot};
  float now[3 * COUNT], before[3 * COUNT];
  assert_ok(pbf_set_snapshots(s, 2));
  assert_ok(pbf_keep_previous(s, 1));
  assert_ok(pbf_step(s, 2));
  step_until_cancelled(s, 0.002);
  assert_ok(pbf_acquire_snapshot(s, &snapshot));
  assert_int_equal(snapshot.step, steps_of(s));
  assert_ok(pbf_get_positions(s, 0, COUNT, now));
  assert_memory_equal(snapshot.positions, now, sizeof now);
  assert_ok(pbf_release_snapshot(&snapshot));
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = PBF_FIELD_POSITION,
                              .count = COUNT,
                              .behind = 1,
                              .data = before};
  assert_ok(pbf_read(s, &read));
  assert_memory_equal(before, now, sizeof now);
  pbf_destroy(s);
}

/* Before a call nothing is to be cancelled; while one is inside, its next step does not begin. */
static void cancel_inside(void *user) { assert_ok(pbf_cancel(user)); }

static void which_call_is_meant(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  assert_ok(pbf_cancel(s));
  assert_ok(pbf_step(s, 5));
  assert_int_equal(steps_of(s), 5);
  if (test_is_stub()) {
    ballistic_control *control = test_stub_control();
    pbf_params params = test_params();
    params.iterations = UINT32_MAX; /* so long that steps go one by one */
    assert_ok(pbf_set_params(s, &params));
    control->inside_step = cancel_inside;
    control->user = s;
    assert_fails(pbf_step(s, 5), PBF_ERROR_CANCELLED, "after 1 of 5 steps");
    assert_ok(pbf_step(s, 1)); /* which had no other step left */
    test_stub_control();
    assert_int_equal(steps_of(s), 7);
  }
  pbf_destroy(s);
  assert_fails(pbf_cancel(s), PBF_ERROR_INVALID_ARGUMENT, "has taken back");
  assert_fails(pbf_cancel(NULL), PBF_ERROR_INVALID_ARGUMENT, "solver is null");
}

/* Where something moves each step is looked at before it is made. It is not all of them that are:
 * that would take many seconds. The first steps take their time on an emulated processor. */
static void check_far_ahead(pbf_solver *s) {
  const uint64_t before = steps_of(s);
  for (double time = 0.002; steps_of(s) == before && time < 0.6; time *= 256)
    step_until_cancelled(s, time);
  assert_true(steps_of(s) > before);
  pbf_destroy(s);
}

static void long_calls_begin_at_once(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_params params = test_params();
  params.wall_amplitude[PBF_WALL_X_MIN] = 0.01;
  params.wall_frequency[PBF_WALL_X_MIN] = 1;
  assert_ok(pbf_set_params(s, &params));
  check_far_ahead(s);
  s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.01;
  ball.velocity[0] = 1e32; /* it can be placed for a million steps of all */
  assert_ok(pbf_set_colliders(s, 1, &ball));
  check_far_ahead(s);
}

/* Particles do not tell how long a step takes. */
typedef struct slow_steps {
  pbf_solver *solver;
  uint32_t made;
} slow_steps;

static void be_slow(void *user) {
  slow_steps *slow = user;
  const struct timespec nap = {0, 3000000};
  nanosleep(&nap, NULL);
  if (++slow->made == 20) assert_ok(pbf_cancel(slow->solver));
}

static void slow_steps_are_few_at_once(void **state) {
  (void)state;
  if (!test_is_stub()) test_skip("of the stub's steps one knows how long they take");
  pbf_solver *s = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  slow_steps slow = {.solver = s};
  ballistic_control *control = test_stub_control();
  control->inside_step = be_slow;
  control->user = &slow;
  assert_int_equal(pbf_step(s, 200), PBF_ERROR_CANCELLED);
  test_stub_control();
  assert_in_range(steps_of(s), 20, 32);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_done_stand),          cmocka_unit_test(parts_of_steps_are_completed),
      cmocka_unit_test(readers_see_what_was_done), cmocka_unit_test(which_call_is_meant),
      cmocka_unit_test(long_calls_begin_at_once),  cmocka_unit_test(slow_steps_are_few_at_once),
  };
  return TEST_RUN(tests);
}
