/* What a caller sets anew while fluid moves: particles elsewhere, solids of another shape. */
#include "support.h"

#include <math.h>
#include <string.h>

#include <pbf/shapes.h>

static const double d = 0.05, gravity = 9.81;

enum { LAYERS = 10, WIDE = 14, MOST = WIDE * LAYERS * 6, FLOOR = 20 };

/* Water of LAYERS in a tank; `room` above its floor for a solid below it. */
static pbf_solver *pool(uint32_t dimension, uint32_t precision, double time_step, double room) {
  static double points[3 * MOST];
  const uint32_t count = WIDE * LAYERS * (dimension == 3 ? 6 : 1);
  pbf_params params = test_params();
  params.spacing = d;
  params.smoothing_radius = 2 * d;
  params.time_step = time_step;
  params.iterations = 4;
  params.attraction = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const double width = k == 0 ? WIDE * d : dimension == 3 ? 6 * d : 1;
    params.gravity[k] = k == 1 ? -gravity : 0;
    params.domain_min[k] = k == 1 ? -room : 0;
    params.domain_max[k] = k == 1 ? 3 : width;
  }
  const pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, &params);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % WIDE, i / WIDE % LAYERS, i / WIDE / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(points, (uint64_t)i * dimension + k, precision, d * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(s, count, points, NULL, NULL));
  return s;
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

static void rest(pbf_solver *s, double seconds, double time_step) {
  assert_ok(pbf_step(s, (uint32_t)lround(seconds / time_step)));
}

/* ---- Particles ------------------------------------------------------------------------------- */

/* Row k of the highest ones to a place between four of the lowest; all at once, or one by one. */
static void set_among_others(pbf_solver *s, uint32_t dimension, uint32_t precision, int at_once) {
  static double x[3 * MOST];
  const uint32_t count = stats_of(s).count;
  assert_ok(pbf_get_positions(s, 0, count, x));
  for (uint32_t k = 0; k < 6; ++k) {
    const uint32_t row = WIDE * (LAYERS - 1) + 2 * k;
    const double place[3] = {d * (2 * k + 2), 3 * d, 3 * d};
    for (uint32_t axis = 0; axis < dimension; ++axis)
      test_put(x, (uint64_t)row * dimension + axis, precision, place[axis]);
    if (!at_once)
      assert_ok(pbf_set_positions(s, row, 1, (char *)x + (size_t)row * dimension * precision));
  }
  if (at_once) assert_ok(pbf_set_positions(s, 0, count, x));
}

/* Below four particles of the lattice there is room for none: nothing of what overlaps is faster
 * than a fall by the water's depth, however short the steps. */
static void check_set_among_others(uint32_t dimension, uint32_t precision) {
  const double torricelli = sqrt(2 * gravity * LAYERS * d);
  for (int at_once = 0; at_once <= 1; ++at_once) {
    const double dt = 1.0 / 480;
    pbf_solver *s = pool(dimension, precision, dt, 0);
    double fastest = 0;
    rest(s, 0.25, dt);
    set_among_others(s, dimension, precision, at_once);
    for (int k = 0; k < 60; ++k) {
      assert_ok(pbf_step(s, 1));
      fastest = fmax(fastest, stats_of(s).speed_max);
    }
    if (!(fastest <= torricelli))
      fail_msg("%uD, %s: %g m/s, at most %g", dimension, at_once ? "at once" : "one by one",
               fastest, torricelli);
    pbf_destroy(s);
  }
}

static void what_is_set_among_others_is_not_thrown(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_set_among_others);
}

static void what_is_set_is_saved(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    const double dt = 1.0 / 120;
    pbf_solver *one = pool(dimension, PBF_FLOAT32, dt, 0);
    pbf_solver *other = pool(dimension, PBF_FLOAT32, dt, 0);
    uint64_t size;
    assert_ok(pbf_step(one, 20));
    set_among_others(one, dimension, PBF_FLOAT32, 1);
    void *saved = test_save(one, &size);
    assert_ok(pbf_load(other, saved, size));
    free(saved);
    assert_ok(pbf_step(one, 20));
    assert_ok(pbf_step(other, 20));
    assert_int_equal(test_hash(one), test_hash(other));
    pbf_destroy(one);
    pbf_destroy(other);
  }
}

/* What is set where it is, or moved as a step moves it, overlaps nothing: no allowance is kept, of
 * which a saved state would be larger. */
static void what_is_pushed_is_not_placed(void **state) {
  (void)state;
  static float x[3 * MOST];
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    pbf_solver *s = pool(dimension, PBF_FLOAT32, 1.0 / 120, 0);
    uint64_t before, after;
    assert_ok(pbf_step(s, 20));
    free(test_save(s, &before));
    assert_ok(pbf_get_positions(s, 0, 1, x));
    x[1] += (float)(0.1 * d);
    assert_ok(pbf_set_positions(s, 0, 1, x));
    free(test_save(s, &after));
    assert_int_equal(before, after);
    x[1] += (float)(4 * d);
    assert_ok(pbf_set_positions(s, 0, 1, x));
    free(test_save(s, &after));
    assert_true(after > before);
    pbf_destroy(s);
  }
}

/* All but one take each other's places, so that the fluid is what it was: what weight presses it
 * by is no overlap, and no level falls. */
static void check_exchanged(uint32_t dimension, uint32_t precision) {
  static double x[3 * MOST], y[3 * MOST];
  const double dt = 1.0 / 240;
  pbf_solver *s = pool(dimension, precision, dt, 0);
  rest(s, 2, dt);
  const uint32_t most = stats_of(s).count - 1;
  const double level = stats_of(s).center_of_mass[1];
  double lowest = level;
  assert_ok(pbf_get_positions(s, 0, most, x));
  for (uint32_t row = 0; row < most; ++row)
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(y, (uint64_t)row * dimension + k, precision,
               test_value(x, (uint64_t)(most - 1 - row) * dimension + k, precision));
  assert_ok(pbf_set_positions(s, 0, most, y));
  for (int k = 0; k < 120; ++k) {
    assert_ok(pbf_step(s, 1));
    lowest = fmin(lowest, stats_of(s).center_of_mass[1]);
  }
  pbf_destroy(s);
  if (!(lowest >= 0.9985 * level))
    fail_msg("%uD: falls to %g of its level", dimension, lowest / level);
}

static void what_takes_anothers_place_rests(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_exchanged);
}

/* ---- Solids ---------------------------------------------------------------------------------- */

/* A floor that is baked at this height. */
static pbf_shape *floor_at(uint32_t dimension, double height) {
  static double heights[FLOOR * FLOOR];
  pbf_shape *shape;
  for (int i = 0; i < FLOOR * FLOOR; ++i) heights[i] = height;
  const pbf_heights_desc terrain = {.struct_size = sizeof terrain,
                                    .dimension = dimension,
                                    .count = {FLOOR, dimension == 3 ? FLOOR : 0},
                                    .heights = heights,
                                    .spacing = d,
                                    .base = -4 * d,
                                    .cell = 0.5 * d};
  assert_ok(pbf_shape_from_heights(&terrain, &shape));
  return shape;
}

static void set_floor(pbf_solver *s, uint32_t dimension, double height) {
  pbf_collider floor;
  assert_ok(pbf_collider_init(&floor, sizeof floor, PBF_COLLIDER_SHAPE));
  floor.position[0] = -3 * d;
  floor.position[2] = -6 * d;
  floor.geometry = floor_at(dimension, height);
  assert_ok(pbf_set_colliders(s, 1, &floor));
  pbf_release_shape(floor.geometry);
}

/* Water has no way but up: it rises as its floor does. */
static void check_floor(uint32_t dimension, uint32_t precision) {
  const double lengths[] = {1.0 / 60, 1.0 / 240}, speed = 0.2;
  for (int k = 0; k < 2; ++k) {
    const double dt = lengths[k];
    pbf_solver *s = pool(dimension, precision, dt, 5 * d);
    set_floor(s, dimension, 0);
    rest(s, 0.5, dt);
    const double level = stats_of(s).center_of_mass[1];
    for (int step = 1; step * dt < 0.5; ++step) {
      set_floor(s, dimension, speed * dt * step);
      assert_ok(pbf_step(s, 1));
    }
    const double rise = stats_of(s).center_of_mass[1] - level;
    if (!(fabs(rise / (speed * 0.5) - 1) < 0.05))
      fail_msg("%uD, steps of %g: risen by %g, the floor by %g", dimension, dt, rise, speed * 0.5);
    pbf_destroy(s);
  }
}

static void water_rises_with_a_floor_that_is_baked_anew(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_floor);
}

/* Whether a floor that is exchanged for one so much higher counts as one that is put there. */
static int counts_as_put(uint32_t dimension, double rise) {
  uint64_t hash[2];
  for (int put = 0; put < 2; ++put) {
    pbf_solver *s = pool(dimension, PBF_FLOAT32, 1.0 / 120, 5 * d);
    set_floor(s, dimension, 0);
    assert_ok(pbf_step(s, 20));
    if (put) assert_ok(pbf_set_colliders(s, 0, NULL));
    set_floor(s, dimension, rise);
    assert_ok(pbf_step(s, 5));
    hash[put] = test_hash(s);
    pbf_destroy(s);
  }
  return hash[0] == hash[1];
}

/* What it may push out in a step is sqrt(g h) of that, 0.16 spacings. */
static void floors_that_jump_are_as_put_there(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    assert_true(counts_as_put(dimension, 0.2 * d));
    assert_true(counts_as_put(dimension, 2 * d));
    assert_false(counts_as_put(dimension, 0.12 * d));
  }
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_set_among_others_is_not_thrown),
      cmocka_unit_test(what_is_set_is_saved),
      cmocka_unit_test(what_is_pushed_is_not_placed),
      cmocka_unit_test(what_takes_anothers_place_rests),
      cmocka_unit_test(water_rises_with_a_floor_that_is_baked_anew),
      cmocka_unit_test(floors_that_jump_are_as_put_there),
  };
  return TEST_RUN(tests);
}
