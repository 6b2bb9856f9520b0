/* The same bits whatever the caller has made of the processor's floating-point environment, which
 * calls give back as it was. */
#define _GNU_SOURCE /* feenableexcept */
#include <dlfcn.h>
#include <fenv.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <pbf/batch.h>

#include "support.h"

enum { COUNT = 600 };

static void to_nearest(void) { fesetround(FE_TONEAREST); }
static void upward(void) { fesetround(FE_UPWARD); }
static void downward(void) { fesetround(FE_DOWNWARD); }
static void toward_zero(void) { fesetround(FE_TOWARDZERO); }
static void traps(void) { feenableexcept(FE_ALL_EXCEPT); }
static void flag(void) { feraiseexcept(FE_DIVBYZERO); }

#if defined(__x86_64__)
static void flush_subnormals(void) {
  const unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x40;
  _mm_setcsr(_mm_getcsr() | flush_to_zero | denormals_are_zero);
}
#endif

typedef void (*setting)(void);
static const setting settings[] = {
    upward,           downward, toward_zero, traps, flag,
#if defined(__x86_64__)
    flush_subnormals,
#endif
};
enum { SETTINGS = sizeof settings / sizeof settings[0] };

/* What a thread can tell of its environment. */
typedef struct environment {
  int rounding, trapped, raised;
  unsigned control;
} environment;

static environment environment_now(void) {
  environment e;
  memset(&e, 0, sizeof e);
  e.rounding = fegetround();
  e.trapped = fegetexcept();
  e.raised = fetestexcept(FE_ALL_EXCEPT);
#if defined(__x86_64__)
  e.control = _mm_getcsr();
#endif
  return e;
}

static void assert_environment(environment expected) {
  environment now = environment_now();
  assert_memory_equal(&now, &expected, sizeof now);
}

/* What each call has to leave as it was. */
#define assert_leaves(expected, call) \
  do {                                \
    pbf_status status = (call);       \
    assert_environment(expected);     \
    assert_int_equal(status, PBF_OK); \
  } while (0)

/* Prepared where nothing can trap. */
typedef struct scene {
  pbf_desc desc;
  pbf_params params;
  pbf_collider ball;
  uint32_t count;
  void *x, *v;
} scene;

/* A block that falls; and one particle beside, whose velocity is subnormal. */
static scene make_scene(uint32_t dimension, uint32_t precision) {
  scene s = {.desc = test_desc(dimension, precision, COUNT),
             .params = test_params(),
             .count = dimension == 2 ? 200 : COUNT};
  s.params.viscosity = 1e-4;
  s.x = calloc((size_t)COUNT * dimension, precision);
  s.v = calloc((size_t)COUNT * dimension, precision);
  for (uint32_t k = 0; k < dimension; ++k) {
    test_put(s.x, k, precision, k == 1 ? 0.95 : 0.12);
    test_put(s.v, k, precision, k == 1 ? 0 : precision == PBF_FLOAT32 ? 1e-40 : 1e-310);
  }
  for (uint32_t i = 1; i < s.count; ++i) {
    const uint32_t side = dimension == 2 ? 13 : 9;
    const uint32_t place[3] = {i % side, dimension == 2 ? i / side : i / side % side,
                               i / side / side};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(s.x, (uint64_t)i * dimension + k, precision,
               (k == 1 ? 0.05 : 0.3) + 0.05 * place[k]);
  }
  assert_ok(pbf_collider_init(&s.ball, sizeof s.ball, PBF_COLLIDER_SPHERE));
  s.ball.radius = 0.1;
  s.ball.position[0] = 0.6;
  s.ball.velocity[0] = -0.3;
  return s;
}

static void free_scene(scene *s) {
  free(s->x);
  free(s->v);
}

typedef struct outcome {
  uint64_t hash;
  double energy, limit;
  char velocity[3 * sizeof(double)];
} outcome;

/* Runs the scene in the environment that `set` makes, and checks that each call leaves it. */
static outcome run(const scene *s, setting set) {
  pbf_solver *solver = NULL;
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_backend_info info = {.struct_size = sizeof info};
  outcome o;
  fenv_t usual;
  uint32_t backends;
  memset(&o, 0, sizeof o);
  assert_ok(pbf_get_backend_count(&backends));
  feholdexcept(&usual);
  set();
  const environment expected = environment_now();
  for (uint32_t k = 0; k < backends; ++k)
    assert_leaves(expected, pbf_get_backend_info(&s->desc, k, &info));
  assert_leaves(expected, pbf_create(&s->desc, &s->params, &solver));
  assert_leaves(expected, pbf_add_particles(solver, s->count, s->x, s->v, NULL));
  assert_leaves(expected, pbf_set_colliders(solver, 1, &s->ball));
  assert_leaves(expected, pbf_step(solver, 10));
  assert_leaves(expected, pbf_set_params(solver, &s->params));
  assert_leaves(expected, pbf_step(solver, 10));
  assert_leaves(expected, pbf_get_stats(solver, &stats));
  assert_leaves(expected, pbf_get_step_limit(solver, &o.limit));
  assert_leaves(expected, pbf_hash(solver, &o.hash));
  assert_leaves(expected, pbf_get_velocities(solver, 0, 1, o.velocity));
  pbf_destroy(solver);
  assert_environment(expected);
  fesetenv(&usual);
  o.energy = stats.kinetic_energy;
  return o;
}

static void compare(uint32_t dimension, uint32_t precision) {
  scene s = make_scene(dimension, precision);
  const outcome usual = run(&s, to_nearest);
  const double subnormal = test_value(usual.velocity, 0, precision);
  if (precision == PBF_FLOAT32 && strcmp(test_backend(), "cuda") == 0)
    assert_true(subnormal == 0); /* kernels in float flush subnormal values to 0 */
  else
    assert_true(subnormal > 0 && subnormal < (precision == PBF_FLOAT32 ? 1e-39 : 1e-309));
  for (size_t k = 0; k < SETTINGS; ++k) {
    outcome o = run(&s, settings[k]);
    if (memcmp(&o, &usual, sizeof o) != 0) fail_msg("setting %zu changes the bits", k);
  }
  free_scene(&s);
}

static void a_callers_environment_changes_nothing(void **state) {
  (void)state;
  test_for_each_kind(compare);
}

/* ---- Callbacks ------------------------------------------------------------------------------ */

static setting left; /* by each callback, as by one that loads a library which sets it */

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  void *memory = test_allocator.allocate(user, size, alignment);
  left();
  return memory;
}

static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  test_allocator.release(user, memory, size, alignment);
  left();
}

static void take_log(void *user, int32_t level, const char *message) {
  (void)user, (void)level, (void)message;
  left();
}

static void *run_at_once(void *user, pbf_task_fn run_items, void *task, uint32_t items,
                         uint32_t min_range) {
  (void)user, (void)min_range;
  run_items(task, 0, items);
  left();
  return NULL;
}

static void finish(void *user, void *handle) { (void)user, (void)handle; }

static void compare_left(uint32_t dimension, uint32_t precision) {
  scene s = make_scene(dimension, precision);
  pbf_allocator memory = test_allocator;
  s.params.time_step = 1 / 30.0; /* which the log is told is too long */
  const outcome usual = run(&s, to_nearest);
  memory.allocate = allocate;
  memory.release = release;
  s.desc.allocator = &memory;
  s.desc.log = take_log;
  if (strcmp(test_backend(), "threads") == 0) {
    s.desc.enqueue_task = run_at_once;
    s.desc.finish_task = finish;
  }
  for (size_t k = 0; k < SETTINGS; ++k) {
    left = settings[k];
    outcome o = run(&s, to_nearest);
    if (memcmp(&o, &usual, sizeof o) != 0) fail_msg("callbacks' setting %zu changes the bits", k);
  }
  free_scene(&s);
}

static void a_callbacks_environment_changes_nothing(void **state) {
  (void)state;
  test_for_each_kind(compare_left);
}

/* Nor that of the thread which steps a batch with such callbacks. */
static void check_batch(int with_tasks) {
  pbf_allocator memory = test_allocator;
  pbf_desc desc = test_desc(2, PBF_FLOAT32, 4);
  pbf_batch *batch;
  desc.threads = 2;
  desc.allocator = &memory;
  if (with_tasks) {
    desc.enqueue_task = run_at_once;
    desc.finish_task = finish;
  }
  memory.allocate = allocate;
  memory.release = release;
  left = to_nearest;
  assert_ok(pbf_batch_create(&desc, NULL, 4, &batch));
  left = downward;
  const pbf_status status = pbf_batch_step(batch, NULL, 1);
  const int rounding = fegetround();
  to_nearest();
  assert_ok(status);
  assert_int_equal(rounding, FE_TONEAREST);
  pbf_batch_destroy(batch);
  assert_int_equal(fegetround(), FE_TONEAREST);
}

static void a_batchs_callbacks_change_nothing(void **state) {
  (void)state;
  check_batch(0);
  check_batch(1);
}

/* ---- Threads that have been started by others ---------------------------------------------- */

/* The entry to a parallel region of GCC's OpenMP library, if that is loaded. (Those of clang's have
 * the caller's environment in all threads.) */
typedef void (*parallel_function)(void (*function)(void *), void *data, unsigned threads,
                                  unsigned flags);
static parallel_function openmp(void) {
  parallel_function parallel = NULL;
  void *library = dlopen("libgomp.so.1", RTLD_NOW | RTLD_NOLOAD);
  if (library) *(void **)&parallel = dlsym(library, "GOMP_parallel");
  return parallel;
}

static void round_downward(void *unused) {
  (void)unused;
  downward();
}

static void count_downward(void *counter) {
  if (fegetround() == FE_DOWNWARD) __atomic_fetch_add((int *)counter, 1, __ATOMIC_RELAXED);
}

/* The program's own parallel regions run on the same threads as those of `openmp`. */
static void a_pools_environment_changes_nothing(void **state) {
  (void)state;
  if (strcmp(test_backend(), "openmp") != 0) test_skip("for openmp alone");
  pbf_backend_info info;
  info.struct_size = sizeof info;
  assert_ok(pbf_get_backend_info(NULL, 0, &info));
  parallel_function parallel = openmp();
  if (!parallel) test_skip("for GCC's OpenMP alone");
  scene s = make_scene(3, PBF_FLOAT32);
  const outcome usual = run(&s, to_nearest);
  int threads = 0;
  parallel(round_downward, NULL, s.desc.threads, 0);
  to_nearest();
  for (int k = 0; k < 5; ++k) {
    outcome o = run(&s, to_nearest);
    assert_memory_equal(&o, &usual, sizeof o);
  }
  parallel(count_downward, &threads, s.desc.threads, 0);
  assert_int_equal(threads, s.desc.threads - 1);
  free_scene(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_callers_environment_changes_nothing),
      cmocka_unit_test(a_callbacks_environment_changes_nothing),
      cmocka_unit_test(a_batchs_callbacks_change_nothing),
      cmocka_unit_test(a_pools_environment_changes_nothing),
  };
  return TEST_RUN(tests);
}
