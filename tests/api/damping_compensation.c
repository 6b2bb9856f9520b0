/* What implicit steps take from a fluid's rotation, and what `damping_compensation` and
 * `angular_momentum_correction` give back. */
#include "support.h"

#include <math.h>

static const double rate = 1, time_step = 0.01;
enum { STEPS = 120 };

/* Particles along a radius. */
static int across(uint32_t dimension) { return dimension == 2 ? 10 : 6; }

/* A disc, or a ball, of radius 1 about the origin that turns about the z axis. */
typedef struct body {
  uint32_t dimension, precision, count;
  pbf_solver *solver;
  void *x, *v;
} body;

static int within(const double at[3], uint32_t dimension) {
  double r2 = 0;
  for (uint32_t k = 0; k < dimension; ++k) r2 += at[k] * at[k];
  return r2 < 1;
}

/* Fills x and v, unless they are null; the number of particles. */
static uint32_t place(const body *b) {
  uint32_t count = 0;
  const int most = across(b->dimension), deep = b->dimension == 3 ? most : 0;
  const double spacing = 1.0 / most;
  for (int i = -most; i <= most; ++i)
    for (int j = -most; j <= most; ++j)
      for (int k = -deep; k <= deep; ++k) {
        const double at[3] = {i * spacing, j * spacing, k * spacing};
        const double v[3] = {-rate * at[1], rate * at[0], 0};
        if (!within(at, b->dimension)) continue;
        for (uint32_t a = 0; a < b->dimension && b->x; ++a) {
          test_put(b->x, (uint64_t)count * b->dimension + a, b->precision, at[a]);
          test_put(b->v, (uint64_t)count * b->dimension + a, b->precision, v[a]);
        }
        ++count;
      }
  return count;
}

static pbf_params params_of(uint32_t dimension, double damping_compensation) {
  pbf_params p = test_params();
  p.spacing = 1.0 / across(dimension);
  p.smoothing_radius = (dimension == 2 ? 3 : 2) * p.spacing;
  p.time_step = time_step;
  p.iterations = 8;
  p.pressure_grid = 0;
  p.damping_compensation = damping_compensation;
  p.angular_momentum_correction = 0;
  for (int k = 0; k < 3; ++k) {
    p.gravity[k] = 0;
    p.domain_min[k] = -3;
    p.domain_max[k] = 3;
  }
  return p;
}

static body body_of(uint32_t dimension, uint32_t precision, const pbf_params *params) {
  body b = {dimension, precision, 0, NULL, NULL, NULL};
  b.count = place(&b);
  pbf_desc desc = test_desc(dimension, precision, b.count);
  b.solver = test_create(&desc, params);
  b.x = calloc((size_t)b.count * dimension, precision);
  b.v = calloc((size_t)b.count * dimension, precision);
  place(&b);
  assert_ok(pbf_add_particles(b.solver, b.count, b.x, b.v, NULL));
  return b;
}

static void destroy(body *b) {
  pbf_destroy(b->solver);
  free(b->x);
  free(b->v);
}

/* About the origin and the z axis; and the linear momentum, over the sum of all speeds. */
static double angular_momentum(body *b, double *drift) {
  double sum = 0, speeds = 0, p[2] = {0, 0};
  assert_ok(pbf_get_positions(b->solver, 0, b->count, b->x));
  assert_ok(pbf_get_velocities(b->solver, 0, b->count, b->v));
  for (uint32_t i = 0; i < b->count; ++i) {
    double x[2], v[2];
    for (uint32_t k = 0; k < 2; ++k) {
      x[k] = test_value(b->x, (uint64_t)i * b->dimension + k, b->precision);
      v[k] = test_value(b->v, (uint64_t)i * b->dimension + k, b->precision);
      p[k] += v[k];
    }
    sum += x[0] * v[1] - x[1] * v[0];
    speeds += hypot(v[0], v[1]);
  }
  *drift = hypot(p[0], p[1]) / speeds;
  return sum;
}

/* What the angular momentum becomes, over what it was. */
static double kept(body *b, double *drift) {
  double before = angular_momentum(b, drift);
  assert_ok(pbf_step(b->solver, STEPS));
  return angular_momentum(b, drift) / before;
}

/* Held together by attraction, of A r: the pushes of a step carry (A - rate²) r outwards, along
 * where it is at the end of a step, not at its start, and so turn it by (A - rate²) dt of its
 * angular momentum in a time unit, faster. */
static void check_free(uint32_t dimension, uint32_t precision) {
  const double attraction = 3, gain = (attraction - rate * rate) * time_step * time_step * STEPS;
  double left[2], drift[2];
  for (int on = 0; on < 2; ++on) {
    pbf_params params = params_of(dimension, on);
    params.attraction = attraction;
    body b = body_of(dimension, precision, &params);
    left[on] = kept(&b, &drift[on]) - 1;
    destroy(&b);
  }
  if (!(fabs(left[0] - gain) < 0.4 * gain && fabs(left[1]) < 0.15 * gain && drift[1] < 2e-6))
    fail_msg(
        "%uD: angular momentum changes by %g (%g in theory), with damping_compensation by %g; "
        "linear: %g",
        dimension, left[0], gain, left[1], drift[1]);
}

/* Whatever pairs do to each other: the body turns, and is torn into a spiral by an attraction that
 * is too weak to hold it. */
static void check_torque(uint32_t dimension, uint32_t precision) {
  const double rounding = precision == PBF_FLOAT32 ? 1e-6 : 1e-13;
  for (int damping_compensation = 0; damping_compensation < 2; ++damping_compensation)
    for (int strong = 0; strong < 2; ++strong) {
      pbf_params params = params_of(dimension, damping_compensation);
      params.attraction = strong ? 3 : 0.3;
      params.angular_momentum_correction = strong ? 1 : -1; /* which is 1 without gravity */
      body b = body_of(dimension, precision, &params);
      double drift, left = kept(&b, &drift) - 1;
      destroy(&b);
      if (!(fabs(left) < rounding && drift < 2e-6))
        fail_msg("%uD, damping_compensation %d: angular momentum changes by %g, linear by %g",
                 dimension, damping_compensation, left, drift);
    }
}

/* The lattice does not fit a wall, and what settles there changes the angular momentum, too: it has
 * settled before the body turns. */
static void settle(body *b) {
  memset(b->v, 0, (size_t)b->count * b->dimension * b->precision);
  assert_ok(pbf_set_velocities(b->solver, 0, b->count, b->v));
  assert_ok(pbf_step(b->solver, STEPS));
  assert_ok(pbf_get_positions(b->solver, 0, b->count, b->x));
  for (uint32_t i = 0; i < b->count; ++i) {
    const uint64_t first = (uint64_t)i * b->dimension;
    test_put(b->v, first, b->precision, -rate * test_value(b->x, first + 1, b->precision));
    test_put(b->v, first + 1, b->precision, rate * test_value(b->x, first, b->precision));
  }
  assert_ok(pbf_set_velocities(b->solver, 0, b->count, b->v));
}

/* In a round basin it is the wall that pushes, by rate² r inwards, and takes rate² dt. */
static void check_basin(uint32_t dimension, uint32_t precision) {
  const double loss = rate * rate * time_step * time_step * STEPS;
  double left[2], drift;
  for (int on = 0; on < 2; ++on) {
    pbf_params params = params_of(dimension, on);
    pbf_collider basin;
    body b = body_of(dimension, precision, &params);
    assert_ok(pbf_collider_init(&basin, sizeof basin, PBF_COLLIDER_SPHERE));
    basin.inverted = 1;
    basin.radius = 1;
    assert_ok(pbf_set_colliders(b.solver, 1, &basin));
    settle(&b);
    left[on] = kept(&b, &drift) - 1;
    destroy(&b);
  }
  if (!(fabs(left[0] + loss) < 0.4 * loss && left[1] > left[0] + 0.6 * loss &&
        fabs(left[1]) < 0.4 * loss))
    fail_msg("%uD: angular momentum changes by %g (%g in theory), with damping_compensation by %g",
             dimension, left[0], -loss, left[1]);
}

/* A block flies into a corner by 0.9 spacings a step. */
static void throw_block(uint32_t precision, double spacings, uint32_t iterations) {
  enum { WIDE = 20 };
  const double spacing = 1.0 / WIDE;
  pbf_params p = params_of(2, 1);
  pbf_desc desc = test_desc(2, precision, WIDE * WIDE);
  p.spacing = spacing;
  p.smoothing_radius = spacings * spacing;
  p.time_step = 0.9 * spacing;
  p.iterations = iterations;
  for (int k = 0; k < 3; ++k) p.domain_min[k] = 0, p.domain_max[k] = 2;
  pbf_solver *s = test_create(&desc, &p);
  void *x = calloc(2 * WIDE * WIDE, precision), *v = calloc(2 * WIDE * WIDE, precision);
  assert_non_null(x);
  assert_non_null(v);
  for (uint32_t i = 0; i < WIDE * WIDE; ++i) {
    test_put(x, 2 * i, precision, 0.2 + spacing * (i % WIDE + 0.5));
    test_put(x, 2 * i + 1, precision, 0.2 + spacing * (i / WIDE + 0.5));
    test_put(v, 2 * i, precision, -1);
    test_put(v, 2 * i + 1, precision, -0.7);
  }
  assert_ok(pbf_add_particles(s, WIDE * WIDE, x, v, NULL));
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  double start = stats.kinetic_energy;
  for (int k = 0; k < 10; ++k) {
    assert_ok(pbf_step(s, 6));
    assert_ok(pbf_get_stats(s, &stats));
    if (!(stats.kinetic_energy < 1.02 * start))
      fail_msg("h %g, %u iterations: a block ends with %g of its energy", spacings, iterations,
               stats.kinetic_energy / start);
  }
  free(x);
  free(v);
  pbf_destroy(s);
}

static void check_impact(uint32_t dimension, uint32_t precision) {
  if (dimension != 2) return;
  throw_block(precision, 1.6, 4);
  throw_block(precision, 2, 16);
  throw_block(precision, 2.5, 16);
}

static void impacts_gain_nothing(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_impact);
}

static void free_rotation_is_kept(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no pairs");
  test_for_long_kinds(check_free);
}

static void pairs_exert_no_torque(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no pairs");
  test_for_long_kinds(check_torque);
}

/* Where walls carry a weight, nothing is paid for what they give of angular momentum. */
static void gravity_needs_no_correction(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no pairs");
  uint64_t hashes[2];
  for (int off = 0; off < 2; ++off) {
    pbf_params params = params_of(2, 0);
    params.gravity[1] = -1;
    params.angular_momentum_correction = off ? 0 : -1;
    body b = body_of(2, PBF_FLOAT32, &params);
    assert_ok(pbf_step(b.solver, 20));
    hashes[off] = test_hash(b.solver);
    destroy(&b);
  }
  assert_true(hashes[0] == hashes[1]);
}

static void rotation_in_a_basin_is_kept(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no colliders");
  check_basin(2, PBF_FLOAT32);
}

int main(void) {
  const struct CMUnitTest damping_compensation[] = {
      cmocka_unit_test(free_rotation_is_kept),       cmocka_unit_test(pairs_exert_no_torque),
      cmocka_unit_test(gravity_needs_no_correction), cmocka_unit_test(rotation_in_a_basin_is_kept),
      cmocka_unit_test(impacts_gain_nothing),
  };
  return TEST_RUN(damping_compensation);
}
