/* Any consistent set of units will do: with lengths and times that are powers of two as large,
 * which rounds nothing otherwise, a fluid ends with the same bits. Whatever compares a number that
 * has a unit with one that has none shows here. */
#include "support.h"

#include <math.h>

enum { STEPS = 20, MOST = 600 };

typedef struct scale {
  double length, time;
} scale;

typedef void (*kind)(pbf_params *params, scale in);

static void defaults(pbf_params *params, scale in) {
  (void)params;
  (void)in;
}

static void every_stage(pbf_params *params, scale in) {
  params->scorr_k = 1e-4 * in.length * in.length;
  params->vorticity = 0.01 * in.length / in.time;
  params->viscosity = 0.05 * in.length * in.length / in.time;
  params->tolerance = 1e-3;
  params->iterations = 8;
  params->pressure_grid = 2;
  params->sleep_speed = 0.07 * in.length / in.time;
  params->sleep_time = 0.5 * in.time;
  params->wall_amplitude[0] = 0.1 * in.length;
  params->wall_frequency[0] = 3 / in.time;
}

/* Particles pile up on walls, and all but coincide. */
static void paper(pbf_params *params, scale in) {
  (void)in;
  params->solver = PBF_SOLVER_JACOBI;
  params->kernel = PBF_KERNEL_POLY6_SPIKY;
  params->wall_density = 0;
  params->cfm = 0.1;
}

static void short_steps(pbf_params *params, scale in) { params->time_step = 1e-4 * in.time; }

static void attracted(pbf_params *params, scale in) {
  params->attraction = 30 / (in.time * in.time);
  for (int k = 0; k < 3; ++k) params->attraction_center[k] = 0.5 * in.length;
}

static pbf_params params_in(kind set, scale in) {
  pbf_params params = test_params();
  params.spacing = 0.05 * in.length;
  params.smoothing_radius = 0.1 * in.length;
  params.time_step = in.time / 120;
  params.gravity[1] = -9.81 * in.length / (in.time * in.time);
  for (int k = 0; k < 3; ++k) params.domain_max[k] = (k == 1 ? 2 : 1) * in.length;
  set(&params, in);
  return params;
}

/* A block with every coordinate off by up to a tenth of a spacing, thrown at a ball that comes. */
static pbf_solver *fluid_in(uint32_t dimension, uint32_t precision, kind set, scale in,
                            uint32_t *count) {
  const uint32_t sides[3] = {7, dimension == 3 ? 11 : 30, dimension == 3 ? 7 : 1};
  const double speed = in.length / in.time;
  const pbf_collider ball = {.struct_size = sizeof ball,
                             .shape = PBF_COLLIDER_SPHERE,
                             .position = {0.8 * in.length, 0.2 * in.length, 0.3 * in.length},
                             .orientation = {0, 0, 0, 1},
                             .velocity = {-0.3 * speed},
                             .radius = 0.15 * in.length};
  uint32_t seed = 1;
  *count = sides[0] * sides[1] * sides[2];
  _Alignas(8) static unsigned char x[MOST * 3 * 8], v[MOST * 3 * 8];
  assert_true(*count <= MOST);
  for (uint32_t i = 0; i < *count; ++i) {
    const uint32_t at[3] = {i % sides[0], i / sides[0] % sides[1], i / sides[0] / sides[1]};
    for (uint32_t k = 0; k < dimension; ++k) {
      seed = seed * 1664525u + 1013904223u;
      double off = seed / 2147483648.0 - 1;
      float place = (float)(0.05 * (at[k] + 1 + 0.1 * off));
      test_put(x, (uint64_t)i * dimension + k, precision, in.length * (double)place);
      test_put(v, (uint64_t)i * dimension + k, precision, speed * (double)(k == 0 ? 1.0f : place));
    }
  }
  pbf_desc desc = test_desc(dimension, precision, *count);
  pbf_params params = params_in(set, in);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, *count, x, v, NULL));
  assert_ok(pbf_set_colliders(s, 1, &ball));
  return s;
}

static double *state_after(uint32_t dimension, uint32_t precision, kind set, scale in,
                           uint32_t *values) {
  uint32_t count;
  pbf_solver *s = fluid_in(dimension, precision, set, in, &count);
  _Alignas(8) static unsigned char x[MOST * 3 * 8], v[MOST * 3 * 8];
  double *state = calloc((size_t)count * dimension * 2, sizeof *state);
  assert_non_null(state);
  assert_ok(pbf_step(s, STEPS));
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_get_velocities(s, 0, count, v));
  *values = count * dimension;
  for (uint32_t i = 0; i < *values; ++i) {
    state[i] = test_value(x, i, precision) / in.length;
    state[*values + i] = test_value(v, i, precision) * in.time / in.length;
  }
  *values *= 2;
  pbf_destroy(s);
  return state;
}

/* h from 1.2e-8 to 5e10; a step from 8e-15 to 9e12, on a GPU in float32 to 9e9: its kernels flush
 * subnormal numbers, as the squares of differences of such velocities are, to 0. */
static void in_other_units(uint32_t dimension, uint32_t precision) {
  const int flushes = precision == PBF_FLOAT32 && strcmp(test_backend(), "cuda") == 0;
  static const kind kinds[] = {defaults, every_stage, paper, short_steps, attracted};
  const scale scales[] = {
      {0x1p-23, 1},      {0x1p-10, 1}, {0x1p39, 1}, {1, 0x1p-40}, {1, flushes ? 0x1p40 : 0x1p50},
      {0x1p-20, 0x1p-10}};
  uint32_t wrong = 0;
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
    uint32_t values, others;
    double *one = state_after(dimension, precision, kinds[k], (scale){1, 1}, &values);
    for (uint32_t i = 0; i < values; ++i) assert_true(isfinite(one[i]));
    for (size_t u = 0; u < sizeof scales / sizeof *scales; ++u) {
      double *other = state_after(dimension, precision, kinds[k], scales[u], &others);
      uint32_t differ = 0;
      assert_int_equal(others, values);
      for (uint32_t i = 0; i < values; ++i) differ += other[i] != one[i];
      wrong += differ != 0;
      if (differ)
        print_error("%uD, float%u, kind %zu, lengths by %g, times by %g: %u of %u differ\n",
                    dimension, 8 * precision, k, scales[u].length, scales[u].time, differ, values);
      free(other);
    }
    free(one);
  }
  assert_int_equal(wrong, 0);
}

/* h from 5.7e-74 to 4.5e73, where squares of kernels' slopes are no numbers. */
static void at_the_ends_of_float64(uint32_t dimension, uint32_t precision) {
  const scale scales[] = {{1, 1}, {0x1p248, 1}, {0x1p-240, 1}};
  double *states[3];
  uint32_t values;
  if (precision == PBF_FLOAT32) return;
  for (int u = 0; u < 3; ++u)
    states[u] = state_after(dimension, precision, paper, scales[u], &values);
  for (uint32_t i = 0; i < values; ++i)
    assert_true(isfinite(states[0][i]) && states[1][i] == states[0][i] &&
                states[2][i] == states[0][i]);
  for (int u = 0; u < 3; ++u) free(states[u]);
}

static void the_same_bits(void **state) {
  (void)state;
  test_for_each_kind(in_other_units);
  test_for_each_kind(at_the_ends_of_float64);
}

static void refuse(uint32_t precision, double h, const char *sentence) {
  pbf_desc desc = test_desc(3, precision, 10);
  pbf_params params = params_in(defaults, (scale){h / 0.1, 1});
  pbf_solver *s = NULL;
  assert_fails(pbf_create(&desc, &params, &s), PBF_ERROR_INVALID_ARGUMENT, sentence);
  assert_null(s);
}

static void beyond_what_numbers_hold(void **state) {
  (void)state;
  refuse(PBF_FLOAT32, 0.9e-8, "float32 can compute with 1e-08 … 1e+11");
  refuse(PBF_FLOAT32, 1.1e11, "choose another unit of length, or PBF_FLOAT64");
  refuse(PBF_FLOAT64, 0.9e-75, "float64 can compute with 1e-75 … 1e+75");
  refuse(PBF_FLOAT64, 1.1e75, "choose another unit of length");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_same_bits),
      cmocka_unit_test(beyond_what_numbers_hold),
  };
  return TEST_RUN(tests);
}
