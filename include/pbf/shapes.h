/* pbf/shapes.h: solids of any form.
 *
 * Any solid with an inside, as signed distances on a grid: made once, never changed, and what a
 * collider of the kind PBF_COLLIDER_SHAPE has for its form. Any number of colliders and solvers may
 * have the same one, in memory once.
 *
 * A shape has one reference when it is made, the caller's, which pbf_release_shape gives back. A
 * solver holds one for each of its colliders that has it, and so has pbf_save's state none: what is
 * saved names a shape by the hash of its content, and pbf_load finds it among all that live in the
 * process. The functions on shapes may be called in any threads at any time; memory is malloc's.
 * The other rules of pbf.h hold here, too.
 */
#ifndef PBF_SHAPES_H
#define PBF_SHAPES_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Made from what -------------------------------------------------------------------------- */

#define PBF_MAX_SHAPE_NODES 268435456u /* 1 GiB of distances */

/* Signed distances, between nodes by quadratic B-splines: values[(k nodes[1] + j) nodes[0] + i] at
 * origin + cell (i, j, k), negative inside, above 0 on the border of the grid, so that the solid
 * ends within. True distances, as far as one can tell: what changes by more than the way between
 * two nodes next to each other, and half of that again, is refused. */
typedef struct pbf_grid_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t nodes[3]; /* nodes along each axis, at least 3; 2D: two of them */
  uint32_t reserved;
  double origin[3]; /* of the first node, in the shape's own space; a collider's position is where
                       that has its 0 */
  double cell;      /* length between nodes, > 0 */
  const float *values;
} pbf_grid_desc;

/* Each of these calls gives a new shape with one reference, the caller's. */
PBF_API pbf_status pbf_shape_from_grid(const pbf_grid_desc *grid, pbf_shape **shape);

/* The solid within a closed surface of triangles, in 2D a closed line of segments, as distances on
 * a grid of this cell around it; whichever way round all of it is. Vertices in one place are one.
 * Refused, with the number of what is at fault: a mesh that is open, crosses itself, has faces of
 * opposite orientation or without area.
 *
 * With a thickness, at least 1.5 cells, it is a shell instead, half the thickness to each side, of
 * any surface, open or not. */
typedef struct pbf_mesh_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t vertex_count;
  uint32_t face_count;
  const double *vertices; /* (vertex_count, dimension) */
  const uint32_t *faces;  /* (face_count, dimension) */
  double cell;            /* > 0; half a spacing of the fluid keeps water, a quarter is smoother */
  double thickness;       /* 0: a solid */
} pbf_mesh_desc;

PBF_API pbf_status pbf_shape_from_mesh(const pbf_mesh_desc *mesh, pbf_shape **shape);

/* A terrain, solid from the heights down to a flat base: heights[j count[0] + i] is the y above
 * (i, j) spacing, along x and z; in 2D heights[i] above i spacing along x. */
typedef struct pbf_heights_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t count[2]; /* along x and, in 3D, z; at least 2 */
  const double *heights;
  double spacing; /* > 0 */
  double base;    /* y of its lower side, below all heights */
  double cell;    /* > 0 */
} pbf_heights_desc;

PBF_API pbf_status pbf_shape_from_heights(const pbf_heights_desc *heights, pbf_shape **shape);

/* The convex hull of points, at least 4, in 2D 3, that are not all in one plane, in 2D line. */
typedef struct pbf_hull_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t point_count;
  uint32_t reserved;
  const double *points; /* (point_count, dimension) */
  double cell;          /* > 0 */
} pbf_hull_desc;

PBF_API pbf_status pbf_shape_from_points(const pbf_hull_desc *hull, pbf_shape **shape);

/* ---- Held and asked -------------------------------------------------------------------------- */

/* One more reference for the caller, each of which pbf_release_shape gives back. */
PBF_API pbf_status pbf_hold_shape(pbf_shape *shape);

/* Gives a reference back; null is nothing. The last one, a solver's or the caller's, frees it. */
PBF_API void pbf_release_shape(pbf_shape *shape);

/* What a shape is and takes; lengths are in its own space. */
typedef struct pbf_shape_info {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t nodes[3];
  uint32_t references; /* the caller's, and a collider's each */
  double origin[3];
  double cell;
  double lower[3]; /* of a box around the inside */
  double upper[3];
  double volume; /* of the inside; 2D: the area */
  double area;   /* of the surface; 2D: the length */
  uint64_t bytes;
  uint64_t hash; /* FNV-1a, 64 bit, of dimension, nodes, origin, cell and values */
} pbf_shape_info;

/* info->struct_size must be set. */
PBF_API pbf_status pbf_get_shape_info(pbf_shape *shape, pbf_shape_info *info);

/* The distance of a point (in 2D two numbers) in the shape's own space, as colliders see it, and,
 * unless it is null, the direction in which it grows. Beyond the grid, which ends some two
 * cells from a solid that is not made of one, it is what nothing of the solid is nearer than. */
PBF_API pbf_status pbf_get_shape_distance(pbf_shape *shape, const double *point, double *distance,
                                          double *normal);

/* ---- Kept ------------------------------------------------------------------------------------ */

/* The distances at its nodes, as pbf_shape_from_grid takes them: `count` is how many those are. */
PBF_API pbf_status pbf_get_shape_values(pbf_shape *shape, uint64_t count, float *values);

/* Writes the shape as bytes, for a file: 72 and 4 a node. With `buffer` null, *size gets the bytes
 * needed; else *size is the room there is, and gets the bytes written. pbf-bake writes such files
 * of meshes. */
PBF_API pbf_status pbf_save_shape(pbf_shape *shape, void *buffer, uint64_t *size);

/* The same shape again, with the same hash: a tenth of a microsecond a node. PBF_ERROR_DATA for
 * anything that pbf_save_shape did not write. */
PBF_API pbf_status pbf_load_shape(const void *buffer, uint64_t size, pbf_shape **shape);

#ifdef __cplusplus
}
#endif

#endif
