/* Boxes without a free surface, exactly full or with more fluid than room: nothing says how great
 * the pressure is but for a constant, and no place of the particles has rest density. */
#include "support.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* So many layers along each axis of a box of side 1; spacings and h are for `fill` = 1. */
static uint32_t layers_in(uint32_t dimension) { return dimension == 3 ? 8 : 24; }

static uint32_t count_in(uint32_t dimension) {
  uint32_t n = layers_in(dimension);
  return dimension == 3 ? n * n * n : n * n;
}

static double spacing_in(uint32_t dimension) { return 1.0 / layers_in(dimension); }

/* The box has a `fill`-th of the room that the fluid takes at rest. A step is `part` of the spacing
 * long: at a speed of 1 and at a gravity of 1. */
static pbf_params box_params(uint32_t dimension, double spacings, double fill, double part) {
  pbf_params params = test_params();
  params.spacing = spacing_in(dimension) * pow(fill, 1.0 / dimension);
  params.smoothing_radius = spacings * params.spacing;
  params.time_step = part * spacing_in(dimension);
  params.prestabilization = 0;
  for (int k = 0; k < 3; ++k) params.gravity[k] = params.domain_min[k] = 0;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 1;
  return params;
}

/* A lattice, every coordinate off by up to a twentieth of a spacing; `speed` is that of an eddy
 * that fills the box, (sin cos, -cos sin) of Taylor and Green, which is at rest in the walls'
 * direction. */
static pbf_solver *box(uint32_t dimension, uint32_t precision, const pbf_params *params,
                       double speed) {
  uint32_t n = layers_in(dimension), count = count_in(dimension), seed = 1;
  pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, params);
  void *x = calloc((size_t)count * dimension, precision);
  void *v = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  assert_non_null(v);
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % n, i / n % n, i / n / n};
    double place[3];
    for (uint32_t k = 0; k < dimension; ++k) {
      seed = seed * 1664525u + 1013904223u;
      place[k] = (at[k] + 0.5 + 0.05 * (seed / 2147483648.0 - 1)) / n;
      test_put(x, (uint64_t)i * dimension + k, precision, place[k]);
    }
    double a = pi * place[0], b = pi * place[1];
    test_put(v, (uint64_t)i * dimension, precision, speed * sin(a) * cos(b));
    test_put(v, (uint64_t)i * dimension + 1, precision, -speed * cos(a) * sin(b));
  }
  assert_ok(pbf_add_particles(s, count, x, v, NULL));
  free(x);
  free(v);
  return s;
}

static double kinetic_energy(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats.kinetic_energy;
}

static void turn(uint32_t dimension, uint32_t precision, double spacings, double fill,
                 uint32_t iterations, double part) {
  pbf_params params = box_params(dimension, spacings, fill, part);
  params.iterations = iterations;
  pbf_solver *s = box(dimension, precision, &params, 1);
  uint32_t steps = (uint32_t)lround(0.4 / params.time_step / 4);
  double start = kinetic_energy(s), end = start;
  for (int k = 0; k < 4; ++k) {
    assert_ok(pbf_step(s, steps));
    end = kinetic_energy(s);
    if (!(end < 1.15 * start))
      fail_msg("%uD, h %g, filled %g times, %u iterations: %g of the energy", dimension, spacings,
               fill, iterations, end / start);
  }
  if (!(end > 0.3 * start))
    fail_msg("%uD, h %g, filled %g times, %u iterations: keeps %g of the energy", dimension,
             spacings, fill, iterations, end / start);
  pbf_destroy(s);
}

/* An eddy turns on, without more energy and without losing all of it. */
static void check_eddies(uint32_t dimension, uint32_t precision) {
  turn(dimension, precision, 2.5, 1.05, 4, 0.2);
  turn(dimension, precision, 3, 1, 4, 0.05);
  turn(dimension, precision, 3, 1.2, 16, 0.1);
}

static void eddies_turn_in_full_boxes(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_eddies);
}

static double mean_pressure(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  uint32_t count = count_in(dimension);
  double sum = 0;
  void *p = calloc(count, precision);
  assert_non_null(p);
  assert_ok(pbf_get_pressures(s, 0, count, p));
  for (uint32_t i = 0; i < count; ++i) sum += test_value(p, i, precision);
  free(p);
  return sum / count;
}

/* The box as the inside of a collider in a wider domain. */
static void in_a_bottle(pbf_solver *s, pbf_params *params) {
  pbf_collider bottle;
  assert_ok(pbf_collider_init(&bottle, sizeof bottle, PBF_COLLIDER_BOX));
  bottle.inverted = 1;
  for (int k = 0; k < 3; ++k) {
    bottle.position[k] = bottle.half_extents[k] = 0.5;
    params->domain_min[k] = -1;
    params->domain_max[k] = 2;
  }
  assert_ok(pbf_set_params(s, params));
  assert_ok(pbf_set_colliders(s, 1, &bottle));
}

typedef struct box_at_rest {
  double fill, gravity;
  uint32_t iterations;
  double part;
  int is_bottle;
} box_at_rest;

static void stand(uint32_t dimension, uint32_t precision, const box_at_rest *is) {
  pbf_params params = box_params(dimension, 2, is->fill, is->part);
  params.iterations = is->iterations;
  params.gravity[1] = -is->gravity;
  pbf_solver *s = box(dimension, precision, &params, 0);
  if (is->is_bottle) in_a_bottle(s, &params);
  assert_ok(pbf_step(s, (uint32_t)lround(1 / params.time_step)));
  double weight = 0.5 * is->gravity, energy = kinetic_energy(s);
  double pressure = mean_pressure(s, dimension, precision);
  const char *what = is->is_bottle ? "bottle" : "box";
  if (!(pressure > 0.5 * weight && pressure < 4 * weight))
    fail_msg("%uD %s, filled %g times: a pressure of %g, the weight makes %g", dimension, what,
             is->fill, pressure, weight);
  if (!(energy < 0.01 * is->gravity))
    fail_msg("%uD %s, filled %g times: moves at %g", dimension, what, is->fill, sqrt(2 * energy));
  pbf_destroy(s);
}

/* Water at rest that is pressed into too little room has the pressure of its weight all the same:
 * by iterations, with a pressure grid, which the third case has in 2D, in short steps, and in a
 * collider. */
static void check_weight(uint32_t dimension, uint32_t precision) {
  const box_at_rest cases[] = {
      {1.05, 1, 8, 0.2, 0}, {1.2, 1, 8, 0.2, 0}, {1.2, 10, 4, 0.2, 0},
      {1.2, 1, 4, 0.05, 0}, {1.2, 1, 8, 0.2, 1},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) stand(dimension, precision, &cases[k]);
}

static void pressure_is_that_of_weight(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_weight);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(eddies_turn_in_full_boxes),
      cmocka_unit_test(pressure_is_that_of_weight),
  };
  return TEST_RUN(tests);
}
