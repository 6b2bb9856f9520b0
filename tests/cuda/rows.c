/* Particles into and out of the caller's memory on the device, in its layout and the order of its
 * stream: the numbers that the same calls have with host memory. */
#include "driver.h"
#include "support.h"

/* A plane has room for fewer. */
enum { COUNT = 700, PLANE_COUNT = 120, CAPACITY = 800, FIRST = 30, SOME = 70 };
enum { ROOM = CAPACITY * 5 * 8, GUARD = 0x5b };

static unsigned char on_host[ROOM], on_device[ROOM];
static const uint32_t gone[] = {0, 7, 30, 31, 110};

static pbf_solver *scene_of(uint32_t dimension, uint32_t precision, void *stream) {
  pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  desc.stream = stream;
  pbf_solver *solver = test_create(&desc, NULL);
  const uint32_t count = dimension == 2 ? PLANE_COUNT : COUNT;
  void *positions = test_lattice(dimension, precision, count);
  assert_ok(pbf_add_particles(solver, count, positions, NULL, NULL));
  free(positions);
  assert_ok(pbf_step(solver, 4));
  return solver;
}

static void *pointer_of(cuda_address address) { return (void *)(uintptr_t)address; }

static uint32_t count_of(pbf_solver *solver) {
  uint32_t count = 0;
  assert_ok(pbf_get_count(solver, &count));
  return count;
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* In float64 the last bit of a speed may differ: a device has fused operations. */
static void check_same(const pbf_read_desc *read, uint64_t stride, uint32_t size) {
  const int is_double = size == 8, speeds = read->w == PBF_W_SPEED && read->components == 4;
  if (!is_double || !speeds) {
    assert_memory_equal(on_device, on_host, ROOM);
    return;
  }
  for (uint32_t i = 0; i < read->count; ++i) {
    double found[4], expected[4];
    memcpy(found, on_device + i * stride, sizeof found);
    memcpy(expected, on_host + i * stride, sizeof expected);
    assert_memory_equal(found, expected, 3 * sizeof(double));
    assert_true(fabs(found[3] - expected[3]) <= 1e-15 * fabs(expected[3]));
  }
}

static void check_read(pbf_solver *solver, pbf_read_desc read, cuda_address memory,
                       cuda_stream stream) {
  const uint32_t size = read.element_type == PBF_TYPE_FLOAT64 ? 8 : 4;
  const uint64_t stride = read.stride ? read.stride : (uint64_t)read.components * size;
  memset(on_host, GUARD, ROOM);
  cuda_write(memory, on_host, ROOM);
  read.struct_size = sizeof read;
  read.data = on_host;
  assert_ok(pbf_read(solver, &read));
  read.data = pointer_of(memory);
  read.device_type = PBF_DEVICE_CUDA;
  read.stream = stream;
  assert_ok(pbf_read(solver, &read));
  cuda_wait(stream); /* the caller's own wait is enough */
  cuda_read(on_device, memory, ROOM);
  check_same(&read, stride, size);
}

static void check_layouts(pbf_solver *solver, uint32_t dimension, cuda_address memory,
                          cuda_stream stream) {
  const uint32_t count = count_of(solver);
  for (uint32_t type = PBF_TYPE_FLOAT32; type <= PBF_TYPE_FLOAT64; type += 4)
    for (uint32_t field = PBF_FIELD_POSITION; field <= PBF_FIELD_VELOCITY; ++field) {
      pbf_read_desc read = {.field = field, .count = count, .element_type = type, .w_value = 0.25};
      for (read.components = dimension; read.components <= 4; ++read.components)
        check_read(solver, read, memory, stream);
      read.components = 4, read.stride = 5 * type;
      for (read.w = PBF_W_CONSTANT; read.w <= PBF_W_PRESSURE; ++read.w) {
        read.first = 0, read.count = count;
        check_read(solver, read, memory, stream);
        read.first = FIRST, read.count = SOME;
        check_read(solver, read, memory, stream);
      }
    }
  for (uint32_t field = PBF_FIELD_DENSITY; field <= PBF_FIELD_PRESSURE; ++field)
    check_read(solver,
               (pbf_read_desc){.field = field,
                               .count = count,
                               .components = 1,
                               .element_type = PBF_TYPE_FLOAT64,
                               .stride = 24},
               memory, stream);
  check_read(solver,
             (pbf_read_desc){.field = PBF_FIELD_ID, .first = FIRST, .count = SOME, .components = 1},
             memory, stream);
}

static void check_kind(uint32_t dimension, uint32_t precision) {
  cuda_primary_context();
  cuda_address memory = cuda_take(ROOM);
  cuda_stream stream = cuda_create_stream();
  pbf_solver *solver = scene_of(dimension, precision, NULL);
  check_layouts(solver, dimension, memory, stream);
  assert_ok(pbf_remove_particles(solver, sizeof gone / sizeof gone[0], gone));
  assert_ok(pbf_step(solver, 1));
  check_layouts(solver, dimension, memory, stream);
  pbf_destroy(solver);
  cuda_destroy_stream(stream);
  cuda_give_back(memory);
  cuda_set_current(NULL);
}

static void layouts(void **state) {
  (void)state;
  test_for_each_kind(check_kind);
}

/* As they are stored: by the ids that lie beside them, each where the order of adding has it. */
static void the_order_of_storing(void **state) {
  static float rows[3 * CAPACITY], stored[4 * CAPACITY];
  static uint32_t ids[CAPACITY];
  (void)state;
  cuda_primary_context();
  cuda_address memory = cuda_take(sizeof stored), id_memory = cuda_take(sizeof ids);
  cuda_stream stream = cuda_create_stream();
  pbf_solver *solver = scene_of(3, PBF_FLOAT32, NULL);
  assert_ok(pbf_step(solver, 40));
  pbf_read_desc read = {.struct_size = sizeof read,
                        .field = PBF_FIELD_POSITION,
                        .count = COUNT,
                        .components = 4,
                        .order = PBF_ORDER_STORED,
                        .data = pointer_of(memory),
                        .device_type = PBF_DEVICE_CUDA,
                        .stream = stream};
  assert_ok(pbf_read(solver, &read));
  read.field = PBF_FIELD_ID, read.components = 1, read.data = pointer_of(id_memory);
  assert_ok(pbf_read(solver, &read));
  cuda_wait(stream);
  cuda_read(stored, memory, COUNT * 4 * sizeof(float));
  cuda_read(ids, id_memory, COUNT * sizeof *ids);
  assert_ok(pbf_get_positions(solver, 0, COUNT, rows));
  uint32_t met[COUNT] = {0};
  for (uint32_t i = 0; i < COUNT; ++i) {
    assert_true(ids[i] < COUNT && !met[ids[i]]++);
    assert_memory_equal(&stored[4 * i], &rows[3 * ids[i]], 3 * sizeof(float));
  }
  pbf_destroy(solver);
  cuda_destroy_stream(stream);
  cuda_give_back(id_memory);
  cuda_give_back(memory);
  cuda_set_current(NULL);
}

/* ---- Writing --------------------------------------------------------------------------------- */

static double speed_of(uint32_t i, uint32_t k) { return (double)(i % 9) / 8 - (double)k / 16; }
static double place_of(uint32_t i, uint32_t k) { return 0.25 + (i * 7 + k * 3) % 32 / 64.0; }

/* Rows of four float64, of which the last is not finite: it is not read. */
static void fill(uint32_t field, uint32_t dimension, double *numbers) {
  for (uint32_t i = 0; i < SOME; ++i)
    for (uint32_t k = 0; k < 4; ++k)
      numbers[4 * i + k] = k >= dimension                ? NAN
                           : field == PBF_FIELD_VELOCITY ? speed_of(i, k)
                                                         : place_of(i, k);
}

static pbf_write_desc write_of(uint32_t field, cuda_address memory, cuda_stream stream) {
  return (pbf_write_desc){.struct_size = sizeof(pbf_write_desc),
                          .field = field,
                          .first = FIRST,
                          .count = SOME,
                          .element_type = PBF_TYPE_FLOAT64,
                          .components = 4,
                          .data = pointer_of(memory),
                          .device_type = PBF_DEVICE_CUDA,
                          .stream = stream};
}

static void check_writing(uint32_t dimension, uint32_t precision) {
  static double numbers[4 * SOME];
  cuda_primary_context();
  cuda_address memory = cuda_take(sizeof numbers);
  cuda_stream stream = cuda_create_stream();
  for (uint32_t field = PBF_FIELD_POSITION; field <= PBF_FIELD_VELOCITY; ++field) {
    pbf_solver *solver = scene_of(dimension, precision, NULL);
    pbf_solver *twin = scene_of(dimension, precision, NULL);
    assert_ok(pbf_remove_particles(solver, sizeof gone / sizeof gone[0], gone));
    assert_ok(pbf_remove_particles(twin, sizeof gone / sizeof gone[0], gone));
    fill(field, dimension, numbers);
    cuda_write(memory, numbers, sizeof numbers);
    const pbf_write_desc write = write_of(field, memory, stream);
    pbf_write_desc from_host = write;
    from_host.data = numbers, from_host.device_type = 0, from_host.stream = NULL;
    assert_ok(pbf_write(solver, &write));
    assert_ok(pbf_write(twin, &from_host));
    assert_true(test_hash(solver) == test_hash(twin));
    assert_ok(pbf_step(solver, 2));
    assert_ok(pbf_step(twin, 2));
    assert_true(test_hash(solver) == test_hash(twin));
    pbf_destroy(twin);
    pbf_destroy(solver);
  }
  cuda_destroy_stream(stream);
  cuda_give_back(memory);
  cuda_set_current(NULL);
}

static void writing(void **state) {
  (void)state;
  test_for_each_kind(check_writing);
}

/* None is written, and what comes next says so, once. */
static void velocities_that_are_not_finite(void **state) {
  static double numbers[4 * SOME];
  static const double bad[] = {NAN, INFINITY, -1e151};
  (void)state;
  cuda_primary_context();
  cuda_address memory = cuda_take(sizeof numbers);
  cuda_stream stream = cuda_create_stream();
  for (int k = 0; k < 3; ++k) {
    pbf_solver *solver = scene_of(3, PBF_FLOAT32, NULL);
    const uint64_t hash = test_hash(solver);
    const pbf_write_desc write = write_of(PBF_FIELD_VELOCITY, memory, stream);
    fill(PBF_FIELD_VELOCITY, 3, numbers);
    numbers[4 * 17 + 1] = bad[k];
    numbers[4 * 60] = NAN;
    cuda_write(memory, numbers, sizeof numbers);
    assert_ok(pbf_write(solver, &write));
    cuda_wait(stream);
    if (k == 0)
      assert_fails(pbf_synchronize(solver), PBF_ERROR_INVALID_ARGUMENT, "the first in row 47");
    else
      assert_fails(pbf_step(solver, 1), PBF_ERROR_INVALID_ARGUMENT, "the first in row 47");
    assert_true(test_hash(solver) == hash);
    assert_ok(pbf_synchronize(solver));
    assert_ok(pbf_step(solver, 1));
    pbf_destroy(solver);
  }
  cuda_destroy_stream(stream);
  cuda_give_back(memory);
  cuda_set_current(NULL);
}

/* ---- Bad input ------------------------------------------------------------------------------- */

static void memory_that_will_not_do(void **state) {
  enum { BYTES = 4096 };
  (void)state;
  cuda_primary_context();
  cuda_address memory = cuda_take(BYTES);
  pbf_solver *solver = scene_of(3, PBF_FLOAT32, NULL);
  pbf_read_desc read = {.struct_size = sizeof read,
                        .field = PBF_FIELD_POSITION,
                        .count = 300,
                        .data = on_host,
                        .device_type = PBF_DEVICE_CUDA};
  pbf_write_desc write = {.struct_size = sizeof write,
                          .field = PBF_FIELD_VELOCITY,
                          .count = 300,
                          .data = on_host,
                          .device_type = PBF_DEVICE_CUDA};
  const uint64_t hash = test_hash(solver);
  assert_fails(pbf_read(solver, &read), PBF_ERROR_INVALID_ARGUMENT,
               "read.data is not memory of a device");
  assert_fails(pbf_write(solver, &write), PBF_ERROR_INVALID_ARGUMENT,
               "write.data is not memory of a device");
  read.data = pointer_of(memory + 2);
  assert_fails(pbf_read(solver, &read), PBF_ERROR_INVALID_ARGUMENT, "aligned to 4 bytes");
  read.data = pointer_of(memory);
  assert_ok(pbf_read(solver, &read));
  read.stride = 1 << 20;
  assert_fails(pbf_read(solver, &read), PBF_ERROR_INVALID_ARGUMENT, "read.data has ");
  read.stride = 0, read.behind = 0.5;
  assert_ok(pbf_keep_previous(solver, 1));
  assert_fails(pbf_read(solver, &read), PBF_ERROR_UNSUPPORTED, "read.behind is 0.5");
  assert_true(test_hash(solver) == hash);
  assert_ok(pbf_step(solver, 2)); /* the device is as good as before */
  pbf_destroy(solver);
  cuda_give_back(memory);
  cuda_set_current(NULL);
}

/* ---- Order ----------------------------------------------------------------------------------- */

/* A reading waits for what the caller's stream has been given before, and not the host for either.
 */
static void the_host_does_not_wait(void **state) {
  static float seen[3 * COUNT], expected[3 * COUNT];
  (void)state;
  cuda_primary_context();
  cuda_address memory = cuda_take(sizeof seen);
  cuda_stream stream = cuda_create_stream();
  volatile uint32_t *go = cuda_new_switch();
  pbf_solver *solver = scene_of(3, PBF_FLOAT32, NULL);
  pbf_read_desc read = {.struct_size = sizeof read,
                        .field = PBF_FIELD_POSITION,
                        .count = COUNT,
                        .data = pointer_of(memory),
                        .device_type = PBF_DEVICE_CUDA,
                        .stream = stream};
  assert_ok(pbf_read(solver, &read)); /* what it takes at first */
  assert_ok(pbf_synchronize(solver));
  cuda_wait(stream);
  assert_ok(pbf_get_positions(solver, 0, COUNT, expected));
  memset(seen, GUARD, sizeof seen);
  cuda_write(memory, seen, sizeof seen);
  cuda_hold(stream, go);
  assert_ok(pbf_read(solver, &read));
  if (cuda_can_hold()) {
    assert_true(cuda_is_busy(stream));
    pbf_write_desc write = write_of(PBF_FIELD_VELOCITY, memory, stream);
    write.components = 3, write.element_type = PBF_TYPE_FLOAT32; /* what has been read by then */
    assert_ok(pbf_write(solver, &write));
    assert_true(cuda_is_busy(stream));
  }
  *go = 1;
  cuda_wait(stream);
  cuda_read(seen, memory, sizeof seen);
  assert_memory_equal(seen, expected, sizeof seen);
  pbf_destroy(solver);
  cuda_destroy_stream(stream);
  cuda_give_back(memory);
  cuda_set_current(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(layouts),
      cmocka_unit_test(the_order_of_storing),
      cmocka_unit_test(writing),
      cmocka_unit_test(velocities_that_are_not_finite),
      cmocka_unit_test(memory_that_will_not_do),
      cmocka_unit_test(the_host_does_not_wait),
  };
  return TEST_RUN(tests);
}
