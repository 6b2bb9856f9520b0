/* A collider as it stands at a time, as its distance is asked for in the library. */
#ifndef PBF_LIB_SOLVER_SOLID_H
#define PBF_LIB_SOLVER_SOLID_H

#include "solver.h"

typedef struct pbf_solid {
  pbf_collider now;
  uint32_t dimension;
  double frame[3][3]; /* rows: its own axes in the world; the first a plane's or capsule's axis */
  double bound;       /* nothing of it is farther from its position */
} pbf_solid;

pbf_solid pbf_solid_at(const pbf_solver *solver, uint32_t index, double time);

/* Whether nothing of it is within `reach` of a point. */
int pbf_solid_is_beyond(const pbf_solid *solid, const double *x, double reach);

/* Negative where fluid must not be; *normal points to the fluid. */
double pbf_solid_distance(const pbf_solid *solid, const double *x, double normal[3]);

#endif
