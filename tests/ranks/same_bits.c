/* Ranks give the bits of one solver, whatever the scene has, and wherever space is cut. */
#include <pbf/emit.h>

#include "scenes.h"

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

/* Particles come and go between steps, and in them. */
static void come_and_go(const scene *c, pbf_solver *s) {
  uint32_t ids[40];
  for (uint32_t k = 0; k < 40; ++k) ids[k] = 3 + 17 * k;
  EXPECT_OK(pbf_remove_particles(s, 40, ids));
  scene_fill(c, s, 300, 0.03);
  set_jets(s);
  set_pools(s);
}

/* Calls of all scenes below, for a kind. */
static void check_plain(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  scene_check("a dam break", &c);
}

static void check_colliders(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.colliders = SCENE_COLLIDERS;
  c.change = come_and_go;
  c.asks = 1;
  c.params.wall_velocity[PBF_WALL_X_MIN] = 0.3;
  scene_check("colliders, and particles that come and go", &c);
}

/* Every stage that ranks have. */
static void check_stages(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.colliders = SCENE_COLLIDERS;
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
  scene_check("all stages", &c);
  c.params.time_step = 1.0 / 60;
  c.params.max_substeps = 8;
  scene_check("divided steps", &c);
}

static void check_paper(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.solver = PBF_SOLVER_JACOBI;
  c.params.kernel = PBF_KERNEL_POLY6_SPIKY;
  c.params.scorr_k = 1e-4;
  c.params.scorr_dq = 0.2;
  c.params.scorr_n = 4;
  c.params.viscosity = 0.001;
  c.params.wall_density = 0;
  c.params.damping_compensation = c.params.angular_momentum_correction = 0;
  c.params.prestabilization = c.params.max_depenetration_speed = 0;
  scene_check("the paper's method", &c);
}

static void check_tolerance(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.tolerance = 0.004;
  c.params.iterations = 30;
  scene_check("a tolerance", &c);
}

/* Images of others' particles in walls, of which the domain has some on each rank. */
static void check_ghosts(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.params.spacing = 0.05;
  c.params.smoothing_radius = 0.135;
  scene_check("walls that mirror", &c);
}

/* A grid whose cells wrap, for it has room for more than there are. */
static void check_sparse(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  for (uint32_t k = 0; k < dimension; ++k) c.params.domain_max[k] = 200;
  c.count = 400;
  c.params.gravity[1] = 0;
  c.params.attraction = -40; /* blows it apart */
  scene_check("sparse particles", &c);
}

/* They reach a particle on whichever rank it is. */
static void check_accelerated(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  scene_run_alone(&c);
  const uint64_t without = c.hash;
  scene_free(&c);
  c.change = scene_accelerate;
  scene_check("accelerations", &c);
  assert_true(c.hash != without);
}

static void check_few(uint32_t dimension, uint32_t precision) {
  scene c = scene_plain(dimension, precision);
  c.count = 20;
  scene_check("fewer particles than make groups for all", &c);
}

static void a_dam_break_is_the_same(void **state) {
  (void)state;
  test_for_each_kind(check_plain);
}

static void so_are_colliders_and_jets(void **state) {
  (void)state;
  test_for_long_kinds(check_colliders);
}

static void so_are_all_stages(void **state) {
  (void)state;
  test_for_long_kinds(check_stages);
}

static void so_is_the_method_of_the_paper(void **state) {
  (void)state;
  test_for_long_kinds(check_paper);
}

static void so_is_a_solve_that_ends_at_a_tolerance(void **state) {
  (void)state;
  test_for_long_kinds(check_tolerance);
}

static void so_are_walls_that_mirror(void **state) {
  (void)state;
  test_for_long_kinds(check_ghosts);
}

static void so_are_sparse_particles(void **state) {
  (void)state;
  test_for_long_kinds(check_sparse);
}

static void so_are_accelerations(void **state) {
  (void)state;
  test_for_long_kinds(check_accelerated);
}

static void so_are_few_particles(void **state) {
  (void)state;
  test_for_long_kinds(check_few);
}

/* Shares that have one group, and nearly all. */
static void it_does_not_matter_where_space_is_cut(void **state) {
  static const double shares[][3] = {{1, 1, 1}, {1000, 1, 1}, {1, 3, 900}, {1, 2, 3}};
  (void)state;
  scene c = scene_plain(3, PBF_FLOAT32);
  scene_run_alone(&c);
  for (size_t k = 0; k < sizeof shares / sizeof shares[0]; ++k)
    scene_expect_same("uneven shares", &c, 3, shares[k]);
  scene_free(&c);
}

static void nor_whether_ranks_work_while_they_exchange(void **state) {
  (void)state;
  thread_ranks_overlap = 0;
  test_for_long_kinds(check_plain);
  test_for_long_kinds(check_stages);
  thread_ranks_overlap = 1;
}

static void nor_how_wide_groups_are(void **state) {
  (void)state;
  scene c = scene_plain(3, PBF_FLOAT32);
  if (!BUILT_WITH_SCALAR) test_skip("built without the instruction set \"scalar\"");
  c.isa = "scalar";
  scene_check("one lane", &c);
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
      cmocka_unit_test(nor_whether_ranks_work_while_they_exchange),
      cmocka_unit_test(nor_how_wide_groups_are),
  };
  return TEST_RUN(tests);
}
