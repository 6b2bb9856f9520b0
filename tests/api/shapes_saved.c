/* Shapes as bytes: the same again, and nothing else. */
#include "shape_solids.h"

static uint64_t hash_of(pbf_shape *shape) {
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  return info.hash;
}

static unsigned char *bytes_of(pbf_shape *shape, uint64_t *size) {
  assert_ok(pbf_save_shape(shape, NULL, size));
  unsigned char *bytes = malloc(*size);
  assert_non_null(bytes);
  assert_ok(pbf_save_shape(shape, bytes, size));
  return bytes;
}

static void comes_back(uint32_t dimension) {
  pbf_shape *shape = small_ball(dimension), *again = NULL;
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  const uint64_t nodes =
      (uint64_t)info.nodes[0] * info.nodes[1] * (dimension == 3 ? info.nodes[2] : 1);
  uint64_t size;
  unsigned char *bytes = bytes_of(shape, &size);
  assert_true(size == 72 + 4 * nodes);
  assert_ok(pbf_load_shape(bytes, size, &again));
  assert_ptr_not_equal(again, shape);
  assert_true(hash_of(again) == info.hash);
  /* Once the first is gone, the second has it all. */
  const double at[3] = {0.7 * ball_radius, 0.2 * ball_radius, 0};
  double before, after;
  assert_ok(pbf_get_shape_distance(shape, at, &before, NULL));
  pbf_release_shape(shape);
  assert_ok(pbf_get_shape_distance(again, at, &after, NULL));
  assert_true(before == after);
  pbf_release_shape(again);
  free(bytes);
}

static void shapes_come_back(void **state) {
  (void)state;
  comes_back(2);
  comes_back(3);
}

/* The values are the ball's distances at the nodes, and make the same shape again. */
static void values_are_distances(void **state) {
  (void)state;
  pbf_shape *shape = small_ball(3), *again = NULL;
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  const uint64_t nodes = (uint64_t)info.nodes[0] * info.nodes[1] * info.nodes[2];
  float *values = malloc(nodes * sizeof *values);
  assert_non_null(values);
  assert_ok(pbf_get_shape_values(shape, nodes, values));
  for (uint64_t n = 0; n < nodes; ++n) {
    const uint64_t place[3] = {n % info.nodes[0], n / info.nodes[0] % info.nodes[1],
                               n / info.nodes[0] / info.nodes[1]};
    double p[3];
    for (int k = 0; k < 3; ++k) p[k] = info.origin[k] + info.cell * (double)place[k];
    assert_true(fabs((double)values[n] - ball(p, 3)) < 1e-6);
  }
  pbf_grid_desc grid = {.struct_size = sizeof grid, .dimension = 3, .cell = info.cell};
  memcpy(grid.nodes, info.nodes, sizeof grid.nodes);
  memcpy(grid.origin, info.origin, sizeof grid.origin);
  grid.values = values;
  assert_ok(pbf_shape_from_grid(&grid, &again));
  assert_true(hash_of(again) == info.hash);
  assert_fails(pbf_get_shape_values(shape, nodes - 1, values), PBF_ERROR_INVALID_ARGUMENT,
               "count is");
  assert_fails(pbf_get_shape_values(shape, nodes, NULL), PBF_ERROR_INVALID_ARGUMENT,
               "values is null");
  assert_fails(pbf_get_shape_values(NULL, nodes, values), PBF_ERROR_INVALID_ARGUMENT,
               "shape is null");
  pbf_release_shape(shape);
  pbf_release_shape(again);
  free(values);
}

/* A state finds the shape that has been loaded from a file. */
static void states_find_loaded_shapes(void **state) {
  (void)state;
  pbf_shape *shape = small_ball(3);
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 64, 64);
  pbf_collider collider = collider_of(shape), found = {.struct_size = sizeof found};
  uint64_t state_size, size;
  assert_ok(pbf_set_colliders(solver, 1, &collider));
  void *saved = test_save(solver, &state_size);
  unsigned char *bytes = bytes_of(shape, &size);
  pbf_release_shape(shape);
  pbf_destroy(solver);
  shape = NULL;
  assert_ok(pbf_load_shape(bytes, size, &shape));
  solver = test_filled(3, PBF_FLOAT32, 64, 64);
  assert_ok(pbf_load(solver, saved, state_size));
  assert_ok(pbf_get_collider(solver, 0, &found));
  assert_ptr_equal(found.geometry, shape);
  pbf_release_shape(shape);
  pbf_destroy(solver);
  free(bytes);
  free(saved);
}

static void refused(const unsigned char *bytes, uint64_t size, const char *words) {
  pbf_shape *shape = NULL;
  assert_fails(pbf_load_shape(bytes, size, &shape), PBF_ERROR_DATA, words);
  assert_null(shape);
}

/* One number of the header, or of the distances, is another one. */
static void changed(const unsigned char *bytes, uint64_t size, uint64_t at, const void *number,
                    uint64_t width, const char *words) {
  unsigned char *copy = malloc(size);
  assert_non_null(copy);
  memcpy(copy, bytes, size);
  memcpy(copy + at, number, width);
  refused(copy, size, words);
  free(copy);
}

static void other_bytes_are_refused(void **state) {
  (void)state;
  pbf_shape *shape = small_ball(3);
  uint64_t size, room;
  unsigned char *bytes = bytes_of(shape, &size);
  const uint32_t two = 2, many = 100000, four = 4;
  const double none = 0, nan = NAN;
  const float far_off = 1e6f, not_a_number = NAN, near_by = 0.001f;
  for (uint64_t cut = 0; cut < 72; cut += 7) refused(bytes, cut, "cut short");
  refused(bytes, size - 1, "by its header it has");
  changed(bytes, size, 0, "PBFSTATE", 8, "does not begin as one");
  changed(bytes, size, 8, &two, 4, "has format 2; this library reads format 1");
  changed(bytes, size, 12, &two, 4, "header has what it can't have");
  changed(bytes, size, 12, &four, 4, "dimension is 4; it must be 2 or 3");
  changed(bytes, size, 16, &many, 4, "by its header it has");
  changed(bytes, size, 28, &two, 4, "header has what it can't have");
  changed(bytes, size, 32, &nan, 8, "origin[0] is NaN");
  changed(bytes, size, 56, &none, 8, "cell is 0");
  changed(bytes, size, 64, &none, 8, "has another hash");
  changed(bytes, size, 72 + 4 * 400, &far_off, 4, "by no more than the way");
  changed(bytes, size, 72 + 4 * 400, &not_a_number, 4, "is NaN; it must be finite");
  float value;
  memcpy(&value, bytes + size - 4, sizeof value);
  value += near_by;
  changed(bytes, size, size - 4, &value, 4, "has another hash");

  /* What has no meaning in 2D is not another number, either. */
  pbf_shape *flat = small_ball(2);
  uint64_t flat_size;
  unsigned char *flat_bytes = bytes_of(flat, &flat_size);
  const double one = 1;
  changed(flat_bytes, flat_size, 48, &one, 8, "has another hash");
  changed(flat_bytes, flat_size, 24, &two, 4, "header has what it can't have");
  pbf_release_shape(flat);
  free(flat_bytes);

  pbf_shape *none_made = NULL;
  assert_fails(pbf_load_shape(NULL, size, &none_made), PBF_ERROR_INVALID_ARGUMENT,
               "buffer is null");
  assert_fails(pbf_load_shape(bytes, size, NULL), PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  room = size - 1;
  assert_fails(pbf_save_shape(shape, bytes, &room), PBF_ERROR_INVALID_ARGUMENT, "the shape needs");
  assert_fails(pbf_save_shape(shape, bytes, NULL), PBF_ERROR_INVALID_ARGUMENT, "size is null");
  assert_fails(pbf_save_shape(NULL, bytes, &size), PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  pbf_release_shape(shape);
  free(bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shapes_come_back),
      cmocka_unit_test(values_are_distances),
      cmocka_unit_test(states_find_loaded_shapes),
      cmocka_unit_test(other_bytes_are_refused),
  };
  return TEST_RUN(tests);
}
