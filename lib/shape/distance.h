/* How far a point is from the surface of a shape. */
#ifndef PBF_LIB_SHAPE_DISTANCE_H
#define PBF_LIB_SHAPE_DISTANCE_H

#include "registry.h"

/* Negative inside. `normal` gets the slope of it, of any length, also 0; of a finite point. */
double pbf_shape_distance_at(const pbf_shape *shape, const double *point, double normal[3]);

#endif
