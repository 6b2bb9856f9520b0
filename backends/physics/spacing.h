/* The distance of neighbours in a lattice at rest density. Host only, float64; C17 and C++17, for
 * lib/ needs it, too. */
#ifndef PBF_PHYSICS_SPACING_H
#define PBF_PHYSICS_SPACING_H

#include <pbf/pbf.h>

static inline double pbf_derive_spacing(const pbf_params *params) {
  return params->spacing > 0 ? params->spacing : 0.5 * params->smoothing_radius;
}

#endif
