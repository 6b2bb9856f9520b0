/* What a solver holds, by its allocator, on every backend of the build. A device's own memory does
 * not go through the allocator: there the plan alone is looked at. */
#include "param_table.h"
#include "support.h"

static pbf_plan plan_of(pbf_solver *solver) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  return plan;
}

static int on_a_device(pbf_solver *solver) {
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(solver, &info));
  return info.device_type != PBF_DEVICE_CPU;
}

/* Bytes that a solver of that capacity holds, and what its plan says of one particle. */
static uint64_t bytes_at(uint32_t dimension, uint32_t precision, uint32_t capacity,
                         double *per_particle) {
  pbf_desc desc = test_desc(dimension, precision, capacity);
  pbf_params params = test_params();
  params.pressure_grid = 0; /* which has a least size */
  pbf_solver *s = test_create(&desc, &params);
  uint64_t bytes = on_a_device(s) ? plan_of(s).bytes : test_count.live_bytes;
  *per_particle = plan_of(s).bytes_per_particle;
  pbf_destroy(s);
  return bytes;
}

static void check_per_particle(uint32_t dimension, uint32_t precision) {
  enum { FEW = 20000, MANY = 60000 };
  double few_say, many_say;
  uint64_t few = bytes_at(dimension, precision, FEW, &few_say);
  uint64_t many = bytes_at(dimension, precision, MANY, &many_say);
  double counted = (double)(many - few) / (MANY - FEW);
  assert_true(fabs(counted - many_say) < 0.02 * counted);
}

static void bytes_of_a_particle(void **state) {
  (void)state;
  test_for_each_kind(check_per_particle);
}

static void check_coordinates(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_solver(dimension, precision, 20000);
  pbf_plan plan = plan_of(s);
  uint32_t vectors = 0;
  for (uint32_t k = 0; k < plan.array_count; ++k) {
    const pbf_plan_array *a = &plan.arrays[k];
    if (strcmp(a->name, "position") != 0 && strcmp(a->name, "velocity") != 0) continue;
    assert_true(a->bytes_per_particle < 1.02 * dimension * precision);
    ++vectors;
  }
  if (!on_a_device(s)) assert_int_equal(vectors, 2);
  pbf_destroy(s);
}

static void two_dimensions_hold_two_coordinates(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 16);
  int device = on_a_device(s);
  pbf_destroy(s);
  if (device) test_skip("a device aligns points to 16 bytes in 3D");
  if (test_is_stub()) test_skip("the stub keeps no arrays of its own");
  test_for_each_kind(check_coordinates);
}

static pbf_params bare(void) {
  pbf_params params = test_params();
  params.gravity[1] = 0;
  params.solver = PBF_SOLVER_JACOBI;
  params.wall_density = 0;
  return params;
}

/* The lists of neighbours grow as they must, and belong to no feature. */
static uint64_t bytes_but_lists(pbf_solver *solver) {
  pbf_plan plan = plan_of(solver);
  uint64_t lists = 0;
  for (uint32_t k = 0; k < plan.array_count; ++k)
    if (strcmp(plan.arrays[k].name, "neighbor list") == 0) lists += plan.arrays[k].bytes;
  if (on_a_device(solver)) return plan.bytes - lists;
  assert_int_equal(plan.bytes, test_count.live_bytes);
  return test_count.live_bytes - lists;
}

static void check_freed(pbf_solver *s, const pbf_params *params, uint64_t bytes) {
  const pbf_params none = bare();
  assert_ok(pbf_set_params(s, params));
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_set_params(s, &none));
  assert_int_equal(bytes_but_lists(s), bytes);
}

static pbf_params moving_walls(void) {
  pbf_params params = bare();
  params.wall_amplitude[0] = 0.01, params.wall_frequency[0] = 1;
  return params;
}

/* Each optional parameter alone, and all at once. */
static void check_optional_params(pbf_solver *s, uint64_t bytes) {
  pbf_params all = moving_walls();
  for (int k = 0; k < TABLE_PARAMS; ++k) {
    if (table_params[k].usual == 0) continue;
    pbf_params one = bare();
    table_turn_on(&one, &table_params[k]);
    table_turn_on(&all, &table_params[k]);
    check_freed(s, &one, bytes);
  }
  check_freed(s, &all, bytes);
}

static void check_other_params(pbf_solver *s, uint64_t bytes) {
  pbf_params params = bare();
  params.kernel = PBF_KERNEL_POLY6_SPIKY;
  check_freed(s, &params, bytes);
  params = bare();
  params.solver = PBF_SOLVER_CHEBYSHEV;
  check_freed(s, &params, bytes);
  params = moving_walls();
  check_freed(s, &params, bytes);
}

static void what_is_dropped_is_freed(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 500);
  pbf_params params = bare();
  pbf_solver *s = test_create(&desc, &params);
  void *positions = test_lattice(3, PBF_FLOAT32, 500);
  assert_ok(pbf_add_particles(s, 500, positions, NULL, NULL));
  assert_ok(pbf_step(s, 1));
  uint64_t bytes = bytes_but_lists(s);
  check_optional_params(s, bytes);
  check_other_params(s, bytes);
  pbf_collider collider;
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_SPHERE));
  collider.radius = 0.01;
  assert_ok(pbf_set_colliders(s, 1, &collider));
  assert_ok(pbf_step(s, 2));
  assert_ok(pbf_set_colliders(s, 0, NULL));
  assert_int_equal(bytes_but_lists(s), bytes);
  pbf_destroy(s);
  free(positions);
}

static void looking_takes_no_memory(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 500, 500);
  pbf_stats stats = {.struct_size = sizeof stats};
  float densities[500];
  assert_ok(pbf_step(s, 8)); /* lists have grown to what they need */
  uint64_t calls = test_count.calls, bytes = plan_of(s).bytes;
  assert_ok(pbf_get_stats(s, &stats));
  assert_ok(pbf_get_densities(s, 0, 500, densities));
  if (pbf_set_timing(s, 1) == PBF_OK) assert_ok(pbf_step(s, 1));
  assert_int_equal(test_count.calls, calls);
  assert_int_equal(plan_of(s).bytes, bytes);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest bytes[] = {
      cmocka_unit_test(bytes_of_a_particle),
      cmocka_unit_test(two_dimensions_hold_two_coordinates),
      cmocka_unit_test(what_is_dropped_is_freed),
      cmocka_unit_test(looking_takes_no_memory),
  };
  return TEST_RUN(bytes);
}
