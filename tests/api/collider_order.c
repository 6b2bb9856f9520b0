/* Colliders that are set anew in another order, or with one more in front: a caller's list, from
 * which some are erased and to which others come, is none that numbers tell anything of. Those that
 * stay where they are press as before. */
#include "support.h"

#include <math.h>
#include <string.h>

static const double d = 0.05, gravity = 9.81;

enum { LAYERS = 12, WIDE = 36, DEEP = 8, SOLIDS = 6, MOST = WIDE * LAYERS * DEEP, LIST = 100 };

static pbf_collider solid(uint32_t shape, double x, double y) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  c.position[0] = x * d;
  c.position[1] = y * d;
  c.position[2] = 0.5 * DEEP * d;
  return c;
}

static pbf_collider plane(double x, double y, double slope_x, double slope_y) {
  pbf_collider c = solid(PBF_COLLIDER_PLANE, x, y);
  c.axis[0] = slope_x;
  c.axis[1] = slope_y;
  return c;
}

/* On and above the floor, and two walls through one point of it. */
static uint32_t put_solids(pbf_collider *to) {
  to[0] = solid(PBF_COLLIDER_SPHERE, 8, 4);
  to[0].radius = 2.5 * d;
  to[1] = solid(PBF_COLLIDER_BOX, 16, 3);
  for (int k = 0; k < 3; ++k) to[1].half_extents[k] = 2 * d;
  to[2] = solid(PBF_COLLIDER_SPHERE, 27, 6);
  to[2].radius = 3 * d;
  to[3] = solid(PBF_COLLIDER_CAPSULE, 21, 7);
  to[3].radius = d;
  to[3].half_length = 2 * d;
  to[4] = plane(0, 0, 0, 1);
  to[5] = plane(0, 0, 1, 0);
  return SOLIDS;
}

/* Where no fluid begins: half a spacing around the round ones, and the box. */
static int is_in_one(const pbf_collider *solids, const double x[3], uint32_t dimension) {
  double across = 0;
  for (int i = 0; i < 4; ++i) {
    double r2 = 0;
    for (uint32_t k = 0; k < dimension; ++k) {
      const double half = i == 3 && k == 1 ? solids[i].half_length : 0;
      const double way = fabs(x[k] - solids[i].position[k]);
      r2 += pow(fmax(way - half, 0), 2);
      if (i == 1) across = fmax(across, way);
    }
    if (i != 1 && r2 < pow(solids[i].radius + 0.5 * d, 2)) return 1;
  }
  return across < 2.3 * d;
}

/* Water around the solids, which are set. */
static pbf_solver *sleepy_pool(uint32_t dimension, uint32_t precision, double time_step,
                               double sleep_speed) {
  static double points[3 * MOST];
  pbf_collider solids[SOLIDS];
  pbf_params params = test_params();
  uint32_t count = 0;
  params.sleep_speed = sleep_speed;
  params.sleep_time = sleep_speed > 0 ? 0.2 : 0;
  params.spacing = d;
  params.smoothing_radius = 2 * d;
  params.time_step = time_step;
  params.attraction = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    params.gravity[k] = k == 1 ? -gravity : 0;
    params.domain_max[k] = k == 0 ? WIDE * d : k == 1 ? 2 : dimension == 3 ? DEEP * d : 1;
  }
  put_solids(solids);
  for (uint32_t i = 0; i < WIDE * LAYERS * (dimension == 3 ? DEEP : 1u); ++i) {
    const double x[3] = {d * (i % WIDE + 0.5), d * (i / WIDE % LAYERS + 0.5),
                         d * (i / WIDE / LAYERS + 0.5)};
    if (is_in_one(solids, x, dimension)) continue;
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(points, (uint64_t)count * dimension + k, precision, x[k]);
    ++count;
  }
  const pbf_desc desc = test_desc(dimension, precision, count + 1);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, SOLIDS, solids));
  assert_ok(pbf_add_particles(s, count, points, NULL, NULL));
  return s;
}

static pbf_solver *pool(uint32_t dimension, uint32_t precision, double time_step) {
  return sleepy_pool(dimension, precision, time_step, 0);
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

/* What is far from the fluid, in front of the list or behind it. */
static pbf_collider far_off(int number) {
  pbf_collider c = solid(PBF_COLLIDER_SPHERE, 3 + 2 * (number % 16), 30 + 2 * (number / 16));
  c.radius = 0.5 * d;
  return c;
}

enum how { LEFT_ALONE, TURNED_ROUND, ONE_IN_FRONT, MANY_IN_FRONT, HOWS };

static uint32_t put_list(enum how how, int step, pbf_collider *list) {
  pbf_collider solids[SOLIDS];
  uint32_t count = 0;
  const int in_front = how == ONE_IN_FRONT ? step % 2 : how == MANY_IN_FRONT ? 80 + step % 3 : 0;
  const uint32_t first = how == TURNED_ROUND ? (uint32_t)step % SOLIDS : 0;
  put_solids(solids);
  for (int i = 0; i < in_front; ++i) list[count++] = far_off(i);
  for (uint32_t i = 0; i < SOLIDS; ++i) list[count++] = solids[(first + i) % SOLIDS];
  return count;
}

/* Steps for a second; the list is set before each, in the air and in the water. */
static pbf_stats after(uint32_t dimension, uint32_t precision, double time_step, enum how how) {
  pbf_solver *s = pool(dimension, precision, time_step);
  for (int step = 0; step * time_step < 1; ++step) {
    pbf_collider list[LIST];
    const uint32_t count = put_list(how, step, list);
    if (how != LEFT_ALONE) assert_ok(pbf_set_colliders(s, count, list));
    assert_ok(pbf_step(s, 1));
  }
  const pbf_stats stats = stats_of(s);
  pbf_destroy(s);
  return stats;
}

/* Water has the volume that it has: it stands as high, and is as dense, whatever the list is. */
static void check_order(uint32_t dimension, uint32_t precision) {
  const double lengths[] = {1.0 / 60, 1.0 / 240};
  for (int k = 0; k < 2; ++k) {
    const pbf_stats alone = after(dimension, precision, lengths[k], LEFT_ALONE);
    assert_true(alone.density_error_mean < 0.006);
    for (int how = LEFT_ALONE + 1; how < HOWS; ++how) {
      const pbf_stats found = after(dimension, precision, lengths[k], (enum how)how);
      const double level = found.center_of_mass[1] / alone.center_of_mass[1];
      if (!(fabs(level - 1) < 0.005) || !(found.density_error_mean < 0.006))
        fail_msg("%uD, steps of %g, list %d: at %g of the level, denser by %g", dimension,
                 lengths[k], how, level, found.density_error_mean);
    }
  }
}

static void water_stands_whatever_the_order(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_order);
}

/* One that comes where none stood is found, also if the list is set once more in another order
 * before a step, and one of the same kind and place with a face that looks elsewhere: what it finds
 * is not thrown. At most a fall by the water's depth. */
static void check_placed(uint32_t dimension, uint32_t precision) {
  const double dt = 1.0 / 480, torricelli = sqrt(2 * gravity * LAYERS * d);
  for (int aslant = 0; aslant <= 1; ++aslant) {
    pbf_collider list[SOLIDS + 1];
    pbf_solver *s = pool(dimension, precision, dt);
    double fastest = 0;
    assert_ok(pbf_step(s, 120));
    put_solids(list);
    list[SOLIDS] = aslant ? plane(0, 0, 0.98, -0.2) : solid(PBF_COLLIDER_SPHERE, 14, 9);
    list[SOLIDS].radius = 2 * d;
    assert_ok(pbf_set_colliders(s, SOLIDS + 1, list));
    const pbf_collider first = list[0];
    list[0] = list[SOLIDS];
    list[SOLIDS] = first;
    assert_ok(pbf_set_colliders(s, SOLIDS + 1, list));
    for (int k = 0; k < 60; ++k) {
      assert_ok(pbf_step(s, 1));
      fastest = fmax(fastest, stats_of(s).speed_max);
    }
    pbf_destroy(s);
    if (!(fastest <= torricelli))
      fail_msg("%uD, %s: %g m/s, at most %g", dimension, aslant ? "a plane" : "a ball", fastest,
               torricelli);
  }
}

static void what_comes_is_found(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_placed);
}

/* What sleeps sleeps on, whatever the order; and wakes where one has been taken out of the list. */
static void check_sleep(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = sleepy_pool(dimension, precision, 1.0 / 60, 2);
  const uint32_t all = stats_of(s).count;
  assert_ok(pbf_step(s, 60));
  assert_int_equal(stats_of(s).asleep, all);
  for (int step = 0; step < 12; ++step) {
    pbf_collider list[LIST];
    const uint32_t count = put_list(step < 6 ? TURNED_ROUND : ONE_IN_FRONT, step, list);
    assert_ok(pbf_set_colliders(s, count, list));
    assert_ok(pbf_step(s, 1));
    assert_int_equal(stats_of(s).asleep, all);
  }
  pbf_collider list[SOLIDS];
  put_solids(list);
  assert_ok(pbf_set_colliders(s, SOLIDS - 1, list + 1));
  assert_ok(pbf_step(s, 1));
  assert_int_equal(stats_of(s).asleep, 0);
  pbf_destroy(s);
}

static void what_sleeps_sleeps_on(void **state) {
  (void)state;
  if (strcmp(test_backend(), "reference") == 0) test_skip("nothing sleeps");
  test_for_long_kinds(check_sleep);
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_stands_whatever_the_order),
      cmocka_unit_test(what_comes_is_found),
      cmocka_unit_test(what_sleeps_sleeps_on),
  };
  return TEST_RUN(tests);
}
