/* Each instruction set against its scalar twin, and the ways to ask for one. */
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
  desc.isa = set;
  pbf_status status = pbf_create(&desc, &params, &solver);
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

/* Whether another one would do or not: a typo must not make `reference` of "auto". */
static const char *const backends[] = {"auto", "serial", "threads", "openmp", "reference"};
enum { BACKENDS = sizeof backends / sizeof backends[0] };

static void an_unknown_set_is_refused(void **state) {
  (void)state;
  static const char *const unknown[] = {"mmx", "", "AVX2", "avx2 ", "scalar\n"}, *const quoted[] = {
                                                                                     "\"mmx\"",
                                                                                     "\"\"",
                                                                                     "\"AVX2\"",
                                                                                     "\"avx2 \"",
                                                                                     "\"scalar?\""};
  pbf_solver *solver = NULL;
  for (size_t k = 0; k < BACKENDS * 2; ++k)
    for (size_t n = 0; n < sizeof unknown / sizeof unknown[0]; ++n) {
      pbf_desc desc = cpu_desc(backends[k / 2], 3, PBF_FLOAT32, 10, 1);
      desc.strict = k % 2;
      desc.isa = unknown[n];
      assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT, "desc.isa is \"");
      assert_non_null(strstr(pbf_last_error(), quoted[n]));
      assert_non_null(strstr(pbf_last_error(), "avx512"));
    }
  assert_null(solver);
}

static void an_unknown_set_in_the_environment_is_refused(void **state) {
  (void)state;
  pbf_solver *solver = NULL;
  for (size_t k = 0; k < BACKENDS * 2; ++k) {
    pbf_desc desc = cpu_desc(backends[k / 2], 3, PBF_FLOAT32, 10, 1);
    desc.strict = k % 2;
    setenv("PBF_ISA", "mmx", 1);
    assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_INVALID_ARGUMENT,
                 "PBF_ISA in the environment is \"mmx\"");
    assert_non_null(strstr(pbf_last_error(), "avx2"));
    setenv("PBF_ISA", "", 1);
    assert_ok(pbf_create(&desc, NULL, &solver));
    pbf_destroy(solver);
    solver = NULL;
    unsetenv("PBF_ISA");
  }
}

/* The set that a solver of that backend has got; the solver is destroyed. */
static void assert_set(const char *backend, const char *isa, const char *environment,
                       const char *expected) {
  pbf_desc desc = cpu_desc(backend, 3, PBF_FLOAT32, 10, 1);
  pbf_solver *solver = NULL;
  pbf_info info = {.struct_size = sizeof info};
  desc.isa = isa;
  if (environment) setenv("PBF_ISA", environment, 1);
  assert_ok(pbf_create(&desc, NULL, &solver));
  unsetenv("PBF_ISA");
  assert_ok(pbf_get_info(solver, &info));
  if (!strstr(info.device_name, expected))
    fail_msg("\"%s\" with \"%s\" is %s on %s", backend, isa, info.backend, info.device_name);
  pbf_destroy(solver);
}

static void a_set_is_what_was_asked_for(void **state) {
  (void)state;
  assert_set("serial", "scalar", NULL, "(scalar)");
  assert_set("openmp", "scalar", NULL, "(scalar)");
  assert_set("auto", "scalar", NULL, "(scalar)");
  assert_set("serial", NULL, "scalar", "(scalar)");
  assert_set("auto", NULL, "scalar", "(scalar)");
  assert_set("reference", NULL, "scalar", "one CPU thread");
}

static void the_description_goes_before_the_environment(void **state) {
  (void)state;
  assert_set("serial", "scalar", "mmx", "(scalar)");
  assert_set("auto", "scalar", "mmx", "(scalar)");
}

/* A backend without a choice can't serve a request for one. */
static void the_reference_has_no_sets(void **state) {
  (void)state;
  pbf_desc desc = cpu_desc("reference", 3, PBF_FLOAT32, 10, 1);
  pbf_solver *solver = NULL;
  desc.isa = "scalar";
  desc.strict = 1;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE,
               "reference: it has no choice of instruction sets");
  assert_null(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(vectors_agree_with_scalars),
      cmocka_unit_test(an_unknown_set_is_refused),
      cmocka_unit_test(an_unknown_set_in_the_environment_is_refused),
      cmocka_unit_test(a_set_is_what_was_asked_for),
      cmocka_unit_test(the_description_goes_before_the_environment),
      cmocka_unit_test(the_reference_has_no_sets),
  };
  return TEST_RUN(tests);
}
