/* What queries keep between calls, and what they refuse. */
#include "query_scene.h"

typedef struct answers {
  double density[POINTS], velocity[POINTS * 3], distance[POINTS], level[POINTS];
  pbf_volume_flow flow;
} answers;

static answers ask(const pool *p) {
  answers a;
  double x[POINTS * 3], down[POINTS * 3];
  uint32_t seed = 11;
  pbf_volume box = volume_of(PBF_VOLUME_BOX);
  memset(&a, 0, sizeof a);
  for (uint32_t i = 0; i < POINTS * p->dimension; ++i) {
    x[i] = random_in(&seed, 0, 1.2 * SIDE * d);
    down[i] = random_in(&seed, -1, 1);
  }
  assert_ok(pbf_sample(p->solver, &(pbf_samples){.struct_size = sizeof(pbf_samples),
                                                 .count = POINTS,
                                                 .points = x,
                                                 .densities = a.density,
                                                 .velocities = a.velocity}));
  assert_ok(pbf_cast_rays(p->solver, POINTS, x, down, INFINITY, a.distance, NULL));
  assert_ok(pbf_get_levels(p->solver, POINTS, x, a.level));
  box.half_extents[0] = box.half_extents[1] = box.half_extents[2] = 3 * d;
  a.flow = measure(p, &box);
  return a;
}

static pool copy_of(const pool *p) {
  uint64_t size;
  void *state = test_save(p->solver, &size);
  pool copy = *p;
  copy.solver = test_solver(p->dimension, p->precision, MOST + 8);
  assert_ok(pbf_load(copy.solver, state, size));
  free(state);
  return copy;
}

/* As from a solver that is asked for the first time. */
static void check_fresh(const pool *p) {
  const pool copy = copy_of(p);
  const answers a = ask(p), b = ask(&copy);
  assert_memory_equal(&a, &b, sizeof a);
  pbf_destroy(copy.solver);
}

/* What is kept is of the particles as they are now, and the order of adding does not matter but to
 * rounding: ids decide. */
static void check_kept(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, slope, 1);
  double raw[3] = {0};
  const uint64_t before = test_hash(p.solver);
  answers first = ask(&p), again = ask(&p);
  assert_memory_equal(&first, &again, sizeof first);
  assert_true(test_hash(p.solver) == before);
  assert_ok(pbf_step(p.solver, 3));
  again = ask(&p);
  assert_memory_not_equal(&first, &again, sizeof first);
  check_fresh(&p);
  for (uint32_t k = 0; k < dimension; ++k) test_put(raw, k, precision, 0.31);
  assert_ok(pbf_set_positions(p.solver, p.count / 2, 1, raw));
  check_fresh(&p);
  assert_ok(pbf_set_velocities(p.solver, p.count / 3, 1, raw));
  check_fresh(&p);
  assert_ok(pbf_remove_particles(p.solver, 3, (const uint32_t[]){5, 60, 97}));
  check_fresh(&p);
  assert_ok(pbf_add_particles(p.solver, 1, raw, NULL, NULL));
  check_fresh(&p);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(p.solver, &params));
  params.smoothing_radius *= 1.25;
  assert_ok(pbf_set_params(p.solver, &params));
  check_fresh(&p);
  assert_ok(pbf_end_queries(p.solver));
  check_fresh(&p);
  pbf_destroy(p.solver);
}

static void answers_follow_changes(void **state) {
  (void)state;
  test_for_each_kind(check_kept);
}

/* All others after the first one, as long as there are not more particles. */
static void nothing_is_allocated(void **state) {
  (void)state;
  const pool p = pool_of(3, PBF_FLOAT32, slope, 1);
  double x[3] = {0.3, 0.3, 0.3}, v[3], surface;
  const pbf_samples samples = {
      .struct_size = sizeof samples, .count = 1, .points = x, .velocities = v};
  assert_ok(pbf_sample(p.solver, &samples));
  assert_ok(pbf_step(p.solver, 1));
  const uint64_t calls = test_count.calls, blocks = test_count.live_blocks;
  const pbf_volume ball = volume_of(PBF_VOLUME_SPHERE);
  for (int i = 0; i < 3; ++i) {
    measure(&p, &ball);
    assert_ok(pbf_sample(p.solver, &samples));
    assert_ok(pbf_get_levels(p.solver, 1, x, &surface));
  }
  if (strcmp(test_backend(), "cuda") != 0) assert_int_equal(test_count.calls, calls);
  assert_ok(pbf_end_queries(p.solver));
  assert_int_equal(test_count.live_blocks, blocks - 2);
  pbf_destroy(p.solver);
  assert_int_equal(test_count.live_blocks, 0);
}

static void no_particles(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 8);
  const pool p = {s, 3, PBF_FLOAT32, 0};
  const answers a = ask(&p);
  assert_true(a.density[0] == 0 && a.velocity[0] == 0 && isinf(a.distance[0]));
  assert_true(isnan(a.level[0]) && a.flow.fraction == 0);
  pbf_destroy(s);
}

static const pbf_status bad = PBF_ERROR_INVALID_ARGUMENT;

static void volumes_refused(void **state) {
  (void)state;
  const pool p = pool_of(2, PBF_FLOAT32, slope, 1);
  pbf_volume v = volume_of(PBF_VOLUME_BOX), two[2] = {v, v};
  pbf_volume_flow found = {.struct_size = sizeof found, .volume = 99};
  uint32_t count = 7;
  assert_fails(pbf_volume_init(&v, sizeof v, 3), bad, "shape is 3");
  assert_fails(pbf_volume_init(NULL, sizeof v, 0), bad, "volume is null");
  assert_fails(pbf_find_in_volume(p.solver, NULL, 0, NULL, &count), bad, "volume is null");
  assert_fails(pbf_find_in_volume(p.solver, &v, 1, NULL, &count), bad, "ids is null");
  assert_fails(pbf_find_in_volume(p.solver, &v, 0, NULL, NULL), bad, "count is null");
  v.half_extents[1] = 0;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "half_extents[1] is 0");
  v = volume_of(PBF_VOLUME_CAPSULE);
  v.axis[1] = 0;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "volumes[0].axis");
  v = volume_of(PBF_VOLUME_SPHERE);
  v.radius = NAN;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "radius is NaN");
  v.radius = 1;
  v.orientation[0] = 1;
  v.orientation[3] = 0;
  assert_fails(pbf_measure_volumes(p.solver, 1, &v, &found), bad, "a turn about z");
  two[1].struct_size = sizeof v + 8;
  assert_fails(pbf_measure_volumes(p.solver, 2, two, &found), PBF_ERROR_STRUCT_SIZE, "volumes[1]");
  assert_fails(pbf_measure_volumes(p.solver, 1, two, NULL), bad, "flows is null");
  assert_true(found.volume == 99 && count == 7);
  pbf_destroy(p.solver);
}

static void points_refused(void **state) {
  (void)state;
  const pool p = pool_of(3, PBF_FLOAT32, slope, 1);
  double x[6] = {0.1, 0.1, 0.1, 0.2, NAN, 0.2}, to[6] = {1, 0, 0, 0, 0, 0}, out[6] = {99};
  pbf_samples samples = {.struct_size = sizeof samples, .count = 2, .points = x, .densities = out};
  pbf_sample_grid grid = {sizeof grid, {1, 2, 2}, {0}, {1, 1, 1}};
  assert_fails(pbf_sample(p.solver, &samples), bad, "samples.points[1][1] is NaN");
  samples.points = NULL;
  assert_fails(pbf_sample(p.solver, &samples), bad, "samples.points is null");
  assert_fails(pbf_sample_on_grid(p.solver, &grid, &samples), bad, "the grid has 4 points");
  samples.densities = NULL;
  assert_fails(pbf_sample(p.solver, &samples), bad, "at least one");
  assert_fails(pbf_sample(p.solver, NULL), bad, "samples is null");
  assert_fails(pbf_get_levels(p.solver, 2, x, out), bad, "points[1][1] is NaN");
  x[4] = 0.2;
  assert_fails(pbf_cast_rays(p.solver, 2, x, to, 1, out, NULL), bad,
               "directions[1] has the length 0");
  to[4] = 1;
  assert_fails(pbf_cast_rays(p.solver, 2, x, to, 0, out, NULL), bad, "length is 0");
  assert_fails(pbf_cast_rays(p.solver, 2, x, to, 1, NULL, NULL), bad, "distances is null");
  assert_fails(pbf_sample(NULL, &samples), bad, "null");
  assert_true(out[0] == 99);
  if (!test_is_stub()) {
    pbf_params params = {.struct_size = sizeof params};
    assert_ok(pbf_get_params(p.solver, &params));
    params.solver = PBF_SOLVER_JACOBI;
    params.max_depenetration_speed = 0;
    assert_ok(pbf_set_params(p.solver, &params));
    samples.points = x;
    samples.pressures = out;
    assert_fails(pbf_sample(p.solver, &samples), PBF_ERROR_UNSUPPORTED, "keeps no pressure");
  }
  pbf_destroy(p.solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(answers_follow_changes), cmocka_unit_test(nothing_is_allocated),
      cmocka_unit_test(no_particles),           cmocka_unit_test(volumes_refused),
      cmocka_unit_test(points_refused),
  };
  return TEST_RUN(tests);
}
