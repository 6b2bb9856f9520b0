/* A surface of triangles, in 2D of segments, as distances are found from it. */
#ifndef PBF_LIB_SHAPE_MESH_H
#define PBF_LIB_SHAPE_MESH_H

#include "registry.h"

/* All places have three coordinates, in 2D the third is 0; a face has `dimension` corners. */
typedef struct pbf_mesh {
  uint32_t dimension, vertex_count, face_count;
  double (*vertices)[3];
  uint32_t (*faces)[3];
  double (*face_normals)[3];    /* unit */
  double (*vertex_normals)[3];  /* angle-weighted sums (Baerentzen & Aanaes 2005) */
  double (*edge_normals)[3][3]; /* of the edge from corner k to the next; sums of two */
  int outwards;                 /* 1, or -1 where the faces of a closed mesh face inwards */
} pbf_mesh;

/* Fails, with nothing to free, where memory lacks. */
pbf_status pbf_mesh_allocate(pbf_mesh *mesh, uint32_t dimension, uint32_t vertex_count,
                             uint32_t face_count);
void pbf_mesh_free(pbf_mesh *mesh);

/* Gives vertices in one place one index, checks the faces, finds their normals. `label` is what
 * messages call the mesh. */
pbf_status pbf_mesh_prepare(pbf_mesh *mesh, const char *label);

/* Finds the other normals of what must have an inside: fails where an edge is not that of two
 * faces that go along it in opposite directions. */
pbf_status pbf_mesh_close(pbf_mesh *mesh, const char *label);

/* The shape of a prepared mesh: closed, which must not cross itself, or, > 0, a shell of this
 * thickness. */
pbf_status pbf_mesh_bake(const pbf_mesh *mesh, const char *label, double cell, double thickness,
                         pbf_shape **shape);

/* ---- The nearest face ----------------------------------------------------------------------- */

typedef struct pbf_mesh_tree pbf_mesh_tree;

/* Null where memory lacks. */
pbf_mesh_tree *pbf_mesh_tree_of(const pbf_mesh *mesh);
void pbf_mesh_tree_free(pbf_mesh_tree *tree);

/* What of a mesh is nearest to a place. */
typedef struct pbf_nearest {
  double distance2, point[3];
  uint32_t face;
  int corner, edge; /* of it, or -1 */
} pbf_nearest;

/* Looks through one face. */
void pbf_mesh_look(const pbf_mesh *mesh, uint32_t face, const double place[3],
                   pbf_nearest *nearest);

/* `nearest` has a bound, such as that of any face, or INFINITY. */
void pbf_mesh_find(const pbf_mesh_tree *tree, const double place[3], pbf_nearest *nearest);

/* Calls visit for the faces that have boxes which meet a box, until it returns 0. */
int pbf_mesh_each_in(const pbf_mesh_tree *tree, const double lower[3], const double upper[3],
                     int (*visit)(void *context, uint32_t face), void *context);

/* Fails where an edge goes through a face. */
pbf_status pbf_mesh_check_crossings(const pbf_mesh *mesh, const pbf_mesh_tree *tree,
                                    const char *label);

#endif
