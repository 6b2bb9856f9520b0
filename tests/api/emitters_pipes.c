/* Streams in pipes: what is held up in one is pressed, and not ever denser. */
#include "emitter_scene.h"

static const double speed = 1;

/* A pipe, which the stream fills, 24 d long, and a wall at its end with a neck of half of its
 * width. */
enum { WIDE = 12, DEEP = 6 };

static pbf_solver *pipe(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  pbf_params params = test_params();
  params.gravity[1] = 0;
  memcpy(params.domain_max, (double[]){40 * d, WIDE * d, DEEP * d}, sizeof params.domain_max);
  params.time_step = 1.0 / 240;
  return test_create(&desc, &params);
}

static void close_half(pbf_solver *s) {
  pbf_collider walls[2];
  for (int k = 0; k < 2; ++k) {
    assert_ok(pbf_collider_init(&walls[k], sizeof walls[k], PBF_COLLIDER_BOX));
    memcpy(walls[k].position, (double[]){25 * d, k ? 12.5 * d : -0.5 * d, 0},
           sizeof walls[k].position);
    memcpy(walls[k].half_extents, (double[]){d, 3.5 * d, 1}, sizeof walls[k].half_extents);
  }
  assert_ok(pbf_set_colliders(s, 2, walls));
}

static void let_through(pbf_solver *s) {
  pbf_emitter e = emitter_of(PBF_EMITTER_RECTANGLE);
  pbf_volume drain;
  memcpy(e.position, (double[]){d / 2, WIDE * d / 2, DEEP * d / 2}, sizeof e.position);
  memcpy(e.velocity, (double[]){speed, 0, 0}, sizeof e.velocity);
  memcpy(e.across, (double[]){0, 1, 0}, sizeof e.across);
  e.half_width = WIDE * d / 2;
  e.half_height = DEEP * d / 2;
  assert_ok(pbf_volume_init(&drain, sizeof drain, PBF_VOLUME_BOX));
  memcpy(drain.position, (double[]){38 * d, 0, 0}, sizeof drain.position);
  memcpy(drain.half_extents, (double[]){3 * d, 9, 9}, sizeof drain.half_extents);
  assert_ok(pbf_set_emitters(s, 1, &e));
  assert_ok(pbf_set_drains(s, 1, &drain));
}

/* What is beyond 1 of densities in the middle of the pipe, on average, in so many steps. */
static double denser(pbf_solver *s, uint32_t dimension, uint32_t precision, int steps) {
  static double x[3 * CAPACITY], density[CAPACITY];
  double sum = 0, count = 0;
  for (int step = 0; step < steps; step += 8) {
    const uint32_t all = count_of(s);
    assert_ok(pbf_step(s, 8));
    assert_ok(pbf_get_positions(s, 0, count_of(s), x));
    assert_ok(pbf_get_densities(s, 0, count_of(s), density));
    for (uint32_t i = 0; i < all && i < count_of(s); ++i) {
      const double along = test_value(x, (uint64_t)i * dimension, precision);
      if (along < 5 * d || along > 20 * d) continue;
      sum += fmax(test_value(density, i, precision) - 1, 0);
      ++count;
    }
  }
  return sum / count;
}

/* The pressure that drives water through the neck, some (4 - 1)/2 of the stream's speed squared and
 * more, does not compress it. */
static void check_neck(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = pipe(dimension, precision);
  close_half(s);
  let_through(s);
  assert_ok(pbf_step(s, 360));
  const double error = denser(s, dimension, precision, 80);
  if (!(error < 0.01)) fail_msg("%uD: denser by %g in a pipe with a neck", dimension, error);
  pbf_destroy(s);
}

static void what_is_held_up_is_pressed(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_neck);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_held_up_is_pressed)};
  return TEST_RUN(tests);
}
