/* Phases that are listed, and of which there is no fluid: oil that is to come. Water is what it is
 * without them. */
#include "support.h"

#include <math.h>

#include <pbf/phases.h>

static const double d = 0.05, gravity = 9.81;

enum { LAYERS = 24, WIDE = 12, DEEP = 8, MOST = WIDE * LAYERS * DEEP };

static pbf_phase phase_of(double density) {
  pbf_phase phase;
  assert_ok(pbf_phase_init(&phase, sizeof phase));
  phase.rest_density = density;
  return phase;
}

/* A pool that is deep for steps of 1/60 s. */
static pbf_solver *pool(uint32_t dimension, uint32_t precision, double density) {
  static double points[3 * MOST];
  const uint32_t count = WIDE * LAYERS * (dimension == 3 ? DEEP : 1);
  pbf_params params = test_params();
  params.spacing = d;
  params.smoothing_radius = 2 * d;
  params.time_step = 1.0 / 60;
  params.attraction = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    params.gravity[k] = k == 1 ? -gravity : 0;
    params.domain_max[k] = k == 0 ? WIDE * d : k == 1 ? 2 : dimension == 3 ? DEEP * d : 1;
  }
  const pbf_desc desc = test_desc(dimension, precision, count);
  pbf_solver *s = test_create(&desc, &params);
  const pbf_phase phases[2] = {phase_of(1), phase_of(density)};
  assert_ok(pbf_set_phases(s, 2, phases));
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t at[3] = {i % WIDE, i / WIDE % LAYERS, i / WIDE / LAYERS};
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(points, (uint64_t)i * dimension + k, precision, d * (at[k] + 0.5));
  }
  assert_ok(pbf_add_particles(s, count, points, NULL, NULL));
  return s;
}

static pbf_stats after(pbf_solver *s, uint32_t steps) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_step(s, steps));
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

/* It stands as high as its volume, is pressed by no more than water is in such steps, and rests. */
static void check_calm(uint32_t dimension, const pbf_stats *stats, double density) {
  const double level = stats->center_of_mass[1] / (0.5 * LAYERS * d);
  const double denser = stats->density_error_mean;
  if (!(fabs(level - 1) < 0.01) || !(denser < 0.006) || !(stats->speed_max < 0.15))
    fail_msg("%uD, with a fluid of %g listed: at %g of its level, denser by %g, %g m/s", dimension,
             density, level, denser, stats->speed_max);
}

static void check_unused(uint32_t dimension, uint32_t precision) {
  const double densities[] = {0.5, 0.3, 2};
  for (int k = 0; k < 3; ++k) {
    pbf_solver *s = pool(dimension, precision, densities[k]);
    const pbf_stats stats = after(s, 150);
    check_calm(dimension, &stats, densities[k]);
    pbf_destroy(s);
  }
}

static void water_is_what_it_is_without_oil(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_unused);
}

/* A drop of it comes, and goes: the pool is none the worse for it afterwards. A state that is saved
 * in between goes on as it does. */
static void check_drop(uint32_t dimension, uint32_t precision) {
  const uint32_t oil[4] = {1, 1, 1, 1}, water[4] = {0, 0, 0, 0};
  uint64_t size;
  pbf_solver *s = pool(dimension, precision, 0.8), *other = pool(dimension, precision, 0.8);
  (void)after(s, 40);
  assert_ok(pbf_set_particle_phases(s, WIDE * (LAYERS - 1), 4, oil));
  (void)after(s, 40);
  assert_ok(pbf_set_particle_phases(s, WIDE * (LAYERS - 1), 4, water));
  (void)after(s, 40);
  void *saved = test_save(s, &size);
  assert_ok(pbf_load(other, saved, size));
  free(saved);
  const pbf_stats stats = after(s, 150);
  (void)after(other, 150);
  check_calm(dimension, &stats, 0.8);
  assert_int_equal(test_hash(s), test_hash(other));
  pbf_destroy(s);
  pbf_destroy(other);
}

static void a_drop_comes_and_goes(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_drop);
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_is_what_it_is_without_oil),
      cmocka_unit_test(a_drop_comes_and_goes),
  };
  return TEST_RUN(tests);
}
