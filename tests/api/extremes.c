/* Numbers at the edges of their types, each alone in each place: refused by name, or a step later
 * the particles are finite and inside. */
#include <float.h>
#include <stdio.h>

#include "support.h"

typedef struct number {
  const char *name;
  size_t offset;
  uint32_t components;
} number;

#define P(member, components) \
  { #member, offsetof(pbf_params, member), components }
#define C(member, components) \
  { #member, offsetof(pbf_collider, member), components }
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const number in_params[] = {
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  P(name, 1),
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  P(name, count),
#include "physics/params.def"
};

static const number in_collider[] = {C(position, 3),         C(orientation, 4), C(velocity, 3),
                                     C(angular_velocity, 3), C(axis, 3),        C(half_extents, 3),
                                     C(radius, 1),           C(half_length, 1)};

/* Denormal in float64 and in float32, the least normal ones, and the largest of which squares, and
 * they themselves, are numbers. */
static const double edges[] = {5e-324, 1e-39, DBL_MIN, FLT_MIN,  -1e-39,  1e19,
                               -1e19,  1e154, FLT_MAX, -FLT_MAX, DBL_MAX, -DBL_MAX};

/* One thread: there is little to do, and often. */
static pbf_solver *filled(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 12);
  desc.threads = 1;
  pbf_solver *s = test_create(&desc, NULL);
  void *lattice = test_lattice(dimension, precision, 12);
  assert_ok(pbf_add_particles(s, 12, lattice, NULL, NULL));
  free(lattice);
  return s;
}

/* Both dimensions and both precisions, once each. */
static void for_two_kinds(void (*function)(uint32_t dimension, uint32_t precision)) {
  function(2, PBF_FLOAT64);
  function(3, PBF_FLOAT32);
}

static void put(void *object, const number *n, uint32_t component, double value) {
  memcpy((char *)object + n->offset + component * sizeof value, &value, sizeof value);
}

static void label(char *text, size_t size, const char *object, const number *n,
                  uint32_t component) {
  if (n->components == 1) {
    snprintf(text, size, "%s.%s", object, n->name);
  } else {
    snprintf(text, size, "%s.%s[%u]", object, n->name, component);
  }
}

static void runs_or_says_why(pbf_solver *s, uint32_t dimension, uint32_t precision,
                             const char *what, double value) {
  enum { MOST = 12 };
  unsigned char x[MOST * 3 * 8], v[MOST * 3 * 8];
  uint32_t count = 0;
  pbf_status status = pbf_step(s, 2);
  if (status != PBF_OK) {
    assert_true(pbf_last_error()[0]);
    return;
  }
  assert_ok(pbf_get_count(s, &count));
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_get_velocities(s, 0, count, v));
  for (uint32_t i = 0; i < count * dimension; ++i) {
    double position = test_value(x, i, precision), velocity = test_value(v, i, precision);
    /* A wall that has been set elsewhere is where it was set; the stub has none. */
    int is_inside = test_is_stub() || fabs(position) < 3;
    int is_finite = test_is_stub() || (isfinite(position) && isfinite(velocity));
    if (!is_finite || !is_inside)
      fail_msg("%uD f%u: %s = %g leads to the position %g, velocity %g", dimension, 8 * precision,
               what, value, position, velocity);
  }
}

static void edges_in_params(uint32_t dimension, uint32_t precision) {
  for (size_t f = 0; f < LENGTH(in_params); ++f) {
    for (uint32_t c = 0; c < in_params[f].components; ++c) {
      for (size_t t = 0; t < LENGTH(edges); ++t) {
        pbf_solver *s = filled(dimension, precision);
        pbf_params params = test_params();
        char what[64];
        label(what, sizeof what, "params", &in_params[f], c);
        put(&params, &in_params[f], c, edges[t]);
        pbf_status status = pbf_set_params(s, &params);
        if (status == PBF_OK) {
          runs_or_says_why(s, dimension, precision, what, edges[t]);
        } else {
          assert_int_equal(status, PBF_ERROR_INVALID_ARGUMENT);
          assert_non_null(strstr(pbf_last_error(), "params."));
        }
        pbf_destroy(s);
      }
    }
  }
}

static void parameters_at_the_edges(void **state) {
  (void)state;
  for_two_kinds(edges_in_params);
}

/* In a capsule and in a box, that every number means something in one of them. */
static void edges_in_colliders(uint32_t dimension, uint32_t precision) {
  const uint32_t shapes[] = {PBF_COLLIDER_CAPSULE, PBF_COLLIDER_BOX, PBF_COLLIDER_PLANE};
  pbf_solver *s = filled(dimension, precision);
  for (size_t shape = 0; shape < LENGTH(shapes); ++shape) {
    for (size_t f = 0; f < LENGTH(in_collider); ++f) {
      for (uint32_t c = 0; c < in_collider[f].components; ++c) {
        for (size_t t = 0; t < LENGTH(edges); ++t) {
          pbf_collider collider;
          char what[64];
          assert_ok(pbf_collider_init(&collider, sizeof collider, shapes[shape]));
          collider.radius = collider.half_length = 0.1;
          collider.position[0] = collider.position[1] = 0.4;
          collider.angular_velocity[2] = 1;
          label(what, sizeof what, "colliders[0]", &in_collider[f], c);
          put(&collider, &in_collider[f], c, edges[t]);
          pbf_status status = pbf_set_colliders(s, 1, &collider);
          if (status == PBF_OK) {
            runs_or_says_why(s, dimension, precision, what, edges[t]);
          } else {
            assert_int_equal(status, PBF_ERROR_INVALID_ARGUMENT);
            assert_non_null(strstr(pbf_last_error(), "colliders[0]."));
          }
        }
      }
    }
  }
  pbf_destroy(s);
}

static void colliders_at_the_edges(void **state) {
  (void)state;
  for_two_kinds(edges_in_colliders);
}

/* Particles as far apart as a denormal, at a wall and in the middle. */
static void tiny_in_particles(uint32_t dimension, uint32_t precision) {
  const double steps[] = {0, 5e-324, 1e-45, 1e-39, FLT_MIN, DBL_MIN, 1e-30};
  for (size_t t = 0; t < LENGTH(steps); ++t) {
    pbf_solver *s = test_solver(dimension, precision, 12);
    _Alignas(8) unsigned char x[12 * 3 * 8], v[12 * 3 * 8];
    for (uint32_t i = 0; i < 12 * dimension; ++i) {
      double base = i / dimension < 6 ? 0 : 0.5;
      test_put(x, i, precision, base + steps[t] * (i / dimension));
      test_put(v, i, precision, i % 2 ? -steps[t] : steps[t]);
    }
    assert_ok(pbf_add_particles(s, 12, x, v, NULL));
    runs_or_says_why(s, dimension, precision, "particles apart by", steps[t]);
    pbf_destroy(s);
  }
}

/* Every other stage squares velocities, too. */
static void fast_particles(uint32_t dimension, uint32_t precision) {
  for (size_t t = 0; t < LENGTH(edges); ++t) {
    if (precision == PBF_FLOAT32 && fabs(edges[t]) > FLT_MAX) continue;
    pbf_solver *s = filled(dimension, precision);
    pbf_params params = test_params();
    _Alignas(8) unsigned char v[12 * 3 * 8];
    params.vorticity = params.viscosity = params.sleep_speed = 0.1;
    params.sleep_time = 0.5;
    params.damping_compensation = 1;
    assert_ok(pbf_set_params(s, &params));
    for (uint32_t i = 0; i < 12 * dimension; ++i)
      test_put(v, i, precision, i % 3 ? edges[t] : -edges[t]);
    if (fabs(edges[t]) > 1e150) {
      assert_fails(pbf_set_velocities(s, 0, 12, v), PBF_ERROR_INVALID_ARGUMENT, "at most 1e150");
      pbf_destroy(s);
      continue;
    }
    assert_ok(pbf_set_velocities(s, 0, 12, v));
    runs_or_says_why(s, dimension, precision, "velocities", edges[t]);
    pbf_destroy(s);
  }
}

static void speeds_at_the_edges(void **state) {
  (void)state;
  test_for_each_kind(fast_particles);
}

/* A container as far off along a periodic axis as numbers go: no wall ends what it pushes there. */
static void far_containers(uint32_t dimension, uint32_t precision) {
  pbf_desc desc = test_desc(dimension, precision, 12);
  pbf_params params = test_params();
  pbf_collider ball;
  pbf_stats stats = {.struct_size = sizeof stats};
  desc.threads = 1;
  params.periodic = PBF_PERIODIC_X;
  params.collide = PBF_COLLIDE_AFTER_SOLVE;
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  ball.inverted = 1;
  ball.radius = 0.07;
  ball.position[0] = precision == PBF_FLOAT32 ? -3.4e38 : -1e150;
  pbf_solver *s = test_create(&desc, &params);
  void *lattice = test_lattice(dimension, precision, 12);
  assert_ok(pbf_add_particles(s, 12, lattice, NULL, NULL));
  free(lattice);
  assert_ok(pbf_set_colliders(s, 1, &ball));
  for (int k = 0; k < 3; ++k) {
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_stats(s, &stats));
    assert_true(isfinite(stats.speed_max) && isfinite(stats.kinetic_energy));
  }
  uint64_t size = 0;
  assert_ok(pbf_save(s, NULL, &size));
  void *saved = malloc(size);
  assert_ok(pbf_save(s, saved, &size));
  assert_ok(pbf_load(s, saved, size)); /* which refuses what is not finite */
  free(saved);
  pbf_destroy(s);
}

static void containers_far_away(void **state) {
  (void)state;
  for_two_kinds(far_containers);
}

static void tiny_distances(void **state) {
  (void)state;
  test_for_each_kind(tiny_in_particles);
}

/* A dam that breaks gains no energy, whatever the parameters. */
static void expect_no_gain(pbf_params params) {
  enum { ACROSS = 8, HIGH = 16, COUNT = ACROSS * HIGH };
  float positions[2 * COUNT];
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_solver *s = test_solver(2, PBF_FLOAT32, COUNT);
  double d = params.smoothing_radius / 2;
  params.domain_max[0] = params.domain_max[1] = 2 * HIGH * d;
  assert_ok(pbf_set_params(s, &params));
  for (int i = 0; i < COUNT; ++i) {
    positions[2 * i] = (float)(d * (i % ACROSS + 0.5));
    positions[2 * i + 1] = (float)(d * (i / ACROSS + 0.5));
  }
  assert_ok(pbf_add_particles(s, COUNT, positions, NULL, NULL));
  double start = -params.gravity[1] * 0.5 * HIGH * d;
  for (int frame = 0; frame < 12; ++frame) {
    assert_ok(pbf_step(s, 10));
    assert_ok(pbf_get_stats(s, &stats));
    double energy = stats.kinetic_energy - params.gravity[1] * stats.center_of_mass[1];
    assert_true(energy <= 1.001 * start);
  }
  pbf_destroy(s);
}

static void artificial_pressure(void **state) {
  (void)state;
  pbf_params params = test_params();
  params.scorr_k = 10;
  params.scorr_dq = 0.3;
  params.scorr_n = 4;
  expect_no_gain(params);
}

static void viscosity(void **state) {
  (void)state;
  pbf_params params = test_params();
  params.viscosity = 1e5;
  expect_no_gain(params);
}

/* More than a maximum does not act: 1 with PBF_SOLVER_JACOBI. */
static void check_max_viscosity(uint32_t dimension, uint32_t precision, uint32_t solver,
                                double max) {
  uint64_t hashes[2];
  for (int k = 0; k < 2; ++k) {
    pbf_params params = test_params();
    params.solver = solver;
    params.viscosity = k == 0 ? max : 5 * max;
    pbf_solver *s = test_filled(dimension, precision, 100, 100);
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 5));
    hashes[k] = test_hash(s);
    pbf_destroy(s);
  }
  assert_int_equal(hashes[0], hashes[1]);
}

static void check_viscosity(uint32_t dimension, uint32_t precision) {
  check_max_viscosity(dimension, precision, PBF_SOLVER_JACOBI, 1);
  check_max_viscosity(dimension, precision, PBF_SOLVER_CHEBYSHEV, 1e6);
}

static void most_viscosity(void **state) {
  (void)state;
  test_for_each_kind(check_viscosity);
}

static void vorticity(void **state) {
  (void)state;
  pbf_params params = test_params();
  params.vorticity = 1000;
  expect_no_gain(params);
}

/* Three times the fluid that a box has room for, at the largest viscosity. */
static void check_viscous_crowd(uint32_t dimension, uint32_t precision) {
  enum { WIDE = 8 };
  uint32_t count = dimension == 2 ? 2 * WIDE * WIDE : WIDE * WIDE * WIDE;
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_params params = test_params();
  pbf_solver *s = test_solver(dimension, precision, count);
  double d = params.smoothing_radius / 2 * (dimension == 2 ? 0.58 : 0.5);
  void *x = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0, at = i; k < dimension; ++k, at /= WIDE)
      test_put(x, (uint64_t)i * dimension + k, precision,
               d * ((k + 1 < dimension ? at % WIDE : at) + 0.5));
  for (uint32_t k = 0; k < dimension; ++k) params.domain_max[k] = WIDE * d;
  if (dimension == 2) params.domain_max[1] *= 2;
  params.viscosity = 1;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_add_particles(s, count, x, NULL, NULL));
  for (int frame = 0; frame < 20; ++frame) {
    assert_ok(pbf_step(s, 5));
    assert_ok(pbf_get_stats(s, &stats));
    double most = 5 * -params.gravity[1] * WIDE * d;
    if (!test_is_stub() && !(stats.kinetic_energy < most))
      fail_msg("a viscous crowd, %uD: %g of %g", dimension, stats.kinetic_energy, most);
  }
  free(x);
  pbf_destroy(s);
}

static void viscous_crowds(void **state) {
  (void)state;
  for_two_kinds(check_viscous_crowd);
}

int main(void) {
  const struct CMUnitTest extremes[] = {
      cmocka_unit_test(parameters_at_the_edges),
      cmocka_unit_test(colliders_at_the_edges),
      cmocka_unit_test(containers_far_away),
      cmocka_unit_test(tiny_distances),
      cmocka_unit_test(speeds_at_the_edges),
      cmocka_unit_test(artificial_pressure),
      cmocka_unit_test(viscosity),
      cmocka_unit_test(most_viscosity),
      cmocka_unit_test(vorticity),
      cmocka_unit_test(viscous_crowds),
  };
  return TEST_RUN(extremes);
}
