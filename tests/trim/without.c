/* A build with few features: each that it is without is refused, and what is left does the same. */
#include <stdio.h>

#include "param_table.h"
#include "support.h"

static pbf_params minimal(void) {
  pbf_params params = test_params();
  params.solver = PBF_SOLVER_JACOBI;
  params.wall_density = 0;
  return params;
}

static void check_refusal(pbf_solver *s, const pbf_params *params, const char *words) {
  uint64_t before = test_hash(s);
  pbf_solver *other = NULL;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 16);
  assert_fails(pbf_create(&desc, params, &other), PBF_ERROR_UNSUPPORTED, words);
  assert_null(other);
  assert_fails(pbf_set_params(s, params), PBF_ERROR_UNSUPPORTED, words);
  assert_int_equal(test_hash(s), before);
  assert_ok(pbf_step(s, 1));
}

static void each_feature_is_refused(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 16);
  pbf_params params = minimal();
  pbf_solver *s = test_create(&desc, &params);
  params = minimal();
  params.kernel = PBF_KERNEL_POLY6_SPIKY;
  check_refusal(s, &params, "built without the kernel PBF_KERNEL_POLY6_SPIKY");
  params = minimal();
  params.scorr_k = 0.1;
  check_refusal(s, &params, "built without artificial pressure");
  params = minimal();
  params.vorticity = 0.1;
  check_refusal(s, &params, "built without vorticity");
  params = minimal();
  params.viscosity = 0.1;
  check_refusal(s, &params, "built without viscosity");
  params = minimal();
  params.wall_density = 1;
  check_refusal(s, &params, "built without the walls' density");
  params = minimal();
  params.solver = PBF_SOLVER_CHEBYSHEV;
  check_refusal(s, &params, "built without PBF_SOLVER_CHEBYSHEV");
  params = minimal();
  params.sleep_speed = params.sleep_time = 0.1;
  check_refusal(s, &params, "built without sleep");
  params = minimal();
  params.tolerance = 0.001;
  check_refusal(s, &params, "built without the solve's early end");
  params = minimal();
  params.pressure_grid = 2;
  check_refusal(s, &params, "built without the pressure grid");
  pbf_destroy(s);
}

/* Each parameter of the table that asks for a feature, by its name. */
static void each_param_is_refused(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 16);
  pbf_params params = minimal();
  pbf_solver *s = test_create(&desc, &params);
  for (int k = 0; k < TABLE_PARAMS; ++k) {
    const table_param *param = &table_params[k];
    if (param->feature == PBF_FEATURE_NONE || param->usual == 0) continue;
    char words[64];
    int needs_solver = param->min_solver == PBF_SOLVER_CHEBYSHEV; /* which is refused before it */
    snprintf(words, sizeof words, "params.%s", needs_solver ? "solver" : param->name);
    params = minimal();
    table_turn_on(&params, param);
    check_refusal(s, &params, words);
  }
  pbf_destroy(s);
}

static void requests_are_refused(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 16);
  pbf_params params = minimal();
  pbf_collider collider;
  float position[3] = {0.5f, 0.5f, 0.5f}, density;
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, 1, position, NULL, NULL));
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_SPHERE));
  assert_fails(pbf_set_colliders(s, 1, &collider), PBF_ERROR_UNSUPPORTED, "without colliders");
  assert_ok(pbf_set_colliders(s, 0, NULL));
  assert_fails(pbf_get_stats(s, &stats), PBF_ERROR_UNSUPPORTED, "without statistics");
  assert_fails(pbf_get_densities(s, 0, 1, &density), PBF_ERROR_UNSUPPORTED, "without statistics");
  assert_fails(pbf_set_timing(s, 1), PBF_ERROR_UNSUPPORTED, "takes no times");
  assert_ok(pbf_step(s, 1));
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest without[] = {
      cmocka_unit_test(each_feature_is_refused),
      cmocka_unit_test(each_param_is_refused),
      cmocka_unit_test(requests_are_refused),
  };
  return TEST_RUN(without);
}
