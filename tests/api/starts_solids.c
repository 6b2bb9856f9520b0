/* Water that is filled in around solids, which a lattice does not fit: some of it begins too near
 * to them. Nothing has been lifted or let down by more than a spacing or two, and so nothing may be
 * faster than a fall by as much, however short the steps. */
#include "support.h"

#include <math.h>
#include <string.h>

static const double d = 0.05, gravity = 9.81;

enum { LAYERS = 12, WIDE = 30, DEEP = 8, MOST = WIDE * LAYERS * DEEP };

typedef struct start {
  pbf_collider solids[2];
  uint32_t count;
  double lower; /* of the domain */
} start;

static pbf_collider solid(uint32_t shape, double x, double y) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  c.position[0] = x * d;
  c.position[1] = y * d;
  c.position[2] = 0.5 * DEEP * d;
  return c;
}

/* How far x is before the first solid, a ball or a box. */
static double before(const pbf_collider *c, const double x[3], uint32_t dimension) {
  double r2 = 0, most = -INFINITY;
  for (uint32_t k = 0; k < dimension; ++k) {
    const double way = x[k] - c->position[k];
    r2 += way * way;
    most = fmax(most, fabs(way) - c->half_extents[k]);
  }
  return c->shape == PBF_COLLIDER_SPHERE ? sqrt(r2) - c->radius : most;
}

/* A lattice, without what is nearer to the first solid than `room`. */
static pbf_solver *pool(uint32_t dimension, uint32_t precision, double time_step, const start *of,
                        double room) {
  static double points[3 * MOST];
  pbf_params params = test_params();
  uint32_t count = 0;
  params.spacing = d;
  params.smoothing_radius = 2 * d;
  params.time_step = time_step;
  params.attraction = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    params.gravity[k] = k == 1 ? -gravity : 0;
    params.domain_min[k] = k == 1 ? of->lower : 0;
    params.domain_max[k] = k == 0 ? WIDE * d : k == 1 ? 2 : dimension == 3 ? DEEP * d : 1;
  }
  for (uint32_t i = 0; i < WIDE * LAYERS * (dimension == 3 ? DEEP : 1u); ++i) {
    const double x[3] = {d * (i % WIDE + 0.5), d * (i / WIDE % LAYERS + 0.5),
                         d * (i / WIDE / LAYERS + 0.5)};
    if (before(&of->solids[0], x, dimension) < room) continue;
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(points, (uint64_t)count * dimension + k, precision, x[k]);
    ++count;
  }
  const pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, of->count, of->solids));
  assert_ok(pbf_add_particles(s, count, points, NULL, NULL));
  return s;
}

/* In 0.3 seconds. */
static double fastest_of(uint32_t dimension, uint32_t precision, double time_step, const start *of,
                         double room) {
  pbf_solver *s = pool(dimension, precision, time_step, of, room);
  double fastest = 0;
  for (int k = 0; k * time_step < 0.3; ++k) {
    pbf_stats stats = {.struct_size = sizeof stats};
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_stats(s, &stats));
    fastest = fmax(fastest, stats.speed_max);
  }
  pbf_destroy(s);
  return fastest;
}

static double fall_by(double way) { return sqrt(2 * gravity * way); }

/* All places outside of a ball are filled. */
static void check_ball(uint32_t dimension, uint32_t precision) {
  for (int k = 1; k <= 5; k += 2)
    for (int shorter = 0; shorter <= 1; ++shorter) {
      const double dt = shorter ? 1.0 / 480 : 1.0 / 240;
      start ball = {.solids = {solid(PBF_COLLIDER_SPHERE, 15, 5.5)}, .count = 1};
      ball.solids[0].radius = (4 - 0.1 * k) * d;
      const double fastest = fastest_of(dimension, precision, dt, &ball, 0.01 * d);
      if (!(fastest < fall_by(2 * d)))
        fail_msg("%uD, %g spacings, steps of %g: %g m/s, at most %g", dimension, 4 - 0.1 * k, dt,
                 fastest, fall_by(2 * d));
    }
}

static void water_around_a_ball_is_not_thrown(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_ball);
}

/* A box hangs a spacing above a floor, which lies on the domain's or a little above it: a row fits
 * in between, whichever of the two planes is looked at first. */
static void check_gap(uint32_t dimension, uint32_t precision) {
  for (int k = 0; k <= 2; ++k) {
    start gap = {.solids = {solid(PBF_COLLIDER_BOX, 15, 3), solid(PBF_COLLIDER_PLANE, 0, 0)},
                 .count = 2,
                 .lower = -0.1 * k * d};
    for (int a = 0; a < 3; ++a) gap.solids[0].half_extents[a] = 2 * d;
    const double fastest = fastest_of(dimension, precision, 1.0 / 480, &gap, 0.2 * d);
    if (!(fastest < fall_by(2 * d)))
      fail_msg("%uD, %g spacings above the domain's floor: %g m/s, at most %g", dimension, 0.1 * k,
               fastest, fall_by(2 * d));
  }
}

static void a_row_below_a_box_stays(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_gap);
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_around_a_ball_is_not_thrown),
      cmocka_unit_test(a_row_below_a_box_stays),
  };
  return TEST_RUN(tests);
}
