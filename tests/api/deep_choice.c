/* Which water is so deep that the solver gives it a pressure grid. */
#include "deep_column.h"

#include <pbf/phases.h>

static int keeps_grid(pbf_solver *s) { return test_has_stage(s, "pressure grid"); }

static int has_grid(uint32_t layers, const pbf_params *params) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, MOST);
  pbf_solver *s = block(&desc, params, COLUMNS, layers, 0, 0, 0.1);
  int found = keeps_grid(s);
  pbf_destroy(s);
  return found;
}

/* With the correction of the shear stress, which is the default there, from 18 layers on, and where
 * it is asked for from 6 on, however short steps are (params.h). */
static void where_eddies_want_it(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_params params = column_params(-1);
  params.time_step /= 3;
  assert_false(has_grid(17, &params));
  assert_true(has_grid(18, &params));
  params.shear_stress_correction = 0.5;
  assert_false(has_grid(5, &params));
  assert_true(has_grid(6, &params));
  params.shear_stress_correction = 0;
  assert_false(has_grid(18, &params));
}

/* Left to the solver, it is there where g H dt² > 0.06 iterations d² for the depth H that the
 * particles would settle to. */
static void where_water_could_be_deep(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  pbf_params params = column_params(-1);
  params.shear_stress_correction = 0;
  double dt = params.time_step, d = spacing;
  double depth = 0.06 * params.iterations * d * d / (gravity * dt * dt);
  uint32_t layers = (uint32_t)(depth / d);
  assert_false(has_grid(layers, &params));
  assert_true(has_grid(layers + 1, &params));
  params.domain_max[1] = 0.99 * depth;
  assert_false(has_grid(LAYERS, &params));
  params.domain_max[1] = 1.01 * depth;
  assert_true(has_grid(LAYERS, &params));
  params.iterations *= 2;
  assert_false(has_grid(LAYERS, &params));
  params.time_step *= 2;
  assert_true(has_grid(LAYERS, &params));
  params.gravity[1] = 0;
  assert_false(has_grid(LAYERS, &params));
  params.gravity[0] = gravity; /* 6 layers */
  assert_false(has_grid(LAYERS, &params));
  params = column_params(-1);
  params.solver = PBF_SOLVER_JACOBI;
  assert_false(has_grid(LAYERS, &params));
}

/* What holds the water may be a collider, in a domain in which it would be a puddle. */
static void check_bottle(uint32_t dimension, uint32_t precision) {
  const pbf_params column = column_params(-1);
  pbf_params params;
  pbf_collider box = bottle(&column, &params), ball;
  pbf_desc desc = test_desc(dimension, precision, MOST);
  pbf_solver *s = block(&desc, &params, COLUMNS, LAYERS, 0, 0, 1);
  assert_false(keeps_grid(s));
  assert_ok(pbf_set_colliders(s, 1, &box));
  assert_true(keeps_grid(s));
  /* What of it is out of the domain leaves the fluid no room. */
  pbf_params slab = params;
  slab.domain_min[2] = 0;
  slab.domain_max[2] = column.domain_max[2];
  box.half_extents[2] = 100;
  assert_ok(pbf_set_params(s, &slab));
  assert_ok(pbf_set_colliders(s, 1, &box));
  assert_true(keeps_grid(s));
  assert_ok(pbf_step(s, 200));
  double speed = sqrt(2 * stats_of(s).kinetic_energy / (gravity * spacing));
  if (!(fabs(lost_height(s)) < 0.01))
    fail_msg("%uD: %g of the height lost", dimension, lost_height(s));
  if (!(speed < 0.1)) fail_msg("%uD: moves at %g sqrt(g d)", dimension, speed);
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE));
  for (int wide = 0; wide < 2; ++wide) {
    ball.inverted = wide;
    ball.radius = wide ? 1000 * spacing : 0.1 * spacing;
    assert_ok(pbf_set_colliders(s, 1, &ball));
    assert_false(keeps_grid(s));
  }
  ball.radius = 12 * spacing; /* half full */
  assert_ok(pbf_set_colliders(s, 1, &ball));
  assert_int_equal(keeps_grid(s), dimension == 2);
  assert_ok(pbf_set_colliders(s, 0, NULL));
  assert_false(keeps_grid(s));
  pbf_destroy(s);
}

static void bottles_are_deep(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_bottle);
}

/* Planes at the column's sides, `farther` out of it, that lean outwards by `lean` for each length.
 */
static void set_planes(pbf_solver *s, uint32_t dimension, const pbf_params *column, double farther,
                       double lean) {
  pbf_collider planes[4];
  uint32_t count = 0;
  for (uint32_t k = 0; k < dimension; k += 2)
    for (int side = 0; side < 2; ++side) {
      pbf_collider *p = &planes[count++];
      assert_ok(pbf_collider_init(p, sizeof *p, PBF_COLLIDER_PLANE));
      p->position[k] = side ? column->domain_max[k] + farther : -farther;
      p->axis[k] = side ? -1 : 1;
      p->axis[1] = lean;
    }
  assert_ok(pbf_set_colliders(s, count, planes));
}

/* The part of its mean height that a column loses between walls that lean outwards. */
static double lost_to_lean(uint32_t dimension, const pbf_params *column, double lean) {
  const double step = 1e-4 * column->domain_max[1], thick = dimension == 3 ? 3 * spacing : 1;
  const double all = COLUMNS * spacing * LAYERS * spacing * thick;
  double volume = 0, moment = 0;
  for (double y = step / 2; volume < all; y += step) {
    const double more = 2 * lean * y;
    const double slice =
        step * (COLUMNS * spacing + more) * (dimension == 3 ? thick + more : thick);
    volume += slice;
    moment += y * slice;
  }
  return 1 - moment / volume / (0.5 * spacing * LAYERS);
}

/* So they may be planes, upright on an axis and others, wherever they cut the grid's cells: the
 * domain ends so much farther out. */
static void check_planes(uint32_t dimension, uint32_t precision, double lean, double farther) {
  const pbf_params column = column_params(-1);
  const double right = lost_to_lean(dimension, &column, lean);
  pbf_params params = column;
  pbf_desc desc = test_desc(dimension, precision, MOST);
  for (int k = 0; k < 3; k += 2) {
    params.domain_min[k] = -50 * spacing - farther;
    params.domain_max[k] += 50 * spacing;
  }
  pbf_solver *s = block(&desc, &params, COLUMNS, LAYERS, 0, 0, 1);
  assert_false(keeps_grid(s));
  set_planes(s, dimension, &column, 40 * spacing, lean);
  assert_false(keeps_grid(s));
  set_planes(s, dimension, &column, 0, lean);
  assert_true(keeps_grid(s));
  assert_ok(pbf_step(s, 400));
  if (!(fabs(lost_height(s) - right) < 0.01))
    fail_msg("%uD, leaning %g, %g farther: %g of the height lost for %g", dimension, lean, farther,
             lost_height(s), right);
  pbf_destroy(s);
}

static void check_between_planes(uint32_t dimension, uint32_t precision) {
  check_planes(dimension, precision, 0, 0);
  check_planes(dimension, precision, 1e-3, 0);
  check_planes(dimension, precision, 0, spacing); /* one leaves half a spacing of a cell, … */
  check_planes(dimension, precision, 0, 1.65 * spacing); /* … 0.35 */
}

static void planes_hold_deep_water(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_between_planes);
}

/* A floor and two sides that stand on it, flush, thicker than what parts the grid, cut its cells
 * where they like: below the sides is no room, and above the floor is as much as the floor leaves.
 */
static void check_thick_boxes(uint32_t dimension, uint32_t precision) {
  enum { THICK = 20 };
  pbf_params params = column_params(-1);
  pbf_desc desc = test_desc(dimension, precision, MOST);
  pbf_collider boxes[3];
  const double left = 25 * spacing, floor = 21.43 * spacing, width = COLUMNS * spacing;
  const double half = THICK * spacing / 2, tall = (LAYERS + 12) * spacing / 2;
  params.domain_max[0] = (50 + COLUMNS) * spacing;
  params.domain_max[1] += 40 * spacing;
  for (int k = 0; k < 3; ++k) {
    assert_ok(pbf_collider_init(&boxes[k], sizeof *boxes, PBF_COLLIDER_BOX));
    boxes[k].position[0] = left + width / 2 + (k - 1) * (width / 2 + half);
    boxes[k].position[1] = k == 1 ? floor - half : floor + tall;
    boxes[k].half_extents[0] = k == 1 ? width / 2 + 2 * half : half;
    boxes[k].half_extents[1] = k == 1 ? half : tall;
  }
  pbf_solver *s = block(&desc, &params, COLUMNS, LAYERS, left, floor, 1);
  assert_ok(pbf_set_colliders(s, 3, boxes));
  assert_true(keeps_grid(s));
  assert_ok(pbf_step(s, 200));
  const double height = stats_of(s).center_of_mass[1] - floor, right = 0.5 * spacing * LAYERS;
  if (!(fabs(height / right - 1) < 0.01))
    fail_msg("%uD: it is %g high for %g", dimension, height, right);
  pbf_destroy(s);
}

static void thick_boxes_hold_deep_water(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_thick_boxes);
}

/* A floor and walls, flush, around a room from (left, 0, 0) on. */
static void set_vessel(pbf_solver *s, uint32_t dimension, double left, const double inside[3],
                       double thick) {
  const uint32_t count = dimension == 3 ? 5 : 3;
  pbf_collider boxes[5];
  for (uint32_t b = 0; b < count; ++b) {
    const uint32_t axis = b == 0 ? 1 : b < 3 ? 0 : 2;
    const int upper = b > 0 && (b - 1) % 2;
    assert_ok(pbf_collider_init(&boxes[b], sizeof *boxes, PBF_COLLIDER_BOX));
    for (uint32_t k = 0; k < dimension; ++k) {
      const double more = b == 0 || (axis == 0 && k == 2) ? thick : 0;
      const double from = k == 0 ? left : 0;
      boxes[b].half_extents[k] = k == axis ? thick / 2 : inside[k] / 2 + more;
      boxes[b].position[k] = from + (k != axis ? inside[k] / 2
                                     : upper   ? inside[k] + thick / 2
                                               : -thick / 2);
    }
  }
  assert_ok(pbf_set_colliders(s, count, boxes));
}

/* In a domain so wide that cells of the grid's width do not fit into it: those that there are lie
 * around the fluid. */
static void check_wide_domain(uint32_t dimension, uint32_t precision) {
  const double inside[3] = {COLUMNS * spacing, (LAYERS + 10) * spacing, 3 * spacing};
  pbf_params params = column_params(-1);
  pbf_desc desc = test_desc(dimension, precision, MOST);
  for (int k = 0; k < 3; ++k) {
    params.domain_min[k] = -190 * spacing;
    params.domain_max[k] = 210 * spacing;
  }
  pbf_solver *s = block(&desc, &params, COLUMNS, LAYERS, 0, 0, 1);
  set_vessel(s, dimension, 0, inside, spacing);
  assert_true(keeps_grid(s));
  assert_ok(pbf_step(s, 150));
  if (!(fabs(lost_height(s)) < 0.01))
    fail_msg("%uD: %g of the height lost", dimension, lost_height(s));
  pbf_destroy(s);
}

/* Rounding leaves seams between flush boxes, which hold all the same: of vessels as wide as six
 * walls are thick points that tell depth lie in the seams' planes. */
static void check_seams(uint32_t dimension, uint32_t precision) {
  enum { ACROSS = 12, DEEP = 20 };
  const double inside[3] = {ACROSS * spacing, 3 * DEEP * spacing, ACROSS * spacing};
  const uint32_t columns = dimension == 3 ? ACROSS * ACROSS / 3 : ACROSS;
  pbf_params params = column_params(-1);
  pbf_desc desc = test_desc(dimension, precision, 3 * DEEP * columns);
  for (int k = 0; k < 3; ++k) {
    params.domain_min[k] = -190 * spacing;
    params.domain_max[k] = 310 * spacing;
  }
  pbf_solver *s = block(&desc, &params, columns, DEEP, 0, 0, 1);
  for (int k = 0; k < 24; ++k) {
    const double left = 194.26 * spacing + 0.0013 * k;
    set_vessel(s, dimension, left, inside, 2 * spacing);
    if (!keeps_grid(s)) fail_msg("%uD, at %g: no grid", dimension, left);
  }
  pbf_destroy(s);
}

static void vessels_in_wide_domains(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_wide_domain);
  test_for_long_kinds(check_seams);
}

typedef struct filled {
  const char *what;
  double left[2], right[2], low, high; /* of up to two boxes in spacings, from wall to wall */
  int deep;
} filled;

static void set_boxes(pbf_solver *s, const filled *in) {
  pbf_collider boxes[2];
  uint32_t count = 0;
  for (int k = 0; k < 2; ++k) {
    if (!(in->right[k] > in->left[k])) continue;
    pbf_collider *box = &boxes[count++];
    assert_ok(pbf_collider_init(box, sizeof *box, PBF_COLLIDER_BOX));
    box->position[0] = 0.5 * spacing * (in->left[k] + in->right[k]);
    box->position[1] = 0.5 * spacing * (in->low + in->high);
    box->half_extents[0] = 0.5 * spacing * (in->right[k] - in->left[k]);
    box->half_extents[1] = 0.5 * spacing * (in->high - in->low);
  }
  assert_ok(pbf_set_colliders(s, count, boxes));
}

/* Solids may fill most of the domain: in a tank six times as wide as the column it would be ten
 * layers deep. */
static void check_among_solids(uint32_t dimension, uint32_t precision) {
  static const filled all[] = {
      {"nothing", {0, 0}, {0, 0}, 0, 0, 0},
      {"a block at a wall", {6, 0}, {36, 0}, 0, 72, 1},
      {"a block in the middle", {6, 0}, {30, 0}, 0, 70, 1},
      {"two that leave a neck above", {0, 21}, {15, 36}, 4, 72, 1},
      {"a low sill", {19, 0}, {21, 0}, 0, 6, 0},
      {"a block above the water", {6, 0}, {36, 0}, 20, 72, 0},
  };
  pbf_params params = column_params(-1);
  pbf_desc desc = test_desc(dimension, precision, MOST);
  params.domain_max[0] *= 6;
  pbf_solver *s = block(&desc, &params, COLUMNS, LAYERS, 0, 0, 1);
  for (unsigned k = 0; k < sizeof all / sizeof *all; ++k) {
    set_boxes(s, &all[k]);
    if (keeps_grid(s) != all[k].deep)
      fail_msg("%uD, beside %s: %s grid", dimension, all[k].what, all[k].deep ? "no" : "a");
  }
  set_boxes(s, &all[1]);
  assert_ok(pbf_step(s, 400));
  if (!(fabs(lost_height(s)) < 0.01))
    fail_msg("%uD: %g of the height lost beside a block", dimension, lost_height(s));
  pbf_destroy(s);
}

static void solids_leave_deep_water(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_among_solids);
}

static void set_two_phases(pbf_solver *s, uint32_t count, double density, double viscosity) {
  pbf_phase phases[2];
  uint32_t *upper = calloc(count, sizeof *upper);
  assert_non_null(upper);
  for (uint32_t i = 0; i < count; ++i) upper[i] = i / COLUMNS % LAYERS >= LAYERS / 2;
  for (int k = 0; k < 2; ++k) assert_ok(pbf_phase_init(&phases[k], sizeof phases[k]));
  phases[1].rest_density = density;
  phases[1].viscosity = viscosity;
  assert_ok(pbf_set_phases(s, 2, phases));
  assert_ok(pbf_set_particle_phases(s, 0, count, upper));
  free(upper);
}

/* Fluids are as deep as one is: where they differ in viscosity alone, and with wide kernels. Of
 * those that differ by more than a grid carries none has one. */
static void check_fluids(uint32_t dimension, uint32_t precision) {
  static const struct {
    double density, viscosity, h;
    int has[2]; /* shallow, deep */
  } all[] = {{1, 0.5, 2, {0, 1}}, {0.8, 1, 3, {0, 1}}, {0.8, 1, 2, {1, 1}}, {0.3, 1, 2, {0, 0}}};
  const uint32_t thick = dimension == 3 ? 3 : 1, shallow = 10;
  pbf_desc desc = test_desc(dimension, precision, MOST);
  for (unsigned k = 0; k < sizeof all / sizeof *all; ++k) {
    pbf_params params = column_params(-1);
    params.spacing = spacing;
    params.smoothing_radius = all[k].h * spacing;
    params.viscosity = 1e-3;
    for (int deep = 0; deep < 2; ++deep) {
      const uint32_t layers = deep ? LAYERS : shallow;
      pbf_solver *s = block(&desc, &params, COLUMNS, layers, 0, 0, 1);
      set_two_phases(s, layers * COLUMNS * thick, all[k].density, all[k].viscosity);
      if (keeps_grid(s) != all[k].has[deep])
        fail_msg("%uD, %u layers of 1 and %g, h = %g d: %s grid", dimension, layers, all[k].density,
                 all[k].h, keeps_grid(s) ? "a" : "no");
      if (deep && k == 0) {
        assert_ok(pbf_step(s, 400));
        if (!(fabs(lost_height(s)) < 0.01))
          fail_msg("%uD: %g of the height lost by two of one density", dimension, lost_height(s));
      }
      pbf_destroy(s);
    }
  }
}

static void fluids_are_as_deep_as_one(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_skip_if_watched();
  test_for_long_kinds(check_fluids);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(where_eddies_want_it),
      cmocka_unit_test(where_water_could_be_deep),
      cmocka_unit_test(bottles_are_deep),
      cmocka_unit_test(planes_hold_deep_water),
      cmocka_unit_test(thick_boxes_hold_deep_water),
      cmocka_unit_test(vessels_in_wide_domains),
      cmocka_unit_test(solids_leave_deep_water),
      cmocka_unit_test(fluids_are_as_deep_as_one),
  };
  return TEST_RUN(tests);
}
