/* Ranks give the bits of one solver, whatever the scene has, and wherever space is cut. */
#include <pbf/emit.h>

#include "support.h"

#include <stdio.h>

#include "thread_ranks.h"

enum { COUNT = 3000, STEPS = 12, COLLIDERS = 2 };

/* A scene, and what one solver makes of it. */
typedef struct scene {
  uint32_t dimension, precision, count;
  pbf_params params;
  uint32_t colliders;
  int jets;        /* particles come and go between steps, and in them */
  int accelerated; /* half of them, from half of the steps on */
  const char *isa; /* null: the best */
  uint64_t hash;   /* after the steps */
  pbf_stats stats; /* and what else is asked for */
  void *densities, *pressures;
  double asked[4]; /* velocity and level at a point, particles in a ball */
  uint64_t hashes_seen[MAX_THREAD_RANKS];
} scene;

static pbf_params params_of(uint32_t dimension) {
  pbf_params params = test_params();
  params.pressure_grid = 0;
  params.smoothing_radius = 0.1;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = k == 0 ? 3 : 1;
  if (dimension == 2) params.domain_max[0] = 6, params.domain_max[1] = 5;
  return params;
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

static void add_colliders(const scene *c, pbf_solver *s) {
  pbf_collider list[COLLIDERS];
  if (!c->colliders) return;
  EXPECT_OK(pbf_collider_init(&list[0], sizeof list[0], PBF_COLLIDER_SPHERE));
  EXPECT_OK(pbf_collider_init(&list[1], sizeof list[1], PBF_COLLIDER_BOX));
  list[0].position[0] = 0.9;
  list[0].position[1] = 0.3;
  list[0].position[2] = 0.4;
  list[0].radius = 0.15;
  list[0].velocity[0] = -0.8;
  for (int k = 0; k < 3; ++k) list[1].position[k] = 0.3, list[1].half_extents[k] = 0.08;
  list[1].angular_velocity[2] = 3;
  list[1].no_slip = 0.5;
  list[1].adhesion = 0.7; /* where there is a tension */
  EXPECT_OK(pbf_set_colliders(s, COLLIDERS, list));
}

static void set_jets(pbf_solver *s) {
  pbf_emitter tap;
  pbf_volume drain;
  EXPECT_OK(pbf_emitter_init(&tap, sizeof tap, PBF_EMITTER_DISC));
  EXPECT_OK(pbf_volume_init(&drain, sizeof drain, PBF_VOLUME_SPHERE));
  for (int k = 0; k < 3; ++k) tap.position[k] = 0.4, drain.position[k] = 0.2;
  tap.radius = 0.1;
  tap.lifetime = 4 / 120.0;
  drain.radius = 0.06;
  EXPECT_OK(pbf_set_emitters(s, 1, &tap));
  EXPECT_OK(pbf_set_drains(s, 1, &drain));
}

static void set_pools(pbf_solver *s) {
  pbf_reservoir pool;
  EXPECT_OK(pbf_reservoir_init(&pool, sizeof pool));
  for (int k = 0; k < 3; ++k) pool.position[k] = 0.3, pool.half_extents[k] = 0.15;
  pool.depth = 0.2;
  pool.pressure = 0.5;
  EXPECT_OK(pbf_set_reservoirs(s, 1, &pool));
}

/* Every other particle of the first half, by where it is. */
static void accelerate(const scene *c, pbf_solver *s) {
  const uint32_t d = c->dimension, count = c->count / 2;
  void *a = calloc((size_t)count * d, c->precision);
  EXPECT(a);
  EXPECT_OK(pbf_get_positions(s, 0, count, a));
  for (uint32_t i = 1; i < count; i += 2)
    memset((char *)a + i * d * c->precision, 0, d * c->precision);
  EXPECT_OK(pbf_set_accelerations(s, 0, count, a));
  free(a);
}

static void ask(pbf_solver *s, double asked[4]) {
  const double x[3] = {0.35, 0.3, 0.35};
  double v[3];
  uint32_t count = 0;
  pbf_volume ball;
  EXPECT_OK(pbf_sample(
      s, &(pbf_samples){
             .struct_size = sizeof(pbf_samples), .count = 1, .points = x, .velocities = v}));
  EXPECT_OK(pbf_get_levels(s, 1, x, &asked[2]));
  EXPECT_OK(pbf_volume_init(&ball, sizeof ball, PBF_VOLUME_SPHERE));
  EXPECT_OK(pbf_find_in_volume(s, &ball, 0, NULL, &count));
  asked[0] = v[0];
  asked[1] = v[1];
  asked[3] = count;
}

static void run_scene(const scene *c, pbf_solver *s) {
  add_colliders(c, s);
  fill(c, s, c->count, 0);
  EXPECT_OK(pbf_step(s, STEPS / 2));
  if (c->jets) {
    uint32_t ids[40];
    for (uint32_t k = 0; k < 40; ++k) ids[k] = 3 + 17 * k;
    EXPECT_OK(pbf_remove_particles(s, 40, ids));
    fill(c, s, 300, 0.03);
    set_jets(s);
    set_pools(s);
  }
  if (c->accelerated) accelerate(c, s);
  EXPECT_OK(pbf_step(s, STEPS - STEPS / 2));
}

static pbf_desc desc_of(const scene *c) {
  pbf_desc desc = test_desc(c->dimension, c->precision, c->count + 400);
  desc.threads = 1;
  desc.allocator = NULL; /* the counting one is one thread's */
  if (c->isa) desc.isa = c->isa;
  return desc;
}

static uint32_t count_of(pbf_solver *s) {
  uint32_t count = 0;
  EXPECT_OK(pbf_get_count(s, &count));
  return count;
}

static void run_alone(scene *c) {
  const pbf_desc desc = desc_of(c);
  pbf_solver *s = test_create(&desc, &c->params);
  run_scene(c, s);
  assert_int_equal(ranks_failures(), 0);
  const uint32_t count = count_of(s);
  c->hash = test_hash(s);
  if (c->jets) ask(s, c->asked);
  c->stats = (pbf_stats){.struct_size = sizeof c->stats};
  assert_ok(pbf_get_stats(s, &c->stats));
  c->densities = calloc(count, c->precision);
  c->pressures = calloc(count, c->precision);
  assert_ok(pbf_get_densities(s, 0, count, c->densities));
  if (c->params.solver == PBF_SOLVER_CHEBYSHEV)
    assert_ok(pbf_get_pressures(s, 0, count, c->pressures));
  pbf_destroy(s);
}

static void free_answers(scene *c) {
  free(c->densities);
  free(c->pressures);
}

static void run_on_ranks(const pbf_ranks *ranks, void *context) {
  scene *c = context;
  const pbf_desc desc = desc_of(c);
  pbf_solver *s;
  pbf_stats stats = {.struct_size = sizeof stats};
  if (!EXPECT_OK(pbf_create_on_ranks(&desc, &c->params, ranks, &s))) return;
  run_scene(c, s);
  const uint32_t count = count_of(s);
  void *values = calloc(count, c->precision);
  EXPECT_OK(pbf_hash(s, &c->hashes_seen[ranks->rank]));
  EXPECT_OK(pbf_get_stats(s, &stats));
  EXPECT(memcmp(&stats, &c->stats, sizeof stats) == 0);
  double asked[4] = {0};
  if (c->jets) ask(s, asked);
  EXPECT(memcmp(asked, c->asked, sizeof asked) == 0);
  EXPECT_OK(pbf_get_densities(s, 0, count, values));
  EXPECT(memcmp(values, c->densities, (size_t)count * c->precision) == 0);
  if (c->params.solver == PBF_SOLVER_CHEBYSHEV) {
    EXPECT_OK(pbf_get_pressures(s, 0, count, values));
    EXPECT(memcmp(values, c->pressures, (size_t)count * c->precision) == 0);
  }
  free(values);
  pbf_destroy(s);
}

static void expect_same(const char *what, scene *c, uint32_t ranks, const double *shares) {
  memset(c->hashes_seen, 0, sizeof c->hashes_seen);
  thread_ranks_run(ranks, 0, shares, NULL, run_on_ranks, c);
  assert_int_equal(ranks_failures(), 0);
  for (uint32_t r = 0; r < ranks; ++r)
    if (c->hashes_seen[r] != c->hash)
      fail_msg("%s, %uD float%u, rank %u of %u: other bits", what, c->dimension, 8 * c->precision,
               r, ranks);
}

static void check(const char *what, scene *c) {
  static const uint32_t counts[] = {1, 2, 3, 8};
  run_alone(c);
  for (size_t k = 0; k < sizeof counts / sizeof counts[0]; ++k)
    expect_same(what, c, counts[k], NULL);
  free_answers(c);
}

static scene plain(uint32_t dimension, uint32_t precision) {
  return (scene){.dimension = dimension,
                 .precision = precision,
                 .count = COUNT,
                 .params = params_of(dimension)};
}

/* Calls of all scenes below, for a kind. */
static void check_plain(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  check("a dam break", &c);
}

static void check_colliders(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  c.colliders = COLLIDERS;
  c.jets = 1;
  c.params.wall_velocity[PBF_WALL_X_MIN] = 0.3;
  check("colliders, and particles that come and go", &c);
}

/* Every stage that ranks have. */
static void check_stages(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  c.colliders = COLLIDERS;
  c.params.damping_compensation = 1;
  c.params.angular_momentum_correction = 1;
  c.params.shear_stress_correction = 0.7;
  c.params.vorticity = 0.02;
  c.params.viscosity = 0.002;
  c.params.wall_no_slip = 1;
  c.params.surface_tension = 0.002;
  c.params.wall_adhesion = 0.4;
  c.params.drag = 0.3;
  c.params.drag_velocity[0] = 1;
  c.params.collide |= PBF_COLLIDE_AFTER_SOLVE;
  c.params.time_step = 1.0 / 2000; /* there is a residual density, too */
  check("all stages", &c);
  c.params.time_step = 1.0 / 60;
  c.params.max_substeps = 8;
  check("divided steps", &c);
}

static void check_paper(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  c.params.solver = PBF_SOLVER_JACOBI;
  c.params.kernel = PBF_KERNEL_POLY6_SPIKY;
  c.params.scorr_k = 1e-4;
  c.params.scorr_dq = 0.2;
  c.params.scorr_n = 4;
  c.params.viscosity = 0.001;
  c.params.wall_density = 0;
  c.params.damping_compensation = c.params.angular_momentum_correction = 0;
  c.params.prestabilization = c.params.max_depenetration_speed = 0;
  check("the paper's method", &c);
}

static void check_tolerance(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  c.params.tolerance = 0.004;
  c.params.iterations = 30;
  check("a tolerance", &c);
}

/* Images of others' particles in walls, of which the domain has some on each rank. */
static void check_ghosts(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  c.params.spacing = 0.05;
  c.params.smoothing_radius = 0.135;
  check("walls that mirror", &c);
}

/* A grid whose cells wrap, for it has room for more than there are. */
static void check_sparse(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  for (uint32_t k = 0; k < dimension; ++k) c.params.domain_max[k] = 200;
  c.count = 400;
  c.jets = 0;
  c.params.gravity[1] = 0;
  c.params.attraction = -40; /* blows it apart */
  check("sparse particles", &c);
}

/* They reach a particle on whichever rank it is. */
static void check_accelerated(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  run_alone(&c);
  const uint64_t without = c.hash;
  free_answers(&c);
  c.accelerated = 1;
  check("accelerations", &c);
  assert_true(c.hash != without);
}

static void check_few(uint32_t dimension, uint32_t precision) {
  scene c = plain(dimension, precision);
  c.count = 20;
  check("fewer particles than make groups for all", &c);
}

static void a_dam_break_is_the_same(void **state) {
  (void)state;
  test_for_each_kind(check_plain);
}

static void so_are_colliders_and_jets(void **state) {
  (void)state;
  test_for_each_kind(check_colliders);
}

static void so_are_all_stages(void **state) {
  (void)state;
  test_for_each_kind(check_stages);
}

static void so_is_the_method_of_the_paper(void **state) {
  (void)state;
  test_for_each_kind(check_paper);
}

static void so_is_a_solve_that_ends_at_a_tolerance(void **state) {
  (void)state;
  test_for_each_kind(check_tolerance);
}

static void so_are_walls_that_mirror(void **state) {
  (void)state;
  test_for_each_kind(check_ghosts);
}

static void so_are_sparse_particles(void **state) {
  (void)state;
  test_for_each_kind(check_sparse);
}

static void so_are_accelerations(void **state) {
  (void)state;
  test_for_each_kind(check_accelerated);
}

static void so_are_few_particles(void **state) {
  (void)state;
  test_for_each_kind(check_few);
}

/* Shares that have one group, and nearly all. */
static void it_does_not_matter_where_space_is_cut(void **state) {
  static const double shares[][3] = {{1, 1, 1}, {1000, 1, 1}, {1, 3, 900}, {1, 2, 3}};
  (void)state;
  scene c = plain(3, PBF_FLOAT32);
  run_alone(&c);
  for (size_t k = 0; k < sizeof shares / sizeof shares[0]; ++k)
    expect_same("uneven shares", &c, 3, shares[k]);
  free_answers(&c);
}

static void nor_how_wide_groups_are(void **state) {
  (void)state;
  scene c = plain(3, PBF_FLOAT32);
  if (!BUILT_WITH_SCALAR) test_skip("built without the instruction set \"scalar\"");
  c.isa = "scalar";
  check("one lane", &c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_dam_break_is_the_same),
      cmocka_unit_test(so_are_colliders_and_jets),
      cmocka_unit_test(so_are_all_stages),
      cmocka_unit_test(so_is_the_method_of_the_paper),
      cmocka_unit_test(so_is_a_solve_that_ends_at_a_tolerance),
      cmocka_unit_test(so_are_walls_that_mirror),
      cmocka_unit_test(so_are_sparse_particles),
      cmocka_unit_test(so_are_accelerations),
      cmocka_unit_test(so_are_few_particles),
      cmocka_unit_test(it_does_not_matter_where_space_is_cut),
      cmocka_unit_test(nor_how_wide_groups_are),
  };
  return TEST_RUN(tests);
}
