/* Particles at one and the same point: the kernel's gradient is zero between them, so that nothing
 * would ever part them. Host only, float64; C17 and C++17. */
#ifndef PBF_PHYSICS_COINCIDENT_H
#define PBF_PHYSICS_COINCIDENT_H

#include <math.h>
#include <stdint.h>

#include "physics/elementary.h"

/* Where particle `member` of the `count` at a point goes from there. Pairs go to opposite sides, so
 * that the centre stays: the first pair by a quarter of the spacing, later ones farther, so that
 * all of them fill a disc or ball. Directions turn by the golden angle. */
static inline void pbf_coincident_offset(uint32_t dimension, double spacing, uint32_t index,
                                         uint32_t count, double offset[3]) {
  const double golden_angle = 2.399963229728653;
  uint32_t pair = index / 2, pairs = count / 2;
  offset[0] = offset[1] = offset[2] = 0;
  if (pair == pairs) return; /* the last of an odd number stays */
  double angle = golden_angle * pair, height = dimension == 3 ? 1 - (pair + 0.5) / pairs : 0;
  double radius = 0.25 * spacing * pbf_pow(pair + 1, 1.0 / dimension) * (index % 2 ? -1 : 1);
  double across = radius * sqrt(1 - height * height);
  offset[0] = across * pbf_cos(angle);
  offset[1] = across * pbf_sin(angle);
  offset[2] = radius * height;
}

#endif
