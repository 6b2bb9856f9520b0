/* A terrain as a closed mesh. */

#include "common/fp_environment.h"
#include "check.h"
#include "error.h"
#include "grid.h"
#include "lock.h"
#include "mesh.h"
#include "structs.h"
#include "text.h"

static pbf_status check_desc(const pbf_heights_desc *desc) {
  const double nothing[3] = {0, 0, 0};
  const uint32_t some[3] = {3, 3, 3};
  char number[2][PBF_NUMBER_SIZE];
  uint64_t all = 1;
  pbf_status status = pbf_shape_check_size("heights", desc->dimension, some);
  if (status == PBF_OK) status = pbf_shape_check_place("heights", 0, nothing, desc->cell);
  if (status == PBF_OK)
    status = pbf_check_pointer("heights.heights", desc->heights, sizeof *desc->heights);
  if (status != PBF_OK) return status;
  if (!(desc->spacing > 1e-30 && desc->spacing < 1e20)) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "heights.spacing is %s; it must be a length between 1e-30 and 1e20",
                    pbf_text_number(number[0], desc->spacing));
  }
  for (uint32_t k = 0; k + 1 < desc->dimension; ++k) {
    if (desc->count[k] < 2 || desc->count[k] > PBF_MAX_SHAPE_NODES / 8 / all) {
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "heights.count[%u] is %u; it must be 2 or more, and all together at most %u",
                      k, desc->count[k], PBF_MAX_SHAPE_NODES / 8);
    }
    all *= desc->count[k];
  }
  for (uint64_t i = 0; i < all; ++i) {
    if (desc->heights[i] > desc->base && desc->heights[i] < 1e30 && desc->base > -1e30) continue;
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "heights.heights[%llu] is %s; it must be above base, %s, and finite",
                    (unsigned long long)i, pbf_text_number(number[0], desc->heights[i]),
                    pbf_text_number(number[1], desc->base));
  }
  return PBF_OK;
}

static void add_face(pbf_mesh *mesh, uint32_t *n, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t *face = mesh->faces[(*n)++];
  face[0] = a, face[1] = b, face[2] = c;
}

/* The vertices: those of the heights, and as many of the base below them. */
static void place(pbf_mesh *mesh, const pbf_heights_desc *desc, uint32_t nx, uint32_t nz) {
  const uint32_t all = nx * nz;
  for (uint32_t i = 0; i < 2 * all; ++i) {
    const uint32_t column = i % all % nx, row = i % all / nx; /* NOLINT */
    mesh->vertices[i][0] = column * desc->spacing;
    mesh->vertices[i][1] = i < all ? desc->heights[i] : desc->base;
    mesh->vertices[i][2] = row * desc->spacing;
  }
}

/* A strip from the top to the base below it, along so many edges. */
static void add_side(pbf_mesh *mesh, uint32_t *n, uint32_t all, uint32_t first, uint32_t stride,
                     uint32_t edges, int turned) {
  for (uint32_t e = 0; e < edges; ++e) {
    const uint32_t from = first + e * stride, to = from + stride;
    const uint32_t a = turned ? to : from, b = turned ? from : to;
    add_face(mesh, n, a, b, b + all);
    add_face(mesh, n, a, b + all, a + all);
  }
}

static void connect_3d(pbf_mesh *mesh, uint32_t nx, uint32_t nz) {
  const uint32_t all = nx * nz;
  uint32_t n = 0;
  for (uint32_t j = 0; j + 1 < nz; ++j)
    for (uint32_t i = 0; i + 1 < nx; ++i) {
      const uint32_t a = j * nx + i, b = a + 1, c = a + nx, d = c + 1;
      add_face(mesh, &n, a, c, b);
      add_face(mesh, &n, b, c, d);
      add_face(mesh, &n, a + all, b + all, c + all);
      add_face(mesh, &n, b + all, d + all, c + all);
    }
  add_side(mesh, &n, all, 0, 1, nx - 1, 0);
  add_side(mesh, &n, all, (nz - 1) * nx, 1, nx - 1, 1);
  add_side(mesh, &n, all, 0, nx, nz - 1, 1);
  add_side(mesh, &n, all, nx - 1, nx, nz - 1, 0);
}

static void connect_2d(pbf_mesh *mesh, uint32_t nx) {
  uint32_t n = 0;
  for (uint32_t i = 0; i + 1 < nx; ++i) add_face(mesh, &n, i + 1, i, 0);
  for (uint32_t i = 0; i + 1 < nx; ++i) add_face(mesh, &n, nx + i, nx + i + 1, 0);
  add_face(mesh, &n, 0, nx, 0);
  add_face(mesh, &n, 2 * nx - 1, nx - 1, 0);
}

static pbf_status from_heights(const pbf_heights_desc *desc, pbf_shape **shape) {
  const int flat = desc->dimension == 2;
  const uint32_t nx = desc->count[0], nz = flat ? 1 : desc->count[1];
  const uint32_t faces = flat ? 2 * nx : 4 * ((nx - 1) * (nz - 1) + nx - 1 + nz - 1);
  pbf_mesh mesh;
  pbf_status status = pbf_mesh_allocate(&mesh, desc->dimension, 2 * nx * nz, faces);
  if (status != PBF_OK) return status;
  place(&mesh, desc, nx, nz);
  if (flat)
    connect_2d(&mesh, nx);
  else
    connect_3d(&mesh, nx, nz);
  status = pbf_mesh_prepare(&mesh, "heights");
  if (status == PBF_OK) status = pbf_mesh_close(&mesh, "heights");
  if (status == PBF_OK) status = pbf_mesh_bake(&mesh, "heights", desc->cell, 0, shape);
  pbf_mesh_free(&mesh);
  return status;
}

pbf_status pbf_shape_from_heights(const pbf_heights_desc *theirs, pbf_shape **shape) {
  pbf_heights_desc desc;
  pbf_status status = pbf_lock_check();
  if (status == PBF_OK) status = pbf_struct_in(&pbf_kind_heights_desc, theirs, &desc);
  if (status == PBF_OK && !shape) status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "shape is null");
  if (status != PBF_OK) return status;
  const pbf_fp_environment before = pbf_fp_begin();
  status = check_desc(&desc);
  if (status == PBF_OK) status = from_heights(&desc, shape);
  pbf_fp_end(before);
  return status;
}
