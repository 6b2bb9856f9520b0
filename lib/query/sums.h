/* Density and fields of the particles at a point: query.h has the equations. */
#ifndef PBF_LIB_QUERY_SUMS_H
#define PBF_LIB_QUERY_SUMS_H

#include "index.h"

/* The surface is where the density is this. */
#define PBF_QUERY_SURFACE 0.5

/* rho/rho0 at a point; its gradient, too, where that is not null. */
double pbf_query_density(pbf_query_place *place, const double *point, double *gradient);

/* Velocity, in the first three, and pressure, the fourth: those that `fields` asks for, which the
 * index must have. The others are 0. */
void pbf_query_fields(pbf_query_place *place, const double *point, uint32_t fields,
                      double values[4]);

#endif
