/* Solids of any shape: their distances, what is refused, references, states. */
#include "shape_solids.h"

#include <stdio.h>

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

/* How far a place is from a face: the nearest of many of its points, of which one is the foot on
 * its plane or line where that is within. */
static double distance_to_face(const mesh *m, uint32_t face, const double place[3]) {
  const uint32_t dimension = m->dimension, *corner = m->faces + (size_t)face * dimension;
  double a[3] = {0, 0, 0}, sides[2][3] = {{0}}, arm[3] = {0, 0, 0}, least = INFINITY;
  for (uint32_t k = 0; k < dimension; ++k) {
    a[k] = m->vertices[corner[0] * dimension + k];
    arm[k] = place[k] - a[k];
    for (uint32_t c = 0; c + 1 < dimension; ++c)
      sides[c][k] = m->vertices[corner[c + 1] * dimension + k] - a[k];
  }
  double uu = 0, uv = 0, vv = 0, up = 0, vp = 0, pp = 0;
  for (int k = 0; k < 3; ++k) {
    uu += sides[0][k] * sides[0][k], uv += sides[0][k] * sides[1][k];
    vv += sides[1][k] * sides[1][k], pp += arm[k] * arm[k];
    up += sides[0][k] * arm[k], vp += sides[1][k] * arm[k];
  }
  /* Squared distance to a + s u + t v: the feet on three edges, and that on the plane. */
  const double det = uu * vv - uv * uv, s = (up * vv - vp * uv) / det,
               t = (vp * uu - up * uv) / det;
  const double on_u = fmin(fmax(up / uu, 0), 1), on_v = vv > 0 ? fmin(fmax(vp / vv, 0), 1) : 0;
  const double on_w = vv > 0 ? fmin(fmax((vp - up + uu - uv) / (uu - 2 * uv + vv), 0), 1) : 0;
  const double tried[4][2] = {{on_u, 0}, {0, on_v}, {1 - on_w, on_w}, {s, t}};
  for (int i = 0; i < (dimension == 2 ? 1 : 4); ++i) {
    const double x = tried[i][0], y = tried[i][1];
    if (!(x >= 0 && y >= 0 && x + y <= 1 + 1e-12)) continue;
    least = fmin(least, pp - 2 * (x * up + y * vp) + x * x * uu + 2 * x * y * uv + y * y * vv);
  }
  return sqrt(fmax(least, 0));
}

/* Curved both ways, hollow in places, of faces large and small. */
static mesh bumpy_mesh(uint32_t dimension) {
  enum { POINTS = 25, TURNS = 14 };
  double profile[POINTS][2];
  for (int i = 0; i < POINTS; ++i) {
    const double angle = acos(-1) * i / (dimension == 2 ? 0.5 * POINTS : POINTS - 1);
    const double r = 0.3 + 0.06 * cos(5 * angle) + 0.02 * sin(11 * angle);
    profile[i][0] = r * sin(angle), profile[i][1] = 0.7 * r * cos(angle);
  }
  if (dimension == 3) profile[0][0] = profile[POINTS - 1][0] = 0;
  return profile_mesh(dimension, POINTS, (const double(*)[2])profile, TURNS);
}

/* In and out, near and far. */
static void nodes_have_the_nearest_face_s_distance(uint32_t dimension) {
  mesh m = bumpy_mesh(dimension);
  pbf_shape *shape = baked(&m, 0.04, 0);
  pbf_shape_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_shape_info(shape, &info));
  const uint32_t count = info.nodes[0] * info.nodes[1] * (dimension == 3 ? info.nodes[2] : 1);
  float *values = malloc(count * sizeof *values);
  assert_non_null(values);
  assert_ok(pbf_get_shape_values(shape, count, values));
  for (uint32_t n = 0; n < count; ++n) {
    const uint32_t at[3] = {n % info.nodes[0], n / info.nodes[0] % info.nodes[1],
                            n / info.nodes[0] / info.nodes[1]};
    double place[3] = {0, 0, 0}, least = INFINITY;
    for (uint32_t k = 0; k < dimension; ++k) place[k] = info.origin[k] + info.cell * at[k];
    for (uint32_t f = 0; f < m.face_count; ++f) least = fmin(least, distance_to_face(&m, f, place));
    assert_true(fabs(fabs((double)values[n]) - least) < 1e-7);
  }
  free(values);
  pbf_release_shape(shape);
  mesh_free(&m);
}

static void meshes_are_solids(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    a_mesh_has_the_box_s_distances(dimension);
    hulls_and_terrains_are_boxes(dimension);
    nodes_have_the_nearest_face_s_distance(dimension);
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
  assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT, "take larger cells");
  mesh_free(&m);
  m = box_mesh(3, box_half);
  for (double cell = 2; cell < 1e30; cell *= 1e3) {
    desc = mesh_desc_of(&m, cell, 0);
    assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT,
                 "no inside; it may be thinner than a cell");
  }
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

/* A box within another, or beside it, `turned` the other way round or not. */
static mesh two_boxes(uint32_t dimension, double size, double beside, int turned) {
  mesh m = box_mesh(dimension, box_half), all;
  const uint32_t vertices = m.vertex_count, faces = m.face_count;
  all = mesh_of(dimension, 2 * vertices, 2 * faces);
  all.vertex_count = 2 * vertices, all.face_count = 2 * faces;
  for (uint32_t i = 0; i < 2 * vertices * dimension; ++i) {
    const uint32_t from = i % (vertices * dimension);
    const double other = size * m.vertices[from] + (from % dimension == 0 ? beside : 0);
    all.vertices[i] = i == from ? m.vertices[from] : other;
  }
  for (uint32_t f = 0; f < 2 * faces; ++f)
    for (uint32_t c = 0; c < dimension; ++c) {
      const uint32_t corner = f >= faces && turned && c < 2 ? 1 - c : c;
      all.faces[f * dimension + c] =
          m.faces[f % faces * dimension + corner] + (f >= faces ? vertices : 0);
    }
  mesh_free(&m);
  return all;
}

static void parts_face_as_they_lie(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension)
    for (int which = 0; which < 4; ++which) {
      const int turned = which & 1, apart = which >> 1;
      mesh m = two_boxes(dimension, apart ? 1 : 0.5, apart ? 0.6 : 0, turned);
      const pbf_mesh_desc desc = mesh_desc_of(&m, 0.5 * d, 0);
      pbf_shape *shape = NULL;
      if (turned == apart) {
        assert_fails(pbf_shape_from_mesh(&desc, &shape), PBF_ERROR_INVALID_ARGUMENT,
                     "parts that face opposite sides, or one within another");
      } else {
        const double box_volume = 0.4 * 0.6 * (dimension == 3 ? 0.4 : 1);
        pbf_shape_info info = {.struct_size = sizeof info};
        assert_ok(pbf_shape_from_mesh(&desc, &shape));
        assert_ok(pbf_get_shape_info(shape, &info));
        const double right = apart ? 2 : 1 - pow(0.5, dimension);
        assert_true(fabs(info.volume / box_volume / right - 1) < 0.01);
        pbf_release_shape(shape);
      }
      mesh_free(&m);
    }
}

/* The bed of a river that falls by 1 : 20 between its banks: neighbours lie in one plane but for
 * what is rounded, and as heights no terrain crosses itself. */
/* Faces that lie on nodes, where the distance is 0, are where the solid ends. */
static void bounds_reach_nodes_on_faces(void **state) {
  (void)state;
  enum { SIDE = 7 };
  float values[SIDE * SIDE];
  pbf_shape *shape = NULL;
  pbf_shape_info info = {.struct_size = sizeof info};
  const double half[3] = {0.25, 0.25, 0};
  const pbf_grid_desc grid = {.struct_size = sizeof grid,
                              .dimension = 2,
                              .nodes = {SIDE, SIDE},
                              .origin = {-0.375, -0.375},
                              .cell = 0.125,
                              .values = values};
  for (int n = 0; n < SIDE * SIDE; ++n) {
    const double p[3] = {0.125 * (n % SIDE) - 0.375, 0.125 * (n / SIDE) - 0.375, 0};
    values[n] = (float)box_of(p, 2, half);
  }
  assert_ok(pbf_shape_from_grid(&grid, &shape));
  assert_ok(pbf_get_shape_info(shape, &info));
  for (int k = 0; k < 2; ++k) assert_true(info.lower[k] == -0.25 && info.upper[k] == 0.25);
  pbf_release_shape(shape);
}

static void terrains_of_planes_are_taken(void **state) {
  (void)state;
  double heights[13 * 23];
  for (int k = 0; k < 13; ++k)
    for (int i = 0; i < 23; ++i) {
      const double off = fmax(fabs(-0.6 + 0.1 * k) - 0.2, 0), bank = fmin(1.5 * off, 0.3);
      heights[23 * k + i] = 0.3 - 0.05 * (0.1 * i - 0.1) + bank;
    }
  const pbf_heights_desc desc = {.struct_size = sizeof desc,
                                 .dimension = 3,
                                 .count = {23, 13},
                                 .heights = heights,
                                 .spacing = 0.1,
                                 .base = -0.3,
                                 .cell = 0.05};
  pbf_shape *shape = NULL;
  assert_ok(pbf_shape_from_heights(&desc, &shape));
  pbf_release_shape(shape);
}

static void bad_colliders_are_refused(void **state) {
  (void)state;
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_are_right),
      cmocka_unit_test(meshes_are_solids),
      cmocka_unit_test(bad_grids_are_refused),
      cmocka_unit_test(bad_meshes_are_refused),
      cmocka_unit_test(parts_face_as_they_lie),
      cmocka_unit_test(bounds_reach_nodes_on_faces),
      cmocka_unit_test(terrains_of_planes_are_taken),
      cmocka_unit_test(bad_colliders_are_refused),
      cmocka_unit_test(shapes_live_as_long_as_they_are_held),
      cmocka_unit_test(states_name_shapes),
  };
  return TEST_RUN(tests);
}
