/* Calls that end within a callback of the allocator, by a longjmp or since another thread forks
 * meanwhile: the solver is then destroyed, and no block goes back to the allocator twice. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <pbf/diffuse.h>
#include <pbf/emit.h>
#include <pbf/phases.h>
#include <pbf/query.h>
#include <pbf/shapes.h>

#include "support.h"

/* ---- An allocator that counts its blocks, and stops where it is told to ---- */

enum {
  COUNT = 27,
  MANY_SOLIDS = 70,
  BLOCKS = 2000,
  TIME_LIMIT = 60 /* seconds: of a child that hangs */
};

typedef struct heap_block {
  void *memory;
  uint64_t size, alignment;
  int is_out;
} heap_block;

/* No address is given twice, and what was given back keeps what it held, so that all that is done
 * with it again is seen. */
static struct {
  heap_block blocks[BLOCKS];
  int count, out, wrong; /* `wrong`: releases of what is no block, or of another size */
  int stop_in;           /* callbacks; 0: none stops */
  void (*stop)(void);
} heap;

static void maybe_stop(void) {
  if (heap.stop_in && --heap.stop_in == 0) heap.stop();
}

static void *allocate(void *user, uint64_t size, uint64_t alignment) {
  maybe_stop();
  if (heap.count == BLOCKS) return NULL;
  void *memory = test_allocator.allocate(user, size, alignment);
  if (!memory) return NULL;
  heap.blocks[heap.count++] = (heap_block){memory, size, alignment, 1};
  ++heap.out;
  return memory;
}

static int is_block(const heap_block *block, const void *memory, uint64_t size) {
  return block->is_out && block->memory == memory && block->size == size;
}

static void release(void *user, void *memory, uint64_t size, uint64_t alignment) {
  int k = 0;
  (void)user, (void)alignment;
  while (k < heap.count && !is_block(&heap.blocks[k], memory, size)) ++k;
  heap.wrong += k == heap.count;
  if (k == heap.count) return;
  heap.blocks[k].is_out = 0;
  --heap.out;
  maybe_stop();
}

/* All is in order once the last solver has gone. */
static int empty_heap(void) {
  const int in_order = heap.out == 0 && heap.wrong == 0;
  for (int k = 0; k < heap.count; ++k) {
    const heap_block *block = &heap.blocks[k];
    test_allocator.release(test_allocator.user, block->memory, block->size, block->alignment);
  }
  memset(&heap, 0, sizeof heap);
  return in_order;
}

/* ---- A solver that has all that takes memory ---- */

static uint64_t state_size;
static void *state;
static pbf_shape *block;

static int has(pbf_status status) {
  if (status != PBF_ERROR_UNSUPPORTED) assert_ok(status);
  return status == PBF_OK;
}

static void take_fluids(pbf_solver *s, uint32_t count) {
  pbf_phase phases[3];
  for (uint32_t k = 0; k < count; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  has(pbf_set_phases(s, count, count ? phases : NULL));
}

static void take_spray(pbf_solver *s, uint32_t capacity) {
  pbf_diffuse_desc diffuse;
  assert_ok(pbf_diffuse_init(s, &diffuse, sizeof diffuse));
  diffuse.capacity = capacity;
  has(pbf_set_diffuse(s, &diffuse));
}

static void take_tap(pbf_solver *s) {
  pbf_emitter tap;
  assert_ok(pbf_emitter_init(&tap, sizeof tap, PBF_EMITTER_DISC));
  tap.position[0] = tap.position[2] = 0.5;
  tap.position[1] = 0.9;
  tap.radius = 0.06;
  tap.lifetime = 1;
  has(pbf_set_emitters(s, 1, &tap));
}

static void take_solids(pbf_solver *s, uint32_t count, pbf_shape *shape) {
  pbf_collider solids[MANY_SOLIDS];
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t kind = shape ? PBF_COLLIDER_SHAPE : PBF_COLLIDER_SPHERE;
    assert_ok(pbf_collider_init(&solids[k], sizeof solids[k], kind));
    solids[k].radius = shape ? 0 : 0.05;
    solids[k].geometry = shape;
    solids[k].position[0] = 0.2 + 0.01 * k;
  }
  assert_ok(pbf_set_colliders(s, count, solids));
}

static void ask(pbf_solver *s) {
  double point[3] = {0.5, 0.1, 0.5}, level;
  assert_ok(pbf_get_levels(s, 1, point, &level));
}

static pbf_shape *make_block(void) {
  const double corners[4][3] = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0.2}};
  const pbf_hull_desc hull = {.struct_size = sizeof hull,
                              .dimension = 3,
                              .point_count = 4,
                              .points = corners[0],
                              .cell = 0.05};
  pbf_shape *made = NULL;
  assert_ok(pbf_shape_from_points(&hull, &made));
  return made;
}

/* 1 is the test's own. */
static uint32_t references(void) {
  pbf_shape_info info = {.struct_size = sizeof info};
  return pbf_get_shape_info(block, &info) == PBF_OK ? info.references : 0;
}

static pbf_solver *make(void) {
  static pbf_allocator allocator;
  allocator = (pbf_allocator){sizeof allocator, 0, test_allocator.user, allocate, release};
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 4 * COUNT);
  pbf_params params = test_params();
  params.prestabilization = 0;
  desc.allocator = &allocator;
  pbf_solver *s = test_create(&desc, &params);
  float *x = test_lattice(3, PBF_FLOAT32, COUNT), pushes[3] = {0, 1, 0};
  take_fluids(s, 2);
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  take_tap(s);
  take_spray(s, 64);
  take_solids(s, 2, block);
  assert_ok(pbf_keep_previous(s, 1));
  assert_ok(pbf_set_snapshots(s, 2));
  has(pbf_set_accelerations(s, 0, 1, pushes));
  assert_ok(pbf_step(s, 8)); /* the tap has opened */
  ask(s);
  free(x);
  return s;
}

/* ---- Calls that take and give back memory ---- */

static void load(pbf_solver *s) { assert_ok(pbf_load(s, state, state_size)); }
static void set_colliders(pbf_solver *s) { take_solids(s, 3, NULL); }
static void set_shapes(pbf_solver *s) { take_solids(s, 3, block); }
static void set_many_colliders(pbf_solver *s) {
  take_solids(s, MANY_SOLIDS, NULL);
  take_solids(s, 2, NULL);
}
static void set_phases(pbf_solver *s) { take_fluids(s, 3); }
static void set_diffuse(pbf_solver *s) { take_spray(s, 32); }
static void end_diffuse(pbf_solver *s) { assert_ok(pbf_set_diffuse(s, NULL)); }
static void forget_previous(pbf_solver *s) { assert_ok(pbf_keep_previous(s, 0)); }
static void set_snapshots(pbf_solver *s) { assert_ok(pbf_set_snapshots(s, 3)); }
static void end_queries(pbf_solver *s) { assert_ok(pbf_end_queries(s)); }
static void end_pushes(pbf_solver *s) { has(pbf_set_accelerations(s, 0, 0, NULL)); }
static void hash(pbf_solver *s) { test_hash(s); }

static void step(pbf_solver *s) {
  assert_ok(pbf_step(s, 1));
  ask(s);
}

static void remove_some(pbf_solver *s) {
  const uint32_t ids[2] = {1, 3};
  assert_ok(pbf_remove_particles(s, 2, ids));
}

static void (*const calls[])(pbf_solver *) = {
    load,        set_shapes,      set_colliders, set_many_colliders, set_phases, set_diffuse,
    end_diffuse, forget_previous, set_snapshots, end_queries,        end_pushes, hash,
    step,        remove_some};
enum { CALLS = sizeof calls / sizeof *calls, MOST_CALLBACKS = 100 };

/* ---- Left by a longjmp ---- */

static jmp_buf back;
static void jump(void) { longjmp(back, 1); }

/* 0: the call has fewer callbacks. */
static int is_left(pbf_solver *s, int call, int nth) {
  heap.stop = jump;
  heap.stop_in = nth;
  if (setjmp(back) != 0) return 1;
  calls[call](s);
  heap.stop_in = 0;
  return 0;
}

/* Of backends of the library: the stub keeps what it has in no order. */
static void skip_stub(void) {
  if (test_is_stub()) test_skip("the stub promises nothing of calls that are left");
}

static void all_goes_back_once(void **unused) {
  (void)unused;
  skip_stub();
  volatile int left = 0;
  for (volatile int call = 0; call < CALLS; ++call)
    for (volatile int nth = 1, goes_on = 1; goes_on && nth < MOST_CALLBACKS; ++nth) {
      pbf_solver *volatile s = make();
      goes_on = is_left(s, call, nth);
      left += goes_on;
      pbf_destroy(s);
      const int in_order = empty_heap() && references() == 1;
      if (!in_order) print_error("call %d, left in its callback %d\n", call, nth);
      assert_true(in_order);
    }
  assert_true(left > 30); /* the longest call of each backend alone has ten */
}

/* ---- Left by a fork ---- */

/* How far the other thread is with its call. */
typedef enum stage { RUNS, STOPPED, MAY_GO_ON, RETURNED } stage;
static _Atomic stage come;

static void wait_while(stage one) {
  const struct timespec nap = {0, 20000};
  while (come == one) nanosleep(&nap, NULL);
}

static void wait_here(void) {
  come = STOPPED;
  wait_while(STOPPED);
}

typedef struct other_call {
  pbf_solver *solver;
  int call;
} other_call;

static void *make_call(void *user) {
  const other_call *other = user;
  calls[other->call](other->solver);
  heap.stop_in = 0;
  come = RETURNED;
  return NULL;
}

/* What the other thread was about to give back, or had just been given, may stay. */
static int destroy_in_child(pbf_solver *s) {
  int status = -1;
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    alarm(TIME_LIMIT);
    heap.stop_in = 0;
    pbf_destroy(s);
    _exit(heap.wrong || references() < 1 ? 2 : heap.out > 1);
  }
  assert_true(child > 0 && waitpid(child, &status, 0) == child);
  return status;
}

static int is_forked_away(int call, int nth) {
  pthread_t thread;
  other_call other = {make(), call};
  come = RUNS;
  heap.stop = wait_here;
  heap.stop_in = nth;
  assert_int_equal(pthread_create(&thread, NULL, make_call, &other), 0);
  wait_while(RUNS);
  const int was_inside = come == STOPPED;
  if (was_inside) {
    const int status = destroy_in_child(other.solver);
    if (status) print_error("call %d, in its callback %d: the child's %x\n", call, nth, status);
    assert_int_equal(status, 0);
    come = MAY_GO_ON;
  }
  assert_int_equal(pthread_join(thread, NULL), 0);
  pbf_destroy(other.solver);
  assert_true(empty_heap());
  return was_inside;
}

static void a_child_gives_back_once(void **unused) {
  (void)unused;
  skip_stub();
  if (TEST_INSTRUMENTED) test_skip("forks beside threads hang in the sanitizer's own locks");
  if (strcmp(test_backend(), "cuda") == 0) test_skip("a device is the parent's");
  int forks = 0;
  for (int call = 0; call < CALLS; ++call)
    for (int nth = 1; nth < MOST_CALLBACKS && is_forked_away(call, nth); ++nth) ++forks;
  assert_true(forks > 30);
}

static int take_state(void **unused) {
  (void)unused;
  memset(&heap, 0, sizeof heap);
  block = make_block();
  pbf_solver *s = make();
  state = test_save(s, &state_size);
  pbf_destroy(s);
  return !empty_heap();
}

static int drop_state(void **unused) {
  (void)unused;
  free(state);
  pbf_release_shape(block);
  return 0;
}

int main(void) {
  const struct CMUnitTest halfway[] = {
      cmocka_unit_test_setup_teardown(all_goes_back_once, take_state, drop_state),
      cmocka_unit_test_setup_teardown(a_child_gives_back_once, take_state, drop_state),
  };
  return TEST_RUN(halfway);
}
