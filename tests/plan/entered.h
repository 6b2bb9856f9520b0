/* What a backend runs and allocates, counted where it happens: the backend's own source is compiled
 * into the test with every function telling when it is entered, and its memory comes from a
 * counting allocator. What the plan says is compared with that, never trusted.
 *
 * The includer has included a backend's source before, and defines `watched_functions`. */
#ifndef PBF_TESTS_PLAN_ENTERED_H
#define PBF_TESTS_PLAN_ENTERED_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

extern "C" {
#include <cmocka.h>

#include "allocator.h"
}

/* Optional features, one bit each. */
enum {
  NOTHING = 0,
  POLY6 = 1 << 0,
  SCORR = 1 << 1,
  VORTICITY = 1 << 2,
  VISCOSITY = 1 << 3,
  COLLIDERS = 1 << 4,
  WALL_DENSITY = 1 << 5,
  CHEBYSHEV = 1 << 6,
  SLEEP = 1 << 7,
  TOLERANCE = 1 << 8,
  PRESSURE_GRID = 1 << 9,
  FEATURES = 10,
  STATS = 1 << 10,
  TIMING = 1 << 11
};

/* A function that runs for a feature only, or that is a stage of the plan. */
typedef struct watched {
  const char *name;
  void *function;
  int feature;
  const char *stage; /* null: none */
} watched;

enum { MAX_WATCHED = 40 };
static uint64_t entered[MAX_WATCHED];

#define UNTOLD __attribute__((no_instrument_function))

UNTOLD static const watched *watched_at(unsigned k);

/* Bytes of the arrays that a scene wants, by physics/arrays.def. */
static uint64_t wanted_bytes(const solver *s, const pbf_schedule &has, const pbf_params &params);

extern "C" {
UNTOLD void __cyg_profile_func_enter(void *function, void *site);
UNTOLD void __cyg_profile_func_exit(void *function, void *site);
}

void __cyg_profile_func_enter(void *function, void *) {
  const watched *w;
  for (unsigned k = 0; (w = watched_at(k))->name; ++k)
    if (w->function == function) ++entered[k];
}

void __cyg_profile_func_exit(void *, void *) {}

#define WATCH(function, feature) \
  { #function, (void *)&function, feature, NULL }
#define WATCH_STAGE(function, feature, stage) \
  { #function, (void *)&function, feature, stage }

/* ---- The scene: a block in a corner, a sphere in its way ------------------------------------- */

enum {
  SIDE = 6,
  COUNT = PBF_DIM == 3 ? SIDE * SIDE * SIDE : SIDE * SIDE,
  STEPS = 3,
  ITERATIONS = 2
};

static pbf_params params_with(int features) {
  pbf_params p = {.struct_size = sizeof p};
  p.kernel = features & POLY6 ? PBF_KERNEL_POLY6_SPIKY : PBF_KERNEL_WENDLAND_C2;
  p.solver = features & CHEBYSHEV ? PBF_SOLVER_CHEBYSHEV : PBF_SOLVER_JACOBI;
  p.smoothing_radius = 0.1;
  p.spacing = 0.05;
  p.time_step = 1.0 / 120;
  p.iterations = ITERATIONS;
  p.collide = PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_IN_ITERATION;
  p.gravity[1] = -9.81;
  p.min_diagonal = 1;
  p.scorr_k = features & SCORR ? 0.01 : 0;
  p.scorr_dq = 0.2;
  p.scorr_n = 4;
  p.vorticity = features & VORTICITY ? 0.1 : 0;
  p.viscosity = features & VISCOSITY ? 1e-4 : 0; /* one stage */
  p.wall_density = features & WALL_DENSITY ? 1 : 0;
  p.sleep_speed = features & SLEEP ? 1e-6 : 0; /* so slow that no particle ever sleeps */
  p.sleep_time = 0.5;
  p.tolerance = features & TOLERANCE ? 1e-12 : 0;
  p.pressure_grid = features & PRESSURE_GRID ? 2 : 0;
  for (int k = 0; k < 3; ++k) p.domain_max[k] = 1;
  return p;
}

static pbf_collider sphere(void) {
  pbf_collider c = {.struct_size = sizeof c, .shape = PBF_COLLIDER_SPHERE, .radius = 0.05};
  c.orientation[3] = 1;
  return c;
}

static void no_log(void *user, int32_t level, const char *message) {
  (void)user, (void)level, (void)message;
}

typedef struct fluid {
  const pbf_backend_api *api;
  pbf_backend_solver *solver;
  double time;
} fluid;

static void set_features(fluid *f, int features) {
  pbf_params params = params_with(features);
  pbf_collider collider = sphere();
  assert_int_equal(f->api->set_params(f->solver, &params), PBF_OK);
  assert_int_equal(
      f->api->set_colliders(f->solver, features & COLLIDERS ? 1 : 0, &collider, f->time), PBF_OK);
}

static void add_block(fluid *f) {
  pbf_real x[COUNT][PBF_DIM];
  uint32_t ids[COUNT];
  for (uint32_t i = 0, rest; i < COUNT; ++i) {
    rest = ids[i] = i;
    for (int k = 0; k < PBF_DIM; ++k, rest /= SIDE)
      x[i][k] = (pbf_real)(0.026 + 0.05 * (rest % SIDE));
  }
  pbf_particles particles = {sizeof particles, COUNT, ids, x, NULL};
  assert_int_equal(f->api->add_particles(f->solver, &particles), PBF_OK);
}

static fluid fluid_with(int features) {
  fluid f = {0};
  pbf_params params = params_with(NOTHING);
  const pbf_backend_desc desc = {.struct_size = sizeof desc,
                                 .dimension = PBF_DIM,
                                 .precision = sizeof(pbf_real),
                                 .capacity = COUNT,
                                 .threads = 1,
                                 .allocator = test_allocator,
                                 .log = no_log};
  assert_int_equal(begin(&desc, &params, &f.solver, &f.api), PBF_OK);
  add_block(&f);
  set_features(&f, features);
  return f;
}

static void advance(fluid *f, uint32_t steps) {
  uint32_t done = 0;
  assert_int_equal(f->api->step(f->solver, f->time, 0, steps, &done), PBF_OK);
  assert_int_equal(done, steps);
  f->time += steps * params_with(NOTHING).time_step;
}

static void drop(fluid *f) {
  f->api->destroy(f->solver);
  assert_int_equal(test_count.live_blocks, 0);
}

static pbf_plan plan_of(const fluid *f) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_int_equal(f->api->get_plan(f->solver, &plan), PBF_OK);
  return plan;
}

/* ---- What runs ------------------------------------------------------------------------------- */

static uint32_t planned_runs(const pbf_plan *plan, const char *stage) {
  for (uint32_t k = 0; k < plan->stage_count; ++k)
    if (strcmp(plan->stages[k].name, stage) == 0) return plan->stages[k].runs_per_step;
  return 0;
}

static void check_entered(int features, const pbf_plan *plan) {
  const watched *w;
  for (unsigned k = 0; (w = watched_at(k))->name; ++k) {
    int wanted = (w->feature & features) != 0;
    if (w->feature && (entered[k] != 0) != wanted)
      fail_msg("%s: entered %u times with features %x", w->name, (unsigned)entered[k], features);
    if (!w->stage) continue;
    uint64_t planned = (uint64_t)STEPS * planned_runs(plan, w->stage);
    /* With a tolerance a plan says what a step runs at most: this block falls without an error. */
    int is_most = (features & TOLERANCE) && entered[k] >= STEPS && entered[k] < planned;
    if (entered[k] != planned && !is_most)
      fail_msg("%s: entered %u times in %d steps with features %x, and the plan says %u", w->name,
               (unsigned)entered[k], STEPS, features, (unsigned)planned);
  }
}

/* A first step may look for neighbours twice, until there is memory for all. */
static void check_steps(int features) {
  fluid f = fluid_with(features);
  pbf_plan plan = plan_of(&f);
  advance(&f, 1);
  memset(entered, 0, sizeof entered);
  advance(&f, STEPS);
  check_entered(features, &plan);
  set_features(&f, NOTHING);
  plan = plan_of(&f);
  memset(entered, 0, sizeof entered);
  advance(&f, STEPS);
  check_entered(NOTHING, &plan);
  drop(&f);
}

static void only_what_is_asked_for_runs(void **state) {
  (void)state;
  check_steps(NOTHING);
  for (int k = 0; k < FEATURES; ++k) check_steps(1 << k);
  check_steps((1 << FEATURES) - 1);
}

/* When all sleep, a step enters no stage; what wakes them, and it does again. */
static void sleepers_cost_nothing(void **state) {
  (void)state;
  const watched *w;
  fluid f = fluid_with(NOTHING);
  pbf_params params = params_with(SLEEP | VORTICITY | VISCOSITY | CHEBYSHEV | PRESSURE_GRID);
  params.sleep_speed = 10; /* so fast that all sleep at once */
  params.sleep_time = 1e-3;
  assert_int_equal(f.api->set_params(f.solver, &params), PBF_OK);
  advance(&f, 2);
  memset(entered, 0, sizeof entered);
  advance(&f, STEPS);
  for (unsigned k = 0; (w = watched_at(k))->name; ++k)
    if (w->stage && entered[k]) fail_msg("%s: entered %u times", w->name, (unsigned)entered[k]);
  params.gravity[0] = 1;
  assert_int_equal(f.api->set_params(f.solver, &params), PBF_OK);
  advance(&f, 1);
  for (unsigned k = 0; (w = watched_at(k))->name; ++k)
    if (w->stage && !entered[k]) fail_msg("%s: not entered", w->name);
  drop(&f);
}

/* Statistics run when they are asked for, times are taken while they are on. */
static void requests(void **state) {
  (void)state;
  fluid f = fluid_with(NOTHING);
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_plan plan = plan_of(&f);
  advance(&f, 1);
  memset(entered, 0, sizeof entered);
  assert_int_equal(f.api->get_stats(f.solver, &stats), PBF_OK);
  for (unsigned k = 0; watched_at(k)->name; ++k)
    if (watched_at(k)->feature & STATS) assert_true(entered[k] > 0);
  for (int on = 1; f.api->set_timing && on >= 0; --on) {
    assert_int_equal(f.api->set_timing(f.solver, (uint32_t)on), PBF_OK);
    memset(entered, 0, sizeof entered);
    advance(&f, STEPS);
    check_entered(on ? TIMING : NOTHING, &plan);
  }
  drop(&f);
}

static uint64_t entries_of(const char *name) {
  for (unsigned k = 0; watched_at(k)->name; ++k)
    if (strcmp(watched_at(k)->name, name) == 0) return entered[k];
  fail_msg("%s is not watched", name);
  return 0;
}

/* A change from frame to frame looks at no particle, sums up no lattice, and looks for the basins
 * between colliders only where these or the domain have changed, and colliders touch. */
static void check_frame(const char *what, int searches) {
  if (entries_of("pbf_derive_from")) fail_msg("%s: sums up lattices", what);
  if (entries_of("pbf_set_walls")) fail_msg("%s: makes tables of walls", what);
  if (entries_of("pbf_region_basins_of") != (uint64_t)searches)
    fail_msg("%s: looks for basins %u times", what, (unsigned)entries_of("pbf_region_basins_of"));
  if (entries_of("field_at")) fail_msg("%s: looks at particles", what);
}

static void set_for_a_frame(fluid *f, const char *what, const pbf_params *params, int searches) {
  advance(f, 1);
  memset(entered, 0, sizeof entered);
  assert_int_equal(f->api->set_params(f->solver, params), PBF_OK);
  check_frame(what, searches);
}

/* One above the other, so near that water between them could be deep. */
static void move_for_a_frame(fluid *f, uint32_t count, double x, int searches) {
  pbf_collider colliders[2] = {sphere(), sphere()};
  for (int k = 0; k < 2; ++k) {
    colliders[k].position[0] = x;
    colliders[k].position[1] = 0.1 + 0.25 * k;
  }
  advance(f, 1);
  memset(entered, 0, sizeof entered);
  assert_int_equal(f->api->set_colliders(f->solver, count, colliders, f->time), PBF_OK);
  check_frame(count > 1 ? "two colliders" : "a collider", searches);
}

static void check_frames(double pressure_grid) {
  const int asks = pressure_grid < 0, two = asks ? 2 : 0; /* the domain, and what is near solids */
  fluid f = fluid_with(COLLIDERS | WALL_DENSITY | CHEBYSHEV | VISCOSITY | SCORR | PRESSURE_GRID);
  pbf_params params = params_with(WALL_DENSITY | CHEBYSHEV | VISCOSITY | SCORR | PRESSURE_GRID);
  params.viscosity = 1;
  params.pressure_grid = pressure_grid;
  assert_int_equal(f.api->set_params(f.solver, &params), PBF_OK);
  params.gravity[0] = 0.1;
  set_for_a_frame(&f, "gravity", &params, 0);
  params.time_step *= 0.9;
  set_for_a_frame(&f, "time_step", &params, 0);
  params.attraction = 1;
  set_for_a_frame(&f, "attraction", &params, 0);
  params.wall_velocity[0] = 0.01;
  set_for_a_frame(&f, "wall_velocity", &params, 0);
  params.domain_max[0] = 1.1;
  set_for_a_frame(&f, "domain_max", &params, 0);
  move_for_a_frame(&f, 1, 0.3, 0);
  move_for_a_frame(&f, 2, 0.3, two);
  move_for_a_frame(&f, 2, 0.3, 0);
  params.domain_max[0] = 1.2;
  set_for_a_frame(&f, "domain_max", &params, two);
  memset(entered, 0, sizeof entered);
  params.smoothing_radius *= asks ? 1.01 : 1.02;
  assert_int_equal(f.api->set_params(f.solver, &params), PBF_OK);
  assert_int_equal(entries_of("pbf_derive_from"), 1);
  drop(&f);
}

/* What has been derived from parameters once is not again, for another solver. */
static void solvers_alike_share_what_is_derived(void **state) {
  (void)state;
  const int features = COLLIDERS | WALL_DENSITY | CHEBYSHEV;
  fluid first = fluid_with(features);
  drop(&first);
  memset(entered, 0, sizeof entered);
  fluid second = fluid_with(features);
  assert_int_equal(entries_of("pbf_derive_from"), 0);
  assert_int_equal(entries_of("pbf_set_walls"), 0);
  drop(&second);
}

/* Nor for one that has it itself, however many others have come since. */
static void solvers_keep_what_is_derived(void **state) {
  (void)state;
  const int features = COLLIDERS | WALL_DENSITY | CHEBYSHEV;
  fluid own = fluid_with(features);
  pbf_params params = params_with(features), changing = params;
  for (int k = 0; k < 9; ++k) {
    static pbf_derived derived;
    static pbf_constants constants;
    changing.smoothing_radius *= 1.003;
    derive_tables(&changing, &derived, &constants);
  }
  params.gravity[0] = 0.1;
  set_for_a_frame(&own, "gravity beside other solvers", &params, 0);
  drop(&own);
}

static void a_frame_costs_what_changed(void **state) {
  (void)state;
  check_frames(-1);
  check_frames(2);
}

/* ---- What is allocated ----------------------------------------------------------------------- */

/* Of an array of so many bytes. */
static uint64_t allocated(uint64_t bytes) {
  return bytes && bytes < PBF_ALIGNMENT ? uint64_t{PBF_ALIGNMENT} : bytes;
}

static uint64_t bytes_of(const fluid *f, int features) {
  const pbf_params params = params_with(features);
  const pbf_collider collider = sphere();
  const pbf_derived derived = pbf_derive(&params, PBF_DIM);
  static pbf_basins basins;
  const pbf_schedule has = pbf_schedule_of(&params, &derived, &basins, features & COLLIDERS ? 1 : 0,
                                           &collider, COUNT, COUNT, 0);
  return wanted_bytes(f->solver, has, params);
}

static void check_bytes(int features) {
  fluid f = fluid_with(NOTHING);
  assert_int_equal(bytes_of(&f, NOTHING), 0);
  advance(&f, 1);
  uint64_t bare = test_count.live_bytes;
  assert_int_equal(plan_of(&f).bytes, bare);
  set_features(&f, features);
  if (test_count.live_bytes - bare != bytes_of(&f, features))
    fail_msg("features %x take %u bytes more", features, (unsigned)(test_count.live_bytes - bare));
  assert_int_equal(plan_of(&f).bytes, test_count.live_bytes);
  uint64_t calls = test_count.calls;
  advance(&f, 1);
  assert_int_equal(test_count.calls, calls);
  set_features(&f, NOTHING);
  assert_int_equal(test_count.live_bytes, bare);
  assert_int_equal(plan_of(&f).bytes, bare);
  drop(&f);
}

static void only_what_is_asked_for_is_held(void **state) {
  (void)state;
  for (int k = 0; k < FEATURES; ++k) check_bytes(1 << k);
  check_bytes((1 << FEATURES) - 1);
}

static int test_the_plan(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(only_what_is_asked_for_runs),
      cmocka_unit_test(sleepers_cost_nothing),
      cmocka_unit_test(requests),
      cmocka_unit_test(a_frame_costs_what_changed),
      cmocka_unit_test(solvers_alike_share_what_is_derived),
      cmocka_unit_test(solvers_keep_what_is_derived),
      cmocka_unit_test(only_what_is_asked_for_is_held),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
