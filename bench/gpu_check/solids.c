/* What many colliders cost: a dam breaks over them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pbf/shapes.h>

#include "commands.h"
#include "solver.h"

/* Corners of a box that is 1.2 spacings wide to each side; an eighth of them is cut away where
 * `cut`, so that the solid is not convex. */
static pbf_shape *shape_of(const scene *s, int is_hull) {
  static const uint32_t faces[24][3] = {{0, 3, 1}, {0, 2, 3}, {0, 1, 4}, {1, 5, 4},
                                        {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5},
                                        {2, 6, 3}, {3, 6, 7}, {4, 5, 6}, {5, 7, 6}};
  double corners[8][3];
  pbf_shape *shape = NULL;
  const double half = 1.2 * s->spacing;
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) corners[i][k] = (i >> k & 1 ? 1 : -1) * half;
  for (int k = 0; k < 3; ++k) corners[7][k] *= is_hull ? 1 : 0.3;
  if (is_hull) {
    pbf_hull_desc hull = {.struct_size = sizeof hull, .dimension = 3, .point_count = 8};
    hull.points = corners[0];
    hull.cell = 0.5 * s->spacing;
    must(pbf_shape_from_points(&hull, &shape), "pbf_shape_from_points");
  } else {
    pbf_mesh_desc mesh = {.struct_size = sizeof mesh, .dimension = 3};
    mesh.vertex_count = 8;
    mesh.face_count = 12;
    mesh.vertices = corners[0];
    mesh.faces = faces[0];
    mesh.cell = 0.5 * s->spacing;
    must(pbf_shape_from_mesh(&mesh, &shape), "pbf_shape_from_mesh");
  }
  return shape;
}

/* In a lattice all over the domain's lower half, some spacings from its walls. */
static void place_solids(scene *s, uint32_t solids, pbf_shape *shape, int moves) {
  const double *size = s->params.domain_max;
  const double each = cbrt(size[0] * 0.5 * size[1] * size[2] / solids);
  const uint32_t nx = (uint32_t)ceil(size[0] / each), ny = (uint32_t)ceil(0.5 * size[1] / each);
  const uint32_t nz = (uint32_t)ceil((double)solids / nx / ny);
  for (uint32_t i = 0; i < solids; ++i) {
    pbf_collider *c = &s->colliders[i];
    const uint32_t at[3] = {i / ny % nx, i % ny, i / ny / nx}, n[3] = {nx, ny, nz};
    must(pbf_collider_init(c, sizeof *c, shape ? PBF_COLLIDER_SHAPE : PBF_COLLIDER_BOX),
         "pbf_collider_init");
    for (int k = 0; k < 3; ++k) {
      c->position[k] = (at[k] + 0.5) / n[k] * size[k] * (k == 1 ? 0.5 : 1);
      c->half_extents[k] = 1.2 * s->spacing;
    }
    c->geometry = shape;
    if (moves) c->velocity[0] = i % 2 ? 0.2 : -0.2, c->angular_velocity[1] = 1;
  }
  s->collider_count = solids;
}

int time_solids(uint32_t particles, uint32_t solids, const char *shape, int moves) {
  static scene s;
  char name[64];
  const int is_hull = strcmp(shape, "hull") == 0, is_mesh = strcmp(shape, "mesh") == 0;
  if ((!is_hull && !is_mesh && strcmp(shape, "box") != 0) || solids > SCENE_COLLIDERS) return 0;
  s = shallow_dam_break(particles, 2);
  pbf_shape *of = is_hull || is_mesh ? shape_of(&s, is_hull) : NULL;
  if (solids) place_solids(&s, solids, of, moves);
  snprintf(name, sizeof name, "%u %s%s", solids, shape, moves ? ", moving" : "");
  s.name = "dam-over-solids";
  s.extra = name;
  time_scene(&s, PBF_FLOAT32, 100, 60);
  pbf_release_shape(of);
  return 1;
}
