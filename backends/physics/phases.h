/* What phases make different of particles: their mass, and how viscous they are.
 *
 * Particles stand for the same volume, so the density constraint is that of one fluid. What differs
 * is the metric: a pair's push moves each of the two by the reciprocal of its mass, its mobility,
 * and of viscosity, too, what pairs exchange is momentum. Mobilities are over that of the reference
 * density, and without phases all 1. */
#ifndef PBF_PHYSICS_PHASES_H
#define PBF_PHYSICS_PHASES_H

#include <stdint.h>

#include <pbf/pbf_backend.h>

#include "physics/real.h"

typedef struct pbf_phase_constants {
  pbf_real mobility[PBF_MAX_PHASES], viscosity[PBF_MAX_PHASES], thickness[PBF_MAX_PHASES];
  pbf_real thickest;
  double heaviest; /* 1 without phases */
} pbf_phase_constants;

/* In the precision that the particles have. Of no table all are 0: nothing asks. */
static inline pbf_phase_constants pbf_phase_constants_of(const pbf_phase_table *table) {
  pbf_phase_constants p;
  for (uint32_t k = 0; k < PBF_MAX_PHASES; ++k) {
    p.mobility[k] = (pbf_real)table->mobility[k];
    p.viscosity[k] = (pbf_real)table->viscosity[k];
    p.thickness[k] = (pbf_real)table->thickness[k];
  }
  p.thickest = (pbf_real)table->thickest;
  p.heaviest = table->count ? table->heaviest : 1;
  return p;
}

/* `crowding` is what crowding leaves out of a particle's viscosity, of that of the thickest phase.
 * A pair has that of the thinner of its two particles: what lies between two layers transmits as
 * much shear as the thinner one does. */
PBF_FN pbf_real pbf_left_out(const pbf_phase_constants *p, uint8_t phase, pbf_real crowding) {
  return 1 - (1 - crowding) * p->thickness[phase];
}

/* From what pairs of the thickest phase at the reference density would change a velocity by. */
PBF_FN pbf_real pbf_viscous_scale(const pbf_phase_constants *p, uint8_t phase) {
  return p->thickest * p->mobility[phase];
}

#endif
