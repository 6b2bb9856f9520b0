/* What is placed in fluid that moves: nothing is moved without a velocity, and no overlap thrown
 * apart, however short the steps. */
#include "support.h"

#include <math.h>
#include <string.h>

static const double spacing = 0.05, gravity = 9.81;

static pbf_params params_of(uint32_t dimension, double time_step, double width, double height) {
  pbf_params params = test_params();
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = time_step;
  params.attraction = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    params.gravity[k] = k == 1 ? -gravity : 0;
    params.domain_max[k] = k == 1 ? height : k < dimension ? width : 1;
  }
  return params;
}

/* A block of counts[0] × counts[1] × counts[2] particles, the corner of which is `corner`. */
typedef struct block {
  double corner[3];
  uint32_t counts[3];
} block;

static uint32_t count_of(const block *b, uint32_t dimension) {
  return b->counts[0] * b->counts[1] * (dimension == 3 ? b->counts[2] : 1);
}

static void place_of(const block *b, uint32_t i, double x[3]) {
  const uint32_t at[3] = {i % b->counts[0], i / b->counts[0] % b->counts[1],
                          i / b->counts[0] / b->counts[1]};
  for (int k = 0; k < 3; ++k) x[k] = b->corner[k] + spacing * (at[k] + 0.5);
}

static uint32_t add(pbf_solver *s, uint32_t dimension, uint32_t precision, const block *b,
                    const double velocity[3]) {
  const uint32_t count = count_of(b, dimension);
  uint32_t first;
  char *x = calloc((size_t)count * dimension, precision);
  char *v = calloc((size_t)count * dimension, precision);
  assert_non_null(x);
  assert_non_null(v);
  for (uint32_t i = 0; i < count; ++i) {
    double place[3];
    place_of(b, i, place);
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)i * dimension + k, precision, place[k]);
      test_put(v, (uint64_t)i * dimension + k, precision, velocity[k]);
    }
  }
  assert_ok(pbf_add_particles(s, count, x, v, &first));
  free(x);
  free(v);
  return first;
}

static pbf_stats stats_of(pbf_solver *s) {
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(s, &stats));
  return stats;
}

/* Water of so many layers, in a tank 14 wide. */
static pbf_solver *pool(uint32_t dimension, uint32_t precision, uint32_t layers, double time_step) {
  const block water = {{0}, {14, layers, 8}};
  pbf_params params = params_of(dimension, time_step, 0.7, 3);
  params.domain_max[2] = dimension == 3 ? 0.4 : 1;
  const pbf_desc desc = test_desc(dimension, precision, 4000);
  pbf_solver *s = test_create(&desc, &params);
  add(s, dimension, precision, &water, (double[]){0, 0, 0});
  return s;
}

/* ---- Displacement is the integral of velocity ------------------------------------------------ */

/* Line 21 of Algorithm 1: v = (x* - x) / dt, particle by particle. Returns the part of all ways
 * that no velocity explains. */
static double unexplained(pbf_solver *s, uint32_t dimension, double time_step) {
  uint32_t count;
  double way = 0, hidden = 0;
  assert_ok(pbf_get_count(s, &count));
  double *x = calloc((size_t)count * dimension, sizeof *x);
  double *y = calloc((size_t)count * dimension, sizeof *y);
  double *v = calloc((size_t)count * dimension, sizeof *v);
  assert_true(x && y && v);
  assert_ok(pbf_get_positions(s, 0, count, x));
  assert_ok(pbf_step(s, 1));
  assert_ok(pbf_get_positions(s, 0, count, y));
  assert_ok(pbf_get_velocities(s, 0, count, v));
  for (uint32_t i = 0; i < count * dimension; ++i) {
    way += fabs(y[i] - x[i]);
    hidden += fabs(y[i] - x[i] - time_step * v[i]);
  }
  free(x);
  free(y);
  free(v);
  return hidden / way;
}

static void a_tap_moves_nothing_without_velocity(void **state) {
  (void)state;
  const double dt = 1.0 / 120;
  const block mouth = {{0.2, 0.55, 0}, {6, 1, 6}}; /* it comes to be under water */
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    if (!test_has_kind(dimension, PBF_FLOAT64)) continue;
    pbf_solver *s = pool(dimension, PBF_FLOAT64, 10, dt);
    assert_ok(pbf_step(s, 20));
    for (int k = 0; k < 40; ++k) {
      if (k % 3 == 0) add(s, dimension, PBF_FLOAT64, &mouth, (double[]){0, -2, 0});
      const double hidden = unexplained(s, dimension, dt);
      if (!(hidden < 1e-6)) fail_msg("%uD, step %d: %g of the way", dimension, k, hidden);
    }
    pbf_destroy(s);
  }
}

/* ---- Hoses ----------------------------------------------------------------------------------- */

enum { WIDE = 8 };

/* Rows that leave sideways at `speed`, one spacing behind each other, and fall: a flow without
 * pressure, divergence 0, so an exact solution of Euler's equations. After k steps of symplectic
 * Euler a particle is at (speed k dt, -g dt² k (k + 1) / 2). */
static void check_hose(uint32_t dimension, uint32_t precision) {
  const double speed = 3, start = 6, time_step = precision == PBF_FLOAT32 ? 1.0 / 120 : 1.0 / 240;
  const block mouth = {{0.5, start, 0.5}, {1, WIDE, WIDE}};
  const uint32_t rows = 40, each = count_of(&mouth, dimension);
  const uint32_t every = (uint32_t)lround(spacing / speed / time_step);
  pbf_params params = params_of(dimension, time_step, 8, 8);
  const pbf_desc desc = test_desc(dimension, precision, rows * each);
  pbf_solver *s = test_create(&desc, &params);
  for (uint32_t row = 0; row < rows; ++row) {
    add(s, dimension, precision, &mouth, (double[]){speed, 0, 0});
    assert_ok(pbf_step(s, every));
  }
  char *x = calloc((size_t)rows * each * dimension, precision);
  assert_non_null(x);
  assert_ok(pbf_get_positions(s, 0, rows * each, x));
  uint32_t off = 0;
  for (uint32_t i = 0; i < rows * each; ++i) {
    const double k = (double)(rows - i / each) * every;
    double right[3], way2 = 0;
    place_of(&mouth, i % each, right);
    right[0] += speed * k * time_step;
    right[1] -= gravity * time_step * time_step * k * (k + 1) / 2;
    for (uint32_t axis = 0; axis < dimension; ++axis)
      way2 += pow(test_value(x, (uint64_t)i * dimension + axis, precision) - right[axis], 2);
    off += way2 > 0.25 * spacing * spacing;
  }
  if (!(off <= rows * each / 100))
    fail_msg("%uD, 1/%.0f s: %u of %u are off their parabola by half a spacing", dimension,
             1 / time_step, off, rows * each);
  free(x);
  pbf_destroy(s);
}

static void a_hose_pours_a_parabola(void **state) {
  (void)state;
  test_for_long_kinds(check_hose);
}

/* ---- Overlap --------------------------------------------------------------------------------- */

/* Energy a particle, over that of falling by a spacing. */
static double energy_of(pbf_solver *s) {
  const pbf_stats stats = stats_of(s);
  return (stats.kinetic_energy / gravity + stats.center_of_mass[1]) / spacing;
}

typedef struct burst {
  double speed; /* of the fastest particle */
  double gain;  /* of energy, over that of lifting what is added to the surface */
} burst;

static void set_grid(pbf_solver *s, double cells) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(s, &params));
  params.pressure_grid = cells;
  params.shear_stress_correction = cells > 0 ? 0.5 : 0;
  assert_ok(pbf_set_params(s, &params));
}

static burst add_upon_others(uint32_t dimension, uint32_t precision, double time_step,
                             double grid) {
  const double depth = 5.5 * spacing, seconds = 0.25;
  pbf_solver *s = pool(dimension, precision, 10, time_step);
  set_grid(s, grid);
  assert_ok(pbf_step(s, (uint32_t)lround(0.5 / time_step)));
  const block where = {{0.31, depth - 0.02, 0.11}, {4, 1, 4}};
  add(s, dimension, precision, &where, (double[]){0, 0, 0});
  const double start = energy_of(s), lift = count_of(&where, dimension) * 5.0;
  burst most = {0};
  for (int k = 0; k < (int)lround(seconds / time_step); ++k) {
    assert_ok(pbf_step(s, 1));
    most.speed = fmax(most.speed, stats_of(s).speed_max);
    most.gain = fmax(most.gain, energy_of(s) - start);
  }
  most.gain *= stats_of(s).count / lift;
  pbf_destroy(s);
  return most;
}

/* What appears in water at rest gives it no more energy than lifting it takes (Archimedes), half
 * more for what moves, no speed beyond Torricelli's of the depth, at any step, with a pressure grid
 * or without. */
static void check_added(uint32_t dimension, uint32_t precision) {
  const double torricelli = sqrt(2 * gravity * 10 * spacing);
  for (double grid = 0; grid <= 2; grid += 2) {
    const burst a = add_upon_others(dimension, precision, 1.0 / 120, grid),
                b = add_upon_others(dimension, precision, 1.0 / 480, grid);
    if (!(fmax(a.speed, b.speed) <= torricelli))
      fail_msg("%uD: %g and %g m/s, at most %g", dimension, a.speed, b.speed, torricelli);
    if (!(fmax(a.gain, b.gain) <= 1.5))
      fail_msg("%uD, a grid of %g h: gain %g and %g times the lifted weight", dimension, grid,
               a.gain, b.gain);
  }
}

static void what_is_added_upon_others_is_not_thrown(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_added);
}

/* A frame that took a tenth of a second or more: one step, in which particles fall by spacings. */
static void check_long_step(uint32_t dimension, uint32_t precision) {
  const double lengths[] = {0.1, 0.25};
  for (int k = 0; k < 2; ++k) {
    const double dt = 1.0 / 120, torricelli = sqrt(2 * gravity * 10 * spacing);
    pbf_solver *s = pool(dimension, precision, 10, dt);
    pbf_params params = {.struct_size = sizeof params};
    assert_ok(pbf_step(s, 120));
    const double level = stats_of(s).center_of_mass[1];
    assert_ok(pbf_get_params(s, &params));
    params.time_step = lengths[k];
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 1));
    params.time_step = dt;
    assert_ok(pbf_set_params(s, &params));
    for (int step = 0; step < 150; ++step) {
      assert_ok(pbf_step(s, 1));
      const pbf_stats now = stats_of(s);
      if (!(now.speed_max <= torricelli && now.center_of_mass[1] <= 1.02 * level))
        fail_msg("%uD, %g s, step %d: %g m/s, %g of the level", dimension, lengths[k], step,
                 now.speed_max, now.center_of_mass[1] / level);
    }
    pbf_destroy(s);
  }
}

static void a_long_step_throws_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_long_step);
}

/* ---- Steps that change ----------------------------------------------------------------------- */

static void set_time_step(pbf_solver *s, double time_step) {
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(s, &params));
  params.time_step = time_step;
  assert_ok(pbf_set_params(s, &params));
}

/* The root mean square of all speeds, over sqrt(g d). */
static double unrest_of(pbf_solver *s) {
  return sqrt(2 * stats_of(s).kinetic_energy / (gravity * spacing));
}

/* Slow motion, frames of turning lengths, and steps as an adaptive time step chooses them: a tank
 * at rest stays at rest (hydrostatics), within 0.02 sqrt(g d) or twice what it was before. */
static void check_changing_steps(uint32_t dimension, uint32_t precision) {
  static const double lengths[][4] = {
      {0.1, 0.1, 0.1, 0.1}, {0.01, 0.01, 0.01, 0.01}, {0.25, 1, 0.25, 1}, {1, 0.25, 0.5, 0.3}};
  const double dt = 1.0 / 120, seconds = 0.15;
  pbf_solver *still = pool(dimension, precision, 10, dt);
  uint64_t size;
  assert_ok(pbf_step(still, 600));
  const double bar = fmax(0.02, 2 * unrest_of(still));
  void *saved = test_save(still, &size);
  for (size_t k = 0; k < sizeof lengths / sizeof *lengths; ++k) {
    double time = 0, most = 0;
    assert_ok(pbf_load(still, saved, size));
    for (int step = 0; time < seconds && step < 400; ++step) {
      const double now = dt * lengths[k][step % 4];
      set_time_step(still, now);
      assert_ok(pbf_step(still, 1));
      most = fmax(most, unrest_of(still));
      time += now;
    }
    if (!(most <= bar))
      fail_msg("%uD, steps %zu: %g sqrt(g d), at most %g", dimension, k, most, bar);
  }
  free(saved);
  pbf_destroy(still);
}

static void steps_that_change_stir_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_changing_steps);
}

static int has_grid(pbf_solver *s) {
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(s, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k)
    if (strcmp(plan.stages[k].name, "pressure grid") == 0) return plan.stages[k].runs_per_step > 0;
  return 0;
}

/* Of all speeds, in the time that a fall by seven spacings takes. */
static double most_unrest(pbf_solver *s, double time_step) {
  double most = 0;
  for (double time = 0; time < 0.25; time += time_step) {
    assert_ok(pbf_step(s, 1));
    most = fmax(most, unrest_of(s));
  }
  return most;
}

/* Lengths in sqrt(d / g). From 0.14 on such water gets a pressure grid, which leaves the iterations
 * two fifths of what they have without it: the tank of before moved at 0.10 to 0.20 sqrt(g d).
 * Right is 0; bars are 0.05, which is missed by nothing, and twice what it was before. */
static void check_steps_across_grid(uint32_t dimension, uint32_t precision) {
  const double unit = sqrt(spacing / gravity);
  static const struct {
    uint32_t layers;
    double from, to;
    int grid; /* after that */
  } cases[] = {{12, 0.2, 0.1, 1}, {16, 0.06, 0.12, 0}, {16, 0.14, 0.07, 0}, {12, 0.1, 0.2, 1}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
    pbf_solver *s = pool(dimension, precision, cases[k].layers, cases[k].from * unit);
    assert_ok(pbf_step(s, (uint32_t)(24 / cases[k].from)));
    const double bar = fmax(0.05, 2 * unrest_of(s));
    set_time_step(s, cases[k].to * unit);
    const double most = most_unrest(s, cases[k].to * unit);
    if (!(most <= bar))
      fail_msg("%uD, case %zu: %g sqrt(g d), at most %g", dimension, k, most, bar);
    if (has_grid(s) != cases[k].grid) fail_msg("%uD, case %zu: grid", dimension, k);
    pbf_destroy(s);
  }
}

static void steps_across_a_grid_stir_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_steps_across_grid);
}

/* What steps leave goes with the weight and with the iterations as well. Water at rest is at rest
 * on the Moon, too; with more iterations it moved at 0.23 sqrt(g d), on the Moon at 0.13. */
static void check_weights(uint32_t dimension, uint32_t precision) {
  static const struct {
    double weight;
    uint32_t iterations;
    double bar;
  } cases[] = {{1.0 / 6, 4, 0.05}, {2.5, 4, 0.06}, {1, 8, 0.11}, {1, 40, 0.11}};
  const double time_step = 1.0 / 120;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
    pbf_solver *s = pool(dimension, precision, 12, time_step);
    pbf_params params = {.struct_size = sizeof params};
    assert_ok(pbf_step(s, 400));
    assert_ok(pbf_get_params(s, &params));
    params.gravity[1] *= cases[k].weight;
    params.iterations = cases[k].iterations;
    assert_ok(pbf_set_params(s, &params));
    const double most = most_unrest(s, time_step);
    if (!(most <= cases[k].bar))
      fail_msg("%uD, case %zu: %g sqrt(g d), at most %g", dimension, k, most, cases[k].bar);
    pbf_destroy(s);
  }
}

static void weights_that_change_stir_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_weights);
}

/* A grid that the caller gives or takes away: 16 layers moved at 0.14 (2D) and 0.17 sqrt(g d). */
static void check_grids(uint32_t dimension, uint32_t precision) {
  const double widths[] = {0, 2}, time_step = 1.0 / 120;
  for (int to = 0; to < 2; ++to) {
    pbf_solver *s = pool(dimension, precision, 16, time_step);
    pbf_params params = {.struct_size = sizeof params};
    assert_ok(pbf_get_params(s, &params));
    params.pressure_grid = widths[!to];
    assert_ok(pbf_set_params(s, &params));
    assert_ok(pbf_step(s, 400));
    params.pressure_grid = widths[to];
    assert_ok(pbf_set_params(s, &params));
    const double most = most_unrest(s, time_step);
    if (!(most <= 0.06)) fail_msg("%uD, a grid of %g h: %g sqrt(g d)", dimension, widths[to], most);
    pbf_destroy(s);
  }
}

static void grids_that_come_and_go_stir_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_grids);
}

/* Without weight water at rest stays where it is but for what it moves at, however it was pressed:
 * it flew apart, to 1.7 times its height in two seconds. */
static void check_pause(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = pool(dimension, precision, 12, 1.0 / 120);
  assert_ok(pbf_step(s, 600));
  const double level = stats_of(s).center_of_mass[1], speed = unrest_of(s);
  pbf_params params = {.struct_size = sizeof params};
  assert_ok(pbf_get_params(s, &params));
  params.gravity[1] = 0;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_step(s, 120));
  const double way = 1.0 * speed * sqrt(gravity * spacing);
  assert_true(fabs(stats_of(s).center_of_mass[1] - level) <= way + 0.02 * spacing);
  if (!(unrest_of(s) <= 1.1 * speed + 0.002)) fail_msg("%g after %g", unrest_of(s), speed);
  pbf_destroy(s);
}

static void a_pause_without_gravity_moves_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_pause);
}

/* Which steps there have been decides whether there is a grid, and is in a saved state: the same
 * bits go on, in a solver of another capacity, too. */
static void a_saved_grid_goes_on(void **state) {
  (void)state;
  const double unit = sqrt(spacing / gravity);
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    uint64_t size, hash, other_hash;
    if (!test_has_kind(dimension, PBF_FLOAT32)) continue;
    pbf_solver *s = pool(dimension, PBF_FLOAT32, 12, 0.2 * unit);
    assert_ok(pbf_step(s, 20));
    set_time_step(s, 0.1 * unit);
    assert_ok(pbf_step(s, 3));
    void *saved = test_save(s, &size);
    pbf_params params = params_of(dimension, 0.1 * unit, 0.7, 3);
    const pbf_desc desc = test_desc(dimension, PBF_FLOAT32, 9000);
    pbf_solver *other = test_create(&desc, &params);
    assert_ok(pbf_load(other, saved, size));
    assert_ok(pbf_step(s, 7));
    for (int k = 0; k < 7; ++k) assert_ok(pbf_step(other, 1));
    assert_true(has_grid(s) && has_grid(other));
    assert_ok(pbf_hash(s, &hash));
    assert_ok(pbf_hash(other, &other_hash));
    assert_int_equal(hash, other_hash);
    free(saved);
    pbf_destroy(other);
    pbf_destroy(s);
  }
}

/* ---- What is left of an overlap is part of the state ----------------------------------------- */

/* In all, longer than any overlap lasts. */
static void a_saved_overlap_goes_on(void **state) {
  (void)state;
  enum { FIRST = 3, SECOND = 500 };
  const block where = {{0.31, 0.2, 0.11}, {4, 1, 4}};
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    pbf_solver *one = pool(dimension, PBF_FLOAT32, 10, 1.0 / 60), *other = NULL;
    assert_ok(pbf_step(one, 30));
    add(one, dimension, PBF_FLOAT32, &where, (double[]){0, 0, 0});
    for (int part = 0; part < 2; ++part) {
      uint64_t size;
      void *saved = test_save(one, &size);
      if (!other) other = pool(dimension, PBF_FLOAT32, 10, 1.0 / 60);
      assert_ok(pbf_load(other, saved, size));
      free(saved);
      assert_ok(pbf_step(one, part ? SECOND : FIRST));
      for (int k = 0; k < (part ? SECOND : FIRST); ++k) assert_ok(pbf_step(other, 1));
      assert_int_equal(test_hash(one), test_hash(other));
    }
    pbf_destroy(one);
    pbf_destroy(other);
  }
}

/* ---- Solids that jump ------------------------------------------------------------------------ */

/* A plate across the tank, turned by an angle about z. */
static pbf_collider plate_at(double height, double angle) {
  pbf_collider plate;
  assert_ok(pbf_collider_init(&plate, sizeof plate, PBF_COLLIDER_BOX));
  plate.position[0] = 0.35;
  plate.position[1] = height;
  plate.position[2] = 0.2;
  plate.half_extents[0] = 0.3;
  plate.half_extents[1] = plate.half_extents[2] = 0.06;
  plate.orientation[2] = sin(0.5 * angle);
  plate.orientation[3] = cos(0.5 * angle);
  return plate;
}

/* Whether a plate that is set from one pose to another counts as one that is put there. */
static int counts_as_put(uint32_t dimension, double height, double angle) {
  const pbf_collider before = plate_at(0.57, 0), after = plate_at(height, angle);
  uint64_t hash[2];
  for (int put = 0; put < 2; ++put) {
    pbf_solver *s = pool(dimension, PBF_FLOAT32, 10, 1.0 / 120);
    assert_ok(pbf_set_colliders(s, 1, &before));
    assert_ok(pbf_step(s, 20));
    if (put) assert_ok(pbf_set_colliders(s, 0, NULL));
    assert_ok(pbf_set_colliders(s, 1, &after));
    assert_ok(pbf_step(s, 5));
    hash[put] = test_hash(s);
    pbf_destroy(s);
  }
  return hash[0] == hash[1];
}

/* By more than h, h being 0.1, along or about; what goes or turns by less has moved on. */
static void solids_that_jump_are_as_put_there(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    assert_true(counts_as_put(dimension, 0.3, 0));
    assert_true(counts_as_put(dimension, 0.45, 0));
    assert_true(counts_as_put(dimension, 0.57, 0.4));
    assert_false(counts_as_put(dimension, 0.49, 0));
    assert_false(counts_as_put(dimension, 0.57, 0.25));
  }
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tap_moves_nothing_without_velocity),
      cmocka_unit_test(a_hose_pours_a_parabola),
      cmocka_unit_test(what_is_added_upon_others_is_not_thrown),
      cmocka_unit_test(a_long_step_throws_nothing),
      cmocka_unit_test(steps_that_change_stir_nothing),
      cmocka_unit_test(steps_across_a_grid_stir_nothing),
      cmocka_unit_test(weights_that_change_stir_nothing),
      cmocka_unit_test(grids_that_come_and_go_stir_nothing),
      cmocka_unit_test(a_pause_without_gravity_moves_nothing),
      cmocka_unit_test(a_saved_grid_goes_on),
      cmocka_unit_test(a_saved_overlap_goes_on),
      cmocka_unit_test(solids_that_jump_are_as_put_there),
  };
  return TEST_RUN(tests);
}
