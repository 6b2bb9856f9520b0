/* Many colliders, of which the CPU solver looks at those near a group of particles, against the
 * reference, which looks at all of them for each. */
#include "cpu_support.h"

#include <math.h>

enum { FEW = 64, MOST = 300, SIDE_3D = 14, SIDE_2D = 50, SCENES_3D = 12, SCENES_2D = 100 };

static const double spacing = 0.05;

static double between(uint64_t *random, double low, double high) {
  return low + (high - low) * cpu_random(random);
}

static void turn_at_random(uint64_t *random, uint32_t dimension, double orientation[4]) {
  double norm2 = 0;
  for (int k = 0; k < 4; ++k) {
    orientation[k] = k < 2 && dimension == 2 ? 0 : between(random, -1, 1);
    norm2 += orientation[k] * orientation[k];
  }
  for (int k = 0; k < 4; ++k) orientation[k] /= sqrt(norm2);
}

/* Some stand, some cross several particles in a step, some spin by a radian in it; the last ones
 * hold all of the fluid, or are planes under it. */
static void colliders_at_random(uint64_t *random, uint32_t dimension, double side, double dt,
                                uint32_t count, pbf_collider *colliders) {
  for (uint32_t i = 0; i < count; ++i) {
    pbf_collider *c = &colliders[i];
    int holds = i >= count - 4, moves = cpu_random(random) < 0.7;
    assert_ok(pbf_collider_init(c, sizeof *c, i % 4));
    c->inverted = holds && c->shape != PBF_COLLIDER_PLANE;
    c->radius = holds ? side : between(random, 0.2, 1.5) * spacing;
    c->half_length = between(random, 0.2, 3) * spacing;
    turn_at_random(random, dimension, c->orientation);
    for (uint32_t k = 0; k < dimension; ++k) {
      c->half_extents[k] = holds ? side : between(random, 0.1, 2) * spacing;
      c->position[k] = holds ? 0.5 * side : between(random, -0.1, 1.1) * side;
      c->velocity[k] = moves && !holds ? between(random, -2, 2) * spacing / dt : 0;
    }
    c->angular_velocity[2] = moves && !holds ? between(random, -1, 1) / dt : 0;
    if (c->shape != PBF_COLLIDER_PLANE) continue;
    /* A floor, a little aslant. */
    c->position[1] = -0.2 * spacing;
    for (int k = 0; k < 4; ++k) c->orientation[k] = k == 3;
    c->axis[0] = 0.01;
    for (int k = 0; k < 3; ++k) c->velocity[k] = c->angular_velocity[k] = 0;
  }
}

static pbf_solver *scene(const char *backend, uint32_t dimension, uint64_t seed) {
  uint64_t random = seed;
  uint32_t side = dimension == 3 ? SIDE_3D : SIDE_2D;
  uint32_t count = side * side * (dimension == 3 ? side : 1);
  double *x = calloc((size_t)count * dimension, sizeof *x),
         *v = calloc((size_t)count * dimension, sizeof *v);
  pbf_collider colliders[MOST];
  const uint32_t crowd = seed % 4 == 0 ? MOST : FEW;
  pbf_params params;
  assert_true(x && v);
  assert_ok(pbf_params_init(&params, sizeof params));
  params.iterations = 1; /* so that lists and cells find the same neighbours */
  params.pressure_grid = params.prestabilization = 0;
  params.solver = seed % 3 == 0 ? PBF_SOLVER_JACOBI : PBF_SOLVER_CHEBYSHEV;
  params.collide = seed % 2 == 0 ? 7 : PBF_COLLIDE_AFTER_PREDICTION | PBF_COLLIDE_IN_ITERATION;
  for (uint32_t k = 0; k < 3; ++k) {
    params.domain_min[k] = -4 * spacing;
    params.domain_max[k] = spacing * (side + 4);
  }
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t at[3] = {i % side, i / side % side, i / side / side};
    for (uint32_t k = 0; k < dimension; ++k) {
      x[(size_t)i * dimension + k] = spacing * (at[k] + 0.5 + between(&random, -0.1, 0.1));
      v[(size_t)i * dimension + k] = between(&random, -1, 1) * spacing / params.time_step;
    }
  }
  colliders_at_random(&random, dimension, spacing * side, params.time_step, crowd, colliders);
  pbf_desc desc = cpu_desc(backend, dimension, PBF_FLOAT64, count, 2);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, crowd, colliders));
  cpu_add(s, PBF_FLOAT64, dimension, count, x, v);
  assert_ok(pbf_step(s, 1));
  free(x), free(v);
  return s;
}

/* A collider that is not looked at shows by 1e-3 spacings and more. Where three planes nearly meet
 * in a line the point that they hold a particle at multiplies rounding, in one of these 33,000 by
 * 1e8.
 */
static void compare(uint32_t dimension) {
  uint64_t scenes = dimension == 3 ? SCENES_3D : SCENES_2D;
  if (!test_has_kind(dimension, PBF_FLOAT64)) test_skip("not in this build");
  for (uint64_t seed = 1; seed <= scenes; ++seed) {
    pbf_solver *s = scene("serial", dimension, seed);
    pbf_solver *expected = scene("reference", dimension, seed);
    double off = cpu_difference(s, expected, PBF_FIELD_POSITION);
    if (!(off < 1e-6 * spacing))
      fail_msg("%uD, scene %u: %g spacings off", dimension, (unsigned)seed, off / spacing);
    off = cpu_difference(s, expected, PBF_FIELD_DENSITY);
    if (!(off < 1e-6))
      fail_msg("%uD, scene %u: a density is %g off", dimension, (unsigned)seed, off);
    pbf_destroy(s);
    pbf_destroy(expected);
  }
}

static void many_in_2d(void **state) {
  (void)state;
  compare(2);
}

static void many_in_3d(void **state) {
  (void)state;
  compare(3);
}

/* A crowd in a corner, deep in its walls, where these lend each for itself too. */
static pbf_solver *crowd_in_corner(uint32_t dimension, uint32_t precision, uint64_t seed,
                                   double collider_at) {
  enum { CROWD = 6 };
  uint64_t random = seed;
  double x[CROWD * 3], v[CROWD * 3] = {0};
  pbf_collider collider;
  pbf_params params;
  assert_ok(pbf_params_init(&params, sizeof params));
  params.prestabilization = 0;
  params.iterations = 1;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = 100 * spacing;
  for (uint32_t i = 0; i < CROWD * dimension; ++i) x[i] = between(&random, 0, 2 * spacing);
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_SPHERE));
  collider.radius = 0.1 * spacing;
  for (uint32_t k = 0; k < dimension; ++k) collider.position[k] = k == 0 ? collider_at : spacing;
  pbf_desc desc = cpu_desc("serial", dimension, precision, CROWD, 1);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, 1, &collider));
  cpu_add(s, precision, dimension, CROWD, x, v);
  assert_ok(pbf_step(s, 1));
  return s;
}

/* The one is near enough to be asked about, but not to any particle; the other is not asked about.
 */
static void one_near_nobody(uint32_t dimension, uint32_t precision) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    pbf_solver *near = crowd_in_corner(dimension, precision, seed, 4.2 * spacing);
    pbf_solver *far = crowd_in_corner(dimension, precision, seed, 90 * spacing);
    assert_true(cpu_difference(near, far, PBF_FIELD_POSITION) == 0);
    assert_true(cpu_difference(near, far, PBF_FIELD_DENSITY) == 0);
    pbf_destroy(near);
    pbf_destroy(far);
  }
}

static void one_that_meets_nobody(void **state) {
  (void)state;
  test_for_each_kind(one_near_nobody);
}

/* Particles that are all neighbours, and part, next to a box that is near some of them sooner or
 * later. */
static pbf_solver *crowd_that_parts(const char *backend, uint32_t dimension, uint64_t seed) {
  enum { CROWD = 5 };
  uint64_t random = seed;
  double x[CROWD * 3], v[CROWD * 3] = {0};
  pbf_collider collider;
  pbf_params params;
  assert_ok(pbf_params_init(&params, sizeof params));
  params.prestabilization = params.pressure_grid = 0;
  params.iterations = 4;
  for (uint32_t k = 0; k < 3; ++k) params.domain_max[k] = 100 * spacing;
  for (uint32_t i = 0; i < CROWD * dimension; ++i)
    x[i] = (50 + between(&random, -0.25, 0.25)) * spacing;
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_BOX));
  for (uint32_t k = 0; k < dimension; ++k) {
    collider.half_extents[k] = 10 * spacing;
    collider.position[k] = 50 * spacing;
  }
  collider.position[0] = (60 + between(&random, 1, 2.5)) * spacing;
  pbf_desc desc = cpu_desc(backend, dimension, PBF_FLOAT64, CROWD, 1);
  pbf_solver *s = test_create(&desc, &params);
  assert_ok(pbf_set_colliders(s, 1, &collider));
  cpu_add(s, PBF_FLOAT64, dimension, CROWD, x, v);
  assert_ok(pbf_step(s, 1));
  return s;
}

/* Whether one is near them changes from iteration to iteration. */
static void one_that_comes_near(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension)
    for (uint64_t seed = 1; seed <= 200 && test_has_kind(dimension, PBF_FLOAT64); ++seed) {
      pbf_solver *s = crowd_that_parts("serial", dimension, seed);
      pbf_solver *expected = crowd_that_parts("reference", dimension, seed);
      const double off = cpu_difference(s, expected, PBF_FIELD_POSITION);
      if (!(off < 1e-6 * spacing))
        fail_msg("%uD, scene %u: %g spacings off", dimension, (unsigned)seed, off / spacing);
      pbf_destroy(s);
      pbf_destroy(expected);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(many_in_2d), cmocka_unit_test(many_in_3d),
                                     cmocka_unit_test(one_that_meets_nobody),
                                     cmocka_unit_test(one_that_comes_near)};
  return TEST_RUN(tests);
}
