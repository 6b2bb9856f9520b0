/* pbf_move_colliders: colliders reach their targets when they should, as rigid bodies do, and stop.
 */
#include "support.h"

#include <math.h>

enum { PARTS = 3, STEPS = 12 };

static const double duration = 0.1, rounding = 1e-12;

static pbf_params params_of(uint32_t steps) {
  pbf_params params = test_params();
  params.time_step = duration / steps;
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = -4;
    params.domain_max[k] = 4;
  }
  return params;
}

static pbf_collider collider_at(uint32_t shape, const double position[3], double angle) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  memcpy(c.position, position, sizeof c.position);
  c.orientation[2] = sin(0.5 * angle);
  c.orientation[3] = cos(0.5 * angle);
  return c;
}

static pbf_collider get(pbf_solver *solver, uint32_t index) {
  pbf_collider c = {.struct_size = sizeof c};
  assert_ok(pbf_get_collider(solver, index, &c));
  return c;
}

/* Parts of one body, turned about z and moved. */
static void body_at(double angle, const double at[3], pbf_collider parts[PARTS]) {
  static const double own[PARTS][2] = {{0.5, 0}, {-0.5, 0.25}, {0.25, 1}};
  for (int k = 0; k < PARTS; ++k) {
    const double position[3] = {at[0] + cos(angle) * own[k][0] - sin(angle) * own[k][1],
                                at[1] + sin(angle) * own[k][0] + cos(angle) * own[k][1], at[2]};
    parts[k] = collider_at(k == 0 ? PBF_COLLIDER_BOX : PBF_COLLIDER_CAPSULE, position, angle);
  }
}

static double distance(const pbf_collider *a, const pbf_collider *b, uint32_t dimension) {
  double sum = 0;
  for (uint32_t k = 0; k < dimension; ++k) sum += pow(a->position[k] - b->position[k], 2);
  return sqrt(sum);
}

static void assert_there(const pbf_collider *c, const pbf_collider *target, uint32_t dimension) {
  assert_true(distance(c, target, dimension) < rounding);
  for (int k = 0; k < 4; ++k)
    assert_true(fabs(c->orientation[k] - target->orientation[k]) < rounding);
}

static void check_arrival(uint32_t dimension, uint32_t precision) {
  const double from[3] = {0}, to[3] = {1, -0.5, dimension == 3 ? 0.25 : 0};
  const double angle = 2.5;
  pbf_collider parts[PARTS], targets[PARTS];
  const pbf_desc desc = test_desc(dimension, precision, 1);
  const pbf_params params = params_of(STEPS);
  pbf_solver *solver = test_create(&desc, &params);
  body_at(0, from, parts);
  body_at(angle, to, targets);
  assert_ok(pbf_set_colliders(solver, PARTS, parts));
  assert_ok(pbf_move_colliders(solver, PARTS, targets, duration));
  for (int step = 1; step <= STEPS; ++step) {
    assert_ok(pbf_step(solver, 1));
    const pbf_collider first = get(solver, 0);
    const double turned = 2 * atan2(first.orientation[2], first.orientation[3]);
    assert_true(fabs(turned - angle * step / STEPS) < 1e-9);
    for (int k = 1; k < PARTS; ++k) { /* it is one body all the way */
      const pbf_collider part = get(solver, k);
      assert_true(fabs(distance(&part, &first, dimension) -
                       distance(&parts[k], &parts[0], dimension)) < 1e-9);
    }
  }
  assert_ok(pbf_step(solver, STEPS)); /* … and stands then */
  for (int k = 0; k < PARTS; ++k) {
    const pbf_collider there = get(solver, k);
    assert_there(&there, &targets[k], dimension);
    assert_true(there.velocity[0] == 0 && there.angular_velocity[2] == 0 && there.duration == 0);
  }
  pbf_destroy(solver);
}

static void targets_are_reached(void **state) {
  (void)state;
  test_for_each_kind(check_arrival);
}

/* Half-way it is told to go elsewhere, and saved: a state keeps the motion. */
static void check_saved(uint32_t dimension, uint32_t precision) {
  const double from[3] = {0}, first[3] = {1, 0, 0}, second[3] = {0.25, 1, 0};
  pbf_collider parts[PARTS];
  const pbf_desc desc = test_desc(dimension, precision, 1);
  const pbf_params params = params_of(STEPS);
  pbf_solver *solver = test_create(&desc, &params), *other = test_create(&desc, &params);
  body_at(0, from, parts);
  assert_ok(pbf_set_colliders(solver, PARTS, parts));
  body_at(-1, first, parts);
  assert_ok(pbf_move_colliders(solver, PARTS, parts, duration));
  assert_ok(pbf_step(solver, STEPS / 2));
  body_at(0.5, second, parts);
  assert_ok(pbf_move_colliders(solver, PARTS, parts, duration));
  assert_ok(pbf_step(solver, STEPS / 2));
  const pbf_collider part = get(solver, 1);
  assert_true(fabs(part.duration - 0.5 * duration) < 1e-9);
  uint64_t size;
  void *saved = test_save(solver, &size);
  assert_ok(pbf_load(other, saved, size));
  free(saved);
  assert_ok(pbf_step(solver, STEPS));
  assert_ok(pbf_step(other, STEPS));
  for (int k = 0; k < PARTS; ++k) {
    const pbf_collider here = get(solver, k), there = get(other, k);
    assert_memory_equal(&here, &there, sizeof here);
    assert_there(&here, &parts[k], dimension);
  }
  pbf_destroy(solver);
  pbf_destroy(other);
}

static void states_keep_the_motion(void **state) {
  (void)state;
  test_for_each_kind(check_saved);
}

/* A ball swells to twice its radius and pushes a particle before it, which then is as fast as the
 * surface was, also the second time, when it has been resting on it. */
static void check_growth(uint32_t dimension, uint32_t precision) {
  const double at[3] = {0}, radius = 0.3, reach = 0.45;
  const pbf_desc desc = test_desc(dimension, precision, 1);
  pbf_params params = params_of(STEPS);
  params.wall_density = 0; /* of a lone particle that is all the density it has */
  pbf_solver *solver = test_create(&desc, &params);
  pbf_collider ball = collider_at(PBF_COLLIDER_SPHERE, at, 0);
  char x[3 * 8], v[3 * 8];
  ball.radius = radius;
  for (uint32_t k = 0; k < dimension; ++k) test_put(x, k, precision, k == 0 ? reach : 0);
  assert_ok(pbf_set_colliders(solver, 1, &ball));
  assert_ok(pbf_add_particles(solver, 1, x, NULL, NULL));
  ball.radius = 2 * radius;
  assert_ok(pbf_move_colliders(solver, 1, &ball, duration));
  assert_ok(pbf_step(solver, STEPS));
  assert_true(fabs(get(solver, 0).radius - 2 * radius) < rounding);
  assert_ok(pbf_get_positions(solver, 0, 1, x));
  assert_ok(pbf_get_velocities(solver, 0, 1, v));
  const double out = test_value(x, 0, precision), speed = test_value(v, 0, precision);
  if (!(out >= 2 * radius && out < 2 * radius + 0.01))
    fail_msg("it is at %g of %g", out, 2 * radius);
  if (!(fabs(speed - radius / duration) < 0.05 * radius / duration))
    fail_msg("it has %g of %g", speed, radius / duration);
  pbf_destroy(solver);
}

static void sizes_grow_at_a_rate(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub collides with nothing");
  test_for_each_kind(check_growth);
}

static void what_is_no_target_is_refused(void **state) {
  (void)state;
  const double at[3] = {0};
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, 1);
  const pbf_params params = params_of(STEPS);
  pbf_solver *solver = test_create(&desc, &params);
  pbf_collider two[2] = {collider_at(PBF_COLLIDER_BOX, at, 0),
                         collider_at(PBF_COLLIDER_PLANE, at, 0)};
  assert_ok(pbf_set_colliders(solver, 2, two));
  const double bad[] = {0, -1, NAN, INFINITY};
  for (int k = 0; k < 4; ++k)
    assert_fails(pbf_move_colliders(solver, 2, two, bad[k]), PBF_ERROR_INVALID_ARGUMENT,
                 "duration");
  assert_fails(pbf_move_colliders(solver, 1, two, 1), PBF_ERROR_INVALID_ARGUMENT, "count is 1");
  assert_fails(pbf_move_colliders(solver, 2, NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "null");
  two[1].axis[0] = 1;
  assert_fails(pbf_move_colliders(solver, 2, two, 1), PBF_ERROR_INVALID_ARGUMENT,
               "targets[1].axis");
  two[1].axis[0] = 0;
  two[0].inverted = 1;
  assert_fails(pbf_move_colliders(solver, 2, two, 1), PBF_ERROR_INVALID_ARGUMENT,
               "targets[0].inverted");
  two[0].inverted = 0;
  two[0].position[1] = NAN;
  assert_fails(pbf_move_colliders(solver, 2, two, 1), PBF_ERROR_INVALID_ARGUMENT, "position[1]");
  two[0].position[1] = 0;
  two[0].shape = PBF_COLLIDER_SPHERE;
  assert_fails(pbf_move_colliders(solver, 2, two, 1), PBF_ERROR_INVALID_ARGUMENT,
               "targets[0].shape");
  assert_fails(pbf_move_colliders(NULL, 0, NULL, 1), PBF_ERROR_INVALID_ARGUMENT, "solver");
  const pbf_collider still = get(solver, 0);
  assert_true(still.velocity[1] == 0 && still.duration == 0);
  pbf_destroy(solver);
}

static void assert_saved_can_be_loaded(pbf_solver *solver, pbf_solver *other) {
  uint64_t size = 0;
  assert_ok(pbf_save(solver, NULL, &size));
  void *state = malloc(size);
  assert_non_null(state);
  assert_ok(pbf_save(solver, state, &size));
  assert_ok(pbf_load(other, state, size));
  free(state);
  assert_int_equal(test_hash(solver), test_hash(other));
}

/* A way that only velocities beyond those of pbf_set_colliders lead, or a time beyond numbers, is
 * refused: a solver that took it could not be saved and loaded. */
static void a_way_beyond_numbers_is_refused(void **state) {
  (void)state;
  static const struct {
    double x, duration;
    const char *words;
  } bad[] = {{3e38, 1.0 / 60, "velocity[0]"},
             {0.4, 1e-310, "velocity[0]"},
             {0.5, 1e39, "duration"},
             {0.5, 1e308, "duration"}};
  const double at[3] = {0.5, 0.5, 0.5};
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *solver = test_create(&desc, NULL), *other = test_create(&desc, NULL);
  pbf_collider ball = collider_at(PBF_COLLIDER_SPHERE, at, 0);
  ball.radius = 0.1;
  assert_ok(pbf_set_colliders(solver, 1, &ball));
  for (int k = 0; k < 4; ++k) {
    ball.position[0] = bad[k].x;
    assert_fails(pbf_move_colliders(solver, 1, &ball, bad[k].duration), PBF_ERROR_INVALID_ARGUMENT,
                 "targets[0] can't be reached");
    assert_non_null(strstr(pbf_last_error(), bad[k].words));
    assert_saved_can_be_loaded(solver, other);
  }
  const pbf_collider still = get(solver, 0);
  assert_true(still.position[0] == 0.5 && still.velocity[0] == 0);
  pbf_destroy(solver);
  pbf_destroy(other);
}

/* A collider that has shrunk to nothing, and grows again: its state is one as any other. */
static void what_has_shrunk_to_nothing_can_be_saved(void **state) {
  (void)state;
  const double at[3] = {0.5, 0.5, 0.5};
  const uint32_t shapes[] = {PBF_COLLIDER_SPHERE, PBF_COLLIDER_CAPSULE, PBF_COLLIDER_BOX};
  const pbf_desc desc = test_desc(3, PBF_FLOAT32, 8);
  pbf_solver *solver = test_create(&desc, NULL), *other = test_create(&desc, NULL);
  const double four_steps = 4 * test_params().time_step;
  for (int k = 0; k < 3; ++k) {
    pbf_collider body = collider_at(shapes[k], at, 0);
    body.radius = body.half_length = 0.1;
    body.radius_rate = body.half_length_rate = -100;
    for (int a = 0; a < 3; ++a) body.half_extents[a] = 0.1, body.half_extents_rate[a] = -100;
    assert_ok(pbf_set_colliders(solver, 1, &body));
    assert_ok(pbf_step(solver, 2));
    assert_true(get(solver, 0).radius == 0 && get(solver, 0).half_extents[1] == 0);
    assert_saved_can_be_loaded(solver, other);
    assert_ok(pbf_move_colliders(solver, 1, &body, four_steps));
    assert_saved_can_be_loaded(solver, other);
    assert_ok(pbf_step(solver, 6));
    assert_ok(pbf_step(other, 6));
    assert_int_equal(test_hash(solver), test_hash(other));
    assert_true(fabs(get(other, 0).half_extents[0] - 0.1) < 1e-12);
    assert_saved_can_be_loaded(solver, other);
  }
  pbf_destroy(solver);
  pbf_destroy(other);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(targets_are_reached),
      cmocka_unit_test(states_keep_the_motion),
      cmocka_unit_test(sizes_grow_at_a_rate),
      cmocka_unit_test(what_is_no_target_is_refused),
      cmocka_unit_test(a_way_beyond_numbers_is_refused),
      cmocka_unit_test(what_has_shrunk_to_nothing_can_be_saved),
  };
  return TEST_RUN(tests);
}
