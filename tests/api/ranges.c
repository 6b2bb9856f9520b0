/* What is accepted gives numbers: parameters and colliders beyond what a step can multiply are
 * refused, and what has been drawn at random from all the magnitudes there are leaves a state that
 * its own solver loads. */
#include <stdio.h>

#include "support.h"

enum { COUNT = 60 };

/* Faster ones have an energy that is none. */
static void fastest_particles(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
  pbf_stats stats = {.struct_size = sizeof stats};
  double v[3] = {1, -1e150, 1};
  float single[3] = {1, -3e38f, 1};
  assert_ok(pbf_set_velocities(s, 7, 1, precision == PBF_FLOAT64 ? (void *)v : single));
  assert_ok(pbf_get_stats(s, &stats));
  assert_true(isfinite(stats.kinetic_energy));
  v[1] = -1.01e150;
  if (precision == PBF_FLOAT64) {
    assert_fails(pbf_set_velocities(s, 7, 1, v), PBF_ERROR_INVALID_ARGUMENT,
                 "velocities[7][1] is -1.01e+150; it must be at most 1e150 in size");
    assert_ok(pbf_remove_particles(s, 1, (const uint32_t[]){7}));
    assert_fails(pbf_add_particles(s, 1, (const double[]){0.5, 0.5, 0.5}, v, NULL),
                 PBF_ERROR_INVALID_ARGUMENT, "it must be at most 1e150");
  }
  pbf_destroy(s);
}

/* Walls that act in the iterations alone find it far away. */
static void fastest_without_walls(uint32_t dimension, uint32_t precision) {
  for (uint32_t kernel = 0; kernel < 2; ++kernel) {
    pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
    pbf_params params = test_params();
    double v[3 * COUNT] = {0};
    float single[3 * COUNT] = {0};
    params.kernel = kernel;
    params.collide = PBF_COLLIDE_IN_ITERATION;
    params.prestabilization = 0;
    assert_ok(pbf_set_params(s, &params));
    for (uint32_t i = 0; i < COUNT * dimension; i += 7) v[i] = 1e150, single[i] = 1e37f;
    assert_ok(pbf_set_velocities(s, 0, COUNT, precision == PBF_FLOAT64 ? (void *)v : single));
    for (int step = 0; step < 3; ++step) {
      assert_ok(pbf_step(s, 1));
      assert_ok(pbf_get_velocities(s, 0, COUNT, v));
      for (uint32_t i = 0; i < COUNT * dimension; ++i)
        assert_true(fabs(test_value(v, i, precision)) < (test_is_stub() ? INFINITY : 1000));
    }
    pbf_destroy(s);
  }
}

/* On its lattice no particle has a neighbour. */
static void h_is_hardly_more_than_the_spacing(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
  pbf_params params = test_params();
  pbf_stats stats = {.struct_size = sizeof stats};
  params.spacing = 0.9945 * params.smoothing_radius;
  params.shear_stress_correction = 0.7;
  params.damping_compensation = 1;
  params.angular_momentum_correction = 1;
  params.prestabilization = 0;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 3));
  assert_ok(pbf_get_stats(s, &stats));
  assert_true(isfinite(stats.speed_max) && isfinite(stats.momentum[0]));
  pbf_destroy(s);
}

static void at_the_ends(uint32_t dimension, uint32_t precision) {
  const double fastest = precision == PBF_FLOAT32 ? 1e18 : 1e150;
  pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
  const pbf_params usual = test_params();
  const double h = usual.smoothing_radius;
  const struct {
    size_t offset;
    double within, beyond;
    const char *words;
  } ends[] = {
      {offsetof(pbf_params, over_relaxation), 1e6, 1.01e6,
       "over_relaxation is 1010000; it must be"},
      {offsetof(pbf_params, scorr_k), 0.99e6 * h * h, 1.01e6 * h * h,
       "scorr_k is 1010000 in units"},
      {offsetof(pbf_params, vorticity), 0.99e6 * h * 120, 1.01e6 * h * 120,
       "vorticity is 1010000 in"},
      {offsetof(pbf_params, sleep_speed), fastest, 1.01 * fastest, "it must be at most 1e"},
      {offsetof(pbf_params, time_step), 3.01 / fastest, 1.99 / fastest,
       "computes with speeds up to"},
  };
  for (size_t i = 0; i < sizeof ends / sizeof ends[0]; ++i) {
    pbf_params params = usual;
    params.sleep_time = 1;
    double *value = (double *)(void *)((char *)&params + ends[i].offset);
    *value = ends[i].beyond;
    assert_fails(pbf_set_params(s, &params), PBF_ERROR_INVALID_ARGUMENT, ends[i].words);
    *value = ends[i].within;
    assert_ok(pbf_set_params(s, &params));
  }
  pbf_params params = usual;
  params.gravity[1] = 1.01e150;
  if (precision == PBF_FLOAT64)
    assert_fails(pbf_set_params(s, &params), PBF_ERROR_INVALID_ARGUMENT, "at most 1e150 in size");
  pbf_destroy(s);
}

/* What overlaps then parts in more time than numbers hold, or at once. */
static void parts_never_or_at_once(uint32_t dimension, uint32_t precision) {
  for (int at_once = 0; at_once < 2; ++at_once) {
    pbf_solver *s = test_filled(dimension, precision, COUNT, 2 * COUNT);
    pbf_params params = test_params();
    void *x = test_lattice(dimension, precision, COUNT);
    uint64_t size = 0;
    params.max_depenetration_speed = !at_once ? 5e-324 : precision == PBF_FLOAT32 ? 3e38 : 1e150;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
    assert_ok(pbf_step(s, 2));
    void *saved = test_save(s, &size);
    assert_ok(pbf_load(s, saved, size));
    free(saved);
    free(x);
    pbf_destroy(s);
  }
}

/* What a step leaves of errors goes as weight times its square. */
static void longest_steps_under_most_weight(uint32_t dimension, uint32_t precision) {
  if (test_is_stub()) return; /* it has no bound on speeds */
  const double most = precision == PBF_FLOAT32 ? 3e38 : 1e150;
  for (int weight = 0; weight < 2; ++weight) {
    pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
    pbf_params params = test_params();
    uint64_t size = 0;
    params.time_step = most;
    *(weight ? &params.attraction : &params.gravity[1]) = most;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 1));
    void *saved = test_save(s, &size);
    assert_ok(pbf_load(s, saved, size));
    free(saved);
    pbf_destroy(s);
  }
}

static void ends_of_ranges(void **state) {
  (void)state;
  test_for_each_kind(at_the_ends);
  test_for_each_kind(fastest_particles);
  test_for_each_kind(fastest_without_walls);
  test_for_each_kind(h_is_hardly_more_than_the_spacing);
  test_for_each_kind(parts_never_or_at_once);
  test_for_each_kind(longest_steps_under_most_weight);
}

/* Not before it has to be. */
static void flies_away(uint32_t dimension, uint32_t precision) {
  const double most = precision == PBF_FLOAT32 ? 3e38 : 1e150;
  pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
  pbf_params params = test_params();
  pbf_collider ball;
  pbf_info info = {.struct_size = sizeof info};
  params.time_step = precision == PBF_FLOAT32 ? 0.5 : 0.5e150;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.1;
  ball.velocity[0] = most;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_set_colliders(s, 1, &ball));
  if (precision == PBF_FLOAT32) {
    uint64_t size = 0;
    assert_fails(pbf_step(s, 5), PBF_ERROR_STATE,
                 "step 3 of 5 would end at time 1.5, when "
                 "colliders[0].position is beyond what float32");
    assert_ok(pbf_get_info(s, &info));
    assert_int_equal(info.step, 2);
    void *saved = test_save(s, &size);
    assert_ok(pbf_load(s, saved, size));
    free(saved);
  }
  ball.velocity[0] = 0;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, 5));
  pbf_destroy(s);
}

/* On a screw it is back where it began after eight steps; after three, turned by 135 degrees, it is
 * 1.707 radii of its circle away. */
static void comes_back(uint32_t dimension, uint32_t precision) {
  const double turns = 0.78539816339744831; /* an eighth of one, in a time of 1 */
  const double radius = 3e38;
  if (precision != PBF_FLOAT32) return; /* no speed that is taken leads so far */
  for (uint32_t steps = 8; steps <= 8 * 2000; steps += 7 * 8 * 249) {
    pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
    pbf_params params = test_params();
    pbf_info info = {.struct_size = sizeof info};
    pbf_collider ball;
    params.time_step = 1;
    assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
    ball.radius = 0.1;
    ball.path = PBF_PATH_SCREW;
    ball.velocity[0] = radius * turns;
    ball.angular_velocity[2] = turns;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_set_colliders(s, 1, &ball));
    assert_fails(pbf_step(s, steps), PBF_ERROR_STATE,
                 "would end at time 3, when colliders[0].position is beyond what float32");
    assert_ok(pbf_get_info(s, &info));
    assert_int_equal(info.step, 2);
    pbf_destroy(s);
  }
}

/* Also away from the fluid. */
static void walls_fly_away(uint32_t dimension, uint32_t precision) {
  const double speed = precision == PBF_FLOAT32 ? 3e38 : 0.9e150;
  char words[96];
  snprintf(words, sizeof words,
           "step 3 of 5 would end at time 1.5, when a moving wall is beyond what float%u",
           8 * precision);
  for (int wall = 0; wall < 2; ++wall) {
    pbf_solver *s = test_filled(dimension, precision, COUNT, COUNT);
    pbf_params params = test_params();
    uint64_t size = 0;
    params.time_step = 0.5;
    params.wall_velocity[wall] = wall == PBF_WALL_X_MIN ? -speed : speed;
    assert_ok(pbf_set_params(s, &params));
    assert_fails(pbf_step(s, 5), PBF_ERROR_STATE, words);
    void *saved = test_save(s, &size);
    assert_ok(pbf_load(s, saved, size));
    free(saved);
    params.wall_velocity[wall] = 0;
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 5));
    pbf_destroy(s);
  }
}

static void colliders_fly_away(void **state) {
  (void)state;
  test_for_each_kind(walls_fly_away);
  test_for_each_kind(flies_away);
  test_for_each_kind(comes_back);
}

/* ---- At random ---- */

static uint64_t seed = UINT64_C(88172645463325252);

static double draw(void) {
  seed ^= seed << 13;
  seed ^= seed >> 7;
  seed ^= seed << 17;
  return (double)(seed >> 11) * 0x1p-53;
}

static double any_magnitude(uint32_t precision) {
  const double most = precision == PBF_FLOAT32 ? 38 : 300;
  return (draw() < 0.5 ? -1 : 1) * pow(10, (2 * draw() - 1) * most);
}

static const size_t drawn[] = {
    offsetof(pbf_params, time_step),
    offsetof(pbf_params, gravity[1]),
    offsetof(pbf_params, attraction),
    offsetof(pbf_params, attraction_center[0]),
    offsetof(pbf_params, over_relaxation),
    offsetof(pbf_params, cfm),
    offsetof(pbf_params, min_diagonal),
    offsetof(pbf_params, scorr_k),
    offsetof(pbf_params, vorticity),
    offsetof(pbf_params, viscosity),
    offsetof(pbf_params, wall_velocity[0]),
    offsetof(pbf_params, wall_frequency[0]),
    offsetof(pbf_params, wall_phase[0]),
    offsetof(pbf_params, sleep_speed),
    offsetof(pbf_params, drag),
    offsetof(pbf_params, drag_velocity[0]),
    offsetof(pbf_params, max_depenetration_speed),
};

static void draw_collider(pbf_collider *collider, uint32_t precision) {
  double *const members[] = {
      collider->position,     collider->velocity, &collider->angular_velocity[2],
      collider->half_extents, &collider->radius,  collider->half_extents_rate,
      &collider->radius_rate};
  assert_ok(pbf_collider_init(collider, sizeof *collider, (uint32_t)(4 * draw())));
  collider->position[0] = 0.5;
  collider->radius = collider->half_length = 0.2;
  collider->inverted = draw() < 0.4;
  *members[(size_t)(7 * draw())] = any_magnitude(precision);
}

/* 1 when all of it was accepted. */
static int draw_and_step(uint32_t precision) {
  pbf_params params = test_params();
  pbf_collider collider;
  uint64_t size = 0;
  params.solver = draw() < 0.3 ? PBF_SOLVER_JACOBI : PBF_SOLVER_CHEBYSHEV;
  params.sleep_time = 1;
  for (int k = 0; k < 2; ++k) {
    double value = any_magnitude(precision);
    size_t which = (size_t)(draw() * (double)(sizeof drawn / sizeof drawn[0]));
    memcpy((char *)&params + drawn[which], &value, sizeof value);
  }
  draw_collider(&collider, precision);
  pbf_solver *s = test_filled(3, precision, COUNT, COUNT);
  int accepted = pbf_set_params(s, &params) == PBF_OK;
  accepted &= pbf_set_colliders(s, 1, &collider) == PBF_OK;
  pbf_step(s, 2);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  assert_true(isfinite(stats.kinetic_energy) && isfinite(stats.center_of_mass[1]));
  void *saved = test_save(s, &size);
  pbf_status loaded = pbf_load(s, saved, size);
  if (loaded != PBF_OK) print_error("%s\n", pbf_last_error());
  assert_int_equal(loaded, PBF_OK);
  free(saved);
  pbf_destroy(s);
  return accepted;
}

static void any_magnitudes(void **state) {
  (void)state;
  enum { DRAWS = TEST_INSTRUMENTED ? 400 : 1200 };
  int accepted = 0;
  if (test_is_stub() || strcmp(test_backend(), "cuda") == 0)
    test_skip("for backends on a CPU: a device would take minutes");
  for (uint32_t precision = PBF_FLOAT32; precision <= PBF_FLOAT64; precision += 4)
    for (int i = 0; i < DRAWS && test_has_kind(3, precision); ++i)
      accepted += draw_and_step(precision);
  assert_true(accepted > DRAWS / 8);
}

int main(void) {
  const struct CMUnitTest ranges[] = {
      cmocka_unit_test(ends_of_ranges),
      cmocka_unit_test(colliders_fly_away),
      cmocka_unit_test(any_magnitudes),
  };
  return TEST_RUN(ranges);
}
