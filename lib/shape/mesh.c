/* Memory, normals and checks of a mesh. */
#include "mesh.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "physics/elementary.h"
#include "text.h"
#include "vectors.h"

pbf_status pbf_mesh_allocate(pbf_mesh *mesh, uint32_t dimension, uint32_t vertex_count,
                             uint32_t face_count) {
  *mesh = (pbf_mesh){dimension, vertex_count, face_count, NULL, NULL, NULL, NULL, NULL, 1};
  mesh->vertices = calloc(vertex_count, sizeof *mesh->vertices);
  mesh->faces = calloc(face_count, sizeof *mesh->faces);
  mesh->face_normals = calloc(face_count, sizeof *mesh->face_normals);
  mesh->vertex_normals = calloc(vertex_count, sizeof *mesh->vertex_normals);
  mesh->edge_normals = calloc(face_count, sizeof *mesh->edge_normals);
  if (mesh->vertices && mesh->faces && mesh->face_normals && mesh->vertex_normals &&
      mesh->edge_normals)
    return PBF_OK;
  pbf_mesh_free(mesh);
  return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for a mesh of %u vertices and %u faces",
                  vertex_count, face_count);
}

void pbf_mesh_free(pbf_mesh *mesh) {
  free(mesh->vertices);
  free(mesh->faces);
  free(mesh->face_normals);
  free(mesh->vertex_normals);
  free(mesh->edge_normals);
}

static const char *face_word(const pbf_mesh *mesh) {
  return mesh->dimension == 3 ? "triangle" : "segment";
}

/* ---- Vertices in one place ------------------------------------------------------------------ */

typedef struct placed {
  double at[3];
  uint32_t index;
} placed;

static int compare_places(const void *a, const void *b) {
  const placed *one = a, *other = b;
  for (int k = 0; k < 3; ++k)
    if (one->at[k] != other->at[k]) return one->at[k] < other->at[k] ? -1 : 1;
  return one->index < other->index ? -1 : one->index > other->index;
}

/* Files have a vertex as often as it has texture coordinates. */
static pbf_status weld(pbf_mesh *mesh) {
  placed *sorted = malloc(mesh->vertex_count * sizeof *sorted);
  uint32_t *first = malloc(mesh->vertex_count * sizeof *first);
  if (!sorted || !first) {
    free(sorted);
    free(first);
    return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory to join the vertices of a mesh");
  }
  for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
    memcpy(sorted[i].at, mesh->vertices[i], sizeof sorted[i].at);
    sorted[i].index = i;
  }
  qsort(sorted, mesh->vertex_count, sizeof *sorted, compare_places);
  for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
    const int same = i > 0 && memcmp(sorted[i].at, sorted[i - 1].at, sizeof sorted[i].at) == 0;
    first[sorted[i].index] = same ? first[sorted[i - 1].index] : sorted[i].index;
  }
  for (uint32_t f = 0; f < mesh->face_count; ++f)
    for (uint32_t k = 0; k < mesh->dimension; ++k)
      mesh->faces[f][k] = first[mesh->faces[f][k]]; /* NOLINT */
  free(sorted);
  free(first);
  return PBF_OK;
}

/* ---- Faces ---------------------------------------------------------------------------------- */

static pbf_status check_numbers(const pbf_mesh *mesh, const char *label) {
  char number[PBF_NUMBER_SIZE];
  for (uint32_t i = 0; i < mesh->vertex_count; ++i)
    for (uint32_t k = 0; k < mesh->dimension; ++k)
      if (!(fabs(mesh->vertices[i][k]) < 1e30)) {
        return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                        "%s.vertices[%u][%u] is %s; it must be between -1e30 and 1e30", label, i, k,
                        pbf_text_number(number, mesh->vertices[i][k]));
      }
  for (uint32_t f = 0; f < mesh->face_count; ++f)
    for (uint32_t k = 0; k < mesh->dimension; ++k)
      if (mesh->faces[f][k] >= mesh->vertex_count) {
        return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.faces[%u][%u] is %u; there are %u vertices",
                        label, f, k, mesh->faces[f][k], mesh->vertex_count);
      }
  return PBF_OK;
}

/* Twice the area along the normal; of a segment its length, to the right of its way. */
static void area_of(const pbf_mesh *mesh, uint32_t face, double area[3]) {
  const uint32_t *corner = mesh->faces[face];
  double along[3], across[3] = {0, 0, 1};
  pbf_minus(mesh->vertices[corner[1]], mesh->vertices[corner[0]], along);
  if (mesh->dimension == 3) pbf_minus(mesh->vertices[corner[2]], mesh->vertices[corner[0]], across);
  pbf_outer(along, across, area);
}

static double longest_edge(const pbf_mesh *mesh, uint32_t face) {
  double longest = 0, edge[3];
  for (uint32_t k = 0; k < mesh->dimension; ++k) {
    pbf_minus(mesh->vertices[mesh->faces[face][(k + 1) % mesh->dimension]],
              mesh->vertices[mesh->faces[face][k]], edge);
    longest = fmax(longest, pbf_norm(edge));
  }
  return longest;
}

static pbf_status find_face_normals(pbf_mesh *mesh, const char *label) {
  for (uint32_t f = 0; f < mesh->face_count; ++f) {
    double area[3];
    area_of(mesh, f, area);
    const double size = pbf_norm(area), edge = longest_edge(mesh, f);
    if (!(size > 1e-12 * (mesh->dimension == 3 ? edge * edge : 0))) {
      return pbf_fail(
          PBF_ERROR_INVALID_ARGUMENT, "%s has a %s without %s, number %u, of vertices %u, %u%s",
          label, face_word(mesh), mesh->dimension == 3 ? "an area" : "a length", f,
          mesh->faces[f][0], mesh->faces[f][1], mesh->dimension == 3 ? " and a third" : "");
    }
    for (int k = 0; k < 3; ++k) mesh->face_normals[f][k] = area[k] / size;
  }
  return PBF_OK;
}

pbf_status pbf_mesh_prepare(pbf_mesh *mesh, const char *label) {
  pbf_status status = check_numbers(mesh, label);
  if (status == PBF_OK) status = weld(mesh);
  if (status == PBF_OK) status = find_face_normals(mesh, label);
  return status;
}

/* ---- Closed meshes -------------------------------------------------------------------------- */

/* An edge of a face, from its lower vertex to its higher one; in 2D an end of a segment. */
typedef struct half_edge {
  uint32_t low, high, face, corner;
  int forwards;
} half_edge;

static int compare_edges(const void *a, const void *b) {
  const half_edge *one = a, *other = b;
  if (one->low != other->low) return one->low < other->low ? -1 : 1;
  if (one->high != other->high) return one->high < other->high ? -1 : 1;
  return one->face < other->face ? -1 : one->face > other->face;
}

static half_edge half_edge_of(const pbf_mesh *mesh, uint32_t face, uint32_t corner) {
  const uint32_t from = mesh->faces[face][corner];
  if (mesh->dimension == 2) return (half_edge){from, from, face, corner, corner == 0};
  const uint32_t to = mesh->faces[face][(corner + 1) % 3];
  return from < to ? (half_edge){from, to, face, corner, 1}
                   : (half_edge){to, from, face, corner, 0};
}

static void name_edge(const pbf_mesh *mesh, const half_edge *edge, char text[64]) {
  if (mesh->dimension == 2)
    pbf_text_write(text, 64, "vertex %u", edge->low);
  else
    pbf_text_write(text, 64, "the edge of vertices %u and %u", edge->low, edge->high);
}

static pbf_status fail_at_edge(const pbf_mesh *mesh, const char *label, const half_edge *edge,
                               uint32_t count, uint32_t other) {
  char name[64];
  name_edge(mesh, edge, name);
  if (count == 1) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "%s is open: %s is that of %s %u alone; without a thickness it must have an "
                    "inside",
                    label, name, face_word(mesh), edge->face);
  }
  if (count > 2) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s has %u %ss at %s, %u among them; it must be 2",
                    label, count, face_word(mesh), name, edge->face);
  }
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "%s has %ss %u and %u that face opposite sides at %s; one of them is the wrong "
                  "way round",
                  label, face_word(mesh), edge->face, other, name);
}

static pbf_status pair_edges(pbf_mesh *mesh, const char *label, const half_edge *edges,
                             uint32_t count) {
  for (uint32_t first = 0, last; first < count; first = last) {
    const half_edge *a = &edges[first], *b = a + 1;
    for (last = first + 1;
         last < count && edges[last].low == a->low && edges[last].high == a->high;)
      ++last;
    if (last - first != 2) return fail_at_edge(mesh, label, a, last - first, 0);
    if (a->forwards == b->forwards) return fail_at_edge(mesh, label, a, 2, b->face);
    for (int k = 0; k < 3; ++k) {
      const double sum = mesh->face_normals[a->face][k] + mesh->face_normals[b->face][k];
      mesh->edge_normals[a->face][a->corner][k] = mesh->edge_normals[b->face][b->corner][k] = sum;
    }
  }
  return PBF_OK;
}

static pbf_status find_edge_normals(pbf_mesh *mesh, const char *label) {
  const uint32_t count = mesh->face_count * mesh->dimension;
  half_edge *edges = malloc(count * sizeof *edges);
  if (!edges) return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for the edges of a mesh");
  for (uint32_t f = 0, n = 0; f < mesh->face_count; ++f)
    for (uint32_t k = 0; k < mesh->dimension; ++k) edges[n++] = half_edge_of(mesh, f, k);
  qsort(edges, count, sizeof *edges, compare_edges);
  pbf_status status = pair_edges(mesh, label, edges, count);
  free(edges);
  return status;
}

static double angle_at(const pbf_mesh *mesh, uint32_t face, uint32_t corner) {
  const uint32_t *of = mesh->faces[face];
  double one[3], other[3], across[3];
  if (mesh->dimension == 2) return 1;
  pbf_minus(mesh->vertices[of[(corner + 1) % 3]], mesh->vertices[of[corner]], one);
  pbf_minus(mesh->vertices[of[(corner + 2) % 3]], mesh->vertices[of[corner]], other);
  pbf_outer(one, other, across);
  const double y = pbf_norm(across), x = pbf_inner(one, other), size = fmax(y, fabs(x));
  const double acute = size > 0 ? pbf_angle(y / size, fabs(x) / size) : 0;
  return x < 0 ? 0x1.921fb54442d18p+1 - acute : acute; /* half a turn */
}

/* The volume between the faces and a place, times the dimension's factorial. */
static double volume_of(const pbf_mesh *mesh) {
  const double *from = mesh->vertices[mesh->faces[0][0]];
  double volume = 0;
  for (uint32_t f = 0; f < mesh->face_count; ++f) {
    double area[3], arm[3];
    area_of(mesh, f, area);
    pbf_minus(mesh->vertices[mesh->faces[f][0]], from, arm);
    volume += pbf_inner(area, arm);
  }
  return volume;
}

pbf_status pbf_mesh_close(pbf_mesh *mesh, const char *label) {
  pbf_status status = find_edge_normals(mesh, label);
  for (uint32_t f = 0; f < mesh->face_count; ++f)
    for (uint32_t k = 0; k < mesh->dimension; ++k)
      pbf_add_times(mesh->vertex_normals[mesh->faces[f][k]], angle_at(mesh, f, k),
                    mesh->face_normals[f]);
  mesh->outwards = volume_of(mesh) < 0 ? -1 : 1;
  return status;
}
