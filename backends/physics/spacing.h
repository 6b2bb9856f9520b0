/* The distance of neighbours in a lattice at rest density, and units of length. Host only, float64;
 * C17 and C++17, for lib/ needs it, too. */
#ifndef PBF_PHYSICS_SPACING_H
#define PBF_PHYSICS_SPACING_H

#include <string.h>

#include <pbf/pbf.h>

static inline double pbf_derive_spacing(const pbf_params *params) {
  return params->spacing > 0 ? params->spacing : 0.5 * params->smoothing_radius;
}

/* The largest power of two that is no longer than this: what is computed in it has the same bits,
 * and is a number where powers of lengths are none. */
static inline double pbf_unit_near(double length) {
  uint64_t bits;
  double unit;
  memcpy(&bits, &length, sizeof bits);
  bits &= UINT64_C(0x7ff0000000000000);
  memcpy(&unit, &bits, sizeof unit);
  return unit;
}

#endif
