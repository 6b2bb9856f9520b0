/* Whether a mesh crosses itself: an edge of one face goes through another one. */
#include <math.h>

#include "error.h"
#include "mesh.h"
#include "vectors.h"

typedef struct search {
  const pbf_mesh *mesh;
  uint32_t face, other;
  const double *from, *to; /* an edge of the face */
  uint32_t ends[2];
} search;

static int touches(const search *s, uint32_t face) {
  for (uint32_t k = 0; k < s->mesh->dimension; ++k)
    for (int end = 0; end < 2; ++end)
      if (s->mesh->faces[face][k] == s->ends[end]) return 1;
  return 0;
}

/* Six times the volume of a tetrahedron; in 2D, of the last at unit height, the area. */
static double volume(const double a[3], const double b[3], const double c[3], const double d[3]) {
  double one[3], two[3], three[3], across[3];
  pbf_minus(b, a, one);
  pbf_minus(c, a, two);
  pbf_minus(d, a, three);
  pbf_outer(one, two, across);
  return pbf_inner(across, three);
}

/* So far from a face an end of the edge still lies in it: faces of one plane, whose vertices have
 * been rounded each for itself, do not cross. A depth that no grid of distances sees. */
static double in_plane(const search *s) {
  double along[3];
  pbf_minus(s->to, s->from, along);
  return 1e-9 * pbf_norm(along) + 1e-15 * fmax(pbf_norm(s->from), pbf_norm(s->to));
}

/* Whether the ends are on both sides, given their distances times `size`. */
static int parted(const search *s, double from, double to, double size) {
  const double least = in_plane(s) * size;
  return fmin(from, to) < -least && fmax(from, to) > least;
}

static int crosses_triangle(const search *s, uint32_t face) {
  const pbf_mesh *mesh = s->mesh;
  const double *a = mesh->vertices[mesh->faces[face][0]], *b = mesh->vertices[mesh->faces[face][1]];
  const double *c = mesh->vertices[mesh->faces[face][2]];
  double one[3], two[3], normal[3];
  pbf_minus(b, a, one);
  pbf_minus(c, a, two);
  pbf_outer(one, two, normal);
  if (!parted(s, volume(a, b, c, s->from), volume(a, b, c, s->to), pbf_norm(normal))) return 0;
  const double ab = volume(s->from, s->to, a, b), bc = volume(s->from, s->to, b, c),
               ca = volume(s->from, s->to, c, a);
  return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

static double side(const double a[3], const double b[3], const double c[3]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static int crosses_segment(const search *s, uint32_t face) {
  const pbf_mesh *mesh = s->mesh;
  const double *a = mesh->vertices[mesh->faces[face][0]], *b = mesh->vertices[mesh->faces[face][1]];
  double along[3];
  pbf_minus(b, a, along);
  return parted(s, side(a, b, s->from), side(a, b, s->to), pbf_norm(along)) &&
         side(s->from, s->to, a) * side(s->from, s->to, b) < 0;
}

static int visit(void *context, uint32_t face) {
  search *s = context;
  if (face == s->face || touches(s, face)) return 1;
  if (!(s->mesh->dimension == 3 ? crosses_triangle(s, face) : crosses_segment(s, face))) return 1;
  s->other = face;
  return 0;
}

static int edge_crosses(const pbf_mesh_tree *tree, search *s) {
  double lower[3], upper[3];
  for (int k = 0; k < 3; ++k) {
    lower[k] = fmin(s->from[k], s->to[k]);
    upper[k] = fmax(s->from[k], s->to[k]);
  }
  return !pbf_mesh_each_in(tree, lower, upper, visit, s);
}

pbf_status pbf_mesh_check_crossings(const pbf_mesh *mesh, const pbf_mesh_tree *tree,
                                    const char *label) {
  const uint32_t edges = mesh->dimension == 3 ? 3 : 1;
  for (uint32_t f = 0; f < mesh->face_count; ++f)
    for (uint32_t k = 0; k < edges; ++k) {
      const uint32_t from = mesh->faces[f][k], to = mesh->faces[f][(k + 1) % mesh->dimension];
      search s = {mesh, f, 0, mesh->vertices[from], mesh->vertices[to], {from, to}};
      if (!edge_crosses(tree, &s)) continue;
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "%s crosses itself: %s %u goes through %s %u; without a thickness it must "
                      "have one inside",
                      label, mesh->dimension == 3 ? "triangle" : "segment", f,
                      mesh->dimension == 3 ? "triangle" : "segment", s.other);
    }
  return PBF_OK;
}
