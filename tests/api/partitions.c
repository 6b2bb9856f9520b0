/* Solids thinner than a cell of the pressure grid: water on each side of one has its own level, and
 * that which is connected has one. */
#include "support.h"

#include <math.h>
#include <stdio.h>

static const double d = 0.05, gravity = 9.81;

typedef struct scene {
  pbf_desc desc;
  pbf_params params;
  double *points;
  uint32_t count, colliders;
  pbf_collider list[8];
} scene;

/* Water 1 d wide along the third axis is a few lattices thick in 3D. */
enum { THICK = 4, MOST = 8000 };

static scene *scene_of(uint32_t dimension, uint32_t precision, double width, double height) {
  scene *s = calloc(1, sizeof *s);
  assert_non_null(s);
  s->points = calloc(MOST, 3 * sizeof *s->points);
  assert_non_null(s->points);
  s->desc = test_desc(dimension, precision, MOST);
  s->params = test_params();
  s->params.iterations = 4;
  s->params.pressure_grid = -1;
  s->params.domain_max[0] = d * width;
  s->params.domain_max[1] = d * height;
  s->params.domain_max[2] = d * THICK;
  return s;
}

/* A lattice between corners, in spacings. */
static void fill(scene *s, double left, double low, int columns, int layers) {
  const int thick = s->desc.dimension == 3 ? THICK : 1;
  for (int i = 0; i < columns * layers * thick; ++i) {
    const double at[3] = {left + i % columns, low + i / columns % layers,
                          (double)(i / columns / layers)};
    assert_true(s->count < MOST);
    for (int k = 0; k < 3; ++k) s->points[3 * s->count + k] = d * (at[k] + 0.5);
    ++s->count;
  }
}

/* A box between corners in spacings, through all of the third axis, turned around its middle. */
static void add_box(scene *s, double left, double low, double right, double high, double angle) {
  pbf_collider *box = &s->list[s->colliders++];
  assert_ok(pbf_collider_init(box, sizeof *box, PBF_COLLIDER_BOX));
  box->position[0] = 0.5 * d * (left + right);
  box->position[1] = 0.5 * d * (low + high);
  box->half_extents[0] = 0.5 * d * (right - left);
  box->half_extents[1] = 0.5 * d * (high - low);
  box->half_extents[2] = 5;
  box->orientation[2] = sin(0.5 * angle);
  box->orientation[3] = cos(0.5 * angle);
}

static pbf_solver *started(const scene *s) {
  const uint32_t dimension = s->desc.dimension, precision = s->desc.precision;
  pbf_desc desc = s->desc;
  desc.capacity = s->count;
  pbf_solver *solver = test_create(&desc, &s->params);
  void *x = calloc((size_t)s->count * dimension, precision);
  assert_non_null(x);
  for (uint32_t i = 0; i < s->count; ++i)
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(x, (uint64_t)i * dimension + k, precision, s->points[3 * i + k]);
  assert_ok(pbf_set_colliders(solver, s->colliders, s->list));
  assert_ok(pbf_add_particles(solver, s->count, x, NULL, NULL));
  free(x);
  return solver;
}

static void destroy(scene *s, pbf_solver *solver) {
  pbf_destroy(solver);
  free(s->points);
  free(s);
}

static int keeps_grid(pbf_solver *solver) {
  int found = 0;
  pbf_plan plan = {.struct_size = sizeof plan};
  assert_ok(pbf_get_plan(solver, &plan));
  for (uint32_t k = 0; k < plan.stage_count; ++k)
    found |= strcmp(plan.stages[k].name, "pressure grid") == 0;
  return found;
}

/* Mean of the coordinate of some particles, in spacings. */
static double mean(const scene *s, pbf_solver *solver, uint32_t first, uint32_t count, int axis) {
  const uint32_t dimension = s->desc.dimension, precision = s->desc.precision;
  void *x = calloc((size_t)count * dimension, precision);
  double sum = 0;
  assert_non_null(x);
  assert_ok(pbf_get_positions(solver, first, count, x));
  for (uint32_t i = 0; i < count; ++i)
    sum += test_value(x, (uint64_t)i * dimension + (uint32_t)axis, precision);
  free(x);
  return sum / count / d;
}

/* Half as high as the water is its middle. */
static void check_level(const scene *s, pbf_solver *solver, uint32_t first, uint32_t count,
                        double level, double accuracy, const char *what) {
  const double height = 2 * mean(s, solver, first, count, 1);
  if (!(fabs(height / level - 1) < accuracy))
    fail_msg("%uD, %u bytes, %s: water %g layers deep is %g deep", s->desc.dimension,
             s->desc.precision, what, level, height);
}

/* Of water at rest, far from its surface, over that at its bottom. */
static void check_pressures(const scene *s, pbf_solver *solver, uint32_t first, uint32_t count,
                            double level, const char *what) {
  const uint32_t dimension = s->desc.dimension, precision = s->desc.precision;
  void *x = calloc((size_t)count * dimension, precision), *p = calloc(count, precision);
  double worst = 0;
  assert_true(x && p);
  assert_ok(pbf_get_positions(solver, first, count, x));
  assert_ok(pbf_get_pressures(solver, first, count, p));
  for (uint32_t i = 0; i < count; ++i) {
    const double y = test_value(x, (uint64_t)i * dimension + 1, precision);
    if (y < d * (level - 8))
      worst = fmax(worst, fabs(test_value(p, i, precision) - gravity * (d * level - y)));
  }
  if (!(worst < 0.1 * gravity * d * level))
    fail_msg("%uD, %s: a pressure is off by %g of that at the bottom", dimension, what,
             worst / (gravity * d * level));
  free(x);
  free(p);
}

/* ---- A gate -------------------------------------------------------------------------------- */

enum { WIDE = 10, DEEP = 40, SHALLOW = 12 };

static scene *gate(uint32_t dimension, uint32_t precision, int left, double thick, double opening) {
  scene *s = scene_of(dimension, precision, left + thick + WIDE, DEEP + 12);
  fill(s, 0, 0, left, DEEP);
  fill(s, left + thick, 0, WIDE, SHALLOW);
  add_box(s, left, opening ? opening : -10, left + thick, DEEP + 20, 0);
  return s;
}

static void check_gate(uint32_t dimension, uint32_t precision, int left, double thick,
                       double speed) {
  const uint32_t across = dimension == 3 ? THICK : 1, deep = (uint32_t)(DEEP * left) * across;
  scene *s = gate(dimension, precision, left, thick, 0);
  s->list[0].velocity[1] = speed;
  pbf_solver *solver = started(s);
  char what[64];
  snprintf(what, sizeof what, "a gate of %g d that moves at %g", thick, speed);
  assert_true(keeps_grid(solver));
  assert_ok(pbf_step(solver, dimension == 3 ? 100 : 200));
  check_level(s, solver, 0, deep, DEEP, 0.01, what);
  check_level(s, solver, deep, SHALLOW * WIDE * across, SHALLOW, 0.01, what);
  check_pressures(s, solver, 0, deep, DEEP, what);
  destroy(s, solver);
}

static void check_gates(uint32_t dimension, uint32_t precision) {
  check_gate(dimension, precision, WIDE, 1, 0);
  if (dimension == 3) return;
  check_gate(2, precision, WIDE, 0.5, 0.2);
  check_gate(2, precision, WIDE + 2, 1.4, 0); /* of a cell 0.3 spacings are left of it */
  check_gate(2, precision, WIDE, 6, 0);
}

static void each_side_of_a_gate_has_its_level(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_gates);
}

/* ---- A gate aslant -------------------------------------------------------------------------- */

/* Between a wall and a line that is `bottom` away on the floor and goes away by `slope` a height:
 * the mean height of so much water, where the area is (bottom + slope level / 2) level. */
static double slanted_mean(double area, double bottom, double slope) {
  double level = area / bottom;
  for (int k = 0; k < 50; ++k) level = area / (bottom + 0.5 * slope * level);
  return (0.5 * bottom * level * level + slope * level * level * level / 3) / area;
}

static void check_slanted(uint32_t precision) {
  const double angle = 3.14159265358979 / 6, slope = tan(angle), half = 0.5 / cos(angle);
  const double middle = 30, width = 44;
  scene *s = scene_of(2, precision, width, DEEP + 12);
  add_box(s, middle - 0.5, -60, middle + 0.5, 60, angle); /* leans to the left */
  uint32_t counts[2];
  for (int side = 0; side < 2; ++side) {
    const uint32_t before = s->count;
    for (int j = 0; j < (side ? SHALLOW : DEEP); ++j) {
      const double at = middle - slope * (j + 0.5), gap = half + 0.5 / cos(angle);
      const int left = (int)ceil(at + gap - 0.5), right = (int)floor(at - gap + 0.5);
      if (side && left < width) fill(s, left, j, (int)width - left, 1);
      if (!side && right > 0) fill(s, 0, j, right, 1);
    }
    counts[side] = s->count - before;
  }
  pbf_solver *solver = started(s);
  assert_true(keeps_grid(solver));
  assert_ok(pbf_step(solver, 400));
  const double right[2] = {slanted_mean(counts[0], middle - half, -slope),
                           slanted_mean(counts[1], width - middle - half, slope)};
  for (int side = 0; side < 2; ++side) {
    const double is = mean(s, solver, side ? counts[0] : 0, counts[side], 1);
    if (!(fabs(is / right[side] - 1) < 0.02))
      fail_msg("%s of a gate aslant the mean height is %g, it must be %g", side ? "right" : "left",
               is, right[side]);
  }
  destroy(s, solver);
}

static void so_has_each_side_of_one_aslant(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  if (test_has_kind(2, PBF_FLOAT32)) check_slanted(PBF_FLOAT32);
  check_slanted(PBF_FLOAT64);
}

/* ---- What is connected ---------------------------------------------------------------------- */

static void check_opening(uint32_t precision) {
  enum { dimension = 2 };
  scene *s = gate(dimension, precision, WIDE, 1, 5);
  const uint32_t count = s->count;
  pbf_solver *solver = started(s);
  void *x = calloc((size_t)count * dimension, precision);
  uint32_t right = 0;
  assert_non_null(x);
  assert_ok(pbf_step(solver, 400));
  assert_ok(pbf_get_positions(solver, 0, count, x));
  for (uint32_t i = 0; i < count; ++i)
    right += test_value(x, (uint64_t)i * dimension, precision) > d * (WIDE + 0.5);
  if (!(fabs(2.0 * right / count - 1) < 0.1))
    fail_msg("%u of %u particles are right of a gate half open", right, count);
  free(x);
  destroy(s, solver);
}

static void water_below_a_gate_levels_out(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  if (test_has_kind(2, PBF_FLOAT32)) check_opening(PBF_FLOAT32);
  check_opening(PBF_FLOAT64);
}

/* ---- Vessels -------------------------------------------------------------------------------- */

enum { INSIDE = 10, POOL = 60 };

/* A floor and two walls, in 3D between the domain's. */
static scene *pool(uint32_t dimension, uint32_t precision, double wall, double up, int layers) {
  scene *s = scene_of(dimension, precision, 5 * INSIDE, up + POOL + 20);
  const double left = 2.1 * INSIDE;
  fill(s, left, up, INSIDE, layers);
  add_box(s, left - wall, up - wall, left + INSIDE + wall, up, 0);
  add_box(s, left - wall, up - wall, left, up + POOL + 8, 0);
  add_box(s, left + INSIDE, up - wall, left + INSIDE + wall, up + POOL + 8, 0);
  return s;
}

static void check_pool(uint32_t dimension, uint32_t precision) {
  const double up = dimension == 3 ? 1 : 9.3;
  scene *s = pool(dimension, precision, 1, up, POOL);
  pbf_solver *solver = started(s);
  assert_true(keeps_grid(solver));
  assert_ok(pbf_step(solver, dimension == 3 ? 60 : 240));
  const double level = 2 * (mean(s, solver, 0, s->count, 1) - up);
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(solver, &stats));
  if (!(fabs(level / POOL - 1) < 0.01))
    fail_msg("%uD: water %d layers deep between boxes is %g deep", dimension, POOL, level);
  if (!(stats.density_error_mean < 0.01))
    fail_msg("%uD: it is compressed by %g", dimension, stats.density_error_mean);
  destroy(s, solver);
}

static void pools_of_boxes_stand(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_pool);
}

/* A precision that the build has. */
static uint32_t of_2d(void) { return test_has_kind(2, PBF_FLOAT32) ? PBF_FLOAT32 : PBF_FLOAT64; }

/* Without one of its walls it is no pool, nor where so little would fill it that it is shallow. */
static void where_there_is_a_pool(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  scene *s = pool(2, of_2d(), 1, 1, POOL);
  s->params.domain_min[0] = -100 * d;
  s->params.domain_max[0] += 100 * d;
  pbf_solver *solver = started(s);
  assert_true(keeps_grid(solver));
  assert_ok(pbf_set_colliders(solver, 2, s->list));
  assert_false(keeps_grid(solver));
  destroy(s, solver);
  s = pool(2, of_2d(), 1, 1, SHALLOW);
  solver = started(s);
  assert_false(keeps_grid(solver));
  destroy(s, solver);
}

/* ---- Round walls ---------------------------------------------------------------------------- */

/* A wall of three capsules, one above the other, thinner than the grid's points are apart. */
static void check_capsules(uint32_t precision) {
  scene *s = gate(2, precision, WIDE, 0.3, 0);
  const uint32_t deep = DEEP * WIDE;
  s->colliders = 3;
  for (int k = 0; k < 3; ++k) {
    assert_ok(pbf_collider_init(&s->list[k], sizeof s->list[k], PBF_COLLIDER_CAPSULE));
    s->list[k].radius = 0.15 * d;
    s->list[k].half_length = 10 * d;
    s->list[k].axis[0] = 0;
    s->list[k].axis[1] = 1;
    s->list[k].position[0] = d * (WIDE + 0.15);
    s->list[k].position[1] = d * (9 + 20 * k);
  }
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 200));
  check_level(s, solver, 0, deep, DEEP, 0.01, "capsules");
  check_level(s, solver, deep, SHALLOW * WIDE, SHALLOW, 0.01, "capsules");
  destroy(s, solver);
}

static void walls_may_be_round(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  check_capsules(of_2d());
}

/* ---- Vessels as narrow as cells -------------------------------------------------------------- */

/* A box between corners in spacings. */
static void add_block(scene *s, const double low[3], const double high[3]) {
  pbf_collider *box = &s->list[s->colliders++];
  assert_ok(pbf_collider_init(box, sizeof *box, PBF_COLLIDER_BOX));
  for (int k = 0; k < 3; ++k) {
    box->position[k] = 0.5 * d * (low[k] + high[k]);
    box->half_extents[k] = 0.5 * d * (high[k] - low[k]);
  }
}

/* A lattice of 6 spacings along the third axis. */
static void fill_narrow(scene *s, double left, int columns, int layers) {
  for (int i = 0; i < columns * layers * 6; ++i) {
    const double at[3] = {left + i % columns, i / columns % layers,
                          (double)(i / columns / layers) - 3};
    for (int k = 0; k < 3; ++k) s->points[3 * s->count + k] = d * (at[k] + 0.5);
    ++s->count;
  }
}

/* Two arms of 8 by 6 spacings and a channel 6 high between them, 18 layers full. Cells lie so that
 * many have a third to a half of their volume in it. At rest water stays so. */
static void a_narrow_u_rests(void **state) {
  enum { LAYERS = 18, WALL = 4 };
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  scene *s = scene_of(3, PBF_FLOAT32, 0, 0);
  s->params.time_step = 1.0 / 120;
  s->params.pressure_grid = 2.66;
  for (int k = 0; k < 3; ++k) {
    s->params.domain_min[k] = k == 1 ? -12 * d : -20 * d;
    s->params.domain_max[k] = k == 1 ? 44 * d : 20 * d;
  }
  const double blocks[6][2][3] = {
      {{-15 - WALL, -WALL, -3 - WALL}, {15 + WALL, 0, 3 + WALL}}, /* the floor */
      {{-15 - WALL, 0, -3 - WALL}, {-15, 40, 3 + WALL}},          /* the sides */
      {{15, 0, -3 - WALL}, {15 + WALL, 40, 3 + WALL}},
      {{-15, 0, -3 - WALL}, {15, 40, -3}},
      {{-15, 0, 3}, {15, 40, 3 + WALL}},
      {{-7, 6, -3}, {7, 40, 3}}, /* between the arms */
  };
  for (int b = 0; b < 6; ++b) add_block(s, blocks[b][0], blocks[b][1]);
  fill_narrow(s, -15, 8, LAYERS);
  fill_narrow(s, 7, 8, LAYERS);
  fill_narrow(s, -7, 14, 6);
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 480));
  pbf_stats stats = {.struct_size = sizeof stats};
  assert_ok(pbf_get_stats(solver, &stats));
  const double speed = sqrt(2 * stats.kinetic_energy);
  if (!(speed < 0.1 * sqrt(gravity * d)))
    fail_msg("water at rest in a U moves at %.3f of sqrt(g d)", speed / sqrt(gravity * d));
  destroy(s, solver);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_side_of_a_gate_has_its_level),
      cmocka_unit_test(so_has_each_side_of_one_aslant),
      cmocka_unit_test(water_below_a_gate_levels_out),
      cmocka_unit_test(pools_of_boxes_stand),
      cmocka_unit_test(where_there_is_a_pool),
      cmocka_unit_test(walls_may_be_round),
      cmocka_unit_test(a_narrow_u_rests),
  };
  return TEST_RUN(tests);
}
