/* How far one solid reaches beyond another, as where a shape is baked anew for each frame. */
#ifndef PBF_LIB_SHAPE_GROWTH_H
#define PBF_LIB_SHAPE_GROWTH_H

#include "registry.h"

/* A shape as a collider has it. */
typedef struct pbf_scaled_shape {
  const pbf_shape *shape;
  double scale;
} pbf_scaled_shape;

/* How deep what is solid of `next` lies outside of `before`, both in one place; with `inverted` all
 * but these is solid. Looks no further once it is more than `most`. */
double pbf_shape_growth(const pbf_scaled_shape *before, const pbf_scaled_shape *next, int inverted,
                        double most);

#endif
