/* Drag towards a velocity, as of a wind or a stream around the fluid: dv/dt = -drag (v -
 * drag_velocity), solved exactly over the step, so that it is stable at any rate. Over the
 * particles alone. */
#ifndef PBF_PHYSICS_PASSES_DRAG_H
#define PBF_PHYSICS_PASSES_DRAG_H

#include "physics/elementary.h"
#include "physics/passes/pass.h"

namespace {

struct drag_pass {
  pbf_vec velocity; /* the one dragged towards */
  pbf_real kept;    /* part of the difference to it that a step leaves */

  PBF_IN pbf_vec finish(pbf_vec v) const {
    return pbf_add_scaled(velocity, kept, pbf_sub(v, velocity));
  }

  static drag_pass of(const pbf_params *params) {
    drag_pass pass;
    pass.kept = (pbf_real)pbf_exp(-params->drag * params->time_step);
    for (int k = 0; k < PBF_DIM; ++k) pass.velocity.c[k] = (pbf_real)params->drag_velocity[k];
    return pass;
  }
};

}  // namespace

#endif
