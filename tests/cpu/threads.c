/* The same bits run after run, in all plugins, at any number of threads, and whatever order the
 * particles have inside. */
#include "cpu_support.h"

static const char *const pools[] = {"threads", "openmp"};
enum { POOLS = sizeof pools / sizeof pools[0] };

static pbf_params lively(int plain) {
  pbf_params params = test_params();
  params.smoothing_radius = 0.05;
  params.collide = 7;
  params.wall_velocity[PBF_WALL_X_MAX] = -1;
  params.viscosity = 0.02;
  params.vorticity = 0.02;
  params.scorr_k = plain ? 0.001 : 0;
  params.damping_compensation = params.angular_momentum_correction = plain ? 0 : 0.5;
  if (plain) {
    params.solver = PBF_SOLVER_JACOBI;
    params.kernel = PBF_KERNEL_POLY6_SPIKY;
    params.cohesion = 1;
    params.min_diagonal = params.wall_density = 0;
    params.cfm = 1;
  }
  return params;
}

/* A dam with a random velocity each, and a sphere in its way. */
static pbf_solver *make(const char *backend, uint32_t dimension, uint32_t precision,
                        uint32_t threads, int plain) {
  enum { COUNT = TEST_INSTRUMENTED ? 1500 : 3000 };
  pbf_desc desc = cpu_desc(backend, dimension, precision, COUNT + 100, threads);
  pbf_params params = lively(plain);
  pbf_solver *solver = test_create(&desc, &params);
  pbf_collider sphere;
  assert_ok(pbf_collider_init(&sphere, sizeof sphere, PBF_COLLIDER_SPHERE));
  sphere.radius = 0.1;
  sphere.position[0] = 0.7;
  sphere.velocity[0] = -0.3;
  assert_ok(pbf_set_colliders(solver, 1, &sphere));
  double *x = calloc((size_t)COUNT * dimension, sizeof *x);
  double *v = calloc((size_t)COUNT * dimension, sizeof *v);
  uint32_t side = dimension == 2 ? 30 : 15;
  uint64_t seed = 5;
  for (uint32_t i = 0; i < COUNT; ++i) {
    uint32_t rest = i;
    for (uint32_t k = 0; k < dimension; ++k) {
      uint32_t place = k + 1 < dimension ? rest % side : rest;
      x[i * dimension + k] = 0.02 + (dimension == 2 ? 0.0095 : 0.025) * place;
      v[i * dimension + k] = cpu_random(&seed) - 0.5;
      rest /= side;
    }
  }
  cpu_add(solver, precision, dimension, COUNT, x, v);
  free(x);
  free(v);
  return solver;
}

static uint64_t hash_after(const char *backend, uint32_t dimension, uint32_t precision,
                           uint32_t threads, int plain) {
  pbf_solver *solver = make(backend, dimension, precision, threads, plain);
  assert_ok(pbf_step(solver, 8));
  uint32_t gone[40];
  for (uint32_t k = 0; k < 40; ++k) gone[k] = 7 + 31 * k;
  assert_ok(pbf_remove_particles(solver, 40, gone));
  assert_ok(pbf_step(solver, 6));
  uint64_t hash = test_hash(solver);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(solver, &stats));
  assert_true(isfinite(stats.kinetic_energy));
  for (size_t k = 0; k < sizeof stats; ++k)
    hash = (hash ^ ((const unsigned char *)&stats)[k]) * UINT64_C(0x100000001b3);
  pbf_destroy(solver);
  return hash;
}

static void compare(uint32_t dimension, uint32_t precision) {
  static const uint32_t threads[] = {2, 7, 3}; /* 1: of the sleepers */
  const size_t counts = TEST_INSTRUMENTED ? 2 : 3;
  for (int plain = 0; plain < 2; ++plain) {
    uint64_t hash = hash_after("serial", dimension, precision, 1, plain);
    assert_true(hash == hash_after("serial", dimension, precision, 1, plain));
    for (size_t k = 0; k < counts * POOLS; ++k)
      assert_true(hash ==
                  hash_after(pools[k % POOLS], dimension, precision, threads[k / POOLS], plain));
  }
}

static void any_number_of_threads(void **state) {
  (void)state;
  test_for_long_kinds(compare);
}

/* The sort by id undoes any order inside: a loaded solver has the order of adding. */
static void forget_order(const char *backend) {
  pbf_solver *one = make("serial", 3, PBF_FLOAT32, 1, 0),
             *other = make(backend, 3, PBF_FLOAT32, 3, 0);
  assert_ok(pbf_step(one, 12));
  uint64_t size;
  void *saved = test_save(one, &size);
  assert_ok(pbf_load(other, saved, size));
  assert_ok(pbf_step(one, 12));
  assert_ok(pbf_step(other, 12));
  assert_true(test_hash(one) == test_hash(other));
  free(saved);
  pbf_destroy(one);
  pbf_destroy(other);
}

static void the_order_inside_is_forgotten(void **state) {
  (void)state;
  for (int k = 0; k < POOLS; ++k) forget_order(pools[k]);
}

/* Waves in a pool that come to rest: some sleep, some wake. */
static uint64_t hash_of_sleepers(const char *backend, uint32_t threads, double tolerance) {
  enum { SIDE = 14, COUNT = SIDE * SIDE * SIDE };
  static double x[COUNT][3], v[COUNT][3];
  pbf_desc desc = cpu_desc(backend, 3, PBF_FLOAT32, COUNT, threads);
  pbf_params params = test_params();
  params.sleep_speed = 0.3;
  params.sleep_time = 0.05;
  params.tolerance = tolerance;
  params.iterations = tolerance > 0 ? 12 : 4;
  params.viscosity = 0.02;
  params.vorticity = 0.01;
  params.wall_amplitude[PBF_WALL_X_MAX] = 0.05;
  params.wall_frequency[PBF_WALL_X_MAX] = 9;
  params.domain_max[0] = params.domain_max[2] = 0.05 * SIDE + 0.1;
  pbf_solver *solver = test_create(&desc, &params);
  for (uint32_t i = 0; i < COUNT; ++i) {
    const uint32_t place[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
    for (int k = 0; k < 3; ++k) x[i][k] = 0.025 + 0.05 * place[k];
    v[i][0] = place[0] < 3 ? 1.5 : 0;
  }
  cpu_add(solver, PBF_FLOAT32, 3, COUNT, &x[0][0], &v[0][0]);
  pbf_stats stats = {.struct_size = sizeof stats};
  uint64_t hash = 0;
  uint32_t most = 0, least = COUNT, fewest = params.iterations;
  for (int round = 0; round < 8; ++round) {
    assert_ok(pbf_step(solver, 12));
    assert_ok(pbf_get_stats(solver, &stats));
    most = stats.asleep > most ? stats.asleep : most;
    least = most > 0 && stats.asleep < least ? stats.asleep : least;
    hash = 31 * (hash + stats.asleep + COUNT * stats.iterations) + test_hash(solver);
    if (stats.iterations < fewest) fewest = stats.iterations;
  }
  assert_true(most > COUNT / 4 && most < COUNT && least < most);
  assert_true((fewest < params.iterations) == (tolerance > 0));
  pbf_destroy(solver);
  return hash;
}

static void compare_sleepers(double tolerance) {
  uint64_t hash = hash_of_sleepers("serial", 1, tolerance);
  const uint32_t least = TEST_INSTRUMENTED ? 5 : 1;
  for (int k = 0; k < POOLS; ++k)
    for (uint32_t threads = least; threads <= 5; threads += 4)
      assert_true(hash == hash_of_sleepers(pools[k], threads, tolerance));
}

static void sleepers_with_any_number_of_threads(void **state) {
  (void)state;
  test_skip_if_watched(); /* api.sleep is shorter */
  compare_sleepers(0);
}

static void sleepers_with_a_tolerance(void **state) {
  (void)state;
  test_skip_if_watched();
  compare_sleepers(0.005);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_threads),
      cmocka_unit_test(the_order_inside_is_forgotten),
      cmocka_unit_test(sleepers_with_any_number_of_threads),
      cmocka_unit_test(sleepers_with_a_tolerance),
  };
  return TEST_RUN(tests);
}
