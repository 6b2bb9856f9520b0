/* Streams of emitters end at solids: what stands closer before an opening than their stream moves
 * particles, which is h, is not gone through. */
#include "emitter_scene.h"

static const double speed = 2;

static pbf_params params_of(pbf_solver *s) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(s, &params));
  return params;
}

/* The face of what is in the way is there. */
static const double face = 0.6;

typedef enum obstacle { THIN_BOX, BALL, PLANE, WALL, OBSTACLES } obstacle;

/* In its way to the right; a wall needs no collider. */
static void obstruct(pbf_solver *s, obstacle what) {
  static const uint32_t shapes[] = {PBF_COLLIDER_BOX, PBF_COLLIDER_SPHERE, PBF_COLLIDER_PLANE};
  const double thickness[] = {0.5 * d, 16 * d, 0};
  pbf_params params = params_of(s);
  pbf_collider c;
  if (what == WALL) {
    params.domain_max[0] = face;
    assert_ok(pbf_set_params(s, &params));
    return;
  }
  assert_ok(pbf_collider_init(&c, sizeof c, shapes[what]));
  memcpy(c.position, (double[]){face + thickness[what] / 2, 1, 0.5}, sizeof c.position);
  memcpy(c.half_extents, (double[]){thickness[what] / 2, 2, 2}, sizeof c.half_extents);
  memcpy(c.axis, (double[]){-1, 0, 0}, sizeof c.axis);
  c.radius = thickness[what] / 2;
  assert_ok(pbf_set_colliders(s, 1, &c));
}

/* Four spacings wide, its stream to the right. */
static pbf_emitter before(double gap) {
  pbf_emitter e = emitter_of(PBF_EMITTER_RECTANGLE);
  memcpy(e.position, (double[]){face - gap, 1, 0.5}, sizeof e.position);
  memcpy(e.velocity, (double[]){speed, 0, 0}, sizeof e.velocity);
  memcpy(e.across, (double[]){0, 1, 0}, sizeof e.across);
  e.half_height = 2 * d;
  e.half_width = 2 * d;
  return e;
}

static int is_through(const double place[3], obstacle what) {
  const double middle[3] = {face + 8 * d, 1, 0.5}, rounding = 1e-4;
  double square = 0;
  for (int k = 0; k < 3; ++k) square += pow(place[k] - middle[k], 2);
  return what == BALL ? sqrt(square) < 8 * d - rounding : place[0] > face + rounding;
}

static double place_along(const void *raw, uint64_t i, uint32_t k, uint32_t dimension,
                          uint32_t precision, double otherwise) {
  return k < dimension ? test_value(raw, i * dimension + k, precision) : otherwise;
}

static uint32_t count_through(pbf_solver *s, uint32_t dimension, uint32_t precision,
                              obstacle what) {
  static double raw[3 * CAPACITY];
  uint32_t through = 0;
  assert_ok(pbf_get_positions(s, 0, count_of(s), raw));
  for (uint32_t i = 0; i < count_of(s); ++i) {
    double place[3];
    for (uint32_t k = 0; k < 3; ++k)
      place[k] = place_along(raw, i, k, dimension, precision, k == 1 ? 1 : 0.5);
    through += (uint32_t)is_through(place, what);
  }
  return through;
}

/* What a stream has come to. */
typedef struct outcome {
  double fastest, energy; /* over the stream's */
  uint32_t through, count;
} outcome;

static outcome run_stream(uint32_t dimension, uint32_t precision, double time_step, double time,
                          double gap, obstacle what) {
  pbf_solver *s = tank(dimension, precision, 0);
  pbf_params params = params_of(s);
  pbf_stats stats = {.struct_size = sizeof stats};
  const pbf_emitter e = before(gap);
  outcome o = {0};
  params.time_step = time_step;
  assert_ok(pbf_set_params(s, &params));
  obstruct(s, what);
  assert_ok(pbf_set_emitters(s, 1, &e));
  for (int step = 0; step * time_step < time; ++step) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_stats(s, &stats));
    o.fastest = fmax(o.fastest, stats.speed_max / speed);
  }
  o.energy = stats.kinetic_energy / (speed * speed / 2);
  o.count = count_of(s);
  o.through = count_through(s, dimension, precision, what);
  pbf_destroy(s);
  return o;
}

static void check_stream(uint32_t dimension, uint32_t precision, double time_step, double gap,
                         obstacle what) {
  const outcome o = run_stream(dimension, precision, time_step, 0.2, gap, what);
  /* What comes, 4 d wide, has a gap of 1.1 d on each side to go through, at 1.8 times its speed. */
  if (o.through > 0 || !(o.fastest < 1.95))
    fail_msg("%uD, steps of %g, obstacle %d, %g before it: %u of %u through it, %g times as fast",
             dimension, time_step, what, gap, o.through, o.count, o.fastest);
}

static void check_streams(uint32_t dimension, uint32_t precision) {
  for (obstacle what = THIN_BOX; what < OBSTACLES; ++what) {
    check_stream(dimension, precision, 1.0 / 60, 0.6 * d, what);
    check_stream(dimension, precision, 1.0 / 240, 1.1 * d, what);
  }
}

/* The gap is wider than what comes needs to leave as fast, which is 2 d in 2D and 1 d in 3D. A jet
 * that a wall turns aside keeps its speed (Bernoulli), and so all have the energy that they came
 * with; drops may fly ahead. */
static void check_piston(uint32_t dimension, uint32_t precision) {
  for (obstacle what = THIN_BOX; what < OBSTACLES; ++what) {
    const outcome o = run_stream(dimension, precision, 1.0 / 240, 0.4, 2.6 * d, what);
    if (o.through > 0 || !(o.fastest < 2) || !(o.energy < 1.5))
      fail_msg("%uD, obstacle %d: %u of %u through it, %g times as fast, %g times the energy",
               dimension, what, o.through, o.count, o.fastest, o.energy);
  }
}

static void streams_are_no_pistons(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_piston);
}

static void streams_end_at_solids(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_each_kind(check_streams);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(streams_end_at_solids),
                                     cmocka_unit_test(streams_are_no_pistons)};
  return TEST_RUN(tests);
}
