/* Calls that signal handlers make while others run, and calls that a longjmp leaves from within the
 * caller's functions. */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <sys/time.h>

#include <dlpack/dlpack.h>

#include "support.h"

/* ---- Signals ---- */

static pbf_solver *solver;
static pthread_t caller;
static volatile sig_atomic_t handled, refused, others;

/* A timer's signal is the process's: a thread of OpenMP's may take it, and is no call inside. */
static void call_from_handler(int number) {
  const int interrupted_errno = errno;
  (void)number;
  uint32_t count;
  if (!pthread_equal(pthread_self(), caller)) return;
  pbf_status status = pbf_get_count(solver, &count);
  ++handled;
  refused += status == PBF_ERROR_BUSY;
  others += status != PBF_ERROR_BUSY && status != PBF_OK;
  status = pbf_get_backend_count(&count);
  others += status != PBF_ERROR_BUSY && status != PBF_OK;
  errno = interrupted_errno; /* as a handler has to: what it calls may change it */
}

static void set_timer(int microseconds) {
  const struct itimerval timer = {{0, microseconds}, {0, microseconds}};
  assert_int_equal(setitimer(ITIMER_REAL, &timer, NULL), 0);
}

/* A handler that waited for what it has interrupted would wait for ever. */
static void handlers_never_wait(void **state) {
  (void)state;
  enum { ENOUGH = 300 };
  struct sigaction action = {.sa_handler = call_from_handler};
  uint32_t count = 0;
  pbf_backend_info info = {.struct_size = sizeof info};
  solver = test_filled(3, PBF_FLOAT32, 8, 8);
  caller = pthread_self();
  assert_int_equal(sigaction(SIGALRM, &action, NULL), 0);
  set_timer(200);
  while (handled < ENOUGH) {
    for (int i = 0; i < 100; ++i) {
      assert_ok(pbf_get_count(solver, &count));
      assert_int_equal(count, 8);
    }
    assert_ok(pbf_get_backend_info(NULL, 0, &info));
  }
  set_timer(0);
  assert_int_equal(others, 0);
  assert_true(refused > 0); /* half of the time a call is inside */
  pbf_destroy(solver);
}

/* ---- Longjmps ---- */

static jmp_buf back;
static int until_jump; /* calls of the allocator; 0: never */
static int log_jumps;

static void *allocate_or_jump(void *user, uint64_t size, uint64_t alignment) {
  if (until_jump && --until_jump == 0) longjmp(back, 1);
  return test_allocator.allocate(user, size, alignment);
}

static void release_or_jump(void *user, void *memory, uint64_t size, uint64_t alignment) {
  test_allocator.release(user, memory, size, alignment);
  if (until_jump && --until_jump == 0) longjmp(back, 1);
}

static void log_or_jump(void *user, int32_t level, const char *message) {
  (void)user, (void)level, (void)message;
  if (log_jumps) longjmp(back, 1);
}

static pbf_solver *make(void) {
  enum { COUNT = 8 };
  static pbf_allocator allocator;
  allocator =
      (pbf_allocator){sizeof allocator, 0, test_allocator.user, allocate_or_jump, release_or_jump};
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  desc.allocator = &allocator;
  desc.log = log_or_jump;
  pbf_solver *s = test_create(&desc, NULL);
  float *x = test_lattice(3, PBF_FLOAT32, COUNT);
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  free(x);
  return s;
}

/* A call that takes and gives back memory of the host's, and of some backends. */
static void call_that_allocates(pbf_solver *s, int which) {
  const uint32_t ids[2] = {1, 3};
  uint64_t hash;
  pbf_params params = test_params();
  pbf_collider ball;
  pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE);
  ball.radius = 0.1;
  params.viscosity = params.vorticity = 0.01;
  params.sleep_speed = params.sleep_time = 0.1;
  if (which == 0) pbf_remove_particles(s, 2, ids);
  if (which == 1) pbf_hash(s, &hash);
  if (which == 2) pbf_set_colliders(s, 1, &ball);
  if (which == 3) pbf_set_params(s, &params);
  DLManagedTensor *tensor = NULL;
  if (which == 4) pbf_export_dlpack(s, PBF_FIELD_POSITION, &tensor);
  until_jump = 0;
  if (tensor) tensor->deleter(tensor);
}

/* Frames between, so that what comes after has the place on the stack that what was left had. */
static __attribute__((noinline)) int use_deeper_stack(pbf_solver *s, int depth) {
  volatile char some[64] = {0};
  if (depth > 0) return use_deeper_stack(s, depth - 1) + some[0];
  uint32_t count;
  return pbf_get_count(s, &count);
}

static void assert_destroyable(pbf_solver *s) {
  assert_int_equal(use_deeper_stack(s, 100), PBF_ERROR_STATE); /* first: one call tells the next */
  assert_fails(pbf_step(s, 1), PBF_ERROR_STATE, "can only be destroyed");
  pbf_destroy(s);
  assert_fails(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT, "pbf_destroy");
  assert_int_equal(test_count.live_blocks, 0);
}

static void a_longjmp_leaves_a_call(void **state) {
  (void)state;
  volatile int left = 0;
  for (volatile int which = 0; which < 5; ++which) {
    for (volatile int nth = 1; nth < 20; ++nth) {
      pbf_solver *volatile s = make();
      until_jump = nth;
      if (setjmp(back) == 0) {
        call_that_allocates(s, which);
        until_jump = 0;
        pbf_destroy(s);
        assert_int_equal(test_count.live_blocks, 0);
        break;
      }
      ++left;
      assert_destroyable(s);
    }
  }
  assert_true(left >= 5);
}

static void a_longjmp_leaves_the_log(void **state) {
  (void)state;
  pbf_solver *volatile s = make();
  pbf_params params = test_params();
  params.time_step = 1; /* too long for gravity, which the log is told */
  assert_ok(pbf_set_params(s, &params));
  log_jumps = 1;
  volatile int jumped = 1;
  if (setjmp(back) == 0) {
    pbf_step(s, 1);
    jumped = 0;
  }
  log_jumps = 0;
  assert_true(jumped);
  assert_destroyable(s);
}

/* The solver is the caller's when the log hears of it. */
static void a_longjmp_leaves_creation(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *s = NULL;
  pbf_solver **volatile made = &s;
  desc.strict = 0;
  desc.backend = "failing";
  desc.log = log_or_jump;
  if (pbf_load_backend(PBF_STUB_DIR "/failing_probe.so") == PBF_ERROR_UNSUPPORTED)
    test_skip("a static build has no stub");
  log_jumps = 1;
  if (setjmp(back) == 0) pbf_create(&desc, NULL, &s);
  log_jumps = 0;
  assert_non_null(*made);
  assert_destroyable(*made);
}

static pbf_solver *unwanted;

static void destroy_unwanted(void *user, int32_t level, const char *message) {
  (void)user, (void)level, (void)message;
  pbf_destroy(unwanted);
}

static void creation_ends_in_destruction(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  if (pbf_load_backend(PBF_STUB_DIR "/failing_probe.so") == PBF_ERROR_UNSUPPORTED)
    test_skip("a static build has no stub");
  desc.strict = 0;
  desc.backend = "failing";
  desc.log = destroy_unwanted;
  assert_ok(pbf_create(&desc, NULL, &unwanted));
  assert_fails(pbf_step(unwanted, 1), PBF_ERROR_INVALID_ARGUMENT, "pbf_destroy");
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- What looks alike, and is not ---- */

static pbf_solver *in_callback;
static pbf_status inner;
static int asks_itself;

static void *allocate_and_ask(void *user, uint64_t size, uint64_t alignment) {
  uint32_t count;
  if (asks_itself) inner = pbf_get_count(in_callback, &count);
  return test_allocator.allocate(user, size, alignment);
}

static void make_in_callback(const pbf_allocator *allocator) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  desc.allocator = allocator;
  in_callback = test_create(&desc, NULL);
  float *x = test_lattice(3, PBF_FLOAT32, 8);
  assert_ok(pbf_add_particles(in_callback, 8, x, NULL, NULL));
  free(x);
}

/* A callback that asks its own solver is inside a call, at any depth of the stack. */
static void a_callback_asks(void **state) {
  (void)state;
  const uint32_t ids[2] = {1, 3};
  pbf_allocator allocator = test_allocator;
  allocator.allocate = allocate_and_ask;
  make_in_callback(&allocator);
  asks_itself = 1;
  inner = PBF_OK;
  assert_ok(pbf_remove_particles(in_callback, 2, ids));
  asks_itself = 0;
  assert_int_equal(inner, PBF_ERROR_BUSY);
  assert_ok(pbf_step(in_callback, 1));
  pbf_destroy(in_callback);
  assert_int_equal(test_count.live_blocks, 0);
}

/* So is a signal handler with a stack of its own, wherever that lies. */
static void ask_from_handler(int number) {
  (void)number;
  uint32_t count;
  inner = pbf_get_count(in_callback, &count);
}

static void *allocate_and_raise(void *user, uint64_t size, uint64_t alignment) {
  if (asks_itself) raise(SIGUSR1);
  return test_allocator.allocate(user, size, alignment);
}

static void a_handler_asks_from_its_stack(void **state) {
  (void)state;
  static char far[1 << 16];
  char near[1 << 16];
  pbf_allocator allocator = test_allocator;
  allocator.allocate = allocate_and_raise;
  struct sigaction action = {.sa_handler = ask_from_handler, .sa_flags = SA_ONSTACK};
  assert_int_equal(sigaction(SIGUSR1, &action, NULL), 0);
  for (int place = 0; place < 2; ++place) {
    const stack_t own = {.ss_sp = place ? near : far, .ss_size = sizeof far};
    const stack_t none = {.ss_flags = SS_DISABLE};
    const uint32_t id = 1;
    assert_int_equal(sigaltstack(&own, NULL), 0);
    make_in_callback(&allocator);
    asks_itself = 1;
    inner = PBF_OK;
    assert_ok(pbf_remove_particles(in_callback, 1, &id));
    asks_itself = 0;
    assert_int_equal(inner, PBF_ERROR_BUSY);
    assert_ok(pbf_step(in_callback, 1));
    pbf_destroy(in_callback);
    assert_int_equal(sigaltstack(&none, NULL), 0);
  }
}

int main(void) {
  const struct CMUnitTest interrupted[] = {
      cmocka_unit_test(handlers_never_wait),           cmocka_unit_test(a_longjmp_leaves_a_call),
      cmocka_unit_test(a_longjmp_leaves_the_log),      cmocka_unit_test(a_longjmp_leaves_creation),
      cmocka_unit_test(creation_ends_in_destruction),  cmocka_unit_test(a_callback_asks),
      cmocka_unit_test(a_handler_asks_from_its_stack),
  };
  return TEST_RUN(interrupted);
}
