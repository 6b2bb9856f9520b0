/* Part of solver.h: the buffers of a step, by what they hold. */
#ifndef PBF_CPU_STATE_H
#define PBF_CPU_STATE_H

#include "cpu/field.h"
#include "physics/sleep.h"

template <class Buffer>
static inline void exchange(Buffer *a, Buffer *b) {
  Buffer kept = *a;
  *a = *b;
  *b = kept;
}

/* Each thread has a copy, and exchanges buffers where what is in one takes the place of what is in
 * another, so that nothing is copied. The two named `scratch` hold one thing after another: what
 * reads them asks for it by name. */
struct buffers {
  field x, v;                              /* the state, in the order of the last step */
  field sorted_predicted, sorted_velocity; /* in the order of this step; velocity() leaves the
                                              velocity of the end there */
  field scratch[2];
  uint32_t *ids, *sorted_ids;

#define PBF_ARRAY(name, wanted, holders) holders
#define PBF_CPU_BUFFER(type, team_thread, extent) type team_thread;
#include "physics/arrays.def"

  /* Until the sort, in the order of the state. */
  PBF_IN const field &predicted() const { return scratch[0]; }
  PBF_IN const field &predicted_velocity() const { return scratch[1]; }

  /* Where a step begins, until its iterations: where density is wanted there. */
  PBF_IN const field &step_start() const { return scratch[0]; }

  /* x* when so many iterations are done, and where the next one puts it. */
  PBF_IN const field &x_star(uint32_t iterations) const {
    return iterations ? scratch[1] : sorted_predicted;
  }
  PBF_IN const field &next_x_star() const { return scratch[0]; }
  PBF_IN void accept_iteration() { exchange(&scratch[0], &scratch[1]); }

  /* Where particles have accelerations: their velocities with those, before the other forces. */
  PBF_IN const field &accelerated_velocity() const { return sorted_velocity; }

  /* From the sort to the end of the solve nothing reads the old state. Of viscosity: what
   * velocities change by, with what they do after the next stage; and what acts on them. */
  PBF_IN const field &viscous_change() const { return x; }
  PBF_IN const field &next_viscous_change() const { return v; }
  PBF_IN void accept_viscous_stage() { exchange(&x, &v); }
  PBF_IN const field &viscous_force() const { return scratch[1]; }

  /* Where particles go by that. */
  PBF_IN const field &viscous_prediction() const { return scratch[1]; }
  PBF_IN void accept_viscous_prediction() { exchange(&sorted_predicted, &scratch[1]); }

  /* What surfaces contribute is kept there after that. */
  PBF_IN const field &boundary_gradient() const { return v; }
  PBF_IN pbf_real *boundary_rest() const { return x.c[0]; }
  PBF_IN pbf_real *clear_ways_of() const { return x.c[1]; }

  /* Until then, of the overlap: what has been placed, and what that and streams contribute. */
  PBF_IN pbf_real *is_placed() const { return x.c[0]; }
  PBF_IN pbf_real *placed_density() const { return x.c[1]; }
  PBF_IN pbf_real *stream_density() const { return v.c[0]; }

  /* After an iteration or more: the old state gives way to the new one. */
  PBF_IN void accept_step() {
    exchange(&x, &scratch[1]);
    exchange(&v, &sorted_velocity);
    exchange(&ids, &sorted_ids);
    exchange(&activity, &sorted_activity);
    exchange(&sleeping_lambda, &sorted_sleeping_lambda);
    exchange(&overlap, &sorted_overlap);
    exchange(&acceleration, &sorted_acceleration);
    exchange(&phase, &sorted_phase);
  }

  /* After that, each from its stage to the next that has one of these. */
  PBF_IN const field &mean_velocity() const { return scratch[0]; }
  PBF_IN const field &deviator() const { return scratch[0]; }
  PBF_IN pbf_real *rest_of_deviator(int k) const { return sorted_velocity.c[k]; }
  PBF_IN const field &shear_push() const { return scratch[1]; }
  PBF_IN const field &shear_velocity() const { return scratch[0]; }
  PBF_IN const field &sheared_x() const { return scratch[1]; }
  PBF_IN void accept_sheared_x() { exchange(&x, &scratch[1]); }
  PBF_IN const field &rotation_rate() const { return scratch[0]; }
  PBF_IN const field &curl() const { return scratch[0]; }
  PBF_IN pbf_real *wakes() const { return scratch[0].c[0]; }
  PBF_IN const field &smoothed_velocity() const { return scratch[1]; }
  PBF_IN void accept_smoothed_velocity() { exchange(&v, &scratch[1]); }

  /* Between steps. */
  PBF_IN const field &sorted_x() const { return sorted_predicted; }
  PBF_IN pbf_real *sorted_lambda() const { return scratch[0].c[1]; }
  PBF_IN pbf_real *fitted_lambda() const { return scratch[0].c[0]; }
};

#endif
