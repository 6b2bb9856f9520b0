/* Streams of emitters that are moved and turned, and such that waver: what has left an opening goes
 * straight on. */
#include "emitter_scene.h"

typedef enum swing { MOVED, TURNED, WAVERING, SWINGS } swing;

/* Turned by 1.5 radians a time unit, moved across its stream, or with a jitter, and set anew for
 * each step. */
static pbf_emitter swung(double time, swing how) {
  pbf_emitter e = emitter_of(PBF_EMITTER_RECTANGLE);
  const double speed = 3, angle = how == TURNED ? 1.5 * time : 0;
  memcpy(e.position, (double[]){0.3, how == MOVED ? 1 + time : 1.5, 0.5}, sizeof e.position);
  memcpy(e.velocity, (double[]){speed * cos(angle), speed * sin(angle), 0}, sizeof e.velocity);
  memcpy(e.across, (double[]){-sin(angle), cos(angle), 0}, sizeof e.across);
  e.half_width = 3 * d;
  e.jitter = how == WAVERING ? 0.2 : 0;
  return e;
}

static void get_speeds(pbf_solver *s, uint32_t dimension, uint32_t precision, double *fastest,
                       double *energy) {
  static double raw[3 * CAPACITY];
  *fastest = *energy = 0;
  assert_ok(pbf_get_velocities(s, 0, count_of(s), raw));
  for (uint32_t i = 0; i < count_of(s); ++i) {
    double square = 0;
    for (uint32_t k = 0; k < dimension; ++k)
      square += pow(test_value(raw, (uint64_t)i * dimension + k, precision), 2);
    *fastest = fmax(*fastest, sqrt(square) / 3);
    *energy += square / 9 / count_of(s);
  }
}

static void set_wide(pbf_solver *s, double time_step) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(s, &params));
  params.domain_max[0] = 3;
  params.time_step = time_step;
  assert_ok(pbf_set_params(s, &params));
}

/* Without weight all fly on as they have left: where its opening turns a stream is squeezed on one
 * side by a sixteenth, and one that wavers all over by some percent, for which it is in no hurry
 * to part. */
static void check_swing(uint32_t dimension, uint32_t precision, double time_step, swing how) {
  static const char *const names[] = {"moved", "turned", "wavering"};
  pbf_solver *s = tank(dimension, precision, 0);
  double fastest, energy;
  set_wide(s, time_step);
  for (int step = 0; step * time_step < 0.3; ++step) {
    const pbf_emitter e = swung(step * time_step, how);
    assert_ok(pbf_set_emitters(s, 1, &e));
    assert_ok(pbf_step(s, 1));
  }
  get_speeds(s, dimension, precision, &fastest, &energy);
  if (!(fastest < 1.05) || !(energy < 1.01))
    fail_msg("%uD, steps of %g, %s: %g times as fast, %g of the energy", dimension, time_step,
             names[how], fastest, energy);
  pbf_destroy(s);
}

static void check_swings(uint32_t dimension, uint32_t precision) {
  for (swing how = MOVED; how < SWINGS; ++how) {
    check_swing(dimension, precision, 1.0 / 60, how);
    check_swing(dimension, precision, 1.0 / 240, how);
  }
}

/* Two streams through one opening are twice as dense, and part as all that overlaps. */
static void check_twofold(uint32_t dimension, uint32_t precision) {
  const double time_step = 1.0 / 240;
  const pbf_emitter two[2] = {swung(0, TURNED), swung(0, TURNED)};
  pbf_solver *s = tank(dimension, precision, 0);
  double fastest, energy;
  set_wide(s, time_step);
  assert_ok(pbf_set_emitters(s, 2, two));
  assert_ok(pbf_step(s, 60));
  get_speeds(s, dimension, precision, &fastest, &energy);
  if (!(fastest < 1.1) || !(energy < 1.02))
    fail_msg("%uD, twofold: %g times as fast, %g of the energy", dimension, fastest, energy);
  pbf_destroy(s);
}

static void twofold_streams_do_not_burst(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_twofold);
}

static void swung_hoses_pour_straight_on(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_swings);
}

/* All of a world, its opening included, is set half a unit to the right before each step and back
 * after it. */
static void shift(pbf_solver *s, uint32_t dimension, uint32_t precision, double way) {
  static double raw[3 * CAPACITY];
  pbf_params params = {.struct_size = sizeof params};
  pbf_emitter e = {.struct_size = sizeof e};
  assert_ok(pbf_get_params(s, &params));
  assert_ok(pbf_get_emitter(s, 0, &e));
  assert_ok(pbf_get_positions(s, 0, count_of(s), raw));
  for (uint32_t i = 0; i < count_of(s); ++i) {
    const uint64_t at = (uint64_t)i * dimension;
    test_put(raw, at, precision, test_value(raw, at, precision) + way);
  }
  params.domain_min[0] += way;
  params.domain_max[0] += way;
  e.position[0] += way;
  const pbf_params wide = params;
  params.domain_min[0] -= fabs(way);
  params.domain_max[0] += fabs(way);
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_set_positions(s, 0, count_of(s), raw));
  assert_ok(pbf_set_params(s, &wide));
  assert_ok(pbf_set_emitters(s, 1, &e));
}

static void check_shifts(uint32_t dimension, uint32_t precision) {
  static double still[3 * CAPACITY], floating[3 * CAPACITY];
  pbf_solver *a = tank(dimension, precision, 10), *b = tank(dimension, precision, 10);
  const pbf_emitter e = swung(0, TURNED);
  assert_ok(pbf_set_emitters(a, 1, &e));
  assert_ok(pbf_set_emitters(b, 1, &e));
  for (int step = 0; step < 20; ++step) {
    assert_ok(pbf_step(a, 1));
    if (step > 0) shift(b, dimension, precision, step % 2 ? 0.5 : -0.5);
    assert_ok(pbf_step(b, 1));
  }
  shift(b, dimension, precision, -0.5);
  assert_int_equal(count_of(a), count_of(b));
  assert_ok(pbf_get_positions(a, 0, count_of(a), still));
  assert_ok(pbf_get_positions(b, 0, count_of(b), floating));
  for (uint32_t i = 0; i < count_of(a) * dimension; ++i) {
    const double off = test_value(still, i, precision) - test_value(floating, i, precision);
    if (!(fabs(off) < 1e-4 * d)) fail_msg("%uD: number %u is off by %g", dimension, i, off);
  }
  pbf_destroy(a);
  pbf_destroy(b);
}

static void streams_float_with_the_origin(void **state) {
  (void)state;
  test_for_each_kind(check_shifts);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(swung_hoses_pour_straight_on),
      cmocka_unit_test(twofold_streams_do_not_burst),
      cmocka_unit_test(streams_float_with_the_origin),
  };
  return TEST_RUN(tests);
}
