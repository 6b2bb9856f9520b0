/* Ranks of "cuda" give the bits of one solver, on as many devices as there are, of which ranks may
 * share one; what they do not have they refuse, in words. */
#include "support.h"

#include <pbf/phases.h>
#include <stdio.h>

#include "shares.h"

enum {
  COUNT = 3000,
  REMOVED = 40,
  ADDED = 300,
  STEPS = 12,
  COLLIDERS = 2,
  MAX_SOLIDS = 6 + COLLIDERS
};

/* A scene, and what one solver makes of it. */
typedef struct scene {
  uint32_t dimension, precision;
  pbf_params params;
  int comes_and_goes;            /* particles, between steps */
  void (*set_up)(pbf_solver *s); /* before there are particles; null: no */
  void (*change)(pbf_solver *s); /* between steps; null: nothing */
  uint32_t phases;               /* particles are of by turns, once they are set; 0: none */
  uint64_t hash;
  pbf_stats stats;
  void *densities, *saved; /* the state */
  uint64_t saved_size;
  pbf_collider_load loads[MAX_SOLIDS]; /* of walls, and then of colliders, if they are wanted */
  uint64_t hashes_seen[MAX_THREAD_RANKS];
  shared_ids seen; /* in the shares of the ranks */
} scene;

static int device_count = 1;

/* With a stage that one launch of all steps does not have: its sums have another order
 * (docs/notes/cuda.md). */
static pbf_params params_of(uint32_t dimension) {
  pbf_params params = test_params();
  params.pressure_grid = 0;
  params.smoothing_radius = 0.1;
  params.drag = 0.1;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = k == 0 ? 3 : 1;
  if (dimension == 2) params.domain_max[0] = 6, params.domain_max[1] = 5;
  return params;
}

static scene scene_of(uint32_t dimension, uint32_t precision) {
  return (scene){.dimension = dimension, .precision = precision, .params = params_of(dimension)};
}

static pbf_desc desc_of(const scene *c) {
  pbf_desc desc = test_desc(c->dimension, c->precision, COUNT + 400);
  desc.allocator = NULL; /* the counting one is one thread's */
  return desc;
}

/* A block at the left, in which no particle lies on a lattice. */
static void fill(const scene *c, pbf_solver *s, uint32_t count, double shift) {
  const uint32_t d = c->dimension, wide = d == 3 ? 14 : 40;
  void *x = calloc((size_t)count * d, c->precision), *v = calloc((size_t)count * d, c->precision);
  EXPECT(x);
  EXPECT(v);
  uint32_t seed = 7;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % wide, i / wide % (d == 3 ? wide : count), i / wide / wide};
    for (uint32_t k = 0; k < d; ++k) {
      seed = seed * 1664525u + 1013904223u;
      const double off = 0.4 * (seed / 4294967296.0);
      test_put(x, (uint64_t)i * d + k, c->precision, shift + 0.05 * (0.3 + at[k] + off));
      test_put(v, (uint64_t)i * d + k, c->precision, k == 0 ? 2 * off : -off);
    }
  }
  EXPECT_OK(pbf_add_particles(s, count, x, v, NULL));
  free(x);
  free(v);
}

/* Thin for a cell of a pressure grid; the ball moves into the fluid. */
static void set_plate(pbf_solver *s) {
  pbf_collider list[COLLIDERS];
  EXPECT_OK(pbf_collider_init(&list[0], sizeof list[0], PBF_COLLIDER_BOX));
  EXPECT_OK(pbf_collider_init(&list[1], sizeof list[1], PBF_COLLIDER_SPHERE));
  for (int k = 0; k < 3; ++k) list[0].position[k] = 0.35, list[0].half_extents[k] = 0.4;
  list[0].half_extents[0] = 0.012;
  list[1].position[0] = 0.9, list[1].position[1] = 0.3, list[1].position[2] = 0.3;
  list[1].radius = 0.12;
  list[1].velocity[0] = -1;
  for (int k = 0; k < COLLIDERS; ++k) list[k].friction = 0.4, list[k].static_friction = 0.6;
  list[0].no_slip = 0.5;
  EXPECT_OK(pbf_set_colliders(s, COLLIDERS, list));
}

enum { PHASES = 3 };

static void set_fluids(pbf_solver *s) {
  pbf_phase phases[PHASES];
  for (uint32_t k = 0; k < PHASES; ++k) EXPECT_OK(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = 0.6;
  phases[1].viscosity = 0.5;
  phases[2].rest_density = 3;
  EXPECT_OK(pbf_set_phases(s, PHASES, phases));
}

static void set_particle_phases(const scene *c, pbf_solver *s) {
  uint32_t phases[COUNT];
  for (uint32_t i = 0; i < COUNT; ++i) phases[i] = i / 7 % c->phases;
  EXPECT_OK(pbf_set_particle_phases(s, 0, COUNT, phases));
}

static void weigh(const scene *c, pbf_solver *s, pbf_collider_load loads[MAX_SOLIDS]) {
  uint32_t colliders = 0;
  memset(loads, 0, MAX_SOLIDS * sizeof *loads);
  if (!c->params.loads) return;
  EXPECT_OK(pbf_get_collider_count(s, &colliders));
  for (uint32_t k = 0; k < MAX_SOLIDS; ++k) loads[k].struct_size = sizeof loads[k];
  EXPECT_OK(pbf_get_wall_loads(s, 2 * c->dimension, loads));
  EXPECT_OK(pbf_get_collider_loads(s, colliders, loads + 6));
}

static void run_scene(const scene *c, pbf_solver *s) {
  if (c->set_up) c->set_up(s);
  fill(c, s, COUNT, 0);
  if (c->phases) set_particle_phases(c, s);
  EXPECT_OK(pbf_step(s, STEPS / 2));
  if (c->comes_and_goes) {
    uint32_t ids[REMOVED];
    double speed[3] = {0.5, 0.25, -0.5};
    void *v = calloc(3, c->precision);
    for (uint32_t k = 0; k < REMOVED; ++k) ids[k] = 3 + 17 * k;
    EXPECT_OK(pbf_remove_particles(s, REMOVED, ids));
    fill(c, s, ADDED, 0.03);
    for (uint32_t k = 0; k < 3 && EXPECT(v); ++k) test_put(v, k, c->precision, speed[k]);
    EXPECT_OK(pbf_set_velocities(s, 1700, 1, v));
    free(v);
  }
  if (c->change) c->change(s);
  EXPECT_OK(pbf_step(s, STEPS - STEPS / 2));
  EXPECT_OK(pbf_set_accelerations(s, 0, 0, NULL)); /* saved states have none */
}

static uint32_t count_of(pbf_solver *s) {
  uint32_t count = 0;
  EXPECT_OK(pbf_get_count(s, &count));
  return count;
}

/* The whole state, and its size; to be freed. */
static void *save(pbf_solver *s, uint64_t *size) {
  *size = 0;
  EXPECT_OK(pbf_save(s, NULL, size));
  void *bytes = malloc(*size);
  if (EXPECT(bytes)) EXPECT_OK(pbf_save(s, bytes, size));
  return bytes;
}

static void free_answers(scene *c) {
  free(c->densities);
  free(c->saved);
}

static void run_alone(scene *c) {
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = test_create(&desc, &c->params);
  run_scene(c, s);
  assert_int_equal(ranks_failures(), 0);
  c->hash = test_hash(s);
  c->saved = save(s, &c->saved_size);
  weigh(c, s, c->loads);
  c->stats = (pbf_stats){.struct_size = sizeof c->stats};
  assert_ok(pbf_get_stats(s, &c->stats));
  c->densities = calloc(count_of(s), c->precision);
  assert_ok(pbf_get_densities(s, 0, count_of(s), c->densities));
  pbf_destroy(s);
}

/* A sum's terms come in the order of the ranks. */
static int is_about(double a, double b) { return fabs(a - b) <= 1e-12 * (fabs(a) + fabs(b)); }

static void expect_same_stats(const pbf_stats *a, const pbf_stats *b) {
  EXPECT(a->count == b->count);
  EXPECT(a->iterations == b->iterations);
  EXPECT(a->asleep == b->asleep);
  EXPECT(a->neighbors_max == b->neighbors_max);
  EXPECT(a->speed_max == b->speed_max);
  EXPECT(a->density_error_max == b->density_error_max);
  EXPECT(is_about(a->density_mean, b->density_mean));
  EXPECT(is_about(a->density_error_mean, b->density_error_mean));
  EXPECT(is_about(a->neighbors_mean, b->neighbors_mean));
  EXPECT(is_about(a->kinetic_energy, b->kinetic_energy));
  for (int k = 0; k < 3; ++k) EXPECT(a->position_max[k] == b->position_max[k]);
}

static void run_on_ranks(const pbf_ranks *ranks, void *context) {
  scene *c = context;
  pbf_desc desc = desc_of(c);
  pbf_solver *s;
  pbf_stats stats = {.struct_size = sizeof stats};
  desc.device = (int)ranks->rank % device_count;
  if (!EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s))) return;
  run_scene(c, s);
  const uint32_t count = count_of(s);
  void *values = calloc(count, c->precision);
  expect_share(s, c->dimension, c->precision, &c->seen);
  EXPECT_OK(pbf_hash(s, &c->hashes_seen[ranks->rank]));
  EXPECT_OK(pbf_get_stats(s, &stats));
  expect_same_stats(&stats, &c->stats);
  uint64_t size;
  void *saved = save(s, &size);
  EXPECT(size == c->saved_size && saved && memcmp(saved, c->saved, size) == 0);
  free(saved);
  pbf_collider_load loads[MAX_SOLIDS];
  weigh(c, s, loads);
  EXPECT(memcmp(loads, c->loads, sizeof loads) == 0);
  EXPECT_OK(pbf_get_densities(s, 0, count, values));
  EXPECT(memcmp(values, c->densities, (size_t)count * c->precision) == 0);
  free(values);
  pbf_destroy(s);
}

static void expect_same_once(const char *what, scene *c, uint32_t ranks, const double *shares) {
  memset(c->hashes_seen, 0, sizeof c->hashes_seen);
  memset(&c->seen, 0, sizeof c->seen);
  thread_ranks_run(ranks, 0, shares, NULL, run_on_ranks, c);
  if (ranks_failures()) fail_msg("%s, on %u ranks: other answers", what, ranks);
  if (!each_is_in_one(&c->seen, c->stats.count)) fail_msg("%s, on %u ranks: shares", what, ranks);
  for (uint32_t r = 0; r < ranks; ++r)
    if (c->hashes_seen[r] != c->hash)
      fail_msg("%s, %uD float%u, rank %u of %u: other bits", what, c->dimension, 8 * c->precision,
               r, ranks);
}

/* Where devices write into each other's memory, and where the last one is of another host. */
static void expect_same(const char *what, scene *c, uint32_t ranks, const double *shares) {
  char text[96];
  expect_same_once(what, c, ranks, shares);
  if (ranks < 2) return;
  snprintf(text, sizeof text, "%s, the last rank staged", what);
  thread_ranks_staged_from = ranks - 1;
  expect_same_once(text, c, ranks, shares);
  thread_ranks_staged_from = MAX_THREAD_RANKS;
}

static void check(const char *what, scene *c) {
  run_alone(c);
  for (uint32_t ranks = 1; ranks <= 3; ++ranks) expect_same(what, c, ranks, NULL);
  free_answers(c);
}

static void check_plain(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  check("a dam break", &c);
  c.comes_and_goes = 1;
  check("particles that come and go", &c);
}

/* Every stage that ranks have. */
static void check_stages(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.params.damping_compensation = 1;
  c.params.angular_momentum_correction = 1;
  c.params.shear_stress_correction = 0.7;
  c.params.vorticity = 0.02;
  c.params.viscosity = 0.002;
  c.params.wall_no_slip = 1;
  c.params.surface_tension = 0.002;
  c.params.wall_adhesion = 0.4;
  c.params.collide |= PBF_COLLIDE_AFTER_SOLVE;
  c.params.time_step = 1.0 / 2000; /* there is a residual density, too */
  check("all stages", &c);
  c.params.time_step = 1.0 / 60;
  c.params.max_substeps = 8;
  check("divided steps", &c);
}

/* Whether the scene that has been run had a pressure grid. */
static void expect_grid(scene *c) {
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = test_create(&desc, &c->params);
  run_scene(c, s);
  assert_true(test_has_stage(s, "pressure grid"));
  pbf_destroy(s);
}

/* By where they are. */
static void accelerate(pbf_solver *s) {
  const uint32_t count = count_of(s);
  double *a = calloc(3 * (size_t)count, sizeof *a);
  if (!EXPECT(a)) return;
  EXPECT_OK(pbf_get_positions(s, 0, count, a));
  EXPECT_OK(pbf_set_accelerations(s, 0, count, a));
  free(a);
}

/* Of a grid that is asked for, one that a plate tears, and one that deep water has by default. */
static void check_grids(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.params.pressure_grid = 2;
  c.comes_and_goes = 1;
  expect_grid(&c);
  check("a pressure grid", &c);
  c.set_up = set_plate;
  c.change = accelerate;
  check("a pressure grid that a plate divides, and accelerations", &c);
  c = scene_of(dimension, precision);
  c.params.pressure_grid = -1;
  c.params.shear_stress_correction = -1;
  c.params.domain_max[0] = dimension == 3 ? 0.72 : 2;
  c.params.domain_max[2] = 0.85;
  c.params.domain_max[1] = 6;
  c.params.time_step = 1.0 / 60;
  expect_grid(&c);
  check("deep water", &c);
}

/* What a plate and a ball do to the fluid along themselves is told to them, too. */
static void check_loads(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.set_up = set_plate;
  c.params.wall_friction = 0.3;
  c.params.iterations = 8;
  c.params.tolerance = 0.02;
  check("friction, and a solve that ends", &c);
  assert_in_range(c.stats.iterations, 2, 7);
  c.params.tolerance = 0;
  c.params.iterations = 4;
  c.params.loads = 1;
  c.params.pressure_grid = 2;
  c.params.viscosity = 0.002;
  c.params.wall_no_slip = 1;
  check("loads", &c);
}

static void so_are_loads_and_friction(void **state) {
  (void)state;
  test_for_each_kind(check_loads);
}

/* Of which others' particles are, too, and stages that know of mass. */
static void check_fluids(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.set_up = set_fluids;
  c.phases = PHASES;
  c.comes_and_goes = 1;
  c.params.loads = 1;
  c.params.wall_friction = 0.3;
  c.params.viscosity = 0.002;
  c.params.damping_compensation = 1;
  c.params.angular_momentum_correction = 1;
  check("phases", &c);
}

static void so_are_fluids(void **state) {
  (void)state;
  test_for_each_kind(check_fluids);
}

/* Across which ranks are, and are not, cut. */
static void check_periodic(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.params.gravity[0] = -30; /* across the face */
  c.params.periodic = PBF_PERIODIC_X | PBF_PERIODIC_Y;
  c.params.shear_stress_correction = 0.7;
  c.params.loads = 1;
  c.comes_and_goes = 1;
  check("periodic axes", &c);
  if (dimension == 2) return;
  c.params.periodic = PBF_PERIODIC_Z;
  check("the last axis", &c);
}

static void so_are_periodic_axes(void **state) {
  (void)state;
  test_for_each_kind(check_periodic);
}

/* Something falls into what has fallen asleep; and all sleep, until the ball comes. */
static void check_sleep(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.params.sleep_speed = dimension == 3 ? 1 : 1.5;
  c.params.sleep_time = 0.02;
  c.comes_and_goes = 1;
  c.set_up = set_plate;
  c.params.loads = 1;
  check("sleep", &c);
  assert_in_range(c.stats.asleep, COUNT / 10, COUNT - REMOVED + ADDED - 1);
  c = scene_of(dimension, precision);
  c.params.sleep_speed = 100;
  c.params.sleep_time = 0.01;
  c.params.loads = 1;
  check("all asleep", &c);
  assert_int_equal(c.stats.asleep, COUNT);
  c.set_up = set_plate;
  check("all asleep but near a ball", &c);
  assert_in_range(c.stats.asleep, COUNT / 10, COUNT - 1);
}

/* A plate that stands among sleepers of some ranks leaves, and those of all wake. */
static void set_standing_plate(pbf_solver *s) {
  pbf_collider plate;
  EXPECT_OK(pbf_collider_init(&plate, sizeof plate, PBF_COLLIDER_BOX));
  for (int k = 0; k < 3; ++k) plate.position[k] = 0.35, plate.half_extents[k] = 0.012;
  EXPECT_OK(pbf_set_colliders(s, 1, &plate));
}

static void remove_plate(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(stats.asleep == COUNT);
  EXPECT_OK(pbf_set_colliders(s, 0, NULL));
}

static void remove_plate_and_look(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  remove_plate(s);
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(stats.asleep == 0);
}

static void check_left_sleepers(uint32_t dimension, uint32_t precision) {
  scene c = scene_of(dimension, precision);
  c.params.sleep_speed = 100;
  c.params.sleep_time = 0.01;
  c.set_up = set_standing_plate;
  c.change = remove_plate;
  check("a plate leaves sleepers", &c);
  c.change = remove_plate_and_look;
  check("a plate leaves sleepers, which are counted", &c);
}

static void so_is_sleep(void **state) {
  (void)state;
  test_for_each_kind(check_sleep);
  test_for_each_kind(check_left_sleepers);
}

static void so_are_pressure_grids(void **state) {
  (void)state;
  test_for_each_kind(check_grids);
}

static void a_dam_break_is_the_same(void **state) {
  (void)state;
  test_for_each_kind(check_plain);
}

static void so_are_all_stages(void **state) {
  (void)state;
  test_for_each_kind(check_stages);
}

/* Walls of which each rank has some, and a grid whose cells wrap. */
static void so_are_mirrors_and_sparse_particles(void **state) {
  (void)state;
  scene c = scene_of(3, PBF_FLOAT32);
  c.params.spacing = 0.05;
  c.params.smoothing_radius = 0.135;
  check("walls that mirror", &c);
  c = scene_of(3, PBF_FLOAT32);
  for (uint32_t k = 0; k < 3; ++k) c.params.domain_max[k] = 200;
  c.params.gravity[1] = 0;
  c.params.attraction = -40; /* blows it apart */
  check("sparse particles", &c);
}

/* Shares that have one warp, nearly all, and none. */
static void it_does_not_matter_where_space_is_cut(void **state) {
  static const double shares[][3] = {{1000, 1, 1}, {1, 3, 900}, {1, 2, 3}};
  (void)state;
  scene c = scene_of(3, PBF_FLOAT32);
  c.params.loads = 1;
  c.params.iterations = 8;
  c.params.tolerance = 0.02;
  run_alone(&c);
  for (size_t k = 0; k < sizeof shares / sizeof shares[0]; ++k)
    expect_same("uneven shares", &c, 3, shares[k]);
  free_answers(&c);
}

static void refuse(const pbf_ranks *ranks, void *context) {
  scene *c = context;
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = NULL;
  float pressure;
  if (!EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s))) return;
  fill(c, s, COUNT, 0);
  EXPECT_FAILS(pbf_get_pressures(s, 0, 1, &pressure), PBF_ERROR_UNSUPPORTED, "on ranks");
  EXPECT_FAILS(pbf_step(s, 1 + ranks->rank), PBF_ERROR_INVALID_ARGUMENT, "arguments of the call");
  EXPECT_OK(pbf_step(s, 2));
  pbf_destroy(s);
}

static void what_ranks_do_not_have_is_refused(void **state) {
  (void)state;
  scene c = scene_of(3, PBF_FLOAT32);
  thread_ranks_run(2, 0, NULL, NULL, refuse, &c);
  assert_int_equal(ranks_failures(), 0);
}

/* A step for which a rank has no room is none, and the state is what it was. */
static void too_little_room(const pbf_ranks *ranks, void *context) {
  scene *c = context;
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = NULL;
  uint64_t before = 0, after = 1;
  if (!EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s))) return;
  fill(c, s, COUNT, 0);
  EXPECT_OK(pbf_hash(s, &before));
  EXPECT_FAILS(pbf_step(s, 1), PBF_ERROR_CAPACITY, "local_capacity");
  EXPECT_OK(pbf_hash(s, &after));
  EXPECT(before == after);
  pbf_destroy(s);
}

static void too_little_room_is_told(void **state) {
  (void)state;
  scene c = scene_of(3, PBF_FLOAT32);
  c.params.prestabilization = 0;
  for (uint32_t staged_from = 0; staged_from < 3; ++staged_from) {
    thread_ranks_staged_from = staged_from;
    thread_ranks_run(2, COUNT / 2 + 32, NULL, NULL, too_little_room, &c);
    assert_int_equal(ranks_failures(), 0);
  }
  thread_ranks_staged_from = MAX_THREAD_RANKS;
}

/* Rank 1 is gone in the midst of a step, and what is staged does not come. */
static void die(const pbf_ranks *ranks, void *context) {
  scene *c = context;
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = NULL;
  uint64_t hash;
  if (!EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s))) return;
  fill(c, s, COUNT, 0);
  EXPECT_FAILS(pbf_step(s, 20), PBF_ERROR_UNAVAILABLE,
               ranks->rank == 1 ? "this rank is dead" : "a rank has not answered");
  if (ranks->rank != 1)
    EXPECT_FAILS(pbf_hash(s, &hash), PBF_ERROR_STATE, "nothing but pbf_destroy");
  pbf_destroy(s);
}

static void a_staged_rank_that_dies_ends_the_call_on_all(void **state) {
  static const uint64_t after[] = {12, 13, 14, 15, 16, 17, 18, 40};
  (void)state;
  scene c = scene_of(3, PBF_FLOAT32);
  thread_ranks_staged_from = 0;
  for (size_t k = 0; k < sizeof after / sizeof after[0]; ++k) {
    const uint64_t dies_after[2] = {0, after[k]};
    thread_ranks_run(2, 0, NULL, dies_after, die, &c);
    assert_int_equal(ranks_failures(), 0);
  }
  thread_ranks_staged_from = MAX_THREAD_RANKS;
}

/* Devices are numbered without a gap. */
static int count_devices(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 64);
  pbf_solver *s;
  for (desc.device = 1; desc.device < MAX_THREAD_RANKS; ++desc.device) {
    if (pbf_create(&desc, NULL, &s) != PBF_OK) break;
    pbf_destroy(s);
  }
  device_count = desc.device;
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup(a_dam_break_is_the_same, count_devices),
      cmocka_unit_test(so_are_all_stages),
      cmocka_unit_test(so_are_pressure_grids),
      cmocka_unit_test(so_are_loads_and_friction),
      cmocka_unit_test(so_are_fluids),
      cmocka_unit_test(so_are_periodic_axes),
      cmocka_unit_test(so_is_sleep),
      cmocka_unit_test(so_are_mirrors_and_sparse_particles),
      cmocka_unit_test(it_does_not_matter_where_space_is_cut),
      cmocka_unit_test(what_ranks_do_not_have_is_refused),
      cmocka_unit_test(too_little_room_is_told),
      cmocka_unit_test(a_staged_rank_that_dies_ends_the_call_on_all),
  };
  return TEST_RUN(tests);
}
