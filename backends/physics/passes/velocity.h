/* Line 21: the velocity that explains what walls and colliders do to a position. */
#ifndef PBF_PHYSICS_PASSES_VELOCITY_H
#define PBF_PHYSICS_PASSES_VELOCITY_H

#include "physics/real.h"

/* The same for what walls and colliders do to a place. */
PBF_FN pbf_vec pbf_velocity(pbf_real inv_time_step, pbf_vec velocity, pbf_vec before,
                            pbf_vec after) {
  return pbf_add_scaled(velocity, inv_time_step, pbf_sub(after, before));
}

#endif
