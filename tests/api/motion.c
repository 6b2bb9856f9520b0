/* Time, moving walls, moving colliders: what the host computes. */
#include "support.h"

static pbf_info info_of(pbf_solver *s) {
  pbf_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_info(s, &info));
  return info;
}

static pbf_collider collider_of(pbf_solver *s, uint32_t index) {
  pbf_collider collider = {.struct_size = sizeof collider};
  assert_ok(pbf_get_collider(s, index, &collider));
  return collider;
}

/* 0.1 can't be written in binary: a sum of ten of them is not 1, ten times 0.1 is. */
static void time_is_no_sum(void **state) {
  (void)state;
  pbf_solver *s = test_filled(3, PBF_FLOAT32, 2, 4);
  pbf_params params = test_params();
  params.gravity[1] = 0;
  params.time_step = 0.1;
  assert_ok(pbf_set_params(s, &params));
  for (int i = 0; i < 10; ++i) assert_ok(pbf_step(s, 1));
  assert_true(info_of(s).time == 1.0);
  params.time_step = 0.25;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 3));
  assert_true(info_of(s).time == 1.75);
  assert_int_equal(info_of(s).step, 13);
  params.viscosity = 0.01; /* another parameter leaves the time alone */
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 1));
  assert_true(info_of(s).time == 2.0);
  pbf_destroy(s);
}

static void colliders_move(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 4);
  pbf_params params = test_params();
  params.time_step = 0.125;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 8)); /* time 1: poses hold from when they are set */
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  box.position[0] = 0.5;
  box.velocity[0] = -0.25;
  box.angular_velocity[2] = pi / 2;
  assert_ok(pbf_set_colliders(s, 1, &box));
  assert_ok(pbf_step(s, 8));
  pbf_collider now = collider_of(s, 0);
  assert_true(now.position[0] == 0.25);
  /* A quarter turn about z: (0, 0, sin 45°, cos 45°). */
  assert_true(fabs(now.orientation[2] - sqrt(0.5)) < 1e-15);
  assert_true(fabs(now.orientation[3] - sqrt(0.5)) < 1e-15);
  assert_true(now.velocity[0] == -0.25 && now.angular_velocity[2] == pi / 2);
  assert_ok(pbf_set_colliders(s, 1, &now)); /* sets it where it is */
  pbf_collider again = collider_of(s, 0);
  assert_memory_equal(&again, &now, sizeof now);
  pbf_destroy(s);
}

static void positions_are_held_against_walls_now(void **state) {
  (void)state;
  pbf_solver *s = test_solver(2, PBF_FLOAT64, 4);
  pbf_params params = test_params();
  params.time_step = 0.5;
  params.wall_velocity[PBF_WALL_X_MAX] = 0.5;
  params.wall_velocity[PBF_WALL_Y_MIN] = 0.25;
  assert_ok(pbf_set_params(s, &params));
  double right[2] = {1.4, 0.5}, low[2] = {0.5, 0.1};
  assert_fails(pbf_add_particles(s, 1, right, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT, "0 … 1");
  assert_ok(pbf_step(s, 2));
  assert_fails(pbf_add_particles(s, 1, low, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT, "0.25 … 1");
  assert_ok(pbf_add_particles(s, 1, right, NULL, NULL));
  pbf_destroy(s);
}

/* The walls meet at time 2, at the end of step 4. */
static void walls_that_meet(void **state) {
  (void)state;
  pbf_solver *s = test_filled(2, PBF_FLOAT64, 1, 4);
  pbf_params params = test_params();
  params.time_step = 0.5;
  params.wall_velocity[PBF_WALL_X_MAX] = -0.5;
  assert_ok(pbf_set_params(s, &params));
  assert_fails(pbf_step(s, 10), PBF_ERROR_STATE, "step 4 of 10 would end at time 2");
  assert_int_equal(info_of(s).step, 3);
  assert_true(info_of(s).time == 1.5);
  assert_fails(pbf_step(s, 1), PBF_ERROR_STATE, "step 1 of 1");
  params.wall_velocity[PBF_WALL_X_MAX] = -0.75;
  assert_fails(pbf_set_params(s, &params), PBF_ERROR_INVALID_ARGUMENT, "at the present time 1.5");
  params.wall_velocity[PBF_WALL_X_MAX] = 0;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 10));
  pbf_destroy(s);
}

/* Free fall of one particle against the scheme's own closed form, n(n+1)/2 g dt². */
static void one_particle_falls(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 4);
  pbf_params params = test_params();
  params.time_step = 1.0 / 128;
  params.gravity[1] = -1;
  pbf_solver *s = test_create(&desc, &params);
  void *x = test_lattice(dimension, precision, 1);
  for (uint32_t axis = 0; axis < dimension; ++axis) test_put(x, axis, precision, 0.5);
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_ok(pbf_step(s, 20));
  assert_ok(pbf_get_positions(s, 0, 1, x));
  double expected = 0.5 - 20 * 21 / 2 / (128.0 * 128);
  double fallen = test_value(x, 1, precision), aside = test_value(x, 0, precision);
  free(x);
  if (!(fabs(fallen - expected) < 1e-5))
    fail_msg("%uD: at %.9g, not %.9g", dimension, fallen, expected);
  assert_true(fabs(aside - 0.5) < 1e-6);
  pbf_destroy(s);
}

static void free_fall(void **state) {
  (void)state;
  test_for_each_kind(one_particle_falls);
}

/* Below a moving ceiling and beside a moving ball, which lend density. */
static pbf_solver *between_moving_things(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 40);
  pbf_params params = test_params();
  pbf_collider ball;
  params.wall_density = 1;
  params.gravity[1] = 0;
  params.wall_velocity[PBF_WALL_Y_MAX] = -1;
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.radius = 0.1;
  ball.position[0] = -0.3;
  ball.position[1] = 0.3;
  ball.velocity[0] = 1;
  assert_ok(pbf_set_colliders(s, 1, &ball));
  return s;
}

static void add_lattice(pbf_solver *s, uint32_t dimension, uint32_t precision) {
  void *x = test_lattice(dimension, precision, 16);
  assert_ok(pbf_add_particles(s, 16, x, NULL, NULL));
  free(x);
}

static void same_densities(pbf_solver *a, pbf_solver *b, uint32_t precision) {
  _Alignas(8) unsigned char in_a[16 * 8], in_b[16 * 8];
  pbf_stats stats_a = {.struct_size = sizeof stats_a}, stats_b = {.struct_size = sizeof stats_b};
  assert_ok(pbf_get_densities(a, 0, 16, in_a));
  assert_ok(pbf_get_densities(b, 0, 16, in_b));
  for (uint32_t i = 0; i < 16; ++i) {
    double rho_a = test_value(in_a, i, precision), rho_b = test_value(in_b, i, precision);
    if (!(fabs(rho_a - rho_b) < 1e-5)) fail_msg("density %u is %g and %g", i, rho_a, rho_b);
  }
  assert_ok(pbf_get_stats(a, &stats_a));
  assert_ok(pbf_get_stats(b, &stats_b));
  assert_true(fabs(stats_a.density_mean - stats_b.density_mean) < 1e-5);
}

/* After pbf_load the walls and colliders stand where they did for the solver that was saved. */
static void densities_of_a_loaded_state(uint32_t dimension, uint32_t precision) {
  uint64_t size;
  pbf_solver *a = between_moving_things(dimension, precision);
  pbf_solver *b = test_filled(dimension, precision, 3, 40);
  add_lattice(a, dimension, precision);
  pbf_info info = info_of(a);
  while (info.time < 0.5) assert_ok(pbf_step(a, 1)), info = info_of(a);
  void *saved = test_save(a, &size);
  assert_ok(pbf_load(b, saved, size));
  same_densities(a, b, precision);
  free(saved);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void loaded_densities(void **state) {
  (void)state;
  test_for_each_kind(densities_of_a_loaded_state);
}

/* Time goes on without particles, too. */
static void densities_after_empty_steps(uint32_t dimension, uint32_t precision) {
  pbf_solver *a = between_moving_things(dimension, precision);
  pbf_solver *b = between_moving_things(dimension, precision);
  pbf_collider ball;
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_step(a, 60)); /* half a second */
  add_lattice(a, dimension, precision);
  ball = collider_of(a, 0);
  assert_ok(pbf_set_colliders(b, 1, &ball));
  assert_ok(pbf_get_params(b, &params));
  params.domain_max[1] -= info_of(a).time;
  assert_ok(pbf_set_params(b, &params));
  add_lattice(b, dimension, precision);
  same_densities(a, b, precision);
  pbf_destroy(a);
  pbf_destroy(b);
}

static void densities_without_steps(void **state) {
  (void)state;
  test_for_each_kind(densities_after_empty_steps);
}

/* A tank, with a ball in it, that travels. */
typedef struct travel {
  double speed, time_step;
  uint32_t steps;
} travel;

/* Where the water that slumps in it ends, seen from the tank. Then come the densities. */
static double *slumped(uint32_t dimension, uint32_t precision, travel t, uint32_t *count) {
  enum { ACROSS = 6, HIGH = 10 };
  const double speed = t.speed;
  const double spacing = 0.05, size[3] = {0.5, 1, 0.25};
  const uint32_t deep = dimension == 3 ? 5 : 1;
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = t.time_step;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = size[k];
  params.wall_velocity[PBF_WALL_X_MIN] = params.wall_velocity[PBF_WALL_X_MAX] = speed;
  *count = ACROSS * HIGH * deep;
  pbf_desc desc = test_desc(dimension, precision, *count);
  pbf_solver *s = test_create(&desc, &params);
  const double velocity[3] = {speed, 0, 0};
  void *x = calloc((size_t)*count * dimension, precision);
  void *v = calloc((size_t)*count * dimension, precision);
  double *state = calloc((size_t)*count * (dimension + 1), sizeof *state);
  assert_true(x && v && state);
  for (uint32_t i = 0; i < *count; ++i) {
    const uint32_t at[3] = {i % ACROSS, i / ACROSS % HIGH, i / ACROSS / HIGH};
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)i * dimension + k, precision, spacing * (at[k] + 0.5));
      test_put(v, (uint64_t)i * dimension + k, precision, velocity[k]);
    }
  }
  assert_ok(pbf_add_particles(s, *count, x, v, NULL));
  pbf_collider ball;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.position[0] = 0.41;
  ball.position[1] = 0.1;
  ball.position[2] = 0.1;
  ball.radius = 0.1;
  for (int k = 0; k < 3; ++k) ball.velocity[k] = velocity[k];
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_ok(pbf_step(s, t.steps));
  assert_ok(pbf_get_positions(s, 0, *count, x));
  for (uint32_t i = 0; i < *count * dimension; ++i)
    state[i] = test_value(x, i, precision) - velocity[i % dimension] * t.time_step * t.steps;
  if (strcmp(test_backend(), "ballistic") != 0) {
    assert_ok(pbf_get_densities(s, 0, *count, x));
    for (uint32_t i = 0; i < *count; ++i)
      state[*count * dimension + i] = test_value(x, i, precision);
  }
  free(x);
  free(v);
  pbf_destroy(s);
  return state;
}

/* An observer in a moving tank sees what is seen in one that stands, to rounding and what has
 * grown of it. */
static void expect_the_same(uint32_t dimension, uint32_t precision, travel t) {
  const travel none = {0, t.time_step, t.steps};
  uint32_t count;
  double *standing = slumped(dimension, precision, none, &count), place = 0, density = 0;
  double *travelling = slumped(dimension, precision, t, &count);
  for (uint32_t i = 0; i < count * (dimension + 1); ++i) {
    const double off = travelling[i] - standing[i];
    *(i < count * dimension ? &place : &density) += off * off / count;
  }
  const double most = precision == PBF_FLOAT32 ? 2e-3 : 1e-9;
  assert_true(sqrt(place) < most * 0.05);
  assert_true(sqrt(density) < most);
  free(standing);
  free(travelling);
}

/* Steps of usual length, and such as leave most of a density error to those that follow: by three
 * lengths of the tank. */
static void in_a_tank_that_travels(uint32_t dimension, uint32_t precision) {
  expect_the_same(dimension, precision, (travel){4, 1.0 / 128, 40});
  expect_the_same(dimension, precision, (travel){16, 1.0 / 2048, 200});
}

static void nobody_knows_who_travels(void **state) {
  (void)state;
  test_for_each_kind(in_a_tank_that_travels);
}

int main(void) {
  const struct CMUnitTest motion[] = {
      cmocka_unit_test(time_is_no_sum),
      cmocka_unit_test(colliders_move),
      cmocka_unit_test(positions_are_held_against_walls_now),
      cmocka_unit_test(walls_that_meet),
      cmocka_unit_test(free_fall),
      cmocka_unit_test(loaded_densities),
      cmocka_unit_test(densities_without_steps),
      cmocka_unit_test(nobody_knows_who_travels),
  };
  return TEST_RUN(motion);
}
