/* Particles come, go and keep their ids and order. */
#include <stdio.h>

#include "support.h"

static uint32_t count_of(pbf_solver *s) {
  uint32_t count = UINT32_MAX;
  assert_ok(pbf_get_count(s, &count));
  return count;
}

static void check_ids(pbf_solver *s, const uint32_t *expected, uint32_t count) {
  uint32_t ids[32];
  assert_int_equal(count_of(s), count);
  assert_ok(pbf_get_ids(s, 0, count, ids));
  assert_memory_equal(ids, expected, count * sizeof *ids);
}

static void what_goes_in_comes_out(uint32_t dimension, uint32_t precision) {
  enum { COUNT = 20 };
  pbf_solver *s = test_filled(dimension, precision, COUNT, 32);
  void *lattice = test_lattice(dimension, precision, COUNT);
  unsigned char back[COUNT * 3 * 8];
  size_t row = (size_t)dimension * precision;
  assert_ok(pbf_get_positions(s, 0, COUNT, back));
  assert_memory_equal(back, lattice, COUNT * row);
  assert_ok(pbf_get_positions(s, 7, 5, back));
  assert_memory_equal(back, (char *)lattice + 7 * row, 5 * row);
  assert_ok(pbf_get_velocities(s, 9, 2, back));
  assert_true(test_value(back, 0, precision) == 10 / 8.0);
  assert_true(test_value(back, dimension, precision) == 11 / 8.0);
  assert_true(test_value(back, 1, precision) == 0);
  /* Overwrite rows 3 and 4 with what rows 0 and 1 were; the neighbours stay. */
  assert_ok(pbf_set_positions(s, 3, 2, lattice));
  assert_ok(pbf_get_positions(s, 2, 4, back));
  assert_memory_equal(back, (char *)lattice + 2 * row, row);
  assert_memory_equal(back + row, lattice, 2 * row);
  assert_memory_equal(back + 3 * row, (char *)lattice + 5 * row, row);
  assert_ok(pbf_set_velocities(s, 19, 1, lattice));
  assert_ok(pbf_get_velocities(s, 18, 2, back));
  assert_true(test_value(back, 0, precision) == 19 / 8.0);
  assert_memory_equal(back + row, lattice, row);
  free(lattice);
  pbf_destroy(s);
}

static void round_trips(void **state) {
  (void)state;
  test_for_each_kind(what_goes_in_comes_out);
}

static void ids_after_removals(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 6, 8);
  void *lattice = test_lattice(3, PBF_FLOAT32, 8);
  uint32_t first = 99;
  check_ids(s, (const uint32_t[]){0, 1, 2, 3, 4, 5}, 6);
  assert_ok(pbf_remove_particles(s, 3, (const uint32_t[]){4, 0, 2}));
  check_ids(s, (const uint32_t[]){1, 3, 5}, 3);
  float x[3 * 8], v[3 * 8];
  assert_ok(pbf_get_velocities(s, 0, 3, v));
  assert_true(v[0] == 2 / 8.0f && v[3] == 4 / 8.0f && v[6] == 6 / 8.0f);
  assert_ok(pbf_get_positions(s, 1, 1, x));
  assert_memory_equal(x, (float *)lattice + 9, 12);
  assert_ok(pbf_add_particles(s, 2, lattice, NULL, &first));
  assert_int_equal(first, 6);
  check_ids(s, (const uint32_t[]){1, 3, 5, 6, 7}, 5);
  /* Removing the last ones does not give their ids back. */
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){7}));
  assert_ok(pbf_add_particles(s, 4, lattice, NULL, &first));
  assert_int_equal(first, 8);
  check_ids(s, (const uint32_t[]){1, 3, 5, 6, 8, 9, 10, 11}, 8);
  assert_ok(pbf_get_positions(s, 4, 4, x));
  assert_memory_equal(x, lattice, 48);
  assert_ok(pbf_remove_particles(s, 8, (const uint32_t[]){11, 10, 9, 8, 6, 5, 3, 1}));
  check_ids(s, NULL, 0);
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_add_particles(s, 1, lattice, NULL, &first));
  check_ids(s, (const uint32_t[]){12}, 1);
  free(lattice);
  pbf_destroy(s);
}

static void refused_removals(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT64, 4, 8);
  uint64_t before = test_hash(s);
  assert_fails(pbf_remove_particles(s, 2, (const uint32_t[]){1, 4}), PBF_ERROR_NOT_FOUND,
               "ids[1] is 4; no particle");
  assert_fails(pbf_remove_particles(s, 3, (const uint32_t[]){1, 2, 1}), PBF_ERROR_INVALID_ARGUMENT,
               "ids[2] is 1, which stands twice");
  assert_fails(pbf_remove_particles(s, 5, (const uint32_t[]){0, 1, 2, 3, 4}), PBF_ERROR_NOT_FOUND,
               "holds 4");
  assert_ok(pbf_remove_particles(s, 0, NULL));
  assert_int_equal(test_hash(s), before);
  assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){2}));
  assert_fails(pbf_remove_particles(s, 1, (const uint32_t[]){2}), PBF_ERROR_NOT_FOUND, "is 2");
  pbf_destroy(s);
}

static void above_capacity(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 4, 5);
  float x[6] = {0.5f, 0.5f, 0.5f, 0.6f, 0.5f, 0.5f};
  uint64_t before = test_hash(s);
  uint32_t first = 77;
  assert_fails(pbf_add_particles(s, 2, x, NULL, &first), PBF_ERROR_CAPACITY,
               "count is 2; the solver holds 4 particles and desc.capacity is 5");
  assert_fails(pbf_add_particles(s, UINT32_MAX, x, NULL, &first), PBF_ERROR_CAPACITY, "4294967295");
  assert_int_equal(first, 77);
  assert_int_equal(test_hash(s), before);
  assert_ok(pbf_add_particles(s, 0, NULL, NULL, &first));
  assert_int_equal(first, 4);
  assert_ok(pbf_add_particles(s, 1, x, NULL, &first));
  pbf_destroy(s);
}

/* One bad number at a time, in every place. */
static void bad_numbers(uint32_t dimension, uint32_t precision) {
  const double values[] = {NAN, INFINITY, -INFINITY, -0.001, 1.001};
  pbf_solver *s = test_filled(dimension, precision, 4, 8);
  uint64_t before = test_hash(s);
  for (uint32_t place = 0; place < 3 * dimension; ++place) {
    for (int i = 0; i < 5; ++i) {
      void *lattice = test_lattice(dimension, precision, 3);
      char words[64];
      test_put(lattice, place, precision, values[i]);
      snprintf(words, sizeof words, "positions[%u][%u] is ", place / dimension, place % dimension);
      assert_fails(pbf_add_particles(s, 3, lattice, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT, words);
      snprintf(words, sizeof words, "positions[%u][%u] is ", place / dimension + 1,
               place % dimension);
      assert_fails(pbf_set_positions(s, 1, 3, lattice), PBF_ERROR_INVALID_ARGUMENT, words);
      if (i < 3) {
        void *good = test_lattice(dimension, precision, 3);
        snprintf(words, sizeof words, "velocities[%u][%u] is ", place / dimension,
                 place % dimension);
        assert_fails(pbf_add_particles(s, 3, good, lattice, NULL), PBF_ERROR_INVALID_ARGUMENT,
                     words);
        assert_fails(pbf_set_velocities(s, 0, 3, lattice), PBF_ERROR_INVALID_ARGUMENT, words);
        free(good);
      }
      free(lattice);
    }
  }
  assert_int_equal(test_hash(s), before);
  pbf_destroy(s);
}

static void nan_is_spelled(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT32, 4, 8);
  const float nans[] = {NAN, -NAN};
  for (int i = 0; i < 2; ++i) {
    float x[] = {0.5f, nans[i]};
    assert_fails(pbf_add_particles(s, 1, x, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT,
                 "positions[0][1] is NaN; it must be finite");
  }
  pbf_destroy(s);
}

static void bad_numbers_are_refused(void **state) {
  (void)state;
  test_for_each_kind(bad_numbers);
}

/* Neither 0.1 nor 0.7 is a float32; the nearest ones lie above and below. What a clamp to such a
 * wall leaves must be taken. */
static void the_wall_itself_is_inside(void **state) {
  (void)state;
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_params params = test_params();
  params.domain_max[0] = 0.1;
  params.domain_min[1] = 0.7;
  pbf_solver *s = test_create(&desc, &params);
  float x[6] = {0.1f, 0.7f, 0, 0, 1, 1};
  assert_true((double)x[0] > 0.1 && (double)x[1] < 0.7);
  assert_ok(pbf_add_particles(s, 2, x, NULL, NULL));
  x[0] = nextafterf(x[0], 1);
  assert_fails(pbf_set_positions(s, 0, 1, x), PBF_ERROR_INVALID_ARGUMENT, "positions[0][0]");
  pbf_destroy(s);
}

/* Five particles at one point, and one beside them. */
static void those_at_one_point_are_set_apart(uint32_t dimension, uint32_t precision) {
  enum { COUNT = 6, LONELY = 3 };
  pbf_solver *s = test_solver(dimension, precision, COUNT);
  unsigned char in[COUNT * 3 * 8] = {0}, out[COUNT * 3 * 8];
  for (uint32_t i = 0; i < COUNT; ++i)
    for (uint32_t k = 0; k < dimension; ++k) {
      double value = i == LONELY ? 0.75 : 0.5;
      float single = (float)value;
      memcpy(in + (i * dimension + k) * precision,
             precision == PBF_FLOAT32 ? (void *)&single : (void *)&value, precision);
    }
  assert_ok(pbf_add_particles(s, COUNT, in, NULL, NULL));
  assert_ok(pbf_get_positions(s, 0, COUNT, out));
  double spacing = 0.5 * test_params().smoothing_radius;
  for (uint32_t k = 0; k < dimension; ++k) {
    double centre = 0;
    assert_true(test_value(out, LONELY * dimension + k, precision) == 0.75);
    for (uint32_t i = 0; i < COUNT; ++i)
      if (i != LONELY) centre += test_value(out, i * dimension + k, precision) / (COUNT - 1);
    assert_true(fabs(centre - 0.5) < 1e-7);
  }
  for (uint32_t i = 0; i < COUNT; ++i)
    for (uint32_t j = 0; j < i; ++j) {
      double distance2 = 0;
      for (uint32_t k = 0; k < dimension; ++k)
        distance2 += pow(test_value(out, i * dimension + k, precision) -
                             test_value(out, j * dimension + k, precision),
                         2);
      assert_true(sqrt(distance2) > 0.2 * spacing);
    }
  pbf_destroy(s);
}

static void coincident_particles(void **state) {
  (void)state;
  test_for_each_kind(those_at_one_point_are_set_apart);
}

static void nothing_at_all(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 4);
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_synchronize(s));
  assert_ok(pbf_get_stats(s, &stats));
  assert_int_equal(stats.count, 0);
  assert_ok(pbf_get_info(s, &info));
  assert_int_equal(info.step, 3);
  assert_ok(pbf_get_positions(s, 0, 0, NULL));
  pbf_destroy(s);
}

/* Where all are set it matters what they were, and is not looked at before it is sure that there is
 * something to look at: at address 1 there is nothing. */
static void arrays_are_checked_first(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT64, 4, 4);
  double x[8];
  pbf_view view = {.struct_size = sizeof view};
  const void *nowhere = (const void *)(uintptr_t)1;
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_positions(s, 0, 4, x));
  assert_fails(pbf_set_positions(s, 0, 4, nowhere), PBF_ERROR_INVALID_ARGUMENT, "aligned to");
  assert_fails(pbf_set_velocities(s, 0, 4, nowhere), PBF_ERROR_INVALID_ARGUMENT, "aligned to");
  assert_ok(pbf_map(s, PBF_FIELD_POSITION, &view));
  assert_fails(pbf_set_positions(s, 0, 4, nowhere), PBF_ERROR_STATE, "mapped");
  assert_ok(pbf_unmap(s, PBF_FIELD_POSITION));
  assert_ok(pbf_set_positions(s, 0, 4, x));
  pbf_destroy(s);
}

int main(void) {
  const struct CMUnitTest particles[] = {
      cmocka_unit_test(arrays_are_checked_first), cmocka_unit_test(round_trips),
      cmocka_unit_test(ids_after_removals),       cmocka_unit_test(refused_removals),
      cmocka_unit_test(above_capacity),           cmocka_unit_test(bad_numbers_are_refused),
      cmocka_unit_test(nan_is_spelled),           cmocka_unit_test(the_wall_itself_is_inside),
      cmocka_unit_test(coincident_particles),     cmocka_unit_test(nothing_at_all),
  };
  return TEST_RUN(particles);
}
