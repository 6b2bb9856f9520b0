/* Solids by signed distances on a grid. What is right comes from closed forms of the same solids,
 * and from what a vessel is: nothing goes through it, and what is in it comes to rest. */
#include "meshes.h"
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double d = 0.05, gravity = 9.81;

/* ---- Solids in closed form ------------------------------------------------------------------ */

typedef double (*solid)(const double p[3], uint32_t dimension);

static double length_of(const double *v, uint32_t dimension) {
  double sum = 0;
  for (uint32_t k = 0; k < dimension; ++k) sum += v[k] * v[k];
  return sqrt(sum);
}

static const double ball_radius = 0.2;

static double ball(const double p[3], uint32_t dimension) {
  return length_of(p, dimension) - ball_radius;
}

static double box_of(const double p[3], uint32_t dimension, const double half[3]) {
  double inside = -INFINITY, out[3] = {0, 0, 0};
  for (uint32_t k = 0; k < dimension; ++k) {
    const double beyond = fabs(p[k]) - half[k];
    inside = fmax(inside, beyond);
    out[k] = fmax(beyond, 0);
  }
  return inside > 0 ? length_of(out, dimension) : inside;
}

static const double box_half[3] = {0.2, 0.3, 0.2};

static double box(const double p[3], uint32_t dimension) { return box_of(p, dimension, box_half); }

/* A cup, open at the top: its room is `cup_radius` wide to each side and begins at y = 0. */
static const double cup_radius = 0.25, cup_height = 0.6, cup_wall = 0.08;

static double cup_room(const double p[3], uint32_t dimension) {
  const double across = dimension == 3 ? hypot(p[0], p[2]) : fabs(p[0]);
  return fmax(across - cup_radius, -p[1]);
}

/* ---- Their shapes --------------------------------------------------------------------------- */

/* Nodes around -reach … reach, no node at a place that the solid is symmetric about. */
static pbf_grid_desc grid_of(uint32_t dimension, solid of, const double reach[3], double cell) {
  pbf_grid_desc grid = {.struct_size = sizeof grid, .dimension = dimension, .cell = cell};
  size_t nodes = 1;
  for (uint32_t k = 0; k < dimension; ++k) {
    grid.origin[k] = -reach[k] - 3.3 * cell - 0.01 * cell * k;
    grid.nodes[k] = (uint32_t)(2 * reach[k] / cell) + 8;
    nodes *= grid.nodes[k];
  }
  if (dimension == 2) grid.nodes[2] = 1;
  float *values = malloc(nodes * sizeof *values);
  assert_non_null(values);
  for (size_t n = 0; n < nodes; ++n) {
    const size_t at[3] = {n % grid.nodes[0], n / grid.nodes[0] % grid.nodes[1],
                          n / grid.nodes[0] / grid.nodes[1]};
    double p[3];
    for (int k = 0; k < 3; ++k) p[k] = grid.origin[k] + cell * (double)at[k];
    values[n] = (float)of(p, dimension);
  }
  grid.values = values;
  return grid;
}

static pbf_shape *shape_of(uint32_t dimension, solid of, const double reach[3], double cell) {
  const pbf_grid_desc grid = grid_of(dimension, of, reach, cell);
  pbf_shape *shape = NULL;
  assert_ok(pbf_shape_from_grid(&grid, &shape));
  assert_non_null(shape);
  free((void *)grid.values);
  return shape;
}

static pbf_shape *small_ball(uint32_t dimension) {
  const double reach[3] = {ball_radius, ball_radius, ball_radius};
  return shape_of(dimension, ball, reach, 0.25 * d);
}

static pbf_collider collider_of(pbf_shape *shape) {
  pbf_collider collider;
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_SHAPE));
  collider.geometry = shape;
  return collider;
}

static uint32_t references_to(pbf_shape *shape) {
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  return info.references;
}

/* ---- Distances ------------------------------------------------------------------------------ */

/* Of a sphere within what a quadratic B-spline is off, cell² / (4 r) of its radius of curvature r,
 * and outside of the grid no farther than the ball. */
static void distances_are_those_of_a_ball(uint32_t dimension, uint32_t precision) {
  pbf_shape *shape = small_ball(dimension);
  const double cell = 0.25 * d;
  (void)precision;
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.31 * i, r = 0.1 + 0.002 * i, up = dimension == 3 ? sin(1.7 * i) : 0;
    const double p[3] = {r * cos(angle) * sqrt(1 - up * up), r * sin(angle) * sqrt(1 - up * up),
                         r * up};
    const double right = ball(p, dimension);
    double distance, normal[3] = {0, 0, 0}, along = 0;
    assert_ok(pbf_get_shape_distance(shape, p, &distance, normal));
    for (uint32_t k = 0; k < dimension; ++k) along += normal[k] * p[k] / r;
    if (right < 0.02) {
      assert_true(fabs(distance - right) < 1.1 * (dimension - 1) * cell * cell / (8 * r));
      assert_true(along > 0.9999);
    }
    assert_true(distance < right + cell * cell / r);
    assert_true(distance > (right > 0 ? 0.7 : 1.1) * right - cell * cell);
  }
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  const double disc = acos(-1) * ball_radius * ball_radius;
  const double volume = dimension == 3 ? 4.0 / 3 * disc * ball_radius : disc;
  assert_true(fabs(info.volume / volume - 1) < 0.002);
  assert_true(fabs(info.area * ball_radius / volume / dimension - 1) < 0.01);
  for (uint32_t k = 0; k < dimension; ++k) {
    assert_true(fabs(info.lower[k] + ball_radius) < 0.1 * cell);
    assert_true(fabs(info.upper[k] - ball_radius) < 0.1 * cell);
  }
  pbf_release_shape(shape);
}

static void distances_are_right(void **state) {
  (void)state;
  distances_are_those_of_a_ball(2, 4);
  distances_are_those_of_a_ball(3, 4);
}

/* Of a box: what a mesh of it is baked to. Next to edges it is rounded off. */
static void a_mesh_has_the_box_s_distances(uint32_t dimension) {
  const double cell = 0.5 * d;
  mesh m = box_mesh(dimension, box_half);
  pbf_shape *shape = baked(&m, cell, 0);
  for (int i = 0; i < 2000; ++i) {
    double p[3], distance;
    for (int k = 0; k < 3; ++k) {
      const double part = 0.618 * (i + 1) * (k + 1) + 0.1 * i * k;
      p[k] = dimension == 2 && k == 2 ? 0 : 1.2 * box_half[k] * (2 * (part - floor(part)) - 1);
    }
    const double right = box(p, dimension);
    assert_ok(pbf_get_shape_distance(shape, p, &distance, NULL));
    assert_true((distance > 0) == (right > 0) || fabs(right) < 0.5 * cell);
    assert_true(fabs(distance - right) < (fabs(right) < 2 * cell ? 0.5 : 1) * cell);
    double others = INFINITY; /* how near to the medial axis, or to an edge */
    for (uint32_t k = 0; k < dimension; ++k)
      for (uint32_t a = 0; a < k; ++a)
        others = fmin(others, fabs(fabs(p[k]) - box_half[k] - fabs(p[a]) + box_half[a]));
    if (right < 0 && right > -0.05 && others > 2 * cell) assert_true(fabs(distance - right) < 1e-6);
  }
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  const double volume =
      (dimension == 3 ? 8 : 4) * box_half[0] * box_half[1] * (dimension == 3 ? box_half[2] : 1);
  assert_true(fabs(info.volume / volume - 1) < 0.01);
  pbf_release_shape(shape);
  /* The other way round it is the same solid. */
  for (uint32_t f = 0; f < m.face_count; ++f) {
    uint32_t *face = m.faces + f * dimension, kept = face[0];
    face[0] = face[1];
    face[1] = kept;
  }
  const double middle[3] = {0.01, 0.02, 0.01};
  double distance;
  shape = baked(&m, cell, 0);
  assert_ok(pbf_get_shape_distance(shape, middle, &distance, NULL));
  assert_true(distance < -0.1);
  pbf_release_shape(shape);
  mesh_free(&m);
}

/* A hull of a box's corners, and points within it, is the box; and so is a terrain of one height.
 */
static void hulls_and_terrains_are_boxes(uint32_t dimension) {
  double points[60][3], packed[60 * 3], heights[25];
  for (int i = 0; i < 60; ++i)
    for (int k = 0; k < 3; ++k) {
      const double inner = 0.9 * sin(3.7 * i + 1.3 * k);
      points[i][k] = box_half[k] * (i >= 30 && i < 38 ? ((i - 30) >> k & 1 ? 1 : -1) : inner);
    }
  for (int i = 0; i < 60; ++i)
    for (uint32_t k = 0; k < dimension; ++k) packed[(uint32_t)i * dimension + k] = points[i][k];
  for (int i = 0; i < 25; ++i) heights[i] = 2 * box_half[1];
  const pbf_hull_desc hull = {.struct_size = sizeof hull,
                              .dimension = dimension,
                              .point_count = 60,
                              .points = packed,
                              .cell = 0.5 * d};
  const pbf_heights_desc terrain = {.struct_size = sizeof terrain,
                                    .dimension = dimension,
                                    .count = {5, 5},
                                    .heights = heights,
                                    .spacing = 0.5 * box_half[0],
                                    .base = 0,
                                    .cell = 0.5 * d};
  pbf_shape *shapes[2];
  assert_ok(pbf_shape_from_points(&hull, &shapes[0]));
  assert_ok(pbf_shape_from_heights(&terrain, &shapes[1]));
  for (int which = 0; which < 2; ++which) {
    for (int i = 0; i < 200; ++i) {
      double p[3], moved[3], distance;
      for (int k = 0; k < 3; ++k) p[k] = 1.1 * box_half[k] * sin(0.37 * i * (k + 1) + k);
      for (int k = 0; k < 3; ++k) moved[k] = p[k] + (which ? box_half[k] : 0);
      const double right = box(p, dimension);
      assert_ok(pbf_get_shape_distance(shapes[which], moved, &distance, NULL));
      assert_true(fabs(distance - right) < 0.5 * d);
      assert_true((distance > 0) == (right > 0) || fabs(right) < 0.25 * d);
    }
    pbf_release_shape(shapes[which]);
  }
}

static void meshes_are_solids(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    a_mesh_has_the_box_s_distances(dimension);
    hulls_and_terrains_are_boxes(dimension);
  }
}

/* ---- Bad input ------------------------------------------------------------------------------ */

static void bad_grids_are_refused(void **state) {
  (void)state;
  const double reach[3] = {ball_radius, ball_radius, ball_radius};
  pbf_grid_desc good = grid_of(2, ball, reach, 0.5 * d), bad = good;
  float *values = (float *)good.values;
  pbf_shape *shape = NULL;
  bad.dimension = 4;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_INVALID_ARGUMENT, "dimension is 4");
  bad = good, bad.nodes[1] = 2;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_INVALID_ARGUMENT, "nodes[1] is 2");
  bad = good, bad.nodes[1] = 400000000;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_INVALID_ARGUMENT, "nodes[1] is 4");
  bad = good, bad.cell = NAN;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_INVALID_ARGUMENT, "cell is NaN");
  bad = good, bad.origin[1] = INFINITY;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_INVALID_ARGUMENT, "origin[1] is inf");
  bad = good, bad.values = NULL;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_INVALID_ARGUMENT, "values is null");
  bad = good, bad.struct_size = 8;
  assert_fails(pbf_shape_from_grid(&bad, &shape), PBF_ERROR_STRUCT_SIZE, "struct_size is 8");
  assert_fails(pbf_shape_from_grid(NULL, &shape), PBF_ERROR_INVALID_ARGUMENT, "null");
  assert_fails(pbf_shape_from_grid(&good, NULL), PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  const uint32_t at = 5 + 6 * good.nodes[0];
  const float kept = values[at];
  values[at] = NAN;
  assert_fails(pbf_shape_from_grid(&good, &shape), PBF_ERROR_INVALID_ARGUMENT, "is NaN");
  values[at] = kept + 1;
  assert_fails(pbf_shape_from_grid(&good, &shape), PBF_ERROR_INVALID_ARGUMENT,
               "changes by no more than the way");
  values[at] = kept;
  const float border = values[3];
  values[3] = -0.25f;
  assert_fails(pbf_shape_from_grid(&good, &shape), PBF_ERROR_INVALID_ARGUMENT,
               "[3] is -0.25, on the border");
  values[3] = border;
  for (uint32_t n = 0; n < good.nodes[0] * good.nodes[1]; ++n) values[n] = 0.1f;
  assert_fails(pbf_shape_from_grid(&good, &shape), PBF_ERROR_INVALID_ARGUMENT, "no inside");
  assert_null(shape);
  free(values);
}

static void fails_as(const mesh *m, const char *words) {
  const pbf_mesh_desc desc = mesh_desc_of(m, 0.5 * d, 0);
  pbf_shape *shape = NULL;
  assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT, words);
  assert_null(shape);
}

static void bad_meshes_are_refused(void **state) {
  (void)state;
  mesh m = box_mesh(3, box_half), flat = box_mesh(2, box_half);
  m.face_count = 11;
  fails_as(&m, "mesh is open: the edge of vertices 4 and 6 is that of triangle 0");
  m.face_count = 12;
  const uint32_t kept = m.faces[3 * 4];
  m.faces[3 * 4] = m.faces[3 * 4 + 1];
  m.faces[3 * 4 + 1] = kept;
  fails_as(&m, "face opposite sides");
  m.faces[3 * 4 + 1] = m.faces[3 * 4];
  fails_as(&m, "triangle without an area, number 4");
  m.faces[3 * 4 + 1] = 99;
  fails_as(&m, "mesh.faces[4][1] is 99; there are 8 vertices");
  m.vertices[5] = NAN;
  fails_as(&m, "mesh.vertices[1][2] is NaN");
  mesh_free(&m);
  flat.face_count = 3;
  fails_as(&flat, "mesh is open: vertex 0 is that of segment 0");
  flat.face_count = 4;
  flat.vertices[2] = -0.1, flat.vertices[4] = 0.4, flat.vertices[6] = 0.3; /* a bow tie */
  flat.vertices[7] = -0.2;
  fails_as(&flat, "crosses itself: segment");
  mesh_free(&flat);
  m = box_mesh(3, box_half);
  m.vertices[0] = 0.9, m.vertices[1] = 0.1; /* a corner pulled through the opposite side */
  fails_as(&m, "crosses itself: triangle");
  pbf_mesh_desc desc = mesh_desc_of(&m, 0.5 * d, 0.5 * d);
  pbf_shape *shape = NULL;
  assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT,
               "at least 1.5 cells");
  desc = mesh_desc_of(&m, 1e-6, 0);
  assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT, "mesh.nodes[");
  desc = mesh_desc_of(&m, 0.5 * d, 0);
  desc.faces = NULL;
  assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT, "faces is null");
  const double heights[4] = {1, 2, -1, 1}, line[8] = {0, 0, 1, 1, 2, 2, 3, 3};
  const pbf_heights_desc low = {.struct_size = sizeof low,
                                .dimension = 3,
                                .count = {2, 2},
                                .heights = heights,
                                .spacing = 1,
                                .base = 0,
                                .cell = 0.1};
  assert_fails(pbf_shape_from_heights(&low, &shape), PBF_ERROR_INVALID_ARGUMENT,
               "heights[2] is -1; it must be above base, 0");
  const pbf_hull_desc thin = {
      .struct_size = sizeof thin, .dimension = 2, .point_count = 4, .points = line, .cell = 0.1};
  assert_fails(pbf_shape_from_points(&thin, &shape), PBF_ERROR_INVALID_ARGUMENT, "all in one line");
  mesh_free(&m);
}

/* In a GPU's kernels distances on a grid cost too much, whether or not there are any. */
static int refuses_shapes(void) { return strcmp(test_backend(), "cuda") == 0; }

static void skip_without_shapes(void) {
  if (refuses_shapes()) test_skip("cuda has no colliders of shapes");
}

static void skip_without_fluid_at_shapes(void) {
  skip_without_shapes();
  if (test_is_stub()) test_skip("the stub has no fluid");
}

static void a_backend_without_them_says_so(void **state) {
  (void)state;
  if (!refuses_shapes()) test_skip("the backend has colliders of shapes");
  pbf_shape *ball = small_ball(3);
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 8, 8);
  const pbf_collider collider = collider_of(ball);
  const uint64_t before = test_hash(solver);
  assert_fails(pbf_set_colliders(solver, 1, &collider), PBF_ERROR_UNSUPPORTED,
               "colliders[0] has a geometry");
  assert_true(test_hash(solver) == before);
  pbf_destroy(solver);
  pbf_release_shape(ball);
}

static void bad_colliders_are_refused(void **state) {
  (void)state;
  skip_without_shapes();
  pbf_shape *flat = small_ball(2), *full = small_ball(3);
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 8, 8);
  pbf_collider bad = collider_of(flat);
  assert_fails(pbf_set_colliders(solver, 1, &bad), PBF_ERROR_INVALID_ARGUMENT, "shape in 2D");
  bad.geometry = NULL;
  assert_fails(pbf_set_colliders(solver, 1, &bad), PBF_ERROR_INVALID_ARGUMENT, "geometry is null");
  bad.geometry = (pbf_shape *)&bad;
  assert_fails(pbf_set_colliders(solver, 1, &bad), PBF_ERROR_INVALID_ARGUMENT,
               "which is no shape that lives");
  bad = collider_of(full);
  bad.scale = 0;
  assert_fails(pbf_set_colliders(solver, 1, &bad), PBF_ERROR_INVALID_ARGUMENT, "scale is 0");
  bad = collider_of(full);
  bad.shape = PBF_COLLIDER_BOX;
  assert_fails(pbf_set_colliders(solver, 1, &bad), PBF_ERROR_INVALID_ARGUMENT,
               "geometry is set, and shape 3");
  assert_int_equal(references_to(full), 1);
  pbf_destroy(solver);
  pbf_release_shape(flat);
  pbf_release_shape(full);
}

/* ---- References ----------------------------------------------------------------------------- */

static void shapes_live_as_long_as_they_are_held(void **state) {
  (void)state;
  skip_without_shapes();
  pbf_shape *shape = small_ball(3);
  pbf_solver *a = test_filled(3, PBF_FLOAT32, 8, 8), *b = test_filled(3, PBF_FLOAT32, 8, 8);
  pbf_collider two[2] = {collider_of(shape), collider_of(shape)};
  two[0].position[0] = two[1].position[0] = 5;
  two[1].position[1] = 3;
  assert_ok(pbf_set_colliders(a, 2, two));
  assert_ok(pbf_set_colliders(b, 1, two));
  assert_int_equal(references_to(shape), 4);
  assert_ok(pbf_set_colliders(a, 2, two));
  assert_ok(pbf_move_colliders(a, 2, two, 0.1));
  assert_int_equal(references_to(shape), 4);
  pbf_destroy(b);
  assert_int_equal(references_to(shape), 3);
  pbf_release_shape(shape);
  assert_ok(pbf_step(a, 3));
  assert_int_equal(references_to(shape), 2);
  assert_ok(pbf_set_colliders(a, 0, NULL));
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_fails(pbf_get_shape_info(shape, &info), PBF_ERROR_INVALID_ARGUMENT, "no shape that lives");
  pbf_destroy(a);
  pbf_release_shape(NULL);
}

/* A saved state names the shape, and finds another one of the same content. */
static void states_name_shapes(void **state) {
  (void)state;
  skip_without_shapes();
  pbf_shape *shape = small_ball(3);
  pbf_solver *solver = test_filled(3, PBF_FLOAT32, 64, 64);
  pbf_collider collider = collider_of(shape), loaded = {.struct_size = sizeof loaded};
  uint64_t size;
  assert_ok(pbf_set_colliders(solver, 1, &collider));
  void *saved = test_save(solver, &size);
  assert_ok(pbf_step(solver, 5));
  const uint64_t right = test_hash(solver);
  assert_ok(pbf_set_colliders(solver, 0, NULL));
  pbf_release_shape(shape);
  assert_fails(pbf_load(solver, saved, size), PBF_ERROR_DATA, "has to be made before pbf_load");
  shape = small_ball(3);
  assert_ok(pbf_load(solver, saved, size));
  assert_ok(pbf_get_collider(solver, 0, &loaded));
  assert_ptr_equal(loaded.geometry, shape);
  assert_int_equal(references_to(shape), 2);
  assert_ok(pbf_step(solver, 5));
  assert_true(test_hash(solver) == right);
  free(saved);
  pbf_destroy(solver);
  assert_int_equal(references_to(shape), 1);
  pbf_release_shape(shape);
}

/* ---- Fluids --------------------------------------------------------------------------------- */

enum { MOST = 4000 };

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
  assert_ok(pbf_step(solver, 1200));
  const findings f = find(solver, s, cup_room, 0);
  const double area = dimension == 3 ? acos(-1) * cup_radius * cup_radius : 2 * cup_radius;
  const double volume = s->count * pow(d, dimension);
  assert_true(f.deepest < 0);
  assert_true(fabs(f.level - volume / area) < 0.5 * d);
  assert_true(f.speed < 0.02);
  end(s, solver);
}

static void a_tilted_cup_holds(uint32_t dimension, uint32_t precision) {
  scene *s = cup_of_water(dimension, precision, 0.25, acos(-1) / 6);
  pbf_solver *solver = started(s);
  assert_ok(pbf_step(solver, 1200));
  const findings f = find(solver, s, cup_room, 0);
  assert_true(f.deepest < 0);
  assert_true(f.speed < 0.05);
  end(s, solver);
}

static void cups_hold_water(void **state) {
  (void)state;
  skip_without_fluid_at_shapes();
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
  skip_without_fluid_at_shapes();
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
    assert_ok(pbf_step(solver, 600));
    f[as_shape] = find(solver, s, box, -box_half[1]);
    assert_ok(pbf_get_stats(solver, &stats));
    density[as_shape] = stats.density_mean;
    pbf_destroy(solver);
    pbf_release_shape(shape);
    mesh_free(&m);
    free(s);
  }
  assert_true(f[1].deepest < 0);
  assert_true(fabs(f[1].level / f[0].level - 1) < 0.01);
  assert_true(fabs(density[1] - density[0]) < 0.01 * density[0]);
  assert_true(f[1].speed < 0.03);
}

static void boxes_are_boxes(void **state) {
  (void)state;
  skip_without_fluid_at_shapes();
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
  skip_without_fluid_at_shapes();
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
  assert_ok(pbf_step(solver, 900));
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
  assert_true(speed < 0.05);
  free(x);
  end(s, solver);
}

static void bowls_hold_water(void **state) {
  (void)state;
  skip_without_fluid_at_shapes();
  test_for_long_kinds(a_bowl_holds);
}

static void scales_are_sizes(void **state) {
  (void)state;
  skip_without_fluid_at_shapes();
  test_for_long_kinds(a_scale_is_a_size);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_are_right),
      cmocka_unit_test(meshes_are_solids),
      cmocka_unit_test(bad_grids_are_refused),
      cmocka_unit_test(bad_meshes_are_refused),
      cmocka_unit_test(bad_colliders_are_refused),
      cmocka_unit_test(shapes_live_as_long_as_they_are_held),
      cmocka_unit_test(states_name_shapes),
      cmocka_unit_test(a_backend_without_them_says_so),
      cmocka_unit_test(cups_hold_water),
      cmocka_unit_test(carried_cups_hold_water),
      cmocka_unit_test(boxes_are_boxes),
      cmocka_unit_test(nothing_passes_a_plate),
      cmocka_unit_test(bowls_hold_water),
      cmocka_unit_test(scales_are_sizes),
  };
  return TEST_RUN(tests);
}
