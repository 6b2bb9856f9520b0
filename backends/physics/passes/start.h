/* Where a step begins, told from where it leads: what undoes or repeats a part of it asks for that
 * after particles are sorted by their predicted positions. */
#ifndef PBF_PHYSICS_PASSES_START_H
#define PBF_PHYSICS_PASSES_START_H

#include "physics/real.h"

PBF_FN pbf_vec pbf_start(pbf_real time_step, pbf_vec predicted, pbf_vec velocity) {
  return pbf_add_scaled(predicted, -time_step, velocity);
}

#endif
