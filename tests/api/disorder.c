/* Water that is no lattice comes to rest, too: by the last step's pressure, of which each takes
 * over a part where pairs alone carry the weight, and which saved states hold. */
#include "support.h"

#include <math.h>
#include <stdio.h>

enum { ACROSS = 40, LAYERS = 15, COUNT = ACROSS * LAYERS };
static const double spacing = 0.05;

static pbf_params params_of(void) {
  pbf_params p = test_params();
  p.spacing = spacing;
  p.smoothing_radius = 2 * spacing;
  p.time_step = 1.0 / 120;
  p.iterations = 4;
  p.domain_max[0] = ACROSS * spacing;
  p.domain_max[1] = 2 * LAYERS * spacing;
  return p;
}

/* Places drawn at random in what water of so many layers takes. */
static pbf_solver *pool(uint32_t precision, const pbf_params *params, uint32_t draw) {
  const pbf_desc desc = test_desc(2, precision, COUNT);
  pbf_solver *s = test_create(&desc, params);
  char *x = malloc((size_t)COUNT * 2 * sizeof(double));
  uint32_t random = draw;
  assert_non_null(x);
  for (uint32_t i = 0; i < 2 * COUNT; ++i) {
    random = random * 1664525u + 1013904223u;
    test_put(x, i, precision, (i % 2 ? LAYERS : ACROSS) * spacing * ((random >> 8) / 16777216.0));
  }
  assert_ok(pbf_add_particles(s, COUNT, x, NULL, NULL));
  free(x);
  return s;
}

/* Root mean square of speeds over sqrt(g d), in the last fifth of a second of twenty. */
static double stirring(pbf_solver *s) {
  enum { STEPS = 2400, LOOKS = 24 };
  double sum = 0;
  assert_ok(pbf_step(s, STEPS - LOOKS));
  for (int k = 0; k < LOOKS; ++k) {
    pbf_stats stats = {.struct_size = sizeof stats};
    assert_ok(pbf_step(s, 1));
    assert_ok(pbf_get_stats(s, &stats));
    sum += 2 * stats.kinetic_energy / LOOKS;
  }
  return sqrt(sum / (9.81 * spacing));
}

/* Without that these draws move on at 0.18 to 0.21. */
static void check_rest(uint32_t precision, uint32_t draw) {
  const pbf_params params = params_of();
  pbf_solver *s = pool(precision, &params, draw);
  const double speed = stirring(s);
  pbf_destroy(s);
  if (!(speed < 0.02)) fail_msg("draw %u moves by %g of sqrt(g d)", draw, speed);
}

static void disordered_water_comes_to_rest(void **state) {
  (void)state;
  test_skip_if_watched();
  check_rest(PBF_FLOAT32, 1);
  check_rest(PBF_FLOAT32, 3);
  check_rest(PBF_FLOAT64, 5);
}

/* The same bits after a load, which the last pressure has a say in. */
static void pressure_is_saved(void **state) {
  (void)state;
  const pbf_params params = params_of();
  pbf_solver *a = pool(PBF_FLOAT32, &params, 4), *b = pool(PBF_FLOAT32, &params, 5);
  uint64_t size;
  assert_ok(pbf_step(a, 30));
  void *saved = test_save(a, &size);
  assert_ok(pbf_step(b, 7));
  assert_ok(pbf_load(b, saved, size));
  for (int k = 0; k < 5; ++k) {
    assert_ok(pbf_step(a, 1));
    assert_ok(pbf_step(b, 1));
    assert_int_equal(test_hash(a), test_hash(b));
  }
  free(saved);
  pbf_destroy(a);
  pbf_destroy(b);
}

/* Where they are in a saved state: of the header, and behind the velocities, at the end. */
enum { AT_HEADER_SIZE = 12, AT_KEPT = 44, KEPT_PRESSURES = 4, CHECKSUM = 8 };
enum { BYTES = COUNT * (int)sizeof(float) };

static uint32_t kept_in(const char *saved) {
  uint32_t kept;
  memcpy(&kept, saved + AT_KEPT, sizeof kept);
  return kept;
}

/* Some of a state's pressures are not 0. */
static int has_pressures(pbf_solver *s) {
  uint64_t size;
  char *saved = test_save(s, &size);
  float pressures[COUNT], most = 0;
  assert_true(kept_in(saved) & KEPT_PRESSURES);
  memcpy(pressures, saved + size - CHECKSUM - BYTES, sizeof pressures);
  for (int i = 0; i < COUNT; ++i) most = pressures[i] > most ? pressures[i] : most;
  free(saved);
  return most > 0;
}

/* A pressure grid, or a correction of shear stress in every third step, leaves pressure alone, but
 * not a correction that steps are too long for. */
static void check_where(double grid, double correction, double time_step, int smoothed) {
  pbf_params params = params_of();
  params.pressure_grid = grid;
  params.shear_stress_correction = correction;
  params.time_step = time_step;
  pbf_solver *s = pool(PBF_FLOAT32, &params, 6);
  assert_ok(pbf_step(s, 20));
  assert_int_equal(has_pressures(s), smoothed);
  pbf_destroy(s);
}

static void pairs_alone_carry_the_weight(void **state) {
  (void)state;
  const double usual = 1.0 / 120, too_long = 1.01 * sqrt(0.5 * spacing / 9.81);
  check_where(0, 0, usual, 1);
  check_where(-1, -1, usual, 1); /* by default, so shallow */
  check_where(2, 0, usual, 0);
  check_where(0, 0.75, usual, 0);
  check_where(0, 0.75, too_long, 1);
}

/* Parameters that end smoothing forget the pressure. */
static void a_grid_forgets_pressure(void **state) {
  (void)state;
  pbf_params params = params_of();
  pbf_solver *s = pool(PBF_FLOAT32, &params, 7);
  assert_ok(pbf_step(s, 20));
  assert_true(has_pressures(s));
  params.pressure_grid = 2;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 1));
  assert_false(has_pressures(s));
  pbf_destroy(s);
}

/* As versions have written it that knew none: the section is cut out. */
static uint64_t without_pressures(char *saved, uint64_t size) {
  uint32_t header, none = 0;
  const uint64_t shorter = size - BYTES;
  memcpy(&header, saved + AT_HEADER_SIZE, sizeof header);
  memcpy(saved + AT_KEPT, &none, sizeof none);
  memcpy(saved + header - sizeof shorter, &shorter, sizeof shorter);
  test_seal(saved, shorter);
  return shorter;
}

static void states_without_pressure_load(void **state) {
  (void)state;
  const pbf_params params = params_of();
  pbf_solver *s = pool(PBF_FLOAT32, &params, 8);
  uint64_t size;
  assert_ok(pbf_step(s, 20));
  char *saved = test_save(s, &size);
  const uint64_t shorter = without_pressures(saved, size);
  const uint64_t hash = test_hash(s);
  assert_ok(pbf_load(s, saved, shorter));
  assert_int_equal(test_hash(s), hash);
  assert_false(has_pressures(s));
  free(saved);
  pbf_destroy(s);
}

/* The paper's solver has none that could be kept. */
static void a_forged_state(void **state) {
  (void)state;
  pbf_params params = params_of();
  pbf_solver *s = pool(PBF_FLOAT32, &params, 9);
  uint64_t size;
  assert_ok(pbf_step(s, 5));
  char *saved = test_save(s, &size);
  uint32_t header, kept = KEPT_PRESSURES;
  params.solver = PBF_SOLVER_JACOBI;
  assert_ok(pbf_set_params(s, &params));
  uint64_t other_size;
  char *other = test_save(s, &other_size);
  assert_int_equal(kept_in(other), 0);
  assert_int_equal(other_size, size - BYTES);
  memcpy(&header, other + AT_HEADER_SIZE, sizeof header);
  memcpy(saved, other, other_size);
  memcpy(saved + AT_KEPT, &kept, sizeof kept);
  memcpy(saved + header - sizeof size, &size, sizeof size);
  test_seal(saved, size);
  assert_fails(pbf_load(s, saved, size), PBF_ERROR_DATA, "pressures");
  free(saved);
  free(other);
  pbf_destroy(s);
}

/* The stub has no fluid. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(disordered_water_comes_to_rest), cmocka_unit_test(pressure_is_saved),
      cmocka_unit_test(pairs_alone_carry_the_weight),   cmocka_unit_test(a_grid_forgets_pressure),
      cmocka_unit_test(states_without_pressure_load),   cmocka_unit_test(a_forged_state)};
  return TEST_RUN(tests);
}
