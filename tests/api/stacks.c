/* Threads with as little stack as pbf.h asks for, from the search for backends on. */
#define _GNU_SOURCE /* pthread_setattr_default_np */
#include <pthread.h>
#include <stdio.h>

#include "support.h"

enum { STACK = 64 << 10, COUNT = 400 };

static pbf_status worst;

static void note(pbf_status status) {
  if (status != PBF_OK && worst == PBF_OK) worst = status;
}

static void use_all(pbf_solver *s, pbf_params *params) {
  pbf_collider ball;
  pbf_stats stats = {.struct_size = sizeof stats};
  static float x[3 * COUNT];
  uint64_t size = 0;
  static unsigned char saved[1 << 18];
  for (uint32_t i = 0; i < COUNT; ++i) {
    x[3 * i] = 0.1f + 0.05f * (float)(i % 16);
    x[3 * i + 1] = 0.1f + 0.05f * (float)(i / 16 % 5);
    x[3 * i + 2] = 0.1f + 0.05f * (float)(i / 80);
  }
  note(pbf_add_particles(s, COUNT, x, NULL, NULL));
  note(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_BOX));
  ball.half_extents[0] = ball.half_extents[1] = ball.half_extents[2] = 0.1;
  ball.velocity[0] = ball.angular_velocity[1] = 0.5;
  note(pbf_set_colliders(s, 1, &ball));
  note(pbf_step(s, 5));
  params->viscosity = params->vorticity = 0.01;
  params->damping_compensation = params->angular_momentum_correction = 1;
  params->tolerance = 1e-3;
  params->pressure_grid = 2;
  params->sleep_speed = params->sleep_time = 0.1;
  params->max_substeps = 4;
  note(pbf_set_params(s, params));
  note(pbf_step(s, 5));
  note(pbf_get_stats(s, &stats));
  note(pbf_get_pressures(s, 0, COUNT, x));
  size = sizeof saved;
  note(pbf_save(s, saved, &size));
  note(pbf_load(s, saved, size));
  note(pbf_step(s, 1));
  if (pbf_step(NULL, 1) != PBF_ERROR_INVALID_ARGUMENT) worst = PBF_ERROR_PLUGIN;
}

static void *use_little_stack(void *user) {
  pbf_desc desc;
  pbf_params params;
  pbf_solver *solver = NULL;
  note(pbf_desc_init(&desc, sizeof desc));
  note(pbf_params_init(&params, sizeof params));
  desc.capacity = COUNT;
  desc.threads = 2;
  desc.backend = user;
  desc.strict = 1;
  note(pbf_create(&desc, &params, &solver));
  if (solver) use_all(solver, &params);
  pbf_destroy(solver);
  return NULL;
}

/* Before anything else has loaded a backend. */
static int run_in_thread(void) {
  pthread_attr_t attributes;
  pthread_t thread;
  char *name = getenv("PBF_TEST_BACKEND");
  if (!name || strcmp(name, "ballistic") == 0 || strcmp(name, "cuda") == 0) return 0;
  if (pthread_attr_init(&attributes) || pthread_attr_setstacksize(&attributes, STACK)) return 0;
  int made = pthread_create(&thread, &attributes, use_little_stack, name) == 0;
  if (made) pthread_join(thread, NULL);
  pthread_attr_destroy(&attributes);
  return made;
}

static int was_run;

static void little_stack_will_do(void **state) {
  (void)state;
  if (!was_run) test_skip("for backends on a CPU, without a sanitizer");
  if (worst != PBF_ERROR_UNSUPPORTED) assert_int_equal(worst, PBF_OK);
}

#if defined(__GLIBC__)
static void *pass_gate(void *gate) {
  pthread_mutex_lock(gate);
  pthread_mutex_unlock(gate);
  return NULL;
}
#endif

/* In a program where threads have next to no stack unless they ask for more: the thread that
 * pbf_begin_step starts does. */
static void begun_steps_have_enough(void **state) {
  (void)state;
#if defined(__GLIBC__)
  enum { LITTLE = 16 << 10 };
  pthread_attr_t attributes, before;
  if (TEST_INSTRUMENTED) test_skip("a sanitizer's threads need more");
  assert_int_equal(pthread_getattr_default_np(&before), 0);
  assert_int_equal(pthread_attr_init(&attributes), 0);
  if (pthread_attr_setstacksize(&attributes, LITTLE) != 0) test_skip("threads need more here");
  pbf_params params = test_params();
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, COUNT, COUNT);
  pbf_solver *twin = test_filled(3, PBF_FLOAT32, COUNT, COUNT);
  params.loads = 1;
  if (!test_is_stub()) assert_ok(pbf_set_params(solver, &params));
  if (!test_is_stub()) assert_ok(pbf_set_params(twin, &params));
  /* It has the stack of the thread before, which the C library would give to the next one. */
  pthread_t other;
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&gate);
  pthread_attr_t as_before;
  assert_int_equal(pthread_attr_init(&as_before), 0);
  assert_int_equal(pthread_attr_setstacksize(&as_before, STACK), 0);
  assert_int_equal(pthread_create(&other, &as_before, pass_gate, &gate), 0);
  assert_int_equal(pthread_setattr_default_np(&attributes), 0);
  const pbf_status begun = pbf_begin_step(solver, 5);
  assert_int_equal(pthread_setattr_default_np(&before), 0);
  assert_ok(begun);
  assert_ok(pbf_end_step(solver));
  assert_ok(pbf_step(twin, 5));
  assert_int_equal(test_hash(solver), test_hash(twin));
  pbf_destroy(solver);
  pbf_destroy(twin);
  pthread_mutex_unlock(&gate);
  pthread_join(other, NULL);
  pthread_attr_destroy(&as_before);
  pthread_attr_destroy(&attributes);
  pthread_attr_destroy(&before);
#else
  test_skip("the C library has no such default");
#endif
}

int main(void) {
  const struct CMUnitTest stacks[] = {
      cmocka_unit_test(little_stack_will_do),
      cmocka_unit_test(begun_steps_have_enough),
  };
  was_run = !TEST_INSTRUMENTED && run_in_thread();
  return TEST_RUN(stacks);
}
