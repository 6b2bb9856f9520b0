/* The convex hull of points, one after the other: what faces it goes, and what is left of their
 * edges gets faces to it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fp_environment.h"
#include "error.h"
#include "grid.h"
#include "lock.h"
#include "mesh.h"
#include "structs.h"
#include "text.h"
#include "vectors.h"

enum { MOST_POINTS = 4096 };

/* Faces of the hull so far, counted so that the outside is where a normal points. */
typedef struct hull {
  uint32_t dimension, count;
  const double (*points)[3];
  uint32_t (*faces)[3];
  uint8_t *facing;
  double rounding;
} hull;

/* How far a point is before a face, times the face's area. */
static double before(const hull *h, const uint32_t face[3], const double point[3]) {
  double along[3], across[3] = {0, 0, 1}, normal[3], arm[3];
  pbf_minus(h->points[face[1]], h->points[face[0]], along);
  if (h->dimension == 3) pbf_minus(h->points[face[2]], h->points[face[0]], across);
  pbf_minus(point, h->points[face[0]], arm);
  pbf_outer(along, across, normal);
  return pbf_inner(normal, arm) / fmax(pbf_norm(normal), 1e-300);
}

static void add_face(hull *h, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t *face = h->faces[h->count++];
  face[0] = a, face[1] = b, face[2] = c;
}

/* Whether an edge, or in 2D an end, of a face that goes is one of a face that stays. */
static int is_horizon(const hull *h, uint32_t faces, uint32_t from, uint32_t to) {
  for (uint32_t f = 0; f < faces; ++f)
    for (uint32_t k = 0; k < h->dimension; ++k) {
      const uint32_t *face = h->faces[f];
      if (!h->facing[f] && face[k] == to &&
          (h->dimension == 2 || face[(k + 1) % h->dimension] == from))
        return 1;
    }
  return 0;
}

static void add_point(hull *h, uint32_t point) {
  const uint32_t faces = h->count;
  int any = 0;
  for (uint32_t f = 0; f < faces; ++f)
    any |= h->facing[f] = before(h, h->faces[f], h->points[point]) > h->rounding;
  if (!any) return;
  for (uint32_t f = 0; f < faces; ++f)
    for (uint32_t k = 0; k < h->dimension && h->facing[f]; ++k) {
      const uint32_t from = h->faces[f][k], to = h->faces[f][(k + 1) % h->dimension];
      if (h->dimension == 3 && is_horizon(h, faces, from, to)) add_face(h, from, to, point);
      if (h->dimension == 2 && is_horizon(h, faces, from, from))
        add_face(h, k == 0 ? from : point, k == 0 ? point : from, 0);
    }
  uint32_t kept = 0;
  for (uint32_t f = 0; f < h->count; ++f) {
    if (f < faces && h->facing[f]) continue;
    memmove(h->faces[kept++], h->faces[f], sizeof h->faces[f]);
  }
  h->count = kept;
}

/* The first face, or two of them back to back: points as far as can be from each other. */
static uint32_t farthest(const hull *h, uint32_t count, uint32_t corners, const uint32_t of[3]) {
  uint32_t best = 0;
  double most = -1;
  for (uint32_t i = 0; i < count; ++i) {
    double away = 0, arm[3], along[3], across[3];
    pbf_minus(h->points[i], h->points[of[0]], arm);
    if (corners == 1) away = pbf_norm(arm);
    if (corners == 2) {
      pbf_minus(h->points[of[1]], h->points[of[0]], along);
      pbf_outer(along, arm, across);
      away = pbf_norm(across) / fmax(pbf_norm(along), 1e-300);
    }
    if (corners == 3) away = fabs(before(h, of, h->points[i]));
    if (away > most) most = away, best = i;
  }
  return most > 1e3 * h->rounding ? best : UINT32_MAX;
}

static int begin(hull *h, uint32_t count) {
  uint32_t of[4] = {0, 0, 0, 0};
  for (uint32_t corner = 1; corner <= h->dimension; ++corner) {
    of[corner] = farthest(h, count, corner, of);
    if (of[corner] == UINT32_MAX) return 0;
  }
  if (h->dimension == 2) {
    add_face(h, of[0], of[1], 0);
    add_face(h, of[1], of[0], 0);
    return 1;
  }
  add_face(h, of[0], of[1], of[2]);
  add_face(h, of[0], of[2], of[1]);
  return 1;
}

static pbf_status bake(const hull *h, uint32_t count, double cell, pbf_shape **shape) {
  pbf_mesh mesh;
  pbf_status status = pbf_mesh_allocate(&mesh, h->dimension, count, h->count);
  if (status != PBF_OK) return status;
  memcpy(mesh.vertices, h->points, count * sizeof *mesh.vertices);
  memcpy(mesh.faces, h->faces, h->count * sizeof *mesh.faces);
  status = pbf_mesh_prepare(&mesh, "hull");
  if (status == PBF_OK) status = pbf_mesh_close(&mesh, "hull");
  if (status == PBF_OK) status = pbf_mesh_bake(&mesh, "hull", cell, 0, shape);
  pbf_mesh_free(&mesh);
  return status;
}

static pbf_status check_desc(const pbf_hull_desc *desc) {
  const double nothing[3] = {0, 0, 0};
  const uint32_t some[3] = {3, 3, 3};
  char number[PBF_NUMBER_SIZE];
  pbf_status status = pbf_shape_check_size("hull", desc->dimension, some);
  if (status == PBF_OK) status = pbf_shape_check_place("hull", 0, nothing, desc->cell);
  if (status != PBF_OK) return status;
  if (!desc->points) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "hull.points is null");
  if (desc->point_count <= desc->dimension || desc->point_count > MOST_POINTS) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "hull.point_count is %u; it must be %u … %u",
                    desc->point_count, desc->dimension + 1, MOST_POINTS);
  }
  for (uint32_t i = 0; i < desc->point_count * desc->dimension; ++i)
    if (!(fabs(desc->points[i]) < 1e30)) {
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "hull.points[%u][%u] is %s; it must be between -1e30 and 1e30",
                      i / desc->dimension, i % desc->dimension,
                      pbf_text_number(number, desc->points[i]));
    }
  return PBF_OK;
}

static pbf_status from_points(const pbf_hull_desc *desc, pbf_shape **shape) {
  const uint32_t count = desc->point_count;
  double(*points)[3] = calloc(count, sizeof *points);
  hull h = {.dimension = desc->dimension, .points = (const double(*)[3])points};
  h.faces = calloc(8 * (uint64_t)count + 8, sizeof *h.faces);
  h.facing = calloc(8 * (uint64_t)count + 8, sizeof *h.facing);
  pbf_status status = PBF_OK;
  if (!points || !h.faces || !h.facing)
    status = pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for a hull of %u points", count);
  double most = 0;
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    for (uint32_t k = 0; k < desc->dimension; ++k) {
      points[i][k] = desc->points[(uint64_t)i * desc->dimension + k] + 0.0;
      most = fmax(most, fabs(points[i][k]));
    }
  h.rounding = 1e-12 * most;
  if (status == PBF_OK && !begin(&h, count))
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "hull.points are all in one %s",
                      desc->dimension == 3 ? "plane" : "line");
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i) add_point(&h, i);
  if (status == PBF_OK) status = bake(&h, count, desc->cell, shape);
  free(points);
  free(h.faces);
  free(h.facing);
  return status;
}

pbf_status pbf_shape_from_points(const pbf_hull_desc *theirs, pbf_shape **shape) {
  pbf_hull_desc desc;
  pbf_status status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_struct_in(&pbf_kind_hull_desc, theirs, &desc);
  if (status == PBF_OK && !shape) status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  if (status != PBF_OK) return status;
  const pbf_fp_environment kept = pbf_fp_begin();
  status = check_desc(&desc);
  if (status == PBF_OK) status = from_points(&desc, shape);
  pbf_fp_end(kept);
  return status;
}
