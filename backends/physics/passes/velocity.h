/* Line 21: the velocity that explains what walls and colliders do to a position. */
#ifndef PBF_PHYSICS_PASSES_VELOCITY_H
#define PBF_PHYSICS_PASSES_VELOCITY_H

#include "physics/real.h"

/* Along an axis, such that sums of squares are finite: along a periodic axis no wall ends a way.
 * The next prediction has a bound of its own (pbf_max_speed_of). */
PBF_FN pbf_real pbf_largest_speed() {
  return (pbf_real)(sizeof(pbf_real) == sizeof(float) ? 1e18 : 1e150);
}

/* The same for what walls and colliders do to a place. */
PBF_FN pbf_vec pbf_velocity(pbf_real inv_time_step, pbf_vec velocity, pbf_vec before,
                            pbf_vec after) {
  velocity = pbf_add_scaled(velocity, inv_time_step, pbf_sub(after, before));
  const pbf_real most = pbf_largest_speed();
  for (int k = 0; k < PBF_DIM; ++k)
    velocity.c[k] = pbf_real_max(-most, pbf_real_min(velocity.c[k], most));
  return velocity;
}

#endif
