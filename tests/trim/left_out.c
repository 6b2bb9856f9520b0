/* What a trimmed build says of what it is without. */
#include "support.h"

static pbf_desc desc_of(const char *backend, uint32_t dimension, uint32_t precision) {
  pbf_desc desc;
  assert_ok(pbf_desc_init(&desc, sizeof desc));
  desc.backend = backend;
  desc.dimension = dimension;
  desc.precision = precision;
  desc.capacity = 16;
  return desc;
}

static void a_missing_variant(void **state) {
  (void)state;
  pbf_solver *solver = NULL;
  pbf_desc desc = desc_of("serial", 2, PBF_FLOAT64);
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE,
               "serial: built without 2D float64");
  desc = desc_of("auto", 3, PBF_FLOAT64);
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE,
               "serial: built without 3D float64");
  assert_null(solver);
}

static void a_missing_backend(void **state) {
  (void)state;
  pbf_solver *solver = NULL;
  pbf_desc desc = desc_of("openmp", 3, PBF_FLOAT32);
  desc.strict = 1;
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE, "openmp: built without it");
  desc.strict = 0;
  assert_ok(pbf_create(&desc, NULL, &solver));
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(solver, &info));
  assert_string_equal(info.backend, "serial");
  assert_string_equal(info.path, "");
  assert_int_equal(info.fell_back, 1);
  assert_non_null(strstr(info.fallback_reason, "built without it"));
  pbf_destroy(solver);
  desc.backend = "opnemp";
  assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_NOT_FOUND, "known are: auto; reference");
}

static void no_plugins(void **state) {
  (void)state;
  assert_fails(pbf_load_backend("/lib/pbf_backend_cuda.so"), PBF_ERROR_UNSUPPORTED,
               "/lib/pbf_backend_cuda.so: built without plugins");
  assert_fails(pbf_load_backend("x.so"), PBF_ERROR_INVALID_ARGUMENT, "absolute");
}

static void a_missing_instruction_set(void **state) {
  (void)state;
  pbf_solver *solver = NULL;
  static const char *const backends[] = {"serial", "auto"};
  for (int k = 0; k < 4; ++k) {
    pbf_desc desc = desc_of(backends[k / 2], 3, PBF_FLOAT32);
    desc.isa = k % 2 ? "scalar" : NULL;
    if (!desc.isa) setenv("PBF_ISA", "scalar", 1);
    assert_fails(pbf_create(&desc, NULL, &solver), PBF_ERROR_UNAVAILABLE,
                 "which this build is without");
    unsetenv("PBF_ISA");
  }
}

int main(void) {
  const struct CMUnitTest left_out[] = {
      cmocka_unit_test(a_missing_variant),
      cmocka_unit_test(a_missing_backend),
      cmocka_unit_test(no_plugins),
      cmocka_unit_test(a_missing_instruction_set),
  };
  return TEST_RUN(left_out);
}
