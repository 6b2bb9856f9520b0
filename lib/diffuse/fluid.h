/* The fluid around a place, as spray, foam and bubbles see it: all sums go over its particles
 * within h, by the weight W = 1 - distance / h. */
#ifndef PBF_LIB_DIFFUSE_FLUID_H
#define PBF_LIB_DIFFUSE_FLUID_H

#include "diffuse.h"
#include "query/index.h"

/* Where sums are taken; places that follow each other are looked up once. */
typedef struct pbf_fluid {
  pbf_query_place place;
  double radius;      /* h */
  double rest_weight; /* the sum of W around a particle of the lattice at rest, without its own */
} pbf_fluid;

pbf_fluid pbf_fluid_of(const pbf_solver *solver, const pbf_query_index *index);

/* At a point: how many particles are within h, its velocity there, and how that changes,
 * gradient[k][l] = dv_k/dx_l; 0 where there is none. */
typedef struct pbf_fluid_flow {
  uint32_t neighbors;
  double velocity[3], gradient[3][3];
} pbf_fluid_flow;

pbf_fluid_flow pbf_fluid_flow_at(pbf_fluid *fluid, const double *point);

/* Around a particle of it, `own` by its place in the index. */
typedef struct pbf_fluid_sums {
  double closing;   /* sum of (|v_ij| - v_ij·x_ij/|x_ij|) W_ij over W0 */
  double normal[3]; /* out of it, of length 1; 0 where that is inside */
} pbf_fluid_sums;

pbf_fluid_sums pbf_fluid_sums_around(pbf_fluid *fluid, uint32_t own);

/* Position and velocity of one of its particles. */
void pbf_fluid_particle(const pbf_fluid *fluid, uint32_t own, double position[3],
                        double velocity[3]);

/* Calls visit(context, other, way, weight) for the others within h of one of its particles. */
typedef void (*pbf_fluid_visit)(void *context, uint32_t other, const double way[3], double weight);
void pbf_fluid_each_near(pbf_fluid *fluid, uint32_t own, pbf_fluid_visit visit, void *context);

#endif
