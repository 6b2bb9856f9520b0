/* Openings of emitters in water that stands before them: what is in a stream's way gives way at
 * about the stream's own speed, however short steps are. */
#include <math.h>

#include <pbf/emit.h>

#include "support.h"

enum { WIDE = 12, LAYERS = 12, MOST = WIDE * LAYERS * WIDE + 4000 };

static const double d = 0.05, speed = 1;

static int is_in_solid(const double place[3], const pbf_collider *solid, uint32_t dimension) {
  double square = 0, farthest = 0;
  if (!solid) return 0;
  for (uint32_t k = 0; k < dimension; ++k) {
    const double away = fabs(place[k] - solid->position[k]);
    square += away * away;
    farthest = fmax(farthest, away / solid->half_extents[k]);
  }
  return solid->shape == PBF_COLLIDER_SPHERE ? square < solid->radius * solid->radius
                                             : farthest < 1;
}

/* A tank of twelve layers at rest, without what would stand in the solid. */
static pbf_solver *tank(uint32_t dimension, uint32_t precision, double time_step,
                        const pbf_collider *solid) {
  const uint32_t depth = dimension == 3 ? WIDE : 1;
  const pbf_desc desc = test_desc(dimension, precision, MOST);
  pbf_params params = test_params();
  unsigned char *x = malloc(MOST * 3 * 8);
  uint32_t count = 0;
  params.time_step = time_step;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = d * (k == 1 ? 2 * LAYERS : WIDE);
  for (uint32_t i = 0; i < WIDE * LAYERS * depth; ++i) {
    const double place[3] = {d * (i % WIDE + 0.5), d * (i / WIDE % LAYERS + 0.5),
                             d * (i / WIDE / LAYERS + 0.5)};
    if (is_in_solid(place, solid, dimension)) continue;
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)count * dimension + k, precision, place[k]);
    ++count;
  }
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  if (solid) assert_ok(pbf_set_colliders(s, 1, solid));
  assert_ok(pbf_step(s, (uint32_t)lround(0.2 / time_step)));
  free(x);
  return s;
}

/* Four spacings wide. */
static pbf_emitter opening(double height, double velocity) {
  pbf_emitter e;
  assert_ok(pbf_emitter_init(&e, sizeof e, PBF_EMITTER_RECTANGLE));
  for (int k = 0; k < 3; ++k) e.position[k] = k == 1 ? height : d * WIDE / 2;
  e.velocity[1] = velocity;
  e.half_width = e.half_height = 2 * d;
  return e;
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

typedef enum where { IN_WATER, ON_A_BOX, ON_THE_FLOOR, IN_A_BALL, PLACES } where;

/* The box's upper face is as high as the opening; that lies 3 d deep in the ball, deeper than the h
 * on which its stream moves a particle. */
static pbf_collider solid_at(where place) {
  pbf_collider solid;
  const uint32_t shape = place == IN_A_BALL ? PBF_COLLIDER_SPHERE : PBF_COLLIDER_BOX;
  assert_ok(pbf_collider_init(&solid, sizeof solid, shape));
  for (int k = 0; k < 3; ++k) {
    solid.position[k] = d * (k == 1 && place == ON_A_BOX ? 4 : WIDE / 2);
    solid.half_extents[k] = 2 * d;
  }
  solid.radius = 3 * d;
  return solid;
}

static void check_opening(uint32_t dimension, uint32_t precision, double time_step, where place) {
  static const char *const names[] = {"in the water", "on a box", "on the floor", "in a ball"};
  const pbf_collider solid = solid_at(place);
  const int has_solid = place == ON_A_BOX || place == IN_A_BALL;
  pbf_solver *s = tank(dimension, precision, time_step, has_solid ? &solid : NULL);
  const pbf_emitter e = opening(place == ON_THE_FLOOR ? 0 : 6 * d, speed);
  double fastest = 0;
  assert_ok(pbf_set_emitters(s, 1, &e));
  for (double t = 0; t < 0.3; t += time_step) {
    assert_ok(pbf_step(s, 1));
    fastest = fmax(fastest, stats_of(s).speed_max);
  }
  if (!(fastest < 2.5 * speed))
    fail_msg("%uD, steps of %g, %s: %g m/s for a stream of %g", dimension, time_step, names[place],
             fastest, speed);
  const double error = stats_of(s).density_error_mean;
  const double most = place == IN_A_BALL && dimension == 2 ? 0.12 : 0.03;
  if (!(error < most))
    fail_msg("%uD, steps of %g, %s: an error of %g", dimension, time_step, names[place], error);
  pbf_destroy(s);
}

static void check_openings(uint32_t dimension, uint32_t precision) {
  for (where place = IN_WATER; place < PLACES; ++place) {
    check_opening(dimension, precision, 1.0 / 60, place);
    check_opening(dimension, precision, 1.0 / 240, place);
  }
}

static void water_gives_way_at_the_streams_speed(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_openings);
}

static double speed_of(pbf_solver *s, uint32_t dimension, uint32_t precision, uint32_t row) {
  unsigned char v[3 * 8];
  double square = 0;
  assert_ok(pbf_get_velocities(s, row, 1, v));
  for (uint32_t k = 0; k < dimension; ++k) square += pow(test_value(v, k, precision), 2);
  return sqrt(square);
}

/* The fastest of a tank and of what is added upon some of it; streams fall through the air. */
static double parting(uint32_t dimension, uint32_t precision, uint32_t streams) {
  const uint32_t added = dimension == 3 ? 8 : 4;
  pbf_solver *s = tank(dimension, precision, 1.0 / 240, NULL);
  const pbf_emitter e = opening(20 * d, -speed);
  unsigned char x[8 * 3 * 8];
  uint32_t standing, first;
  double fastest = 0;
  assert_ok(pbf_get_count(s, &standing));
  assert_ok(pbf_set_emitters(s, streams, &e));
  assert_ok(pbf_step(s, 6));
  for (uint32_t i = 0; i < added; ++i) {
    const double place[3] = {d * (2 + 0.7 * (i % 2)), d * (3 + 0.7 * (i / 2 % 2)),
                             d * (2 + 0.7 * (i / 4))};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, place[k]);
  }
  assert_ok(pbf_add_particles(s, added, x, NULL, &first));
  for (int step = 0; step < 24; ++step) {
    assert_ok(pbf_step(s, 1));
    for (uint32_t row = 0; row < first + added; row = row + 1 == standing ? first : row + 1)
      fastest = fmax(fastest, speed_of(s, dimension, precision, row));
  }
  pbf_destroy(s);
  return fastest;
}

/* With a stream elsewhere, too, at a few tenths of sqrt(g h), which is 1 m/s. */
static void check_parting(uint32_t dimension, uint32_t precision) {
  for (uint32_t streams = 0; streams < 2; ++streams) {
    const double fastest = parting(dimension, precision, streams);
    if (!(fastest < 0.5))
      fail_msg("%uD: with %u streams elsewhere %g m/s", dimension, streams, fastest);
  }
}

static void other_overlaps_part_as_without(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_parting);
}

/* The same bits in one call, in many, and from a state saved on the way. */
static void check_calls(uint32_t dimension, uint32_t precision) {
  const pbf_emitter e = opening(6 * d, speed);
  pbf_solver *one = tank(dimension, precision, 1.0 / 120, NULL);
  pbf_solver *many = tank(dimension, precision, 1.0 / 120, NULL);
  uint64_t size = 0;
  assert_ok(pbf_set_emitters(one, 1, &e));
  assert_ok(pbf_set_emitters(many, 1, &e));
  assert_ok(pbf_step(one, 24));
  for (int step = 0; step < 12; ++step) assert_ok(pbf_step(many, 1));
  assert_ok(pbf_save(many, NULL, &size));
  void *state = malloc(size);
  assert_ok(pbf_save(many, state, &size));
  assert_ok(pbf_step(many, 12));
  const uint64_t right = test_hash(one);
  assert_true(test_hash(many) == right);
  assert_ok(pbf_load(many, state, size));
  assert_ok(pbf_step(many, 12));
  assert_true(test_hash(many) == right);
  free(state);
  pbf_destroy(one);
  pbf_destroy(many);
}

static void calls_and_states_do_not_matter(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_calls);
}

int main(void) {
  const struct CMUnitTest openings[] = {
      cmocka_unit_test(water_gives_way_at_the_streams_speed),
      cmocka_unit_test(other_overlaps_part_as_without),
      cmocka_unit_test(calls_and_states_do_not_matter),
  };
  return TEST_RUN(openings);
}
