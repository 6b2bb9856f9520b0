/* Deep water on a periodic axis: its pressure grid goes on over the axis' faces. */
#include <math.h>

#include "support.h"

static const double d = 0.05, gravity = 9.81, pi = 3.14159265358979323846;

typedef struct water {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
  double wide, deep; /* in spacings; the tank is eight of them across */
  double *x, *v;     /* read back */
} water;

enum { ACROSS = 8 };

/* How deep it is at x, and its velocity there; null: at rest. */
typedef uint32_t (*layers_fn)(const water *w, double x);
typedef void (*velocity_fn)(const water *w, const double x[3], double v[3]);

static uint32_t fill(const water *w, layers_fn layers, velocity_fn velocity, void *x, void *v) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < (uint32_t)w->wide; ++i)
    for (uint32_t j = 0; j < layers(w, d * (i + 0.5)); ++j)
      for (uint32_t k = 0; k < (w->dimension == 3 ? ACROSS : 1); ++k, ++count) {
        const double place[3] = {d * (i + 0.5), d * (j + 0.5), d * (k + 0.5)};
        double moves[3] = {0, 0, 0};
        if (velocity) velocity(w, place, moves);
        for (uint32_t axis = 0; axis < w->dimension; ++axis) {
          const uint64_t at = (uint64_t)count * w->dimension + axis;
          test_put(x, at, w->precision, place[axis]);
          test_put(v, at, w->precision, moves[axis]);
        }
      }
  return count;
}

static water begin(uint32_t dimension, uint32_t precision, double wide, double deep,
                   layers_fn layers, velocity_fn velocity) {
  water w = {.dimension = dimension, .precision = precision, .wide = wide, .deep = deep};
  const uint32_t most = (uint32_t)(wide * deep) * (dimension == 3 ? ACROSS : 1);
  const pbf_desc desc = test_desc(dimension, precision, most);
  pbf_params params = test_params();
  params.periodic = PBF_PERIODIC_X;
  params.time_step = 1.0 / 60;
  for (int k = 0; k < 3; ++k) params.domain_min[k] = 0;
  params.domain_max[0] = wide * d;
  params.domain_max[1] = 1.5 * deep * d;
  params.domain_max[2] = ACROSS * d;
  char *x = calloc(3 * (size_t)most, precision), *v = calloc(3 * (size_t)most, precision);
  w.x = calloc(3 * (size_t)most, sizeof *w.x);
  w.v = calloc(3 * (size_t)most, sizeof *w.v);
  assert_true(x && v && w.x && w.v);
  w.solver = test_create(&desc, &params);
  w.count = fill(&w, layers, velocity, x, v);
  assert_ok(pbf_add_particles(w.solver, w.count, x, v, NULL));
  free(x);
  free(v);
  return w;
}

static void end(water *w) {
  pbf_destroy(w->solver);
  free(w->x);
  free(w->v);
}

static uint32_t evenly(const water *w, double x) {
  (void)x;
  return (uint32_t)w->deep;
}

/* ---- Waves ----------------------------------------------------------------------------------- */

static double phase; /* of the wave at the faces: where its slope is 0, or steepest */

static double wave_number(const water *w) { return 2 * pi / (w->wide * d); }

/* Of a standing wave as it goes through its level (linear theory). */
static void mode(const water *w, const double x[3], double v[3]) {
  const double k = wave_number(w), at_surface = sinh(k * w->deep * d);
  v[0] = -sin(k * x[0] + phase) * cosh(k * x[1]) / at_surface;
  v[1] = cos(k * x[0] + phase) * sinh(k * x[1]) / at_surface;
  v[2] = 0;
}

static void rising(const water *w, const double x[3], double v[3]) {
  mode(w, x, v);
  for (int k = 0; k < 3; ++k) v[k] *= 0.15;
}

static double part_of_mode(water *w) {
  double sum = 0;
  test_read(w->solver, w->dimension, w->precision, w->count, w->x, w->v);
  for (uint32_t i = 0; i < w->count; ++i) {
    double v[3];
    mode(w, w->x + i * w->dimension, v);
    for (uint32_t k = 0; k < w->dimension; ++k) sum += v[k] * w->v[i * w->dimension + k];
  }
  return sum;
}

/* Thin walls along the stream, over the faces, which part all cells there. */
static void set_fins(const water *w) {
  enum { FINS = 4 };
  pbf_collider fin[FINS];
  for (int k = 0; k < FINS; ++k) {
    assert_ok(pbf_collider_init(&fin[k], sizeof fin[k], PBF_COLLIDER_BOX));
    fin[k].position[0] = k % 2 * w->wide * d;
    fin[k].position[2] = (k / 2 ? 2 : 6) * d;
    fin[k].half_extents[0] = 6 * d;
    fin[k].half_extents[1] = 2 * w->deep * d;
    fin[k].half_extents[2] = 0.25 * d;
  }
  assert_ok(pbf_set_colliders(w->solver, FINS, fin));
}

/* It comes to a stop a quarter and three quarters of a period after that, the same wherever the
 * faces are, and omega² = g k tanh(k H). */
static void check_wave(uint32_t dimension, uint32_t precision, double at_faces, int has_fins) {
  enum { LENGTH = 62, LAYERS = 20, STOPS = 2 };
  phase = at_faces;
  water w = begin(dimension, precision, LENGTH, LAYERS, evenly, rising);
  const double k = wave_number(&w), period = 2 * pi / sqrt(gravity * k * tanh(k * LAYERS * d));
  double before = part_of_mode(&w), stops[STOPS] = {0};
  if (has_fins) set_fins(&w);
  for (uint32_t step = 1, found = 0; found < STOPS && step < 120; ++step) {
    assert_ok(pbf_step(w.solver, 1));
    const double now = part_of_mode(&w);
    if (before * now < 0) stops[found++] = (step - 1 + before / (before - now)) / 60.0;
    before = now;
  }
  for (int stop = 0; stop < STOPS; ++stop)
    if (!(fabs(stops[stop] / period - (0.25 + 0.5 * stop)) < 0.02))
      fail_msg("%uD: a wave with phase %g at the faces stops after %g periods", dimension, at_faces,
               stops[stop] / period);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(w.solver, &stats));
  assert_true(stats.density_error_mean < 0.005);
  end(&w);
}

static void check_waves(uint32_t dimension, uint32_t precision) {
  check_wave(dimension, precision, 0, 0);
  check_wave(dimension, precision, pi / 2, 0);
  if (dimension == 3) check_wave(dimension, precision, pi / 2, 1);
}

static void waves_go_over_the_faces(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_waves);
}

/* ---- A river --------------------------------------------------------------------------------- */

/* Along the axis gravity is not carried: without friction all moves at g t, and as in a tank the
 * floor carries the weight. */
static void check_river(uint32_t dimension, uint32_t precision) {
  enum { STEPS = 60 };
  water w = begin(dimension, precision, 20, 24, evenly, NULL);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(w.solver, &params));
  params.gravity[0] = 0.5;
  assert_ok(pbf_set_params(w.solver, &params));
  assert_ok(pbf_step(w.solver, STEPS));
  test_read(w.solver, dimension, precision, w.count, w.x, w.v);
  double mean = 0;
  for (uint32_t i = 0; i < w.count; ++i) mean += w.v[i * dimension] / w.count;
  const double right = 0.5 * STEPS / 60;
  if (!(fabs(mean / right - 1) < 0.02)) fail_msg("%uD: %g m/s, not %g", dimension, mean, right);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(w.solver, &stats));
  assert_true(stats.density_error_mean < 0.005);
  end(&w);
}

static void rivers_run(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_river);
}

/* ---- Walls ----------------------------------------------------------------------------------- */

static const double walls[2] = {1, 21}; /* where, in spacings, and a spacing thick */
static const uint32_t levels[2] = {24, 16};

static int is_between(double x) { return x > walls[0] * d && x < walls[1] * d; }

static uint32_t between_walls(const water *w, double x) {
  (void)w;
  for (int k = 0; k < 2; ++k)
    if (fabs(x - walls[k] * d) < 0.9 * d) return 0;
  return is_between(x) ? levels[0] : levels[1];
}

/* Each set a period apart, too, since solids act where they lie. */
static void set_walls(water *w) {
  pbf_collider colliders[6];
  for (int k = 0; k < 6; ++k) {
    assert_ok(pbf_collider_init(&colliders[k], sizeof colliders[k], PBF_COLLIDER_BOX));
    colliders[k].position[0] = d * (walls[k % 2] + w->wide * (k / 2 - 1));
    colliders[k].half_extents[0] = 0.5 * d;
    colliders[k].half_extents[1] = colliders[k].half_extents[2] = 2 * w->deep * d;
  }
  assert_ok(pbf_set_colliders(w->solver, 6, colliders));
}

/* Two thin walls part the water, one of them beside a face: what stands at either side of both
 * stays there, at its own level and at rest, also what lies on both sides of the faces. */
static void check_walls(uint32_t dimension, uint32_t precision) {
  water w = begin(dimension, precision, 40, 24, between_walls, NULL);
  uint32_t before[2] = {0, 0}, after[2] = {0, 0};
  double height[2] = {0, 0}, energy = 0;
  set_walls(&w);
  test_read(w.solver, dimension, precision, w.count, w.x, w.v);
  for (uint32_t i = 0; i < w.count; ++i) ++before[!is_between(w.x[i * dimension])];
  assert_ok(pbf_step(w.solver, 120));
  test_read(w.solver, dimension, precision, w.count, w.x, w.v);
  for (uint32_t i = 0; i < w.count; ++i) {
    const int side = !is_between(w.x[i * dimension]);
    ++after[side];
    height[side] += 2 * w.x[i * dimension + 1] / d;
    for (uint32_t k = 0; k < dimension; ++k) energy += pow(w.v[i * dimension + k], 2) / w.count;
  }
  for (int side = 0; side < 2; ++side) {
    const double length = side ? w.wide - (walls[1] - walls[0]) - 1 : walls[1] - walls[0] - 1;
    const double right = before[side] / (length * (dimension == 3 ? ACROSS : 1));
    assert_int_equal(after[side], before[side]);
    if (!(fabs(height[side] / after[side] / right - 1) < 0.02))
      fail_msg("%uD: it stands %g spacings high, not %g", dimension, height[side] / after[side],
               right);
  }
  assert_true(sqrt(energy) < 0.1 * sqrt(gravity * d));
  end(&w);
}

static void walls_beside_faces_part_water(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_walls);
}

static uint32_t all_layers(const water *w, double x) {
  (void)x;
  return (uint32_t)w->deep;
}

/* A period is short beside a domain so high that cells no wider than it are too many for the grid.
 */
static void check_high_domain(uint32_t dimension, uint32_t precision) {
  water w = begin(dimension, precision, 8, 24, all_layers, NULL);
  pbf_params params = test_params();
  double height = 0;
  assert_ok(pbf_get_params(w.solver, &params));
  params.domain_max[1] = 900;
  assert_ok(pbf_set_params(w.solver, &params));
  assert_ok(pbf_step(w.solver, 60));
  test_read(w.solver, dimension, precision, w.count, w.x, w.v);
  for (uint32_t i = 0; i < w.count; ++i) height += 2 * w.x[i * dimension + 1] / d / w.count;
  if (!(fabs(height / w.deep - 1) < 0.1))
    fail_msg("%uD: it stands %g spacings high, not %g", dimension, height, w.deep);
  end(&w);
}

static void short_periods_have_high_domains(void **state) {
  (void)state;
  test_for_long_kinds(check_high_domain);
}

int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest periodic[] = {
      cmocka_unit_test(waves_go_over_the_faces),
      cmocka_unit_test(rivers_run),
      cmocka_unit_test(walls_beside_faces_part_water),
      cmocka_unit_test(short_periods_have_high_domains),
  };
  return TEST_RUN(periodic);
}
