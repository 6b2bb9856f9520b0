/* Meshes whose solids have a closed form. */
#ifndef PBF_TESTS_API_MESHES_H
#define PBF_TESTS_API_MESHES_H

#include "support.h"

#include <pbf/shapes.h>

typedef struct mesh {
  uint32_t dimension, vertex_count, face_count;
  double *vertices;
  uint32_t *faces;
} mesh;

static inline mesh mesh_of(uint32_t dimension, uint32_t vertices, uint32_t faces) {
  mesh m = {dimension, 0, 0, calloc((size_t)vertices * dimension, sizeof *m.vertices),
            calloc((size_t)faces * dimension, sizeof *m.faces)};
  assert_non_null(m.vertices);
  assert_non_null(m.faces);
  return m;
}

static inline void mesh_free(mesh *m) {
  free(m->vertices);
  free(m->faces);
}

static inline void add_vertex(mesh *m, double x, double y, double z) {
  const double p[3] = {x, y, z};
  memcpy(m->vertices + (size_t)m->vertex_count++ * m->dimension, p, m->dimension * sizeof *p);
}

static inline void add_face(mesh *m, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t f[3] = {a, b, c};
  memcpy(m->faces + (size_t)m->face_count++ * m->dimension, f, m->dimension * sizeof *f);
}

static inline pbf_mesh_desc mesh_desc_of(const mesh *m, double cell, double thickness) {
  return (pbf_mesh_desc){.struct_size = sizeof(pbf_mesh_desc),
                         .dimension = m->dimension,
                         .vertex_count = m->vertex_count,
                         .face_count = m->face_count,
                         .vertices = m->vertices,
                         .faces = m->faces,
                         .cell = cell,
                         .thickness = thickness};
}

static inline pbf_shape *baked(const mesh *m, double cell, double thickness) {
  const pbf_mesh_desc desc = mesh_desc_of(m, cell, thickness);
  pbf_shape *shape = NULL;
  assert_ok(pbf_shape_from_mesh(&desc, &shape));
  return shape;
}

/* A closed line in the plane of x and y; in 3D turned about y in so many steps, whose first and
 * last points are then on that axis. */
static inline mesh profile_mesh(uint32_t dimension, uint32_t points, const double (*profile)[2],
                                uint32_t turns) {
  if (dimension == 2) {
    mesh m = mesh_of(2, points, points);
    for (uint32_t i = 0; i < points; ++i) add_vertex(&m, profile[i][0], profile[i][1], 0);
    for (uint32_t i = 0; i < points; ++i) add_face(&m, i, (i + 1) % points, 0);
    return m;
  }
  mesh m = mesh_of(3, points * turns, 2 * points * turns);
  for (uint32_t t = 0; t < turns; ++t)
    for (uint32_t i = 0; i < points; ++i) {
      const double angle = 2 * acos(-1) * t / turns;
      add_vertex(&m, profile[i][0] * cos(angle), profile[i][1], profile[i][0] * sin(angle));
    }
  for (uint32_t t = 0; t < turns; ++t)
    for (uint32_t i = 0; i + 1 < points; ++i) {
      const uint32_t a = t * points + i, b = a + 1, c = (t + 1) % turns * points + i, e = c + 1;
      if (i > 0) add_face(&m, a, b, c);
      if (i + 2 < points || i == 0) add_face(&m, b, e, c);
    }
  return m;
}

/* Half extents; six faces of two triangles. */
static inline mesh box_mesh(uint32_t dimension, const double half[3]) {
  static const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  if (dimension == 2) {
    const double corners[4][2] = {
        {-half[0], -half[1]}, {half[0], -half[1]}, {half[0], half[1]}, {-half[0], half[1]}};
    return profile_mesh(2, 4, corners, 0);
  }
  mesh m = mesh_of(3, 8, 12);
  for (int i = 0; i < 8; ++i)
    add_vertex(&m, i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
               i & 4 ? half[2] : -half[2]);
  for (int q = 0; q < 6; ++q) {
    add_face(&m, quads[q][0], quads[q][1], quads[q][2]);
    add_face(&m, quads[q][0], quads[q][2], quads[q][3]);
  }
  return m;
}

#endif
