/* Every allocation made to fail in turn: the status, no leak, the state as it was. */
#include <dlpack/dlpack.h>

#include <pbf/phases.h>
#include <pbf/query.h>

#include "support.h"

typedef struct scene {
  pbf_solver *solver;
  void *saved;
  uint64_t saved_size;
  pbf_params params;
  pbf_collider collider;
} scene;

typedef pbf_status (*action)(scene *scene);

static pbf_status add(scene *s) {
  void *lattice = test_lattice(3, PBF_FLOAT32, 4);
  pbf_status status = pbf_add_particles(s->solver, 4, lattice, NULL, NULL);
  free(lattice);
  return status;
}
static pbf_status drop(scene *s) {
  return pbf_remove_particles(s->solver, 2, (const uint32_t[]){5, 1});
}
static pbf_status step(scene *s) { return pbf_step(s->solver, 2); }
static pbf_status step_apart(scene *s) {
  pbf_status status = pbf_begin_step(s->solver, 2);
  return status == PBF_OK ? pbf_end_step(s->solver) : status;
}
static pbf_status set_params(scene *s) { return pbf_set_params(s->solver, &s->params); }
/* Takes memory for sleep, and gives back what steps have kept of each particle until now. */
static pbf_status set_drowsy(scene *s) {
  pbf_params params = test_params();
  params.solver = PBF_SOLVER_JACOBI;
  params.sleep_speed = params.sleep_time = 1;
  const pbf_status status = pbf_set_params(s->solver, &params);
  return status == PBF_ERROR_UNSUPPORTED ? PBF_OK : status;
}
/* Of which a pressure grid would carry nothing. */
static pbf_status set_phases(scene *s) {
  pbf_phase phases[2];
  for (int i = 0; i < 2; ++i) assert_ok(pbf_phase_init(&phases[i], sizeof *phases));
  phases[1].rest_density = 0.1;
  const pbf_status status = pbf_set_phases(s->solver, 2, phases);
  return status == PBF_ERROR_UNSUPPORTED ? PBF_OK : status;
}
static pbf_status set_colliders(scene *s) { return pbf_set_colliders(s->solver, 1, &s->collider); }
static pbf_status load(scene *s) { return pbf_load(s->solver, s->saved, s->saved_size); }
static pbf_status save(scene *s) {
  uint64_t size = s->saved_size + 4096;
  void *buffer = malloc(size);
  pbf_status status = pbf_save(s->solver, buffer, &size);
  free(buffer);
  return status;
}
static pbf_status hash(scene *s) { return pbf_hash(s->solver, &(uint64_t){0}); }
static pbf_status get_positions(scene *s) {
  float x[60];
  return pbf_get_positions(s->solver, 0, 20, x);
}
static pbf_status get_densities(scene *s) {
  float rho[20];
  return pbf_get_densities(s->solver, 0, 20, rho);
}
static pbf_status read_quads(scene *s) {
  float quads[80];
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = PBF_FIELD_POSITION,
                              .count = 20,
                              .components = 4,
                              .w = PBF_W_DENSITY,
                              .data = quads};
  return pbf_read(s->solver, &read);
}
static pbf_status get_anisotropies(scene *s) {
  float x[60], shapes[180];
  const pbf_anisotropy_desc wanted = {
      .struct_size = sizeof wanted, .count = 20, .positions = x, .stretches = shapes};
  return pbf_get_anisotropies(s->solver, &wanted);
}
static pbf_status ask(scene *s) {
  const double x[3] = {0.5, 0.5, 0.5};
  double v[3];
  return pbf_sample(
      s->solver,
      &(pbf_samples){.struct_size = sizeof(pbf_samples), .count = 1, .points = x, .velocities = v});
}
static pbf_status find_in_ball(scene *s) {
  pbf_volume ball;
  uint32_t count;
  assert_ok(pbf_volume_init(&ball, sizeof ball, PBF_VOLUME_SPHERE));
  return pbf_find_in_volume(s->solver, &ball, 0, NULL, &count);
}
static pbf_status drop_box(scene *s) {
  const double lower[3] = {-1, -1, -1}, upper[3] = {0.3, 2, 2};
  return pbf_remove_in_box(s->solver, lower, upper, NULL);
}
static pbf_status set_snapshots(scene *s) { return pbf_set_snapshots(s->solver, 3); }
static pbf_status keep_previous(scene *s) { return pbf_keep_previous(s->solver, 1); }
static pbf_status set_velocities(scene *s) {
  float v[60] = {0};
  return pbf_set_velocities(s->solver, 0, 20, v);
}
static pbf_status set_accelerations(scene *s) {
  const float a[15] = {0, 1};
  pbf_status status = pbf_set_accelerations(s->solver, 0, 5, a);
  return status == PBF_ERROR_UNSUPPORTED ? PBF_OK : status;
}
static pbf_status write_quads(scene *s) {
  double quads[80] = {0};
  const pbf_write_desc write = {.struct_size = sizeof write,
                                .field = PBF_FIELD_VELOCITY,
                                .count = 20,
                                .element_type = PBF_TYPE_FLOAT64,
                                .components = 4,
                                .data = quads};
  return pbf_write(s->solver, &write);
}
static pbf_status stats(scene *s) {
  return pbf_get_stats(s->solver, &(pbf_stats){.struct_size = sizeof(pbf_stats)});
}
static pbf_status export(scene *s) {
  DLManagedTensor *tensor = NULL;
  pbf_status status = pbf_export_dlpack(s->solver, PBF_FIELD_POSITION, &tensor);
  if (status == PBF_OK) tensor->deleter(tensor);
  return status;
}
static pbf_status timing(scene *s) {
  pbf_status status = pbf_set_timing(s->solver, 1);
  return status == PBF_ERROR_UNSUPPORTED ? PBF_OK : status;
}

/* What the solver holds before the action. */
typedef enum beginning {
  LATTICE,
  PLACED /* in a solid, out of which the first step moves it */,
  STEPPED /* in a vessel */,
  LYING /* on the floor, under pressure */,
  ASLEEP
} beginning;

static scene make_scene(beginning start) {
  scene s = {.params = test_params()};
  pbf_solver *other = test_filled(3, PBF_FLOAT32, 10, 32);
  assert_ok(pbf_collider_init(&s.collider, sizeof s.collider, PBF_COLLIDER_SPHERE));
  s.collider.radius = 0.01;
  assert_ok(pbf_set_colliders(other, 1, &s.collider));
  assert_ok(pbf_remove_particles(other, 1, (const uint32_t[]){2}));
  s.saved = test_save(other, &s.saved_size);
  pbf_destroy(other);
  s.solver = test_filled(3, PBF_FLOAT32, 20, 32);
  /* All that a parameter can switch on, so that memory is wanted. */
  s.params.vorticity = s.params.viscosity = 0.01;
  s.params.scorr_k = 0.1;
  s.params.smoothing_radius = 0.15;
  if (start == LATTICE) return s;
  if (start == LYING || start == ASLEEP) {
    pbf_params params = test_params();
    if (start == ASLEEP) params.sleep_speed = 10, params.sleep_time = 0.1;
    const pbf_status status = pbf_set_params(s.solver, &params);
    if (status != PBF_ERROR_UNSUPPORTED) assert_ok(status);
    assert_ok(pbf_step(s.solver, 60));
    return s;
  }
  s.collider.radius = 0.2;
  for (int k = 0; k < 3; ++k) s.collider.position[k] = 0.35;
  if (start == STEPPED) {
    pbf_params deep = test_params();
    deep.pressure_grid = 2; /* which wants memory where a solid is in it */
    assert_ok(pbf_set_params(s.solver, &deep));
    s.collider.inverted = 1;
  }
  assert_ok(pbf_set_colliders(s.solver, 1, &s.collider));
  if (start == STEPPED) {
    assert_ok(pbf_step(s.solver, 1));
    s.collider.inverted = 0;
  }
  return s;
}

static void drop_scene(scene *s) {
  pbf_destroy(s->solver);
  free(s->saved);
  assert_int_equal(test_count.live_blocks, 0);
  assert_int_equal(test_count.live_bytes, 0);
}

static pbf_params params_of(pbf_solver *solver) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(solver, &params));
  return params;
}

/* Where the action and a step after it lead, if memory does not fail. */
static uint64_t hash_after(beginning start, action act) {
  scene s = make_scene(start);
  assert_ok(act(&s));
  assert_ok(pbf_step(s.solver, 1));
  const uint64_t after = test_hash(s.solver);
  drop_scene(&s);
  return after;
}

static pbf_status do_nothing(scene *s) {
  (void)s;
  return PBF_OK;
}

/* What a step was planned for is in a saved state, whether or not the step was done. */
static int plans(action act) { return act == step || act == step_apart; }

/* Runs the action with its n-th allocation failing. Whatever comes next, and a step, then lead
 * where they had led without it. Returns whether that allocation was wanted. */
static int fail_once(beginning start, action act, uint64_t n, action next, uint64_t right) {
  scene s = make_scene(start);
  uint64_t size, size_after;
  void *before = test_save(s.solver, &size);
  const uint64_t hash_before = test_hash(s.solver);
  pbf_params params = params_of(s.solver);
  test_count.failing_call = test_count.calls + n;
  pbf_status status = act(&s);
  const int failed = test_count.calls >= test_count.failing_call;
  test_count.failing_call = 0;
  if (status != PBF_OK) {
    assert_int_equal(status, PBF_ERROR_OUT_OF_MEMORY);
    assert_int_not_equal(pbf_last_error()[0], 0);
    assert_int_equal(test_hash(s.solver), hash_before);
    void *now = test_save(s.solver, &size_after);
    assert_int_equal(size_after, size);
    if (!plans(act)) assert_memory_equal(now, before, size);
    free(now);
    pbf_params after = params_of(s.solver);
    assert_memory_equal(&after, &params, sizeof after);
    assert_ok(next(&s));
    assert_ok(pbf_step(s.solver, 1));
    assert_int_equal(test_hash(s.solver), right);
  }
  free(before);
  drop_scene(&s);
  return failed;
}

/* For n = 1, 2, … until it needs no more. A fresh scene each time: an action may need memory the
 * first time only. */
static void fail_in_turn(beginning start, action act) {
  const uint64_t with = hash_after(start, act), without = hash_after(start, do_nothing);
  for (uint64_t n = 1; fail_once(start, act, n, act, with); ++n) {
    fail_once(start, act, n, do_nothing, without);
    assert_true(n < 1000);
  }
}

static void each_call(void **state) {
  (void)state;
  const action actions[] = {add,           drop,          step,
                            set_params,    set_colliders, load,
                            save,          hash,          stats,
                            get_positions, get_densities, set_velocities,
                            write_quads,   export,        timing,
                            read_quads,    keep_previous, drop_box,
                            set_snapshots, step_apart,    get_anisotropies,
                            ask,           find_in_ball,  set_accelerations};
  for (size_t i = 0; i < sizeof actions / sizeof actions[0]; ++i) fail_in_turn(LATTICE, actions[i]);
  fail_in_turn(PLACED, step);
  fail_in_turn(STEPPED, set_colliders);
  fail_in_turn(STEPPED, step);
  fail_in_turn(LYING, set_drowsy);
  if (!test_is_stub()) fail_in_turn(ASLEEP, set_phases); /* the stub keeps nothing of sleep */
}

static void creation(void **state) {
  (void)state;
  for (uint64_t n = 1;; ++n) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, 100);
    pbf_solver *solver = NULL;
    test_count.failing_call = test_count.calls + n;
    pbf_status status = pbf_create(&desc, NULL, &solver);
    test_count.failing_call = 0;
    if (status == PBF_OK) {
      pbf_destroy(solver);
      assert_true(n > 1);
      break;
    }
    assert_int_equal(status, PBF_ERROR_OUT_OF_MEMORY);
    assert_null(solver);
    assert_int_equal(test_count.live_blocks, 0);
  }
  assert_int_equal(test_count.live_blocks, 0);
}

static pbf_plan plan_of(pbf_solver *solver) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  return plan;
}

/* The plan's bytes are what the allocator has given out; a device's own come on top. */
static void check_plan(pbf_solver *solver) {
  pbf_plan plan = plan_of(solver);
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(solver, &info));
  if (info.device_type == PBF_DEVICE_CPU) {
    assert_int_equal(plan.bytes, test_count.live_bytes);
  } else {
    assert_true(plan.bytes >= test_count.live_bytes);
  }
  double sum = 0;
  for (uint32_t i = 0; i < plan.array_count; ++i) sum += plan.arrays[i].bytes_per_particle;
  assert_true(fabs(sum - plan.bytes_per_particle) < 1e-9 * (1 + sum));
}

static void the_plan_counts_every_byte(void **state) {
  (void)state;
  scene s = make_scene(LATTICE);
  check_plan(s.solver);
  uint32_t arrays = plan_of(s.solver).array_count;
  assert_ok(drop(&s));
  assert_int_equal(plan_of(s.solver).array_count, arrays + 1); /* the host's ids */
  check_plan(s.solver);
  assert_ok(set_colliders(&s));
  check_plan(s.solver);
  assert_ok(step(&s));
  check_plan(s.solver);
  assert_ok(set_params(&s));
  assert_ok(step(&s));
  check_plan(s.solver);
  assert_ok(stats(&s));
  check_plan(s.solver);
  assert_ok(set_accelerations(&s));
  check_plan(s.solver);
  assert_ok(load(&s));
  check_plan(s.solver);
  assert_ok(pbf_set_colliders(s.solver, 0, NULL));
  check_plan(s.solver);
  drop_scene(&s);
}

static void malloc_without_an_allocator(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 100);
  desc.allocator = NULL;
  pbf_solver *solver = test_create(&desc, NULL);
  assert_int_equal(test_count.live_blocks, 0);
  assert_ok(pbf_step(solver, 1));
  pbf_destroy(solver);
}

/* An allocator that takes no notice of alignment, from its n-th call on or in that alone. */
typedef struct careless {
  int calls, from, for_good, blocks;
} careless;

static void *allocate_carelessly(void *user, uint64_t size, uint64_t alignment) {
  careless *own = user;
  const int n = ++own->calls, off = n == own->from || (n > own->from && own->for_good);
  char *block = aligned_alloc(alignment, (size + 3 * alignment - 1) / alignment * alignment);
  if (!block) return NULL;
  ++own->blocks;
  memset(block, 0, alignment);
  block += alignment + (off ? 8 : 0);
  block[-1] = (char)(off ? 8 : 0);
  return block;
}

static void release_carelessly(void *user, void *memory, uint64_t size, uint64_t alignment) {
  char *block = memory;
  (void)size;
  --((careless *)user)->blocks;
  free(block - block[-1] - alignment);
}

static pbf_status use_carelessly(careless *own) {
  const pbf_allocator allocator = {sizeof allocator, 0, own, allocate_carelessly,
                                   release_carelessly};
  pbf_solver *solver = NULL;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 100);
  desc.allocator = &allocator;
  void *lattice = test_lattice(3, PBF_FLOAT32, 64);
  pbf_status status = pbf_create(&desc, NULL, &solver);
  if (status == PBF_OK) status = pbf_add_particles(solver, 64, lattice, NULL, NULL);
  if (status == PBF_OK) status = pbf_step(solver, 2);
  if (status == PBF_OK)
    status = pbf_get_stats(solver, &(pbf_stats){.struct_size = sizeof(pbf_stats)});
  pbf_destroy(solver);
  free(lattice);
  return status;
}

/* It counts as none, and is given back. */
static void memory_that_is_not_aligned(void **state) {
  (void)state;
  careless all = {.from = 1, .for_good = 1};
  assert_fails(use_carelessly(&all), PBF_ERROR_OUT_OF_MEMORY, "bytes aligned to 64 for a solver");
  assert_int_equal(all.blocks, 0);
  careless never = {.from = 0};
  assert_ok(use_carelessly(&never));
  for (int n = 1; n <= never.calls; ++n) {
    careless own = {.from = n};
    const pbf_status status = use_carelessly(&own);
    assert_true(status == PBF_OK || status == PBF_ERROR_OUT_OF_MEMORY ||
                status == PBF_ERROR_UNAVAILABLE);
    assert_int_equal(own.blocks, 0);
  }
}

int main(void) {
  const struct CMUnitTest memory[] = {
      cmocka_unit_test(each_call),
      cmocka_unit_test(creation),
      cmocka_unit_test(the_plan_counts_every_byte),
      cmocka_unit_test(malloc_without_an_allocator),
      cmocka_unit_test(memory_that_is_not_aligned),
  };
  return TEST_RUN(memory);
}
