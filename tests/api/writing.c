/* Fields from the caller's own layout: the state that the plain calls leave, to the bit; and memory
 * of a device that a solver does not run on. */
#include <stdio.h>

#include "support.h"

enum { COUNT = 60, CAPACITY = 80, FIRST = 9, SOME = 20, ROOM = 5 * CAPACITY };

/* So that float32 holds them, too. */
static double place_of(uint32_t i, uint32_t k) { return 0.25 + (i * 7 + k * 3) % 32 / 64.0; }
static double speed_of(uint32_t i, uint32_t k) { return (double)(i % 5) / 8 - (double)k / 16; }
static double number_of(uint32_t field, uint32_t i, uint32_t k) {
  return field == PBF_FIELD_POSITION ? place_of(i, k) : speed_of(i, k);
}

static void put(void *data, uint32_t type, uint64_t place, double x) {
  if (type == PBF_TYPE_FLOAT32)
    ((float *)data)[place] = (float)x;
  else
    ((double *)data)[place] = x;
}

/* Rows of `width` numbers, those beyond the dimension not finite: they are not read. */
static void fill(void *data, uint32_t type, uint32_t field, uint32_t dimension, uint32_t width) {
  for (uint32_t i = 0; i < SOME; ++i)
    for (uint32_t k = 0; k < width; ++k)
      put(data, type, (uint64_t)i * width + k, k < dimension ? number_of(field, i, k) : NAN);
}

static uint64_t set_plainly(uint32_t dimension, uint32_t precision, uint32_t field) {
  double numbers[ROOM];
  pbf_solver *solver = test_filled(dimension, precision, COUNT, CAPACITY);
  assert_ok(pbf_step(solver, 2));
  fill(numbers, precision, field, dimension, dimension);
  assert_ok(field == PBF_FIELD_POSITION ? pbf_set_positions(solver, FIRST, SOME, numbers)
                                        : pbf_set_velocities(solver, FIRST, SOME, numbers));
  const uint64_t hash = test_hash(solver);
  pbf_destroy(solver);
  return hash;
}

static void check_write(uint32_t dimension, uint32_t precision, pbf_write_desc write,
                        uint32_t width) {
  double numbers[ROOM];
  pbf_solver *solver = test_filled(dimension, precision, COUNT, CAPACITY);
  assert_ok(pbf_step(solver, 2));
  fill(numbers, write.element_type ? write.element_type : precision, write.field, dimension, width);
  write.struct_size = sizeof write;
  write.data = numbers;
  assert_ok(pbf_write(solver, &write));
  assert_true(test_hash(solver) == set_plainly(dimension, precision, write.field));
  pbf_destroy(solver);
}

static void check_layouts(uint32_t dimension, uint32_t precision) {
  static const uint32_t types[] = {0, PBF_TYPE_FLOAT32, PBF_TYPE_FLOAT64};
  for (uint32_t field = PBF_FIELD_POSITION; field <= PBF_FIELD_VELOCITY; ++field)
    for (int t = 0; t < 3; ++t) {
      pbf_write_desc write = {
          .field = field, .first = FIRST, .count = SOME, .element_type = types[t]};
      const uint32_t size = types[t] ? types[t] : precision;
      check_write(dimension, precision, write, dimension);
      write.components = 4;
      check_write(dimension, precision, write, 4);
      write.stride = 5 * size;
      check_write(dimension, precision, write, 5);
      write.components = 0;
      check_write(dimension, precision, write, 5);
    }
}

static void layouts(void **state) {
  (void)state;
  test_for_each_kind(check_layouts);
}

#define REFUSES(change, status, word)                    \
  do {                                                   \
    pbf_write_desc bad = good;                           \
    change;                                              \
    assert_fails(pbf_write(solver, &bad), status, word); \
  } while (0)

static void bad_input_leaves_the_state(void **state) {
  const pbf_status bad_argument = PBF_ERROR_INVALID_ARGUMENT;
  float x[3 * SOME];
  (void)state;
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  fill(x, PBF_TYPE_FLOAT32, PBF_FIELD_POSITION, 3, 3);
  const pbf_write_desc good = {.struct_size = sizeof good,
                               .field = PBF_FIELD_POSITION,
                               .first = FIRST,
                               .count = SOME,
                               .data = x};
  const uint64_t hash = test_hash(solver);
  assert_fails(pbf_write(solver, NULL), bad_argument, "write is null");
  REFUSES(bad.struct_size = 8, PBF_ERROR_STRUCT_SIZE, "pbf_write_desc.struct_size is 8");
  REFUSES(bad.field = PBF_FIELD_ID, bad_argument, "write.field is 3");
  REFUSES(bad.first = COUNT, bad_argument, "first is 60 and count 20");
  REFUSES(bad.element_type = PBF_TYPE_UINT32, bad_argument, "write.element_type is 12");
  REFUSES(bad.components = 2, bad_argument, "write.components is 2");
  REFUSES(bad.components = 5, bad_argument, "write.components is 5");
  REFUSES(bad.stride = 8, bad_argument, "write.stride is 8");
  REFUSES(bad.stride = 14, bad_argument, "write.stride is 14");
  REFUSES(bad.data = NULL, bad_argument, "write.data is null");
  REFUSES(bad.data = (const char *)x + 1, bad_argument, "write.data is");
  REFUSES(bad.device_type = 3, bad_argument, "write.device_type is 3");
  REFUSES(bad.reserved = 1, bad_argument, "write.reserved is 1");
  REFUSES(bad.stream = x, bad_argument, "write.stream is set");
  x[7] = NAN;
  REFUSES((void)bad, bad_argument, "positions[11][1] is NaN");
  x[7] = 1e6f;
  REFUSES((void)bad, bad_argument, "positions[11][1] is 1000000");
  x[7] = INFINITY;
  REFUSES(bad.field = PBF_FIELD_VELOCITY, bad_argument, "velocities[11][1] is inf");
  assert_true(test_hash(solver) == hash);
  pbf_destroy(solver);
}

/* The number that was given, not what another precision or fewer digits make of it. */
static void sentences_have_the_number_given(void **state) {
  (void)state;
  double x[2][3] = {{0.25, 0.25, 0.25}, {0.5, 1e39, 0.5}};
  pbf_write_desc write = {.struct_size = sizeof write,
                          .field = PBF_FIELD_VELOCITY,
                          .first = 5,
                          .count = 2,
                          .element_type = PBF_TYPE_FLOAT64,
                          .data = x};
  pbf_solver *single = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  const uint64_t hash = test_hash(single);
  assert_fails(pbf_write(single, &write), PBF_ERROR_INVALID_ARGUMENT,
               "velocities[6][1] is 1e+39; it must be a number that float32 holds");
  write.field = PBF_FIELD_POSITION;
  x[1][1] = -1e200;
  assert_fails(pbf_write(single, &write), PBF_ERROR_INVALID_ARGUMENT, "positions[6][1] is -1e+200");
  assert_true(test_hash(single) == hash);
  pbf_destroy(single);
  pbf_solver *twofold = test_filled(3, PBF_FLOAT64, COUNT, CAPACITY);
  const double outside = 1 + 1.0 / (1 << 30);
  x[1][1] = outside;
  assert_fails(pbf_write(twofold, &write), PBF_ERROR_INVALID_ARGUMENT,
               "positions[6][1] is 1.0000000009313226; it must be inside the domain, 0 … 1");
  pbf_destroy(twofold);
}

/* Whichever of many it is, and on whichever axis: they are looked at many at once. */
static void one_of_many_is_outside(uint32_t dimension, uint32_t precision) {
  enum { MANY = 13 }; /* no whole number of vectors */
  static const double outside[] = {-0.125, 0.125, NAN};
  double x[MANY * 3];
  float single[MANY * 3];
  char named[40];
  pbf_params params = {.struct_size = sizeof params};
  pbf_solver *s = test_filled(dimension, precision, MANY, MANY);
  assert_ok(pbf_get_params(s, &params));
  for (int axis = 0; axis < 3; ++axis) params.domain_max[axis] = 1 + axis;
  assert_ok(pbf_set_params(s, &params));
  const void *given = precision == PBF_FLOAT32 ? (void *)single : (void *)x;
  for (uint32_t k = 0; k < MANY * dimension; ++k) x[k] = 1 + k % dimension;
  for (uint32_t at = 0; at < MANY * dimension; ++at)
    for (int which = 0; which < 3; ++which) {
      const double inside = x[at];
      x[at] = outside[which] + (which == 1 ? inside : 0);
      for (uint32_t k = 0; k < MANY * dimension; ++k) single[k] = (float)x[k];
      snprintf(named, sizeof named, "positions[%u][%u] is ", at / dimension, at % dimension);
      assert_fails(pbf_set_positions(s, 0, MANY, given), PBF_ERROR_INVALID_ARGUMENT, named);
      x[at] = inside;
    }
  for (uint32_t k = 0; k < MANY * dimension; ++k) single[k] = (float)x[k];
  assert_ok(pbf_set_positions(s, 0, MANY, given));
  pbf_destroy(s);
}

static void one_of_many(void **state) {
  (void)state;
  test_for_each_kind(one_of_many_is_outside);
}

/* Of a GPU, where the solver is on a CPU; on a GPU the host's. */
static void memory_of_another_device(void **state) {
  float x[3 * SOME] = {0};
  (void)state;
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, COUNT, CAPACITY);
  const pbf_write_desc write = {.struct_size = sizeof write,
                                .field = PBF_FIELD_VELOCITY,
                                .count = SOME,
                                .data = x,
                                .device_type = PBF_DEVICE_CUDA};
  pbf_read_desc read = {.struct_size = sizeof read,
                        .field = PBF_FIELD_POSITION,
                        .count = SOME,
                        .data = x,
                        .device_type = PBF_DEVICE_CUDA};
  const uint64_t hash = test_hash(solver);
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(solver, &info));
  const int on_gpu = info.device_type == PBF_DEVICE_CUDA;
  const pbf_status status = on_gpu ? PBF_ERROR_INVALID_ARGUMENT : PBF_ERROR_UNSUPPORTED;
  assert_fails(pbf_write(solver, &write), status,
               on_gpu ? "write.data is not memory of a device" : "write.device_type is 2");
  assert_fails(pbf_read(solver, &read), status,
               on_gpu ? "read.data is not memory of a device" : "read.device_type is 2");
  read.device_type = PBF_DEVICE_CPU;
  read.stream = x;
  assert_fails(pbf_read(solver, &read), PBF_ERROR_INVALID_ARGUMENT, "read.stream is set");
  read.stream = NULL;
  assert_ok(pbf_read(solver, &read));
  assert_true(test_hash(solver) == hash);
  pbf_destroy(solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layouts),
      cmocka_unit_test(bad_input_leaves_the_state),
      cmocka_unit_test(sentences_have_the_number_given),
      cmocka_unit_test(one_of_many),
      cmocka_unit_test(memory_of_another_device),
  };
  return TEST_RUN(tests);
}
