/* From a mesh to distances on a grid. */
#include <inttypes.h>
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

/* Cells around the solid: its border is to be outside, and some of the way out be exact. */
enum { MARGIN = 3 };

/* Thinner ones have places without an inside between nodes. */
static const double thinnest_shell = 1.5;

static pbf_status too_many_nodes(const char *label, uint32_t axis, double length, double cell) {
  char number[2][PBF_NUMBER_SIZE];
  return pbf_fail(
      PBF_ERROR_INVALID_ARGUMENT,
      "%s is %s long along %c, where cells are %s; a shape has at most %u nodes in all, "
      "so take larger cells",
      label, pbf_text_number(number[0], length), "xyz"[axis], pbf_text_number(number[1], cell),
      PBF_MAX_SHAPE_NODES);
}

static pbf_status place_grid(const pbf_mesh *mesh, const char *label, double cell, double beyond,
                             double origin[3], uint32_t nodes[3]) {
  double all = 1, widest = 0;
  nodes[2] = 1;
  origin[2] = 0;
  for (uint32_t k = 0; k < mesh->dimension; ++k) {
    double lower = INFINITY, upper = -INFINITY;
    for (uint32_t f = 0; f < mesh->face_count; ++f)
      for (uint32_t c = 0; c < mesh->dimension; ++c) {
        lower = fmin(lower, mesh->vertices[mesh->faces[f][c]][k]);
        upper = fmax(upper, mesh->vertices[mesh->faces[f][c]][k]);
      }
    widest = fmax(widest, upper - lower);
    const double wanted = ceil((upper - lower + 2 * beyond) / cell) + 2 * MARGIN + 1;
    origin[k] = 0.5 * (lower + upper - (wanted - 1) * cell);
    all *= wanted;
    if (!(all <= PBF_MAX_SHAPE_NODES)) return too_many_nodes(label, k, upper - lower, cell);
    nodes[k] = (uint32_t)wanted;
  }
  /* None of its nodes can be inside, nor may rounding leave a side to one far off. */
  if (beyond == 0 && widest < cell) return pbf_shape_fail_without_inside(label);
  return PBF_OK;
}

/* The side that a place is on by the normal of what is nearest to it (Baerentzen & Aanaes 2005). */
static double side_of(const pbf_mesh *mesh, const double place[3], const pbf_nearest *nearest) {
  const double *normal = mesh->face_normals[nearest->face];
  double way[3];
  if (nearest->edge >= 0) normal = mesh->edge_normals[nearest->face][nearest->edge];
  if (nearest->corner >= 0) {
    const uint32_t vertex = mesh->faces[nearest->face][nearest->corner];
    normal = mesh->vertex_normals[vertex];
  }
  pbf_minus(place, nearest->point, way);
  return pbf_inner(way, normal) < 0 ? -mesh->outwards : mesh->outwards;
}

static void find_distances(const pbf_mesh *mesh, const pbf_mesh_tree *tree, double thickness,
                           pbf_live_shape *made) {
  const pbf_shape *s = &made->shape;
  const uint64_t all = pbf_shape_nodes(s->nodes);
  pbf_nearest nearest = {INFINITY, {0, 0, 0}, 0, -1, -1};
  for (uint64_t n = 0; n < all; ++n) {
    const uint64_t at[3] = {n % s->nodes[0], n / s->nodes[0] % s->nodes[1],
                            n / s->nodes[0] / s->nodes[1]};
    double place[3];
    for (int k = 0; k < 3; ++k) place[k] = s->origin[k] + s->cell * (double)at[k];
    /* What was nearest to the last one is near this one. */
    const uint32_t face = nearest.face;
    nearest.distance2 = INFINITY;
    pbf_mesh_look(mesh, face, place, &nearest);
    pbf_mesh_find(tree, place, &nearest);
    const double distance = sqrt(nearest.distance2);
    made->values[n] = (float)(thickness > 0 ? distance - 0.5 * thickness
                                            : side_of(mesh, place, &nearest) * distance);
  }
}

/* Outwards is one side of all faces: where a part is within another one, or beside it, and faces
 * the wrong way, places between them are inside by the one and outside by the other. */
static pbf_status check_parts(const pbf_shape *s, const char *label) {
  const uint64_t strides[3] = {1, s->nodes[0], (uint64_t)s->nodes[0] * s->nodes[1]};
  char text[3][PBF_NUMBER_SIZE];
  for (uint64_t n = 0, all = pbf_shape_nodes(s->nodes); n < all; ++n)
    for (uint32_t k = 0; k < s->dimension; ++k) {
      if (n / strides[k] % s->nodes[k] == 0) continue;
      const double change = (double)s->values[n] - (double)s->values[n - strides[k]];
      if (fabs(change) <= pbf_shape_steepest_edge * s->cell) continue;
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const uint64_t at = n / strides[axis] % s->nodes[axis];
        pbf_text_number(text[axis], s->origin[axis] + s->cell * (double)at);
      }
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s has parts that face opposite sides, or one within another that faces the "
                      "same side: near (%s, %s%s%s) is inside of one and outside of another",
                      label, text[0], text[1], s->dimension == 3 ? ", " : "",
                      s->dimension == 3 ? text[2] : "");
    }
  return PBF_OK;
}

static pbf_status bake(const pbf_mesh *mesh, const pbf_mesh_tree *tree, const char *label,
                       double cell, double thickness, pbf_shape **shape) {
  double origin[3];
  uint32_t nodes[3];
  pbf_status status = place_grid(mesh, label, cell, 0.5 * thickness, origin, nodes);
  if (status == PBF_OK && thickness == 0) status = pbf_mesh_check_crossings(mesh, tree, label);
  if (status != PBF_OK) return status;
  pbf_live_shape *made = pbf_shape_allocate(mesh->dimension, nodes);
  if (!made) {
    return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for a shape of %" PRIu64 " nodes",
                    pbf_shape_nodes(nodes));
  }
  memcpy(made->shape.origin, origin, sizeof origin);
  made->shape.cell = cell;
  find_distances(mesh, tree, thickness, made);
  status = check_parts(&made->shape, label);
  if (status == PBF_OK) return pbf_shape_finish(made, label, shape);
  free(made);
  return status;
}

pbf_status pbf_mesh_bake(const pbf_mesh *mesh, const char *label, double cell, double thickness,
                         pbf_shape **shape) {
  pbf_mesh_tree *tree = pbf_mesh_tree_of(mesh);
  if (!tree) return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory to search a mesh");
  pbf_status status = bake(mesh, tree, label, cell, thickness, shape);
  pbf_mesh_tree_free(tree);
  return status;
}

/* ---- From a caller's mesh ------------------------------------------------------------------- */

static pbf_status check_desc(const pbf_mesh_desc *desc) {
  const double nothing[3] = {0, 0, 0};
  const uint32_t some[3] = {3, 3, 3};
  char number[2][PBF_NUMBER_SIZE];
  pbf_status status = pbf_shape_check_size("mesh", desc->dimension, some);
  if (status == PBF_OK) status = pbf_shape_check_place("mesh", 0, nothing, desc->cell);
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("mesh.vertices", desc->vertices, sizeof *desc->vertices);
  if (status == PBF_OK) status = pbf_check_pointer("mesh.faces", desc->faces, sizeof *desc->faces);
  if (status != PBF_OK) return status;
  if (desc->face_count < 1 || desc->face_count > PBF_MAX_SHAPE_NODES || desc->vertex_count < 1 ||
      desc->vertex_count > PBF_MAX_SHAPE_NODES) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "mesh has %u vertices and %u faces; it must be 1 … %u of each",
                    desc->vertex_count, desc->face_count, PBF_MAX_SHAPE_NODES);
  }
  if (desc->thickness == 0 ||
      (desc->thickness >= thinnest_shell * desc->cell && desc->thickness < 1e30))
    return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "mesh.thickness is %s; it must be 0, of a solid, or at least %g cells of %s",
                  pbf_text_number(number[0], desc->thickness), thinnest_shell,
                  pbf_text_number(number[1], desc->cell));
}

static pbf_status from_mesh(const pbf_mesh_desc *desc, pbf_shape **shape) {
  pbf_mesh mesh;
  pbf_status status =
      pbf_mesh_allocate(&mesh, desc->dimension, desc->vertex_count, desc->face_count);
  if (status != PBF_OK) return status;
  for (uint32_t i = 0; i < desc->vertex_count; ++i)
    for (uint32_t k = 0; k < desc->dimension; ++k) /* 0, of either sign, is one place */
      mesh.vertices[i][k] = desc->vertices[(uint64_t)i * desc->dimension + k] + 0.0;
  for (uint32_t f = 0; f < desc->face_count; ++f)
    for (uint32_t k = 0; k < desc->dimension; ++k)
      mesh.faces[f][k] = desc->faces[(uint64_t)f * desc->dimension + k];
  status = pbf_mesh_prepare(&mesh, "mesh");
  if (status == PBF_OK && desc->thickness == 0) status = pbf_mesh_close(&mesh, "mesh");
  if (status == PBF_OK) status = pbf_mesh_bake(&mesh, "mesh", desc->cell, desc->thickness, shape);
  pbf_mesh_free(&mesh);
  return status;
}

pbf_status pbf_shape_from_mesh(const pbf_mesh_desc *theirs, pbf_shape **shape) {
  pbf_mesh_desc desc;
  pbf_status status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_struct_in(&pbf_kind_mesh_desc, theirs, &desc);
  if (status == PBF_OK && !shape) status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  if (status != PBF_OK) return status;
  const pbf_fp_environment before = pbf_fp_begin();
  status = check_desc(&desc);
  if (status == PBF_OK) status = from_mesh(&desc, shape);
  pbf_fp_end(before);
  return status;
}
