/* A tree of boxes around faces, halved by their middles along the longest side. Each has a second
 * box as well, across the mean normal of its faces (Gottschalk et al. 1996): around a patch of a
 * curved surface a box along the axes is as thick as the patch is wide, and seen from afar many
 * patches then seem as near as the nearest one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh.h"
#include "vectors.h"

enum { LEAF = 2, DEPTH = 64 };

/* Faces first … first + count - 1 of the order; further boxes at `next` and next + 1 where count is
 * more than a leaf's. */
typedef struct box {
  double lower[3], upper[3];
  double axes[3][3], near[3],
      far[3]; /* the second box: unit axes, places along them from `lower` */
  uint32_t first, count, next;
} box;

struct pbf_mesh_tree {
  const pbf_mesh *mesh;
  uint32_t *order;
  double (*middles)[3];
  box *boxes;
  uint32_t box_count;
};

static void bound(const pbf_mesh_tree *tree, box *b) {
  const pbf_mesh *mesh = tree->mesh;
  for (int k = 0; k < 3; ++k) b->lower[k] = INFINITY, b->upper[k] = -INFINITY;
  for (uint32_t i = b->first; i < b->first + b->count; ++i)
    for (uint32_t c = 0; c < mesh->dimension; ++c)
      for (int k = 0; k < 3; ++k) {
        const double at = mesh->vertices[mesh->faces[tree->order[i]][c]][k];
        b->lower[k] = fmin(b->lower[k], at);
        b->upper[k] = fmax(b->upper[k], at);
      }
}

static int longest_side(const box *b) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (b->upper[k] - b->lower[k] > b->upper[axis] - b->lower[axis]) axis = k;
  return axis;
}

/* The mean normal, and the axis that is halved as far as it is across that. */
static void find_axes(const pbf_mesh_tree *tree, box *b) {
  double normal[3] = {0, 0, 0}, along[3] = {0, 0, 0};
  for (uint32_t i = b->first; i < b->first + b->count; ++i)
    pbf_add_times(normal, 1, tree->mesh->face_normals[tree->order[i]]);
  along[longest_side(b)] = 1;
  const double size = pbf_norm(normal);
  for (int k = 0; k < 3 && size > 0; ++k) normal[k] /= size;
  pbf_add_times(along, -pbf_inner(along, normal), normal);
  const double rest = pbf_norm(along);
  if (!(size > 0 && rest > 1e-6)) { /* faces all around */
    memset(b->axes, 0, sizeof b->axes);
    for (int k = 0; k < 3; ++k) b->axes[k][k] = 1;
    return;
  }
  for (int k = 0; k < 3; ++k) b->axes[0][k] = normal[k], b->axes[1][k] = along[k] / rest;
  pbf_outer(b->axes[0], b->axes[1], b->axes[2]);
}

static void bound_across(const pbf_mesh_tree *tree, box *b) {
  const pbf_mesh *mesh = tree->mesh;
  find_axes(tree, b);
  for (int k = 0; k < 3; ++k) b->near[k] = INFINITY, b->far[k] = -INFINITY;
  for (uint32_t i = b->first; i < b->first + b->count; ++i)
    for (uint32_t c = 0; c < mesh->dimension; ++c) {
      double way[3];
      pbf_minus(mesh->vertices[mesh->faces[tree->order[i]][c]], b->lower, way);
      for (int k = 0; k < 3; ++k) {
        const double at = pbf_inner(way, b->axes[k]);
        b->near[k] = fmin(b->near[k], at);
        b->far[k] = fmax(b->far[k], at);
      }
    }
}

/* Orders a part so that the middles of its lower half are below the others' (Hoare's selection). */
static void halve(const pbf_mesh_tree *tree, uint32_t first, uint32_t last, uint32_t half,
                  int axis) {
  uint32_t *order = tree->order;
  while (last - first > 1) {
    /* Not the last one: what is not above it would be all of them. */
    const double pivot = tree->middles[order[first + (last - first - 1) / 2]][axis];
    uint32_t i = first, j = last - 1;
    for (;;) {
      while (tree->middles[order[i]][axis] < pivot) ++i;
      while (tree->middles[order[j]][axis] > pivot) --j;
      if (i >= j) break;
      const uint32_t kept = order[i];
      order[i++] = order[j];
      order[j--] = kept;
    }
    if (half <= j)
      last = j + 1;
    else
      first = j + 1;
  }
}

static void divide(pbf_mesh_tree *tree, uint32_t index) {
  box *b = &tree->boxes[index];
  bound(tree, b);
  bound_across(tree, b);
  if (b->count <= LEAF) return;
  const uint32_t half = b->count / 2;
  halve(tree, b->first, b->first + b->count, b->first + half, longest_side(b));
  b->next = tree->box_count;
  tree->box_count += 2;
  tree->boxes[b->next] = (box){.first = b->first, .count = half};
  tree->boxes[b->next + 1] = (box){.first = b->first + half, .count = b->count - half};
  divide(tree, b->next);
  divide(tree, b->next + 1);
}

pbf_mesh_tree *pbf_mesh_tree_of(const pbf_mesh *mesh) {
  pbf_mesh_tree *tree = calloc(1, sizeof *tree);
  if (!tree) return NULL;
  tree->mesh = mesh;
  tree->order = malloc(mesh->face_count * sizeof *tree->order);
  tree->middles = calloc(mesh->face_count, sizeof *tree->middles);
  tree->boxes = calloc(2 * (uint64_t)mesh->face_count, sizeof *tree->boxes);
  if (!tree->order || !tree->middles || !tree->boxes) {
    pbf_mesh_tree_free(tree);
    return NULL;
  }
  for (uint32_t f = 0; f < mesh->face_count; ++f) {
    tree->order[f] = f;
    for (uint32_t c = 0; c < mesh->dimension; ++c)
      pbf_add_times(tree->middles[f], 1.0 / mesh->dimension, mesh->vertices[mesh->faces[f][c]]);
  }
  tree->boxes[0] = (box){.first = 0, .count = mesh->face_count};
  tree->box_count = 1;
  divide(tree, 0);
  return tree;
}

void pbf_mesh_tree_free(pbf_mesh_tree *tree) {
  if (!tree) return;
  free(tree->order);
  free(tree->middles);
  free(tree->boxes);
  free(tree);
}

/* ---- Nearest -------------------------------------------------------------------------------- */

static void offer(const double place[3], const double point[3], uint32_t face, int corner, int edge,
                  pbf_nearest *nearest) {
  double way[3];
  pbf_minus(place, point, way);
  const double distance2 = pbf_inner(way, way);
  if (!(distance2 < nearest->distance2)) return;
  *nearest = (pbf_nearest){distance2, {point[0], point[1], point[2]}, face, corner, edge};
}

/* The part 0 … 1 of the way from a to b that is nearest. */
static double part_along(const double a[3], const double b[3], const double place[3]) {
  double along[3], arm[3];
  pbf_minus(b, a, along);
  pbf_minus(place, a, arm);
  return fmin(fmax(pbf_inner(arm, along) / pbf_inner(along, along), 0), 1);
}

/* Whether the foot of a place on a triangle's plane is inside of it. */
static int is_over(const pbf_mesh *mesh, uint32_t face, const double place[3]) {
  for (int k = 0; k < 3; ++k) {
    const double *a = mesh->vertices[mesh->faces[face][k]];
    const double *b = mesh->vertices[mesh->faces[face][(k + 1) % 3]];
    double along[3], arm[3], across[3];
    pbf_minus(b, a, along);
    pbf_minus(place, a, arm);
    pbf_outer(along, arm, across);
    if (pbf_inner(across, mesh->face_normals[face]) < 0) return 0;
  }
  return 1;
}

void pbf_mesh_look(const pbf_mesh *mesh, uint32_t face, const double place[3],
                   pbf_nearest *nearest) {
  const uint32_t *corner = mesh->faces[face];
  if (mesh->dimension == 3 && is_over(mesh, face, place)) {
    double arm[3], foot[3] = {place[0], place[1], place[2]};
    pbf_minus(place, mesh->vertices[corner[0]], arm);
    pbf_add_times(foot, -pbf_inner(arm, mesh->face_normals[face]), mesh->face_normals[face]);
    offer(place, foot, face, -1, -1, nearest);
    return;
  }
  const int edges = mesh->dimension == 3 ? 3 : 1;
  for (int k = 0; k < edges; ++k) {
    const int next = (k + 1) % (int)mesh->dimension;
    const double *a = mesh->vertices[corner[k]], *b = mesh->vertices[corner[next]];
    const double part = part_along(a, b, place);
    double along[3], point[3] = {a[0], a[1], a[2]};
    pbf_minus(b, a, along);
    pbf_add_times(point, part, along);
    const int at = part > 0 ? part < 1 ? -1 : next : k;
    offer(place, at < 0 ? point : mesh->vertices[corner[at]], face, at,
          at < 0 && mesh->dimension == 3 ? k : -1, nearest);
  }
}

/* What no face of a box is nearer than, squared, and a little less, as its places are rounded. */
static double least_distance2(const box *b, const double place[3]) {
  double way[3], sum = 0;
  pbf_minus(place, b->lower, way);
  for (int k = 0; k < 3; ++k) {
    const double at = pbf_inner(way, b->axes[k]);
    const double below = b->near[k] - at, above = at - b->far[k];
    const double out = below > above ? below : above;
    sum += out > 0 ? out * out : 0;
  }
  return (1 - 1e-9) * sum;
}

typedef struct waiting {
  double distance2;
  uint32_t index;
} waiting;

void pbf_mesh_find(const pbf_mesh_tree *tree, const double place[3], pbf_nearest *nearest) {
  waiting stack[2 * DEPTH];
  uint32_t left = 0;
  stack[left++] = (waiting){0, 0};
  while (left > 0) {
    const waiting next = stack[--left];
    if (!(next.distance2 < nearest->distance2)) continue;
    const box *b = &tree->boxes[next.index];
    if (b->count <= LEAF) {
      for (uint32_t i = b->first; i < b->first + b->count; ++i)
        pbf_mesh_look(tree->mesh, tree->order[i], place, nearest);
      continue;
    }
    const waiting one = {least_distance2(&tree->boxes[b->next], place), b->next};
    const waiting other = {least_distance2(&tree->boxes[b->next + 1], place), b->next + 1};
    const int swap = one.distance2 < other.distance2;
    stack[left++] = swap ? other : one;
    stack[left++] = swap ? one : other;
  }
}

int pbf_mesh_each_in(const pbf_mesh_tree *tree, const double lower[3], const double upper[3],
                     int (*visit)(void *context, uint32_t face), void *context) {
  uint32_t stack[2 * DEPTH], left = 0;
  stack[left++] = 0;
  while (left > 0) {
    const box *b = &tree->boxes[stack[--left]];
    int apart = 0;
    for (int k = 0; k < 3; ++k) apart |= b->lower[k] > upper[k] || b->upper[k] < lower[k];
    if (apart) continue;
    for (uint32_t i = b->first; b->count <= LEAF && i < b->first + b->count; ++i)
      if (!visit(context, tree->order[i])) return 0;
    if (b->count <= LEAF) continue;
    stack[left++] = b->next;
    stack[left++] = b->next + 1;
  }
  return 1;
}
