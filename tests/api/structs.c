/* Structs of older and newer callers. */
#include "support.h"

/* A caller of a later header: fields that this library has never heard of. */
typedef struct later_params {
  pbf_params now;
  double later[3];
} later_params;

static void sizes_out_of_range(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  pbf_status bad = PBF_ERROR_STRUCT_SIZE;
  static const uint32_t sizes[] = {0, 1, 4, 8, 70000, UINT32_MAX};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
    uint32_t size = sizes[i];
    pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
    pbf_params params = test_params();
    pbf_collider collider = {.struct_size = size};
    pbf_view view = {.struct_size = size};
    pbf_read_desc read = {.struct_size = size};
    pbf_write_desc write = {.struct_size = size};
    pbf_snapshot snapshot = {.struct_size = size};
    pbf_stats stats = {.struct_size = size};
    pbf_plan plan = {.struct_size = size};
    pbf_info info = {.struct_size = size};
    pbf_timings timings = {.struct_size = size};
    pbf_backend_info backend = {.struct_size = size};
    pbf_solver *none = NULL;
    assert_fails(pbf_desc_init(&desc, size), bad, "pbf_desc.struct_size is");
    assert_fails(pbf_params_init(&params, size), bad, "pbf_params.struct_size is");
    assert_fails(pbf_collider_init(&collider, size, 0), bad, "pbf_collider.struct_size is");
    desc.struct_size = size;
    assert_fails(pbf_create(&desc, NULL, &none), bad, "must be sizeof(pbf_desc)");
    params.struct_size = size;
    assert_fails(pbf_set_params(s, &params), bad, "pbf_params");
    assert_fails(pbf_get_params(s, &params), bad, "pbf_params");
    assert_fails(pbf_set_colliders(s, 1, &collider), bad, "pbf_collider");
    assert_fails(pbf_get_collider(s, 0, &collider), bad, "pbf_collider");
    assert_fails(pbf_map(s, PBF_FIELD_POSITION, &view), bad, "pbf_view");
    assert_fails(pbf_read(s, &read), bad, "pbf_read_desc");
    assert_fails(pbf_write(s, &write), bad, "pbf_write_desc");
    assert_fails(pbf_acquire_snapshot(s, &snapshot), bad, "pbf_snapshot");
    assert_fails(pbf_get_stats(s, &stats), bad, "pbf_stats");
    assert_fails(pbf_get_plan(s, &plan), bad, "pbf_plan");
    assert_fails(pbf_get_info(s, &info), bad, "pbf_info");
    assert_fails(pbf_get_timings(s, &timings), bad, "pbf_timings");
    assert_fails(pbf_get_backend_info(NULL, 0, &backend), bad, "pbf_backend_info");
  }
  pbf_destroy(s);
}

static void a_newer_caller(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  later_params params;
  memset(&params, 0xff, sizeof params);
  assert_ok(pbf_params_init(&params.now, sizeof params));
  assert_int_equal(params.now.struct_size, sizeof params);
  for (int i = 0; i < 3; ++i) assert_true(params.later[i] == 0);
  assert_ok(pbf_set_params(s, &params.now));
  params.later[2] = 1;
  assert_fails(pbf_set_params(s, &params.now), PBF_ERROR_STRUCT_SIZE, "must be 0");
  assert_ok(pbf_get_params(s, &params.now));
  assert_int_equal(params.now.struct_size, sizeof params);
  assert_true(params.later[2] == 0);
  pbf_destroy(s);
}

/* What an older caller does not know has its default, as once it is compiled anew; an explicit 0 is
 * a 0. */
static void an_older_caller(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  pbf_params params, back = {.struct_size = sizeof back};
  const uint32_t without = offsetof(pbf_params, shear_stress_correction);
  assert_ok(pbf_params_init(&params, sizeof params));
  params.shear_stress_correction = 0;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_get_params(s, &back));
  assert_true(back.shear_stress_correction == 0);
  memset(&params, 0xee, sizeof params);
  assert_ok(pbf_params_init(&params, without));
  params.iterations = 7;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_get_params(s, &back));
  assert_int_equal(back.iterations, 7);
  assert_true(back.shear_stress_correction == -1);
  pbf_destroy(s);
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
  assert_ok(pbf_create(&desc, &params, &s));
  assert_ok(pbf_get_params(s, &back));
  assert_int_equal(back.iterations, 7);
  assert_true(back.shear_stress_correction == -1);
  pbf_destroy(s);
}

/* What a caller asks of an out-struct of its own size; the byte behind it is not touched. */
static void outputs_keep_to_the_size(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 3, 10);
  struct {
    pbf_info info;
    unsigned char behind[16];
  } out;
  memset(&out, 0xee, sizeof out);
  out.info.struct_size = sizeof out.info;
  assert_ok(pbf_get_info(s, &out.info));
  for (int i = 0; i < 16; ++i) assert_int_equal(out.behind[i], 0xee);
  out.info.struct_size = sizeof out.info + 8;
  assert_ok(pbf_get_info(s, &out.info));
  for (int i = 0; i < 16; ++i) assert_int_equal(out.behind[i], i < 8 ? 0 : 0xee);
  assert_int_equal(out.info.struct_size, sizeof out.info + 8);
  pbf_destroy(s);
}

static void colliders_of_another_size(void **state) {
  (void)state;
  struct {
    pbf_collider now;
    double later;
  } two[2];
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  for (int i = 0; i < 2; ++i)
    assert_ok(pbf_collider_init(&two[i].now, sizeof two[i], PBF_COLLIDER_SPHERE));
  two[1].now.radius = 3;
  assert_ok(pbf_set_colliders(s, 2, &two[0].now));
  pbf_collider back = {.struct_size = sizeof back};
  assert_ok(pbf_get_collider(s, 1, &back));
  assert_true(back.radius == 3);
  two[1].now.struct_size = sizeof(pbf_collider);
  assert_fails(pbf_set_colliders(s, 2, &two[0].now), PBF_ERROR_STRUCT_SIZE,
               "colliders[1].struct_size");
  pbf_destroy(s);
}

static void an_allocator_is_complete(void **state) {
  (void)state;
  pbf_solver *none = NULL;
  pbf_allocator allocator = test_allocator;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
  desc.allocator = &allocator;
  allocator.struct_size = 8;
  assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_STRUCT_SIZE, "pbf_allocator");
  allocator = test_allocator;
  allocator.release = NULL;
  assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_INVALID_ARGUMENT, "release is null");
  allocator = test_allocator;
  allocator.allocate = NULL;
  assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_INVALID_ARGUMENT, "allocate is null");
  allocator = test_allocator;
  allocator.reserved = 1;
  assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_INVALID_ARGUMENT, "reserved is 1");
  assert_null(none);
}

int main(void) {
  const struct CMUnitTest structs[] = {
      cmocka_unit_test(sizes_out_of_range),        cmocka_unit_test(a_newer_caller),
      cmocka_unit_test(an_older_caller),           cmocka_unit_test(outputs_keep_to_the_size),
      cmocka_unit_test(colliders_of_another_size), cmocka_unit_test(an_allocator_is_complete),
  };
  return TEST_RUN(structs);
}
