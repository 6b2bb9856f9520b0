/* Each instruction set against its scalar twin, and the variable that forces one. */
#include "cpu_support.h"

#include <stdio.h>

static const char *const sets[] = {"sse2", "avx2", "avx512"};

static pbf_params everything(uint32_t kernel) {
  pbf_params params = cpu_block_params();
  params.kernel = kernel;
  params.scorr_k = 0.01;
  params.vorticity = 0.05;
  params.viscosity = 0.05;
  params.collide = 7;
  return params;
}

static pbf_solver *run(const char *set, const cpu_block *block, uint32_t precision,
                       uint32_t kernel) {
  pbf_desc desc = cpu_desc("serial", block->dimension, precision, block->count, 1);
  pbf_params params = everything(kernel);
  pbf_solver *solver = NULL;
  assert_int_equal(setenv("PBF_ISA", set, 1), 0);
  pbf_status status = pbf_create(&desc, &params, &solver);
  unsetenv("PBF_ISA");
  if (status != PBF_OK) {
    const char *why = pbf_last_error();
    assert_true(strstr(why, "machine can't run") || strstr(why, "build is without"));
    return NULL;
  }
  cpu_add(solver, precision, block->dimension, block->count, block->x, block->v);
  assert_ok(pbf_step(solver, 3));
  return solver;
}

static void compare(uint32_t dimension, uint32_t precision) {
  const double x_most = precision == PBF_FLOAT32 ? 1e-6 : 1e-14;
  cpu_block block = cpu_make_block(dimension);
  for (uint32_t kernel = 0; kernel < 2; ++kernel) {
    pbf_solver *scalar = run("scalar", &block, precision, kernel);
    assert_non_null(scalar);
    for (size_t k = 0; k < sizeof sets / sizeof *sets; ++k) {
      pbf_solver *vector = run(sets[k], &block, precision, kernel);
      if (!vector) continue;
      pbf_plan plan = {.struct_size = sizeof plan};
      assert_ok(pbf_get_plan(vector, &plan));
      assert_non_null(strstr(plan.variant, sets[k]));
      assert_true(cpu_difference(scalar, vector, PBF_FIELD_POSITION) < x_most);
      assert_true(cpu_difference(scalar, vector, PBF_FIELD_VELOCITY) < x_most / 2e-4 * 2);
      assert_true(cpu_difference(scalar, vector, PBF_FIELD_DENSITY) < 100 * x_most);
      pbf_destroy(vector);
    }
    pbf_destroy(scalar);
  }
  cpu_free_block(&block);
}

static void vectors_agree_with_scalars(void **state) {
  (void)state;
  test_for_each_kind(compare);
}

static void an_unknown_set_is_refused(void **state) {
  (void)state;
  pbf_desc desc = cpu_desc("serial", 2, PBF_FLOAT32, 10, 1);
  pbf_solver *solver = NULL;
  setenv("PBF_ISA", "mmx", 1);
  assert_true(pbf_create(&desc, NULL, &solver) != PBF_OK);
  assert_null(solver);
  assert_non_null(strstr(pbf_last_error(), "PBF_ISA"));
  assert_non_null(strstr(pbf_last_error(), "mmx"));
  assert_non_null(strstr(pbf_last_error(), "avx2"));
  setenv("PBF_ISA", "", 1);
  assert_ok(pbf_create(&desc, NULL, &solver));
  pbf_destroy(solver);
  unsetenv("PBF_ISA");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(vectors_agree_with_scalars),
      cmocka_unit_test(an_unknown_set_is_refused),
  };
  return TEST_RUN(tests);
}
