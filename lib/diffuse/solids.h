/* What diffuse particles do not go through: the domain's walls and the colliders. */
#ifndef PBF_LIB_DIFFUSE_SOLIDS_H
#define PBF_LIB_DIFFUSE_SOLIDS_H

#include "diffuse.h"
#include "params.h"

/* The walls at a time, and how fast they go, from where they were `elapsed` before. */
typedef struct pbf_diffuse_walls {
  pbf_box box;
  double lower_velocity[3], upper_velocity[3];
} pbf_diffuse_walls;

pbf_diffuse_walls pbf_diffuse_walls_at(const pbf_solver *solver, double time, double elapsed);

/* Onto a wall that it is behind, without the velocity that leads there; along a periodic axis to
 * its image in the domain. */
void pbf_diffuse_keep_inside(const pbf_solver *solver, const pbf_diffuse_walls *walls,
                             pbf_diffuse_particle *particle);

/* The same of all particles and the colliders, as they stand at that time. */
void pbf_diffuse_push_out(const pbf_solver *solver, double time);

/* Whether a direction leads to a wall that is nearer to a point than `reach`. */
int pbf_diffuse_faces_wall(const pbf_solver *solver, const pbf_diffuse_walls *walls,
                           const double *point, const double *direction, double reach);

#endif
