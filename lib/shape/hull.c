/* The convex hull of points, one after the other: what faces it goes, and what is left of their
 * edges gets faces to it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fp_environment.h"
#include "check.h"
#include "error.h"
#include "grid.h"
#include "lock.h"
#include "mesh.h"
#include "structs.h"
#include "text.h"
#include "vectors.h"

enum { MOST_POINTS = 4096 };

/* Of a face that goes, where one that stays is behind it; in 2D an end, `from`. */
typedef struct edge {
  uint32_t from, to, corner;
} edge;

/* Faces of the hull so far, counted so that the outside is where a normal points. They are closed,
 * in one piece and without a handle: by Euler's formula there are at most twice as many as points.
 */
typedef struct hull {
  uint32_t dimension, count;
  double (*points)[3];
  uint32_t (*faces)[3];
  uint8_t *facing;
  edge *horizon;
  uint32_t *next;    /* by point: the one after it on the horizon */
  uint32_t *piece;   /* faces */
  uint32_t first[4]; /* points as far as can be from each other */
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

/* The face at the other side of an edge, or in 2D of an end: each has one, as the hull is closed.
 */
static uint32_t behind(const hull *h, uint32_t faces, uint32_t face, uint32_t corner) {
  const uint32_t from = h->faces[face][corner], to = h->faces[face][(corner + 1) % h->dimension];
  for (uint32_t f = 0; f < faces; ++f)
    for (uint32_t k = 0; k < h->dimension; ++k) {
      const uint32_t *other = h->faces[f];
      if (h->dimension == 2 ? f != face && other[k] == from
                            : other[k] == to && other[(k + 1) % 3] == from)
        return f;
    }
  return face;
}

/* The edges, or in 2D ends, at which faces that go meet faces that stay: so many. */
static uint32_t find_horizon(hull *h, uint32_t faces) {
  uint32_t edges = 0;
  for (uint32_t f = 0; f < faces; ++f)
    for (uint32_t k = 0; k < h->dimension && h->facing[f]; ++k)
      if (!h->facing[behind(h, faces, f, k)])
        h->horizon[edges++] = (edge){h->faces[f][k], h->faces[f][(k + 1) % h->dimension], k};
  return edges;
}

/* Whether they are one way around, which passes through no point twice: then what goes is one
 * piece without a hole. */
static int is_one_way(hull *h, uint32_t edges) {
  uint32_t passed = 0;
  if (h->dimension == 2) return edges == 2;
  for (uint32_t e = 0; e < edges; ++e) h->next[h->horizon[e].from] = UINT32_MAX;
  for (uint32_t e = 0; e < edges; ++e) {
    if (h->next[h->horizon[e].from] != UINT32_MAX) return 0;
    h->next[h->horizon[e].from] = h->horizon[e].to;
  }
  if (edges == 0) return 0;
  uint32_t at = h->horizon[0].from;
  do {
    at = h->next[at];
    ++passed;
  } while (at != h->horizon[0].from && passed < edges);
  return passed == edges && at == h->horizon[0].from;
}

/* Of the faces that are like `first` those that hang together with it stay as they are, and all
 * others become unlike it. */
static void keep_piece(hull *h, uint32_t faces, uint32_t first) {
  const uint8_t like = h->facing[first];
  uint32_t known = 1;
  h->piece[0] = first;
  h->facing[first] = 2;
  for (uint32_t i = 0; i < known; ++i)
    for (uint32_t k = 0; k < h->dimension; ++k) {
      const uint32_t other = behind(h, faces, h->piece[i], k);
      if (h->facing[other] != like) continue;
      h->facing[other] = 2;
      h->piece[known++] = other;
    }
  for (uint32_t f = 0; f < faces; ++f) h->facing[f] = h->facing[f] == 2 ? like : !like;
}

/* Which faces go: those that the point is before. Of faces as thin as rounding that may be told
 * amiss, so that what goes is in pieces, or has holes: then the piece goes that is farthest behind
 * the point, and what surrounds the one that it is farthest before stays. */
static uint32_t find_facing(hull *h, uint32_t faces, uint32_t point) {
  uint32_t most = 0, least = 0, any = 0, edges;
  double highest = -INFINITY, lowest = INFINITY;
  for (uint32_t f = 0; f < faces; ++f) {
    const double ahead = before(h, h->faces[f], h->points[point]);
    any |= h->facing[f] = ahead > h->rounding;
    if (ahead > highest) highest = ahead, most = f;
    if (ahead < lowest) lowest = ahead, least = f;
  }
  if (!any) return 0;
  edges = find_horizon(h, faces);
  if (is_one_way(h, edges)) return edges;
  h->facing[least] = 0;
  keep_piece(h, faces, least);
  h->facing[most] = 1;
  keep_piece(h, faces, most);
  edges = find_horizon(h, faces);
  return is_one_way(h, edges) ? edges : 0;
}

static void add_point(hull *h, uint32_t point) {
  const uint32_t faces = h->count, edges = find_facing(h, faces, point);
  if (edges == 0) return;
  for (uint32_t e = 0; e < edges; ++e) {
    const edge *at = &h->horizon[e];
    if (h->dimension == 3)
      add_face(h, at->from, at->to, point);
    else
      add_face(h, at->corner == 0 ? at->from : point, at->corner == 0 ? point : at->from, 0);
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
  uint32_t *of = h->first;
  memset(of, 0, sizeof h->first);
  h->count = 0;
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

static int is_corner_of_first(const hull *h, uint32_t point) {
  return point == h->first[0] || point == h->first[1] ||
         (h->dimension == 3 && point == h->first[2]);
}

/* Whether no point is before a face, but for what rounding does in faces that are not thin. */
static int is_convex(const hull *h, uint32_t count) {
  for (uint32_t f = 0; f < h->count; ++f)
    for (uint32_t i = 0; i < count; ++i)
      if (before(h, h->faces[f], h->points[i]) > 4 * h->rounding) return 0;
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
  if (status == PBF_OK)
    status = pbf_check_pointer("hull.points", desc->points, sizeof *desc->points);
  if (status != PBF_OK) return status;
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

static void free_hull(hull *h) {
  free(h->points);
  free(h->faces);
  free(h->facing);
  free(h->horizon);
  free(h->next);
  free(h->piece);
}

static pbf_status allocate(hull *h, uint32_t count) {
  const uint64_t faces = 8 * (uint64_t)count + 8;
  h->points = calloc(count, sizeof *h->points);
  h->faces = calloc(faces, sizeof *h->faces);
  h->facing = calloc(faces, sizeof *h->facing);
  h->horizon = calloc(faces, sizeof *h->horizon);
  h->next = calloc(count, sizeof *h->next);
  h->piece = calloc(faces, sizeof *h->piece);
  if (h->points && h->faces && h->facing && h->horizon && h->next && h->piece) return PBF_OK;
  return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for a hull of %u points", count);
}

static void copy_points(hull *h, const pbf_hull_desc *desc) {
  double most = 0;
  for (uint32_t i = 0; i < desc->point_count; ++i)
    for (uint32_t k = 0; k < desc->dimension; ++k) {
      h->points[i][k] = desc->points[(uint64_t)i * desc->dimension + k] + 0.0;
      most = fmax(most, fabs(h->points[i][k]));
    }
  h->rounding = 1e-12 * most;
}

/* To places that are whole multiples of a power of two, 2^16 of them over the longest side: sums
 * and products of three differences are then exact, and so is which side of a face a point is on.
 */
static void round_points(hull *h, uint32_t count) {
  double longest = 0;
  int exponent;
  for (uint32_t k = 0; k < h->dimension; ++k) {
    double lower = h->points[0][k], upper = lower;
    for (uint32_t i = 1; i < count; ++i) {
      lower = fmin(lower, h->points[i][k]);
      upper = fmax(upper, h->points[i][k]);
    }
    longest = fmax(longest, upper - lower);
  }
  frexp(longest, &exponent);
  const double unit = ldexp(1, exponent - 16);
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < h->dimension; ++k)
      h->points[i][k] = unit * floor(h->points[i][k] / unit + 0.5) + 0.0;
  h->rounding = 0;
}

static pbf_status find_hull(hull *h, uint32_t count) {
  if (!begin(h, count))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "hull.points are all in one %s",
                    h->dimension == 3 ? "plane" : "line");
  for (uint32_t i = 0; i < count; ++i)
    if (!is_corner_of_first(h, i)) add_point(h, i);
  return PBF_OK;
}

/* Points that are all but in one plane with others, as those of a box with noise, make faces as
 * thin as rounding, of which a mesh may come out that is none: they are rounded then. */
static pbf_status make(hull *h, const pbf_hull_desc *desc, pbf_shape **shape) {
  const uint32_t count = desc->point_count;
  pbf_status status = find_hull(h, count);
  if (status != PBF_OK) return status;
  if (is_convex(h, count)) {
    status = bake(h, count, desc->cell, shape);
    if (status != PBF_ERROR_INVALID_ARGUMENT) return status;
  }
  round_points(h, count);
  status = find_hull(h, count);
  return status == PBF_OK ? bake(h, count, desc->cell, shape) : status;
}

static pbf_status from_points(const pbf_hull_desc *desc, pbf_shape **shape) {
  hull h = {.dimension = desc->dimension};
  pbf_status status = allocate(&h, desc->point_count);
  if (status == PBF_OK) {
    copy_points(&h, desc);
    status = make(&h, desc, shape);
  }
  free_hull(&h);
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
