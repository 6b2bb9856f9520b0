/* Emitters that are set anew in another order, or with one more in front, or of which one has been
 * erased: the others' streams go on. */
#include "emitter_scene.h"

#include <math.h>
#include <string.h>

enum { TAPS = 3, STEPS = 60 };

static pbf_emitter tap(double x, double speed, double radius) {
  pbf_emitter e = emitter_of(PBF_EMITTER_DISC);
  e.position[0] = x;
  e.velocity[1] = -speed;
  e.radius = radius * d;
  return e;
}

static void put_taps(pbf_emitter *to) {
  to[0] = tap(0.4, 2, 3);
  to[1] = tap(1.2, 1, 4);
  to[2] = tap(2, 1.5, 2);
}

enum how { TURNED_ROUND, ONE_IN_FRONT, ONE_ERASED, MOVED, HOWS };

/* What is set before a step. All that move go by as much, which is less than h. */
static uint32_t put_list(enum how how, int step, pbf_emitter *list) {
  pbf_emitter taps[TAPS];
  uint32_t count = 0;
  const uint32_t first = how == TURNED_ROUND || how == MOVED ? (uint32_t)step % TAPS : 0;
  put_taps(taps);
  if (how == ONE_IN_FRONT && step % 2) list[count++] = tap(2.7, 0.5, 2);
  for (uint32_t i = how == ONE_ERASED && step > STEPS / 2; i < TAPS; ++i) {
    list[count] = taps[(first + i) % TAPS];
    if (how == MOVED) list[count].position[0] += 0.1 * d * step;
    ++count;
  }
  return count;
}

static double rate_of(const pbf_emitter *e, uint32_t dimension) {
  const double across = dimension == 2 ? 2 * e->radius : 3.14159265358979 * e->radius * e->radius;
  return across * fabs(e->velocity[1]);
}

/* Volume of the three taps until a step has ended. */
static double volume_of(enum how how, double time_step, uint32_t dimension) {
  pbf_emitter taps[TAPS];
  double volume = 0;
  put_taps(taps);
  for (int i = 0; i < TAPS; ++i) {
    const int steps = how == ONE_ERASED && i == 0 ? STEPS / 2 + 1 : STEPS;
    volume += rate_of(&taps[i], dimension) * steps * time_step;
  }
  return volume;
}

static uint32_t count_of_taps(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  static double x[3 * CAPACITY];
  const uint32_t count = count_of(s);
  uint32_t found = 0;
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t i = 0; i < count; ++i)
    found += test_value(x, (uint64_t)i * dimension, precision) < 2.5;
  return found;
}

/* Nothing acts on the streams: none is faster than its tap says, and denser than at rest. As much
 * comes as the rates say, but for columns of which a part has left; in 3D what a disc holds is a
 * pattern of columns, of up to a fifth more than its area. */
static void check_order(uint32_t dimension, uint32_t precision) {
  for (int how = 0; how < HOWS; ++how) {
    pbf_solver *s = tank(dimension, precision, 0);
    pbf_params params = {.struct_size = sizeof params};
    pbf_stats stats = {.struct_size = sizeof stats};
    assert_ok(pbf_get_params(s, &params));
    params.domain_max[0] = 3;
    params.spacing = d;
    params.smoothing_radius = 2 * d;
    assert_ok(pbf_set_params(s, &params));
    for (int step = 0; step < STEPS; ++step) {
      pbf_emitter list[TAPS + 1];
      const uint32_t count = put_list((enum how)how, step, list);
      assert_ok(pbf_set_emitters(s, count, list));
      assert_ok(pbf_step(s, 1));
    }
    assert_ok(pbf_get_stats(s, &stats));
    const double volume = count_of_taps(s, dimension, precision) * pow(d, dimension);
    const double part = volume / volume_of((enum how)how, params.time_step, dimension);
    const double most = dimension == 3 ? 1.2 : 1.05;
    if (!(stats.speed_max < 2.02) || !(stats.density_error_mean < 0.01) || !(part > 0.95) ||
        !(part < most))
      fail_msg("%uD, list %d: %g m/s, denser by %g, %g of the volume", dimension, how,
               stats.speed_max, stats.density_error_mean, part);
    pbf_destroy(s);
  }
}

static void streams_go_on_whatever_the_order(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_order);
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(streams_go_on_whatever_the_order),
  };
  return TEST_RUN(tests);
}
