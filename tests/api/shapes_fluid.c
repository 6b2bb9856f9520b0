/* What a fluid does at solids of any shape. */
#include "shape_solids.h"

#include <stdio.h>

static const double gravity = 9.81;

/* ---- Fluids --------------------------------------------------------------------------------- */

/* A sanitizer watches a tenth of the time, in which nothing comes to rest. */
enum { MOST = 4000, PART = TEST_INSTRUMENTED ? 10 : 1, COMES_TO_REST = !TEST_INSTRUMENTED };

typedef struct scene {
  uint32_t dimension, precision, count;
  pbf_params params;
  double points[3 * MOST], velocities[3 * MOST];
  pbf_collider collider;
} scene;

static scene *scene_of(uint32_t dimension, uint32_t precision) {
  scene *s = calloc(1, sizeof *s);
  assert_non_null(s);
  s->dimension = dimension;
  s->precision = precision;
  s->params = test_params();
  s->params.iterations = 4;
  s->params.time_step = 1.0 / 120;
  for (int k = 0; k < 3; ++k) {
    s->params.gravity[k] = k == 1 ? -gravity : 0;
    s->params.domain_min[k] = -1.5;
    s->params.domain_max[k] = 1.5;
  }
  return s;
}

/* A lattice of what lies in `within` by half a spacing, below a height; turned with the collider.
 */
static void fill(scene *s, solid within, const double reach[3], double top, double angle) {
  const int n = 40;
  const double c = cos(angle), sine = sin(angle);
  for (int k = s->dimension == 3 ? -n : 0; k < (s->dimension == 3 ? n : 1); ++k)
    for (int j = -n; j < n; ++j)
      for (int i = -n; i < n; ++i) {
        const double p[3] = {d * (i + 0.5), d * (j + 0.5), s->dimension == 3 ? d * (k + 0.5) : 0};
        if (p[1] > top || fabs(p[0]) > reach[0] || fabs(p[1]) > reach[1]) continue;
        if (within(p, s->dimension) > -0.5 * d + 1e-6) continue;
        assert_true(s->count < MOST);
        double *at = &s->points[3 * s->count++];
        at[0] = c * p[0] - sine * p[1];
        at[1] = sine * p[0] + c * p[1];
        at[2] = p[2];
      }
  s->collider.orientation[2] = sin(0.5 * angle);
  s->collider.orientation[3] = cos(0.5 * angle);
}

static pbf_solver *started(const scene *s) {
  const pbf_desc desc = test_desc(s->dimension, s->precision, s->count);
  pbf_solver *solver = test_create(&desc, &s->params);
  const size_t numbers = (size_t)s->count * s->dimension;
  void *x = calloc(numbers, s->precision), *v = calloc(numbers, s->precision);
  assert_non_null(x);
  assert_non_null(v);
  for (uint32_t i = 0; i < s->count; ++i)
    for (uint32_t k = 0; k < s->dimension; ++k) {
      test_put(x, (uint64_t)i * s->dimension + k, s->precision, s->points[3 * i + k]);
      test_put(v, (uint64_t)i * s->dimension + k, s->precision, s->velocities[3 * i + k]);
    }
  assert_ok(pbf_set_colliders(solver, 1, &s->collider));
  assert_ok(pbf_add_particles(solver, s->count, x, v, NULL));
  free(x);
  free(v);
  return solver;
}

/* What is asked of a fluid, in the collider's frame. */
typedef struct findings {
  double level;   /* twice the mean height above the lowest place of `within` */
  double speed;   /* RMS, over √(g d) */
  double deepest; /* how far a particle is out of `within`, at most */
} findings;

static findings find(pbf_solver *solver, const scene *s, solid within, double lowest) {
  findings f = {0, 0, -INFINITY};
  const size_t numbers = (size_t)s->count * s->dimension;
  void *x = calloc(numbers, s->precision), *v = calloc(numbers, s->precision);
  pbf_collider now = {.struct_size = sizeof now};
  assert_ok(pbf_get_collider(solver, 0, &now));
  assert_ok(pbf_get_positions(solver, 0, s->count, x));
  assert_ok(pbf_get_velocities(solver, 0, s->count, v));
  const double angle = 2 * atan2(now.orientation[2], now.orientation[3]);
  for (uint32_t i = 0; i < s->count; ++i) {
    double p[3] = {0, 0, 0}, speed[3] = {0, 0, 0};
    for (uint32_t k = 0; k < s->dimension; ++k) {
      const uint64_t at = (uint64_t)i * s->dimension + k;
      p[k] = test_value(x, at, s->precision) - now.position[k];
      speed[k] = test_value(v, at, s->precision);
    }
    const double turned[3] = {cos(angle) * p[0] + sin(angle) * p[1],
                              -sin(angle) * p[0] + cos(angle) * p[1], p[2]};
    f.deepest = fmax(f.deepest, within(turned, s->dimension));
    f.level += 2 * (turned[1] - lowest) / s->count;
    f.speed += pow(length_of(speed, s->dimension), 2) / s->count;
  }
  f.speed = sqrt(f.speed / (gravity * d));
  free(x);
  free(v);
  return f;
}

/* As a mesh: its profile, in 3D turned about the axis. */
static mesh cup_mesh(uint32_t dimension) {
  const double out = cup_radius + cup_wall;
  const double flat[8][2] = {{-out, -cup_wall},         {out, -cup_wall},  {out, cup_height},
                             {cup_radius, cup_height},  {cup_radius, 0},   {-cup_radius, 0},
                             {-cup_radius, cup_height}, {-out, cup_height}};
  const double turned[6][2] = {{0, -cup_wall},           {out, -cup_wall}, {out, cup_height},
                               {cup_radius, cup_height}, {cup_radius, 0},  {0, 0}};
  return dimension == 2 ? profile_mesh(2, 8, flat, 0) : profile_mesh(3, 6, turned, 96);
}

static scene *cup_of_water(uint32_t dimension, uint32_t precision, double top, double angle) {
  const double room[3] = {cup_radius, cup_height, cup_radius};
  scene *s = scene_of(dimension, precision);
  mesh m = cup_mesh(dimension);
  s->collider = collider_of(baked(&m, 0.25 * d, 0));
  mesh_free(&m);
  fill(s, cup_room, room, top, angle);
  return s;
}

static void end(scene *s, pbf_solver *solver) {
  pbf_release_shape(s->collider.geometry);
  pbf_destroy(solver);
  free(s);
}

/* A cup holds water for ten seconds, at the height of its volume, at rest. */
static void a_cup_holds(uint32_t dimension, uint32_t precision) {
  scene *s = cup_of_water(dimension, precision, 0.35, 0);
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 1200 / PART));
  const findings f = find(solver, s, cup_room, 0);
  const double area = dimension == 3 ? acos(-1) * cup_radius * cup_radius : 2 * cup_radius;
  const double volume = s->count * pow(d, dimension);
  assert_true(f.deepest < 0);
  if (COMES_TO_REST) assert_true(fabs(f.level - volume / area) < 0.5 * d);
  if (COMES_TO_REST) assert_true(f.speed < 0.02);
  end(s, solver);
}

static void a_tilted_cup_holds(uint32_t dimension, uint32_t precision) {
  scene *s = cup_of_water(dimension, precision, 0.25, acos(-1) / 6);
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 1200 / PART));
  const findings f = find(solver, s, cup_room, 0);
  assert_true(f.deepest < 0);
  if (COMES_TO_REST) assert_true(f.speed < 0.05);
  end(s, solver);
}

static void cups_hold_water(void **state) {
  (void)state;
  test_skip_if_watched();
  skip_without_fluid();
  test_for_long_kinds(a_cup_holds);
  test_for_long_kinds(a_tilted_cup_holds);
}

/* Carried to and fro, and turned about its axis and out of it by less than the water spills at. */
static void a_carried_cup_holds(uint32_t dimension, uint32_t precision) {
  scene *s = cup_of_water(dimension, precision, 0.25, 0);
  pbf_solver *solver = started(s);
  for (int k = 0; k < 40; ++k) {
    pbf_collider target = s->collider;
    const double t = 0.15 * (k + 1), angle = 0.2 * sin(2 * t);
    target.position[0] = 0.2 * sin(3 * t);
    target.position[1] = 0.1 * sin(2 * t);
    target.orientation[2] = sin(0.5 * angle);
    target.orientation[3] = cos(0.5 * angle);
    assert_ok(pbf_move_colliders(solver, 1, &target, 0.15));
    assert_ok(pbf_step(solver, 18));
    assert_true(find(solver, s, cup_room, 0).deepest < 0);
  }
  end(s, solver);
}

static void carried_cups_hold_water(void **state) {
  (void)state;
  test_skip_if_watched();
  skip_without_fluid();
  test_for_long_kinds(a_carried_cup_holds);
}

/* A container of a mesh is as the box that this is of: level, and density. */
static void a_box_is_a_box(uint32_t dimension, uint32_t precision) {
  findings f[2];
  double density[2];
  for (int as_shape = 0; as_shape < 2; ++as_shape) {
    scene *s = scene_of(dimension, precision);
    mesh m = box_mesh(dimension, box_half);
    pbf_shape *shape = baked(&m, 0.5 * d, 0);
    pbf_stats stats = {.struct_size = sizeof stats};
    s->collider = collider_of(shape);
    if (!as_shape) {
      assert_ok(pbf_collider_init(&s->collider, sizeof s->collider, PBF_COLLIDER_BOX));
      memcpy(s->collider.half_extents, box_half, sizeof box_half);
    }
    s->collider.inverted = 1;
    fill(s, box, box_half, 0.1, 0);
    pbf_solver *solver = started(s);
    assert_ok(pbf_step(solver, 600 / PART));
    f[as_shape] = find(solver, s, box, -box_half[1]);
    assert_ok(pbf_get_stats(solver, &stats));
    density[as_shape] = stats.density_mean;
    pbf_destroy(solver);
    pbf_release_shape(shape);
    mesh_free(&m);
    free(s);
  }
  assert_true(f[1].deepest < 0);
  if (!COMES_TO_REST) return;
  assert_true(fabs(f[1].level / f[0].level - 1) < 0.01);
  assert_true(fabs(density[1] - density[0]) < 0.01 * density[0]);
  assert_true(f[1].speed < 0.03);
}

static void boxes_are_boxes(void **state) {
  (void)state;
  skip_without_fluid();
  test_for_long_kinds(a_box_is_a_box);
}

/* Across the y axis, open, and too wide to be gone around. */
static mesh plate_mesh(uint32_t dimension) {
  mesh m = mesh_of(dimension, 4, 2);
  for (int i = 0; i < 4; ++i) add_vertex(&m, i & 1 ? 0.5 : -0.5, 0, i & 2 ? 0.3 : -0.3);
  add_face(&m, 0, 1, 2);
  if (dimension == 3) add_face(&m, 1, 2, 3);
  return m;
}

/* Particles that go 20 spacings a step meet a shell of half a spacing. */
static void nothing_passes(uint32_t dimension, uint32_t precision) {
  scene *s = scene_of(dimension, precision);
  mesh m = plate_mesh(dimension);
  s->params.gravity[1] = 0;
  s->params.domain_min[0] = -0.45;
  s->params.domain_max[0] = 0.45;
  s->params.domain_min[2] = -0.25;
  s->params.domain_max[2] = 0.25;
  s->collider = collider_of(baked(&m, 0.3 * d, 0.5 * d));
  mesh_free(&m);
  for (int i = 0; i < 96; ++i) {
    double *x = &s->points[3 * s->count], *v = &s->velocities[3 * s->count++];
    x[0] = -0.4 + 0.1 * (i % 8), x[1] = 0.1 + 0.06 * (i / 32), x[2] = -0.15 + 0.1 * (i / 8 % 4);
    if (dimension == 2) x[1] = 0.1 + 0.06 * (i / 8);
    v[1] = -20 * d * 120;
    v[0] = (i % 3 - 1) * 12 * d * 120;
  }
  pbf_solver *solver = started(s);
  void *x = calloc((size_t)s->count * dimension, precision);
  for (int step = 0; step < 10; ++step) {
    assert_ok(pbf_step(solver, 1));
    assert_ok(pbf_get_positions(solver, 0, s->count, x));
    for (uint32_t i = 0; i < s->count; ++i)
      assert_true(test_value(x, (uint64_t)i * dimension + 1, precision) > 0);
  }
  free(x);
  end(s, solver);
}

static void nothing_passes_a_plate(void **state) {
  (void)state;
  skip_without_fluid();
  test_for_each_kind(nothing_passes);
}

/* What is larger by a scale is as a shape that is. */
static void a_scale_is_a_size(uint32_t dimension, uint32_t precision) {
  scene *s = cup_of_water(dimension, precision, 0.2, 0);
  pbf_release_shape(s->collider.geometry);
  const double reach[3] = {ball_radius, ball_radius, ball_radius};
  s->collider.geometry = shape_of(dimension, ball, reach, 0.25 * d);
  s->collider.scale = 2;
  s->collider.inverted = 1;
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 240));
  const findings f = find(solver, s, ball, 0);
  assert_true(f.deepest < ball_radius);
  assert_true(f.deepest > 0.5 * ball_radius);
  end(s, solver);
}

/* A bowl in a terrain: what is poured into it comes to rest there, and none of it below. */
static double above_bowl(const double p[3], uint32_t dimension) {
  const double r2 = p[0] * p[0] + (dimension == 3 ? p[2] * p[2] : 0);
  return 0.15 + 1.5 * r2 - p[1];
}

static void a_bowl_holds(uint32_t dimension, uint32_t precision) {
  enum { SIDE = 33 };
  scene *s = scene_of(dimension, precision);
  double heights[SIDE * SIDE];
  for (int i = 0; i < SIDE * SIDE; ++i) {
    const double p[3] = {0.8 * (i % SIDE) / (SIDE - 1) - 0.4, 0,
                         dimension == 3 ? 0.8 * (i / SIDE) / (SIDE - 1) - 0.4 : 0};
    heights[i] = above_bowl(p, dimension);
  }
  const pbf_heights_desc terrain = {.struct_size = sizeof terrain,
                                    .dimension = dimension,
                                    .count = {SIDE, SIDE},
                                    .heights = heights,
                                    .spacing = 0.8 / (SIDE - 1),
                                    .base = 0,
                                    .cell = 0.5 * d};
  const double room[3] = {0.3, 0.6, 0.3};
  pbf_shape *shape;
  assert_ok(pbf_shape_from_heights(&terrain, &shape));
  s->collider = collider_of(shape);
  s->collider.position[0] = -0.4;
  s->collider.position[2] = dimension == 3 ? -0.4 : 0;
  fill(s, above_bowl, room, 0.3, 0);
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 900 / PART));
  void *x = calloc((size_t)s->count * dimension, precision);
  double speed = find(solver, s, above_bowl, 0).speed;
  assert_ok(pbf_get_positions(solver, 0, s->count, x));
  for (uint32_t i = 0; i < s->count; ++i) {
    double p[3] = {0, 0, 0};
    for (uint32_t k = 0; k < dimension; ++k)
      p[k] = test_value(x, (uint64_t)i * dimension + k, precision);
    assert_true(above_bowl(p, dimension) < 0.05 * d);
    assert_true(p[1] < 0.45);
  }
  if (COMES_TO_REST) assert_true(speed < 0.05);
  free(x);
  end(s, solver);
}

static void bowls_hold_water(void **state) {
  (void)state;
  skip_without_fluid();
  test_for_long_kinds(a_bowl_holds);
}

static void scales_are_sizes(void **state) {
  (void)state;
  test_skip_if_watched();
  skip_without_fluid();
  test_for_long_kinds(a_scale_is_a_size);
}

/* ---- Shapes that go ------------------------------------------------------------------------- */

static const double block_half[3] = {0.06, 0.06, 0.06};

static double block(const double p[3], uint32_t dimension) {
  return box_of(p, dimension, block_half);
}

/* Water around a block that divides cells of its pressure grid; after a step a ball takes its
 * place. The pressures are still those of that step: its hash and theirs, once the caller has given
 * the block's shape back, be that before or after. */
static void pressures_after_a_shape(uint32_t dimension, uint32_t precision, int kept,
                                    uint64_t *hash, double *pressures) {
  enum { ROOM = 64 };
  void *others[ROOM];
  scene *s = scene_of(dimension, precision);
  s->params.pressure_grid = 2;
  for (uint32_t k = 0; k < 3; ++k) s->params.domain_min[k] = 0, s->params.domain_max[k] = 1;
  const uint32_t side = dimension == 3 ? 8 : 10;
  for (uint32_t i = 0; i < (dimension == 3 ? side * side * side : side * side); ++i) {
    const uint32_t at[3] = {i % side, i / side % side, i / side / side};
    for (uint32_t k = 0; k < 3; ++k) s->points[3 * s->count + k] = d * (at[k] + 0.5);
    ++s->count;
  }
  const double reach[3] = {block_half[0], block_half[1], block_half[2]};
  pbf_shape *before = shape_of(dimension, block, reach, 0.25 * d);
  s->collider = collider_of(before);
  for (uint32_t k = 0; k < dimension; ++k) s->collider.position[k] = 0.2;
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 1));
  if (!kept) {
    pbf_release_shape(before);
    s->collider.geometry = NULL;
  }
  pbf_collider ball_there;
  assert_ok(pbf_collider_init(&ball_there, sizeof ball_there, PBF_COLLIDER_SPHERE));
  ball_there.position[0] = -3;
  assert_ok(pbf_set_colliders(solver, 1, &ball_there));
  for (size_t k = 0; k < ROOM; ++k) { /* which memory that is free again goes to */
    others[k] = malloc(1000 * (k + 1));
    assert_non_null(others[k]);
    memset(others[k], 0x5a, 1000 * (k + 1));
  }
  void *values = malloc((size_t)s->count * precision);
  assert_ok(pbf_get_pressures(solver, 0, s->count, values));
  for (uint32_t i = 0; i < s->count; ++i) pressures[i] = test_value(values, i, precision);
  assert_ok(pbf_remove_particles(solver, 1, (const uint32_t[]){3}));
  assert_ok(pbf_step(solver, 2));
  *hash = test_hash(solver);
  for (size_t k = 0; k < ROOM; ++k) free(others[k]);
  free(values);
  end(s, solver);
}

static void a_shape_goes(uint32_t dimension, uint32_t precision) {
  uint64_t with, without;
  double right[MOST], found[MOST];
  pressures_after_a_shape(dimension, precision, 1, &with, right);
  pressures_after_a_shape(dimension, precision, 0, &without, found);
  assert_int_equal(without, with);
  for (uint32_t i = 0; i < 100; ++i) assert_true(found[i] == right[i]);
}

static void pressures_outlive_shapes(void **state) {
  (void)state;
  skip_without_fluid();
  test_for_each_kind(a_shape_goes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cups_hold_water),          cmocka_unit_test(carried_cups_hold_water),
      cmocka_unit_test(boxes_are_boxes),          cmocka_unit_test(nothing_passes_a_plate),
      cmocka_unit_test(bowls_hold_water),         cmocka_unit_test(scales_are_sizes),
      cmocka_unit_test(pressures_outlive_shapes),
  };
  return TEST_RUN(tests);
}
