/* What ranks refuse, and what they say when they differ or one of them is gone. */
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include <pbf/diffuse.h>
#include <pbf/emit.h>
#include <pbf/phases.h>

#include "support.h"

#include "thread_ranks.h"

enum { COUNT = 2000, SIDE = 10 };

static pbf_params params_of(void) {
  pbf_params params = test_params();
  params.pressure_grid = 0;
  params.smoothing_radius = 0.1;
  params.prestabilization = 0;
  params.domain_max[0] = 2;
  params.domain_max[1] = 3;
  return params;
}

static pbf_desc desc_of(void) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  desc.allocator = NULL;
  return desc;
}

/* A column with a gap between any two. */
static void fill(pbf_solver *s, float off) {
  float *x = calloc((size_t)COUNT * 3, sizeof *x);
  if (!EXPECT(x)) return;
  for (uint32_t i = 0; i < COUNT; ++i) {
    const uint32_t at[3] = {i % SIDE, i / SIDE / SIDE, i / SIDE % SIDE};
    for (int k = 0; k < 3; ++k)
      x[3 * i + (uint32_t)k] = 0.05f * ((float)at[k] + 0.5f) + (float)(i * 7 % 11) * 1e-4f;
  }
  x[0] += off;
  EXPECT_OK(pbf_add_particles(s, COUNT, x, NULL, NULL));
  free(x);
}

static pbf_solver *solver_on(const pbf_ranks *ranks, const pbf_params *params) {
  const pbf_desc desc = desc_of();
  pbf_solver *s = NULL;
  EXPECT_OK(pbf_create_on_ranks(&desc, params, ranks, &s));
  return s;
}

/* Only where no rank is to fail. */
static void run(uint32_t count, uint32_t local_capacity, thread_rank_fn function, void *context) {
  thread_ranks_run(count, local_capacity, NULL, NULL, function, context);
  assert_int_equal(ranks_failures(), 0);
}

/* ---- Refusals ------------------------------------------------------------------------------ */

/* A backend that knows of none, or that the build is without. */
static void refuse(const pbf_ranks *ranks, void *context) {
  (void)context;
  const pbf_params params = params_of();
  pbf_desc desc = desc_of();
  pbf_solver *s = NULL;
  desc.backend = "reference";
  EXPECT(pbf_create_on_ranks(&desc, &params, ranks, &s) != PBF_OK);
  EXPECT(strstr(pbf_last_error(), "reference"));
  s = solver_on(ranks, &params);
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_step(s, 2));
  pbf_destroy(s);
}

/* Of newer callers, whose struct is longer: what is not known has to be 0. */
static void join_by_a_longer_struct(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  const pbf_desc desc = desc_of();
  struct {
    pbf_ranks ranks;
    char more[24];
  } newer;
  pbf_solver *s = NULL;
  (void)context;
  memset(&newer, 0, sizeof newer);
  newer.ranks = *ranks;
  newer.ranks.struct_size = sizeof newer;
  EXPECT_OK(pbf_create_on_ranks(&desc, &params, &newer.ranks, &s));
  pbf_destroy(s);
  newer.more[5] = 3;
  EXPECT_FAILS(pbf_create_on_ranks(&desc, &params, &newer.ranks, &s), PBF_ERROR_STRUCT_SIZE,
               "this library knows the first");
}

static void what_ranks_do_not_have_is_refused(void **state) {
  (void)state;
  run(2, 0, refuse, NULL);
  run(2, 0, join_by_a_longer_struct, NULL);
}

static void wrong_ranks_are_told(void **state) {
  (void)state;
  const pbf_desc desc = desc_of();
  const pbf_params params = params_of();
  pbf_solver *s;
  pbf_ranks ranks = {.struct_size = sizeof ranks, .count = 2, .rank = 2};
  assert_fails(pbf_create_on_ranks(&desc, &params, NULL, &s), PBF_ERROR_INVALID_ARGUMENT,
               "ranks is null");
  assert_fails(pbf_create_on_ranks(&desc, &params, &ranks, &s), PBF_ERROR_INVALID_ARGUMENT,
               "ranks->rank is 2");
  ranks.rank = 0;
  assert_fails(pbf_create_on_ranks(&desc, &params, &ranks, &s), PBF_ERROR_INVALID_ARGUMENT,
               "a function of ranks is null");
  ranks.count = 0;
  assert_fails(pbf_create_on_ranks(&desc, &params, &ranks, &s), PBF_ERROR_INVALID_ARGUMENT,
               "ranks->count is 0");
  ranks.struct_size = 4;
  assert_fails(pbf_create_on_ranks(&desc, &params, &ranks, &s), PBF_ERROR_STRUCT_SIZE,
               "pbf_ranks.struct_size is 4");
}

/* A caller that knows of no exchange in two calls, and one that has half of it. */
static void exchange_in_one_call(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  const pbf_desc desc = desc_of();
  pbf_ranks older = *ranks, half = *ranks;
  pbf_solver *s = NULL;
  (void)context;
  older.struct_size = offsetof(pbf_ranks, begin_exchange);
  half.end_exchange = NULL;
  EXPECT_FAILS(pbf_create_on_ranks(&desc, &params, &half, &s), PBF_ERROR_INVALID_ARGUMENT,
               "both or neither, begin_exchange and end_exchange");
  s = solver_on(&older, &params);
  if (!s) return;
  const uint64_t before = thread_rank_of(ranks)->exchanges;
  fill(s, 0);
  EXPECT_OK(pbf_step(s, 2));
  EXPECT(thread_rank_of(ranks)->exchanges == before);
  pbf_destroy(s);
}

/* A caller that knows of no staging, and ones that ask for what there is not. */
static void ask_for_staging(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  const pbf_desc desc = desc_of();
  pbf_ranks wrong = *ranks, older = *ranks;
  pbf_solver *s = NULL;
  (void)context;
  wrong.host_staged = 2;
  EXPECT_FAILS(pbf_create_on_ranks(&desc, &params, &wrong, &s), PBF_ERROR_INVALID_ARGUMENT,
               "ranks->host_staged is 2; it must be 0 or 1");
  wrong.host_staged = 0, wrong.reserved = 3;
  EXPECT_FAILS(pbf_create_on_ranks(&desc, &params, &wrong, &s), PBF_ERROR_INVALID_ARGUMENT,
               "ranks->reserved is 3; it must be 0");
  older.struct_size = offsetof(pbf_ranks, host_staged);
  older.end_exchange = NULL;
  EXPECT_FAILS(pbf_create_on_ranks(&desc, &params, &older, &s), PBF_ERROR_INVALID_ARGUMENT,
               "both or neither, begin_exchange and end_exchange");
  older.end_exchange = ranks->end_exchange;
  s = solver_on(&older, &params);
  if (!s) return;
  const uint64_t before = thread_rank_of(ranks)->exchanges;
  fill(s, 0);
  EXPECT_OK(pbf_step(s, 2));
  EXPECT(thread_rank_of(ranks)->exchanges > before);
  pbf_destroy(s);
}

static void staging_may_be_asked_for(void **state) {
  (void)state;
  run(2, 0, ask_for_staging, NULL);
}

static void ranks_of_older_callers_wait_while_they_exchange(void **state) {
  (void)state;
  run(2, 0, exchange_in_one_call, NULL);
}

/* ---- Ranks that differ --------------------------------------------------------------------- */

static void differ_in_a_parameter(const pbf_ranks *ranks, void *context) {
  (void)context;
  pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  uint64_t before = 0, after = 0;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_hash(s, &before));
  params.viscosity = ranks->rank == 1 ? 0.01 : 0;
  EXPECT_OK(pbf_set_params(s, &params));
  EXPECT_FAILS(pbf_step(s, 3), PBF_ERROR_INVALID_ARGUMENT,
               "ranks 0 and 1 differ in params.viscosity: 0 and 0.01");
  params.viscosity = 0;
  EXPECT_OK(pbf_set_params(s, &params));
  EXPECT_OK(pbf_hash(s, &after));
  EXPECT(before == after);
  EXPECT_FAILS(pbf_step(s, 1 + ranks->rank), PBF_ERROR_INVALID_ARGUMENT, "arguments of the call");
  EXPECT_OK(pbf_step(s, 2));
  pbf_destroy(s);
}

static void differ_in_particles(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  float x[3] = {0.5f, 0.5f, 0.5f};
  (void)context;
  if (!s) return;
  x[0] += ranks->rank == 1 ? 1e-3f : 0;
  EXPECT_FAILS(pbf_add_particles(s, 1, x, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "ranks 0 and 1 differ in the arguments of the call");
  pbf_destroy(s);
}

static void differ_in_colliders(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  pbf_collider ball;
  (void)context;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = ranks->rank == 1 ? 0.1 : 0.2;
  EXPECT_OK(pbf_set_colliders(s, 1, &ball));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT, "ranks 0 and 1 differ in the colliders");
  pbf_destroy(s);
}

static void differ_in_phases(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  pbf_phase oil;
  (void)context;
  if (!s) return;
  EXPECT_OK(pbf_phase_init(&oil, sizeof oil));
  oil.rest_density = ranks->rank == 1 ? 0.8 : 0.9;
  fill(s, 0);
  EXPECT_OK(pbf_set_phases(s, 1, &oil));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT, "ranks 0 and 1 differ in the phases");
  pbf_destroy(s);
}

/* Each gives one rank another number than the others, and leaves the particles as they are. */
static void differ_in_emission(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  const int what = *(const int *)context;
  const double off = ranks->rank == 1 ? 1e-3 : 0;
  pbf_emitter tap;
  pbf_volume drain;
  pbf_reservoir tank;
  pbf_diffuse_desc spray;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_emitter_init(&tap, sizeof tap, PBF_EMITTER_DISC));
  EXPECT_OK(pbf_volume_init(&drain, sizeof drain, PBF_VOLUME_BOX));
  EXPECT_OK(pbf_reservoir_init(&tank, sizeof tank));
  EXPECT_OK(pbf_diffuse_init(s, &spray, sizeof spray));
  spray.capacity = 50;
  tap.radius = 0.1;
  tap.rate = 1e-6;
  tap.lifetime = 5 + off;
  for (int k = 0; k < 3; ++k) {
    tap.position[k] = drain.position[k] = 0.9;
    drain.half_extents[k] = 0.02;
    tank.position[k] = 0.75;
    tank.half_extents[k] = 0.05;
  }
  drain.position[0] += off;
  tank.depth = 0.01 + 0.01 * off;
  spray.lifetime_max += off;
  if (what == 0) EXPECT_OK(pbf_set_emitters(s, 1, &tap));
  if (what == 1) EXPECT_OK(pbf_set_drains(s, 1, &drain));
  if (what == 2) EXPECT_OK(pbf_set_reservoirs(s, 1, &tank));
  if (what == 3) EXPECT_OK(pbf_set_diffuse(s, &spray));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT,
               "emitters, drains, reservoirs, diffuse particles");
  pbf_destroy(s);
}

/* Of the same particles, with a drain that is another one's. */
static void load_other_states(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  pbf_volume drain;
  uint64_t size = 0;
  (void)context;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_volume_init(&drain, sizeof drain, PBF_VOLUME_BOX));
  for (int k = 0; k < 3; ++k) drain.position[k] = 0.9, drain.half_extents[k] = 0.02;
  EXPECT_OK(pbf_set_drains(s, 1, &drain));
  EXPECT_OK(pbf_save(s, NULL, &size));
  char *states = malloc(2 * size);
  if (!EXPECT(states)) return;
  EXPECT_OK(pbf_save(s, states, &size));
  drain.position[0] = 0.8;
  EXPECT_OK(pbf_set_drains(s, 1, &drain));
  EXPECT_OK(pbf_save(s, states + size, &size));
  EXPECT_OK(pbf_load(s, states + (ranks->rank == 1 ? size : 0), size));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT, "ranks 0 and 1 differ in emitters");
  free(states);
  pbf_destroy(s);
}

/* Steps read for them, which takes all ranks. Once all have them steps go on. */
static void differ_in_what_is_read(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  const int what = *(const int *)context;
  const uint32_t has = ranks->rank != 1;
  uint64_t before = 0, after = 1;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_set_snapshots(s, 2));
  EXPECT_OK(pbf_hash(s, &before));
  if (what == 0 && !has) EXPECT_OK(pbf_set_snapshots(s, 0));
  if (what == 1) EXPECT_OK(pbf_keep_previous(s, has));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT, "snapshots or previous positions");
  EXPECT_OK(what == 0 ? pbf_set_snapshots(s, 0) : pbf_keep_previous(s, 1));
  EXPECT_OK(pbf_hash(s, &after));
  EXPECT(before == after);
  EXPECT_OK(pbf_step(s, 1));
  pbf_destroy(s);
}

static void make_other_calls(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  pbf_stats stats = {.struct_size = sizeof stats};
  (void)context;
  if (!s) return;
  fill(s, 0);
  if (ranks->rank == 1)
    EXPECT_FAILS(pbf_get_stats(s, &stats), PBF_ERROR_INVALID_ARGUMENT,
                 "the call: pbf_step and pbf_get_stats");
  else
    EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT,
                 "the call: pbf_step and pbf_get_stats");
  EXPECT_OK(pbf_step(s, 1));
  pbf_destroy(s);
}

static void ranks_that_differ_are_told_in_what(void **state) {
  (void)state;
  run(3, 0, differ_in_a_parameter, NULL);
  run(2, 0, differ_in_particles, NULL);
  run(2, 0, differ_in_colliders, NULL);
  run(2, 0, differ_in_phases, NULL);
  run(2, 0, make_other_calls, NULL);
  for (int what = 0; what < 4; ++what) run(3, 0, differ_in_emission, &what);
  for (int what = 0; what < 2; ++what) run(3, 0, differ_in_what_is_read, &what);
  run(2, 0, load_other_states, NULL);
}

/* ---- Readers ------------------------------------------------------------------------------- */

/* Of rank 1 all snapshots are held; it has the latest that it had room for, and steps go on. */
static void hold_all(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  const uint32_t reads = ranks->rank == 1;
  pbf_snapshot held[2] = {{.struct_size = sizeof *held}, {.struct_size = sizeof *held}};
  pbf_snapshot latest = {.struct_size = sizeof latest};
  (void)context;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_set_snapshots(s, 2));
  for (int k = 0; k < 2; ++k) {
    EXPECT_OK(pbf_step(s, 1));
    if (reads) EXPECT_OK(pbf_acquire_snapshot(s, &held[k]));
  }
  for (int k = 0; k < 3; ++k) EXPECT_OK(pbf_step(s, 1));
  EXPECT_OK(pbf_acquire_snapshot(s, &latest));
  EXPECT(latest.step == (reads ? 2 : 5));
  EXPECT_OK(pbf_release_snapshot(&latest));
  for (int k = 0; k < 2 && reads; ++k) EXPECT_OK(pbf_release_snapshot(&held[k]));
  EXPECT_OK(pbf_step(s, 1));
  EXPECT_OK(pbf_acquire_snapshot(s, &latest));
  EXPECT(latest.step == 6);
  pbf_destroy(s);
  EXPECT_OK(pbf_release_snapshot(&latest));
}

static void readers_of_one_rank_stop_none(void **state) {
  (void)state;
  run(3, 0, hold_all, NULL);
}

/* ---- Memory -------------------------------------------------------------------------------- */

/* Room for a share, and not for its neighbours. */
static void hold_too_many(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  uint64_t before = 0, after = 1;
  (void)context;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_hash(s, &before));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_CAPACITY, "local_capacity is 1010");
  EXPECT_OK(pbf_hash(s, &after));
  EXPECT(before == after);
  pbf_destroy(s);
}

static void a_rank_that_is_full_ends_the_step_on_all(void **state) {
  (void)state;
  run(2, COUNT / 2 + 10, hold_too_many, NULL);
}

/* ---- Ranks that are gone ------------------------------------------------------------------- */

/* Rank 1 is gone in the midst of a step. */
static void die(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  uint64_t hash;
  (void)context;
  if (!s) return;
  fill(s, 0);
  if (ranks->rank == 1) {
    EXPECT_FAILS(pbf_step(s, 20), PBF_ERROR_UNAVAILABLE, "this rank is dead");
  } else {
    EXPECT_FAILS(pbf_step(s, 20), PBF_ERROR_UNAVAILABLE, "a rank has not answered");
    EXPECT_FAILS(pbf_hash(s, &hash), PBF_ERROR_STATE, "nothing but pbf_destroy");
    EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_STATE, "nothing but pbf_destroy");
  }
  pbf_destroy(s);
}

static void a_rank_that_dies_ends_the_call_on_all(void **state) {
  static const uint64_t after[] = {9, 12, 16, 40};
  (void)state;
  for (size_t k = 0; k < sizeof after / sizeof after[0]; ++k) {
    const uint64_t dies_after[3] = {0, after[k], 0};
    thread_ranks_run(3, 0, NULL, dies_after, die, NULL);
    assert_int_equal(ranks_failures(), 0);
  }
}

/* ---- Long calls ---------------------------------------------------------------------------- */

/* A call of many steps is made in parts, which are not what each rank takes them to be by its own
 * clock. */
static void step_for_long(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  (void)context;
  if (!s) return;
  fill(s, 0);
  for (int k = 0; k < 3; ++k) {
    if (ranks->rank == 1) thread_rank_of(ranks)->nap = 5e-5;
    EXPECT_OK(pbf_step(s, 100));
  }
  pbf_destroy(s);
}

static void clocks_of_ranks_differ(void **state) {
  (void)state;
  run(2, 0, step_for_long, NULL);
}

/* Until the call has ended: one that has not begun yet is not meant. */
typedef struct canceller {
  pbf_solver *solver;
  atomic_int over;
} canceller;

static void *cancel_soon(void *user) {
  const struct timespec a_while = {0, 50000000};
  canceller *c = user;
  do {
    nanosleep(&a_while, NULL);
    EXPECT_OK(pbf_cancel(c->solver));
  } while (!atomic_load(&c->over));
  return NULL;
}

/* A long call, which one rank cancels, all in turn; again where that has come before any step. */
static void step_until_cancelled(pbf_solver *s, int begins, int cancels) {
  pbf_info before = {.struct_size = sizeof before}, after = before;
  EXPECT_OK(pbf_get_info(s, &before));
  do {
    canceller c = {.solver = s};
    pthread_t thread;
    if (cancels && !EXPECT(pthread_create(&thread, NULL, cancel_soon, &c) == 0)) return;
    if (begins) EXPECT_OK(pbf_begin_step(s, 2000000000));
    EXPECT_FAILS(begins ? pbf_end_step(s) : pbf_step(s, 2000000000), PBF_ERROR_CANCELLED,
                 "pbf_cancel has ended the call");
    atomic_store(&c.over, 1);
    if (cancels) pthread_join(thread, NULL);
    EXPECT_OK(pbf_get_info(s, &after));
  } while (after.step == before.step && ranks_failures() == 0);
}

/* One rank's cancellation ends the call on all after the same step. */
static void cancel_one(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  pbf_info info = {.struct_size = sizeof info};
  uint64_t *steps = context;
  if (!s) return;
  fill(s, 0);
  for (int begun = 0; begun < 2; ++begun) {
    step_until_cancelled(s, begun, ranks->rank == (begun ? 0 : 2));
    EXPECT_OK(pbf_step(s, 1));
    EXPECT_OK(pbf_get_info(s, &info));
    steps[2 * ranks->rank + (uint32_t)begun] = info.step;
  }
  pbf_destroy(s);
}

static void a_cancellation_is_that_of_all(void **state) {
  uint64_t steps[6] = {0};
  (void)state;
  run(3, 0, cancel_one, steps);
  for (int k = 2; k < 6; ++k) assert_true(steps[k] == steps[k % 2] && steps[k] > 1);
}

static void destroy_while_begun(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  const struct timespec a_while = {0, 50000000L * (1 + ranks->rank)};
  pbf_solver *s = solver_on(ranks, &params);
  uint32_t count;
  (void)context;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_begin_step(s, 2000000000));
  EXPECT_FAILS(pbf_get_count(s, &count), PBF_ERROR_BUSY, "pbf_begin_step");
  nanosleep(&a_while, NULL);
  pbf_destroy(s);
  EXPECT(!thread_rank_of(ranks)->all->failed);
}

static void begun_steps_are_destroyed_on_all(void **state) {
  (void)state;
  run(3, 0, destroy_while_begun, NULL);
}

static void die_while_begun(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  (void)context;
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_begin_step(s, 2000000000));
  EXPECT_FAILS(pbf_end_step(s), PBF_ERROR_UNAVAILABLE,
               ranks->rank == 1 ? "this rank is dead" : "a rank has not answered");
  EXPECT_OK(pbf_begin_step(s, 1));
  EXPECT_FAILS(pbf_end_step(s), PBF_ERROR_STATE, "nothing but pbf_destroy");
  EXPECT_OK(pbf_begin_step(s, 1));
  pbf_destroy(s);
}

static void a_rank_that_dies_ends_begun_steps_on_all(void **state) {
  const uint64_t dies_after[3] = {0, 40, 0};
  (void)state;
  thread_ranks_run(3, 0, NULL, dies_after, die_while_begun, NULL);
  assert_int_equal(ranks_failures(), 0);
}

/* ---- States -------------------------------------------------------------------------------- */

typedef struct saved {
  void *bytes;
  uint64_t size, hash;
} saved;

static void save_one(pbf_solver *s, saved *to, int keeps) {
  uint64_t size = 0, hash = 0;
  EXPECT_OK(pbf_save(s, NULL, &size));
  void *bytes = malloc(size);
  if (!EXPECT(bytes)) return;
  EXPECT_OK(pbf_save(s, bytes, &size));
  EXPECT_OK(pbf_step(s, 10));
  EXPECT_OK(pbf_hash(s, &hash));
  if (keeps)
    *to = (saved){bytes, size, hash};
  else
    free(bytes);
}

static void save_on_ranks(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  pbf_solver *s = solver_on(ranks, &params);
  if (!s) return;
  fill(s, 0);
  EXPECT_OK(pbf_step(s, 10));
  save_one(s, context, ranks->rank == 0);
  pbf_destroy(s);
}

static void load_on_ranks(const pbf_ranks *ranks, void *context) {
  const pbf_params params = params_of();
  const saved *from = context;
  pbf_solver *s = solver_on(ranks, &params);
  uint64_t hash = 0;
  if (!s) return;
  EXPECT_OK(pbf_load(s, from->bytes, from->size));
  EXPECT_OK(pbf_step(s, 10));
  EXPECT_OK(pbf_hash(s, &hash));
  EXPECT(hash == from->hash);
  pbf_destroy(s);
}

static void a_state_goes_on_with_other_numbers_of_ranks(void **state) {
  (void)state;
  saved of_two = {0}, of_one = {0};
  run(2, 0, save_on_ranks, &of_two);
  run(1, 0, save_on_ranks, &of_one);
  assert_int_equal(of_one.size, of_two.size);
  assert_memory_equal(of_one.bytes, of_two.bytes, of_one.size);
  assert_true(of_one.hash == of_two.hash);
  run(3, 0, load_on_ranks, &of_two);
  run(1, 0, load_on_ranks, &of_two);
  free(of_one.bytes);
  free(of_two.bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_ranks_do_not_have_is_refused),
      cmocka_unit_test(wrong_ranks_are_told),
      cmocka_unit_test(ranks_of_older_callers_wait_while_they_exchange),
      cmocka_unit_test(staging_may_be_asked_for),
      cmocka_unit_test(readers_of_one_rank_stop_none),
      cmocka_unit_test(ranks_that_differ_are_told_in_what),
      cmocka_unit_test(a_rank_that_is_full_ends_the_step_on_all),
      cmocka_unit_test(a_rank_that_dies_ends_the_call_on_all),
      cmocka_unit_test(clocks_of_ranks_differ),
      cmocka_unit_test(a_cancellation_is_that_of_all),
      cmocka_unit_test(begun_steps_are_destroyed_on_all),
      cmocka_unit_test(a_rank_that_dies_ends_begun_steps_on_all),
      cmocka_unit_test(a_state_goes_on_with_other_numbers_of_ranks),
  };
  return TEST_RUN(tests);
}
