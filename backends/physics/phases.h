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

/* The density that a pressure grid carries of all fluids, over the reference density. What pressure
 * pairs carry holds a particle among its neighbours like a solid, and buoyancy is what pairs carry:
 * single particles stay where they are deeper than some 17 layers, by whatever they are lighter,
 * once pairs carry no more than the difference to the lightest fluid. A grid that carries all
 * fluids alike, as if each had this density, leaves them the rest. It is never more than the
 * lightest one's, which its own weight would not hold down. Of that one pairs keep a third of what
 * they carry of the heaviest: with less the two stir each other, a tank of 1 : 2 at rest, 3D, h = 2
 * spacings, at 0.10 √(g d) with a fifth instead of 0.013, one of 1 : 0.8 with none at 0.05. */
static inline double pbf_carried_of(const pbf_phase_table *table, uint32_t these) {
  double lightest = 1e30, heaviest = 0;
  for (uint32_t k = 0; k < table->count; ++k) {
    if (!(these >> k & 1)) continue;
    const double density = 1 / table->mobility[k];
    lightest = density < lightest ? density : lightest;
    heaviest = density > heaviest ? density : heaviest;
  }
  const double carried = lightest - 0.5 * (heaviest - lightest);
  return !table->count ? 1 : carried > 1e-6 * heaviest ? carried : 0;
}

/* Of those that there is fluid of: a pool of water is not to be left to the iterations because oil
 * is listed. */
static inline double pbf_carried_density(const pbf_phase_table *table) {
  return pbf_carried_of(table, table->used ? table->used : UINT32_MAX);
}

/* Whether fluids differ in density, and so little that a grid carries some of all. Heavier ones
 * fall through lighter ones by themselves. */
static inline int pbf_phases_are_close(const pbf_phase_table *table) {
  int differ = 0;
  for (uint32_t k = 1; k < table->count; ++k)
    differ |= table->mobility[k] < table->mobility[0] || table->mobility[k] > table->mobility[0];
  return differ && pbf_carried_of(table, UINT32_MAX) > 0;
}

typedef struct pbf_phase_constants {
  pbf_real mobility[PBF_MAX_PHASES], viscosity[PBF_MAX_PHASES], thickness[PBF_MAX_PHASES];
  pbf_real thickest;
  double heaviest; /* 1 without phases, … */
  double carried;  /* … as is this, pbf_carried_density */
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
  p.carried = pbf_carried_density(table);
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
