/* Signed distances on a grid, once they are in their place. */
#ifndef PBF_LIB_SHAPE_GRID_H
#define PBF_LIB_SHAPE_GRID_H

#include "registry.h"

/* What is a distance changes by no more than the way; linear interpolation and noise want some. */
static const double pbf_shape_steepest_edge = 1.5;

/* Checks the values of a grid that has its size, origin and cell, measures the solid and publishes
 * it; frees it where it fails. `label` is what messages call the values. */
pbf_status pbf_shape_finish(pbf_live_shape *made, const char *label, pbf_shape **shape);

/* Fails unless a grid of this size can be. */
pbf_status pbf_shape_check_size(const char *label, uint32_t dimension, const uint32_t size[3]);

/* … unless the lengths of that can be. */
pbf_status pbf_shape_check_place(const char *label, uint32_t dimension, const double origin[3],
                                 double cell);

/* The sentence for one of which no node is inside. */
pbf_status pbf_shape_fail_without_inside(const char *label);

#endif
