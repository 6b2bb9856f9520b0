/* Several emitters of one opening, which share its rate, as of fluids that it mixes: together they
 * are the stream that one of them would be. */
#include "emitter_scene.h"

/* A part of what the opening carries. */
static pbf_emitter part_of(uint32_t dimension, uint32_t shape, double part) {
  pbf_emitter e = emitter_of(shape);
  const double columns =
      dimension == 2 ? (shape == PBF_EMITTER_DISC ? 6 : 4) : (shape == PBF_EMITTER_DISC ? 32 : 20);
  const double speed = 1;
  memcpy(e.velocity, (double[]){0, -speed, 0}, sizeof e.velocity);
  e.rate = columns * (dimension == 3 ? d * d : d) * speed * part;
  return e;
}

/* In spacings, of those nearest to each other. */
static double nearest(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  static double x[3 * CAPACITY];
  const uint32_t count = count_of(s);
  double least = INFINITY;
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t j = 0; j < i; ++j) {
      double square = 0;
      for (uint32_t k = 0; k < dimension; ++k)
        square += pow(test_value(x, (uint64_t)i * dimension + k, precision) -
                          test_value(x, (uint64_t)j * dimension + k, precision),
                      2);
      least = fmin(least, square);
    }
  return sqrt(least) / d;
}

static void expect_lattice(pbf_solver *s, uint32_t dimension, uint32_t precision,
                           const char *what) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  const double least = nearest(s, dimension, precision);
  if (!(stats.density_error_mean < 0.002) || !(least > 0.98))
    fail_msg("%uD, %s: an error of %g, %g spacings apart", dimension, what,
             stats.density_error_mean, least);
}

static const double mixtures[][4] = {
    {1, 0, 0, 0},     {0.5, 0.5, 0, 0},     {0.3, 0.7, 0, 0},        {0.2, 0.5, 0.3, 0},
    {0.9, 0.1, 0, 0}, {0.2, 0.2, 0.2, 0.1}, {0.25, 0.25, 0.25, 0.25}};

/* As many of each have come as its rate says, to one. */
static void check_mixture(uint32_t dimension, uint32_t precision, uint32_t shape,
                          const double parts[4]) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_in_out in_out = {.struct_size = sizeof in_out};
  pbf_emitter e[4];
  uint32_t count = 0;
  double due = 0;
  for (; count < 4 && parts[count] > 0; ++count) {
    e[count] = part_of(dimension, shape, parts[count]);
    due += e[count].rate * 120 / 128 / (dimension == 3 ? d * d * d : d * d);
  }
  assert_ok(pbf_set_emitters(s, count, e));
  assert_ok(pbf_step(s, 120));
  assert_ok(pbf_get_in_out(s, &in_out));
  assert_true(fabs((double)in_out.emitted - due) <= count);
  expect_lattice(s, dimension, precision, "a mixture");
  pbf_destroy(s);
}

/* One of two comes later, and then has its share changed. */
static void check_late(uint32_t dimension, uint32_t precision, uint32_t shape) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_emitter e[2] = {part_of(dimension, shape, 0.5), part_of(dimension, shape, 0.5)};
  assert_ok(pbf_set_emitters(s, 1, e));
  assert_ok(pbf_step(s, 29));
  assert_ok(pbf_set_emitters(s, 2, e));
  assert_ok(pbf_step(s, 37));
  e[0] = part_of(dimension, shape, 0.15);
  e[1] = part_of(dimension, shape, 0.85);
  assert_ok(pbf_set_emitters(s, 2, e));
  assert_ok(pbf_step(s, 50));
  expect_lattice(s, dimension, precision, "one that comes later");
  pbf_destroy(s);
}

static void check_mixtures(uint32_t dimension, uint32_t precision) {
  for (int disc = 0; disc < 2; ++disc) {
    const uint32_t shape = disc ? PBF_EMITTER_DISC : PBF_EMITTER_RECTANGLE;
    for (size_t i = 0; i < sizeof mixtures / sizeof *mixtures; ++i)
      check_mixture(dimension, precision, shape, mixtures[i]);
    check_late(dimension, precision, shape);
  }
}

static void parts_of_a_stream_take_turns(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_mixtures);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(parts_of_a_stream_take_turns)};
  return TEST_RUN(tests);
}
