/* Each instruction set against its scalar twin, and the variable that forces one. */
#include "cpu_support.h"

#include <stdio.h>

static const char *const sets[] = {"sse2", "avx2", "avx512"};

/* What passes look up must be what the passes before them left, whichever these were. */
static void everything(pbf_params *params) {
  params->scorr_k = 0.01;
  params->vorticity = 0.05;
  params->viscosity = 0.05;
  params->collide = 7;
}

static void paper(pbf_params *params) {
  everything(params);
  params->kernel = PBF_KERNEL_POLY6_SPIKY;
}

static void pushed_at_the_end(pbf_params *params) {
  everything(params);
  params->viscosity = 0.5;
  params->time_step = 4e-3;
  params->collide = PBF_COLLIDE_AFTER_SOLVE;
}

static void deep(pbf_params *params) {
  params->pressure_grid = 2;
  params->time_step = 4e-3;
}

static void undamped(pbf_params *params) {
  params->damping_compensation = params->angular_momentum_correction = 1;
  params->time_step = 4e-3;
}

static void until_good_enough(pbf_params *params) {
  params->viscosity = 0.05;
  params->tolerance = 1e-3;
  params->iterations = 20;
}

static void (*const kinds[])(pbf_params *) = {everything, paper,    pushed_at_the_end,
                                              deep,       undamped, until_good_enough};

static pbf_solver *run(const char *set, const cpu_block *block, uint32_t precision,
                       void (*kind)(pbf_params *)) {
  pbf_desc desc = cpu_desc("serial", block->dimension, precision, block->count, 1);
  const pbf_collider ball = {.struct_size = sizeof ball,
                             .shape = PBF_COLLIDER_SPHERE,
                             .position = {0.13, 0.13, 0.13},
                             .orientation = {0, 0, 0, 1},
                             .velocity = {2},
                             .radius = 0.03};
  pbf_params params = cpu_block_params();
  kind(&params);
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
  if (kind == pushed_at_the_end) assert_ok(pbf_set_colliders(solver, 1, &ball));
  assert_ok(pbf_step(solver, 3));
  return solver;
}

static void compare(uint32_t dimension, uint32_t precision) {
  const double x_most = precision == PBF_FLOAT32 ? 1e-6 : 1e-14;
  cpu_block block = cpu_make_block(dimension);
  for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; ++kind) {
    pbf_params params = cpu_block_params();
    kinds[kind](&params);
    const double v_most = 2 * x_most / params.time_step;
    pbf_solver *scalar = run("scalar", &block, precision, kinds[kind]);
    assert_non_null(scalar);
    for (size_t k = 0; k < sizeof sets / sizeof *sets; ++k) {
      pbf_solver *vector = run(sets[k], &block, precision, kinds[kind]);
      if (!vector) continue;
      pbf_plan plan = {.struct_size = sizeof plan};
      assert_ok(pbf_get_plan(vector, &plan));
      assert_non_null(strstr(plan.variant, sets[k]));
      assert_true(cpu_difference(scalar, vector, PBF_FIELD_POSITION) < x_most);
      assert_true(cpu_difference(scalar, vector, PBF_FIELD_VELOCITY) < v_most);
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
