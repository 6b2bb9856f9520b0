/* Views without a copy, and DLPack tensors. */
#include <dlpack/dlpack.h>

#include "support.h"

static int on_cpu(const pbf_view *view) { return view->device_type == PBF_DEVICE_CPU; }

/* Every element of a view, looked up by id, is what the copying call gives. */
static void shows_what_get_gives(uint32_t dimension, uint32_t precision) {
  enum { COUNT = 12 };
  pbf_solver *s = test_filled(dimension, precision, COUNT + 1, 16);
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){3}));
  assert_ok(pbf_step(s, 2));
  for (uint32_t field = PBF_FIELD_POSITION; field <= PBF_FIELD_VELOCITY; ++field) {
    unsigned char copy[COUNT * 3 * 8];
    pbf_view view = {.struct_size = sizeof view};
    assert_ok(field == PBF_FIELD_POSITION ? pbf_get_positions(s, 0, COUNT, copy)
                                          : pbf_get_velocities(s, 0, COUNT, copy));
    assert_ok(pbf_map(s, field, &view));
    assert_int_equal(view.field, field);
    assert_int_equal(view.count, COUNT);
    assert_int_equal(view.components, dimension);
    assert_int_equal(view.element_type, precision);
    for (uint32_t i = 0; on_cpu(&view) && i < COUNT; ++i) {
      uint32_t row = view.ids[i] - (view.ids[i] > 3);
      for (uint32_t c = 0; c < dimension; ++c) {
        const char *element =
            (const char *)view.data + i * view.particle_stride + c * view.component_stride;
        assert_memory_equal(element, copy + (row * dimension + c) * precision, precision);
      }
    }
    assert_ok(pbf_unmap(s, field));
  }
  pbf_destroy(s);
}

static void views_show_the_particles(void **state) {
  (void)state;
  test_for_each_kind(shows_what_get_gives);
}

static void changes_are_refused_while_mapped(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 8);
  pbf_view view = {.struct_size = sizeof view};
  float x[12] = {0};
  uint64_t size;
  void *saved = test_save(s, &size);
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_ok(pbf_map(s, PBF_FIELD_ID, &view));
  assert_int_equal(view.element_type, PBF_TYPE_UINT32);
  assert_int_equal(view.components, 1);
  for (int i = 0; i < 2; ++i) {
    assert_fails(pbf_step(s, 1), PBF_ERROR_STATE, "views are mapped");
    assert_fails(pbf_add_particles(s, 1, x, NULL, NULL), PBF_ERROR_STATE, "mapped");
    assert_fails(pbf_remove_particles(s, 1, &(uint32_t){0}), PBF_ERROR_STATE, "mapped");
    assert_fails(pbf_set_positions(s, 0, 1, x), PBF_ERROR_STATE, "mapped");
    assert_fails(pbf_set_velocities(s, 0, 1, x), PBF_ERROR_STATE, "mapped");
    assert_fails(pbf_load(s, saved, size), PBF_ERROR_STATE, "mapped");
    assert_ok(pbf_get_positions(s, 0, 4, x));
    assert_ok(pbf_unmap(s, i == 0 ? PBF_FIELD_ID : PBF_FIELD_POSITION));
  }
  assert_ok(pbf_step(s, 1));
  assert_fails(pbf_unmap(s, PBF_FIELD_POSITION), PBF_ERROR_STATE, "no view is mapped");
  free(saved);
  pbf_destroy(s);
}

static void fields_that_cannot_be_mapped(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 8);
  pbf_view view = {.struct_size = sizeof view};
  DLManagedTensor *tensor = NULL;
  assert_fails(pbf_map(s, 0, &view), PBF_ERROR_INVALID_ARGUMENT, "field is 0");
  assert_fails(pbf_map(s, 6, &view), PBF_ERROR_INVALID_ARGUMENT, "field is 6");
  assert_fails(pbf_map(s, PBF_FIELD_DENSITY, &view), PBF_ERROR_UNSUPPORTED, "density");
  assert_fails(pbf_unmap(s, UINT32_MAX), PBF_ERROR_INVALID_ARGUMENT, "field is");
  assert_fails(pbf_export_dlpack(s, PBF_FIELD_DENSITY, &tensor), PBF_ERROR_UNSUPPORTED, "density");
  assert_null(tensor);
  pbf_destroy(s);
}

static uint64_t generation(pbf_solver *s) {
  pbf_view view = {.struct_size = sizeof view};
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_ok(pbf_unmap(s, PBF_FIELD_POSITION));
  return view.generation;
}

static void generations(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 8);
  float x[3] = {0.5f, 0.5f, 0.5f};
  pbf_params params = test_params();
  uint64_t last = generation(s);
  assert_int_equal(generation(s), last);
  assert_ok(pbf_set_params(s, &params));
  assert_int_equal(generation(s), last);
#define CHANGES(call)                          \
  do {                                         \
    assert_ok(call);                           \
    assert_int_not_equal(generation(s), last); \
    last = generation(s);                      \
  } while (0)
  CHANGES(pbf_step(s, 1));
  CHANGES(pbf_add_particles(s, 1, x, NULL, NULL));
  CHANGES(pbf_remove_particles(s, 1, &(uint32_t){1}));
  CHANGES(pbf_set_positions(s, 0, 1, x));
  CHANGES(pbf_set_velocities(s, 0, 1, x));
  pbf_destroy(s);
}

static void check_tensor(pbf_solver *s, uint32_t field, uint32_t components, DLDataType type) {
  pbf_view view = {.struct_size = sizeof view};
  DLManagedTensor *tensor = NULL;
  assert_ok(pbf_map(s, field, &view));
  assert_ok(pbf_unmap(s, field));
  assert_ok(pbf_export_dlpack(s, field, &tensor));
  const DLTensor *t = &tensor->dl_tensor;
  assert_ptr_equal((const char *)t->data + t->byte_offset, view.data);
  assert_int_equal(t->device.device_type, view.device_type);
  assert_int_equal(t->device.device_id, view.device_id);
  assert_int_equal(t->ndim, 2);
  assert_int_equal(t->shape[0], view.count);
  assert_int_equal(t->shape[1], components);
  assert_memory_equal(&t->dtype, &type, sizeof type);
  assert_int_equal(t->strides[0] * type.bits / 8, view.particle_stride);
  assert_int_equal(t->strides[1] * type.bits / 8, view.component_stride);
  assert_fails(pbf_step(s, 1), PBF_ERROR_STATE, "1 tensors exported");
  tensor->deleter(tensor);
  assert_ok(pbf_step(s, 1));
}

static void tensors(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 5, 8);
  check_tensor(s, PBF_FIELD_POSITION, 3, (DLDataType){kDLFloat, 32, 1});
  pbf_destroy(s);
}

static void wide_tensors(void **state) {
  (void)state;
  pbf_solver *wide = test_filled(2, PBF_FLOAT64, 5, 8);
  check_tensor(wide, PBF_FIELD_VELOCITY, 2, (DLDataType){kDLFloat, 64, 1});
  check_tensor(wide, PBF_FIELD_ID, 1, (DLDataType){kDLUInt, 32, 1});
  pbf_destroy(wide);
}

static void tensors_outlive_the_solver(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 5, 8);
  DLManagedTensor *two[2];
  uint64_t blocks = test_count.live_blocks;
  for (int i = 0; i < 2; ++i) assert_ok(pbf_export_dlpack(s, PBF_FIELD_VELOCITY, &two[i]));
  pbf_destroy(s);
  assert_fails(pbf_step(s, 1), PBF_ERROR_INVALID_ARGUMENT, "pbf_destroy has taken back");
  two[0]->deleter(two[0]);
  assert_int_equal(test_count.live_blocks, blocks + 1);
  if (two[1]->dl_tensor.device.device_type == kDLCPU) {
    float sum = 0;
    const float *v = two[1]->dl_tensor.data;
    for (int64_t i = 0; i < 5; ++i) sum += v[i * two[1]->dl_tensor.strides[0]];
    assert_true(sum == (1 + 2 + 3 + 4 + 5) / 8.0f);
  }
  two[1]->deleter(two[1]);
  assert_int_equal(test_count.live_blocks, 0);
}

static void a_mapped_solver_can_be_destroyed(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 5, 8);
  pbf_view view = {.struct_size = sizeof view};
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  pbf_destroy(s);
  assert_int_equal(test_count.live_blocks, 0);
}

static void an_empty_view(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 8);
  pbf_view view = {.struct_size = sizeof view};
  DLManagedTensor *tensor = NULL;
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_int_equal(view.count, 0);
  assert_ok(pbf_unmap(s, PBF_FIELD_POSITION));
  assert_ok(pbf_export_dlpack(s, PBF_FIELD_ID, &tensor));
  assert_int_equal(tensor->dl_tensor.shape[0], 0);
  tensor->deleter(tensor);
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest views[] = {
      cmocka_unit_test(views_show_the_particles),
      cmocka_unit_test(changes_are_refused_while_mapped),
      cmocka_unit_test(fields_that_cannot_be_mapped),
      cmocka_unit_test(generations),
      cmocka_unit_test(tensors),
      cmocka_unit_test(wide_tensors),
      cmocka_unit_test(tensors_outlive_the_solver),
      cmocka_unit_test(a_mapped_solver_can_be_destroyed),
      cmocka_unit_test(an_empty_view),
  };
  return TEST_RUN(views);
}
