/* What earlier calls have left on the caller's stack is in no result: particles deep in solids,
 * in cells of the pressure grid that are cut by them, see no point of these cells. */
#include "cpu_support.h"

enum { COUNT = 350, COLLIDERS = 4 };

static void fill_stack(int byte) {
  volatile unsigned char below[192 << 10];
  for (size_t i = 0; i < sizeof below; ++i) below[i] = (unsigned char)byte;
}

static void put_colliders(pbf_solver *solver) {
  static const struct {
    uint32_t shape;
    double position[2], velocity[2], half_extents[2], radius;
  } given[COLLIDERS] = {
      {PBF_COLLIDER_BOX, {0.43, 1.12}, {-0.84, 0.84}, {0.18, 0.36}, 1},
      {PBF_COLLIDER_BOX, {0.91, 0.23}, {0.37, 0.53}, {0.09, 0.5}, 1},
      {PBF_COLLIDER_SPHERE, {-0.07, 0.63}, {-0.04, 0.22}, {1, 1}, 0.48},
      {PBF_COLLIDER_SPHERE, {1.0, 0.33}, {-0.31, -0.74}, {1, 1}, 0.34},
  };
  pbf_collider all[COLLIDERS];
  for (int i = 0; i < COLLIDERS; ++i) {
    assert_ok(pbf_collider_init(&all[i], sizeof all[i], given[i].shape));
    for (int k = 0; k < 2; ++k) {
      all[i].position[k] = given[i].position[k];
      all[i].velocity[k] = given[i].velocity[k];
      all[i].half_extents[k] = given[i].half_extents[k];
    }
    all[i].radius = given[i].radius;
  }
  assert_ok(pbf_set_colliders(solver, COLLIDERS, all));
}

static uint64_t hash_after(const char *backend, uint32_t seed, int byte) {
  double x[COUNT][2];
  uint64_t hash = 0;
  pbf_desc desc;
  pbf_params params;
  pbf_solver *solver = NULL;
  for (int i = 0; i < 2 * COUNT; ++i) {
    seed = seed * 1664525u + 1013904223u; /* Numerical Recipes' generator */
    x[i / 2][i % 2] = 0.02 + 0.9 * (seed >> 8) / 16777216.0;
  }
  assert_ok(pbf_desc_init(&desc, sizeof desc));
  assert_ok(pbf_params_init(&params, sizeof params));
  desc.backend = backend;
  desc.strict = 1;
  desc.dimension = 2;
  desc.precision = PBF_FLOAT64;
  desc.capacity = COUNT;
  params.pressure_grid = 1;
  assert_ok(pbf_create(&desc, &params, &solver));
  assert_ok(pbf_add_particles(solver, COUNT, x, NULL, NULL));
  put_colliders(solver);
  for (int step = 0; step < 10; ++step) {
    fill_stack(byte);
    assert_ok(pbf_step(solver, 1));
  }
  assert_ok(pbf_hash(solver, &hash));
  pbf_destroy(solver);
  return hash;
}

static void it_is_in_no_result(void **state) {
  static const char *const backends[] = {"reference", "serial", "threads", "openmp"};
  const int count = test_is_long() ? 4 : 2; /* the last two have the objects of serial */
  (void)state;
  for (int k = 0; k < count; ++k)
    for (uint32_t seed = 2; seed < 12; ++seed) {
      const uint64_t hash = hash_after(backends[k], seed, 0);
      assert_int_equal(hash_after(backends[k], seed, 0xff), hash);
      assert_int_equal(hash_after(backends[k], seed, 0x7f), hash);
    }
}

int main(void) {
  const struct CMUnitTest contents[] = {cmocka_unit_test(it_is_in_no_result)};
  return cmocka_run_group_tests(contents, NULL, NULL);
}
