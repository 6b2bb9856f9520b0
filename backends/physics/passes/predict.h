/* Lines 1 to 4: forces, and the positions that they and the velocities predict. */
#ifndef PBF_PHYSICS_PASSES_PREDICT_H
#define PBF_PHYSICS_PASSES_PREDICT_H

#include <float.h>
#include <math.h>

#include "physics/project.h"
#include "physics/real.h"

/* Forces of one step (Algorithm 1, line 2), in the precision of the particles. */
typedef struct pbf_forces {
  pbf_real time_step, inv_time_step;
  pbf_real max_speed; /* along an axis, see pbf_max_speed_of */
  pbf_real max_way; /* that is predicted along an axis: where walls act in iterations alone, squares
                       of distances from there have to be finite */
  pbf_real rounding; /* part of a last bit that predictions are off, see pbf_rounding_of */
  pbf_vec gravity;
  pbf_real attraction;
  pbf_vec attraction_center;
} pbf_forces;

/* At a constant velocity a place is rounded the same way in every step, and what is lost adds up.
 * So the ways that particles go are off by a part of a last bit before they are rounded, in each
 * step by another one: a golden part of a turn on, which spreads any run of steps as evenly as can
 * be (Kronecker's sequence), so that their mean is what was to be added. The steps' number is told
 * from the `time` at which a step begins, at a place in it that no change of the time step hits. */
static inline pbf_real pbf_rounding_of(double time, double time_step) {
  const double golden = 0.61803398874989485;
  if (!(time_step > 0)) return 0;
  double turns = golden * floor(time / time_step + (1 - golden));
  return (pbf_real)(0.9999 * (turns - floor(turns + 0.5)));
}

/* What crosses the domain in less than a step is as fast as what crosses it in one: walls stop
 * both, and squares of what is faster overflow. So may those of more than 1e15 h a time unit. */
static inline pbf_real pbf_max_speed_of(const pbf_params *params) {
  double way = 0, maximum = 1e15 * params->smoothing_radius;
  for (int k = 0; k < PBF_DIM; ++k) way += params->domain_max[k] - params->domain_min[k];
  way *= pbf_per_time_step(params);
  return (pbf_real)(way > 0 && way < maximum ? way : maximum);
}

static inline pbf_forces pbf_forces_of(const pbf_params *params, double time) {
  pbf_forces f;
  f.time_step = (pbf_real)params->time_step;
  f.inv_time_step = (pbf_real)pbf_per_time_step(params);
  f.max_speed = pbf_max_speed_of(params);
  f.max_way = f.time_step * f.max_speed;
  if (params->collide & PBF_COLLIDE_AFTER_PREDICTION)
    f.max_way = (pbf_real)(sizeof(pbf_real) == sizeof(float) ? FLT_MAX : DBL_MAX);
  f.rounding = pbf_rounding_of(time, params->time_step);
  f.attraction = (pbf_real)params->attraction;
  for (int k = 0; k < PBF_DIM; ++k) {
    f.gravity.c[k] = (pbf_real)params->gravity[k];
    f.attraction_center.c[k] = (pbf_real)params->attraction_center[k];
  }
  return f;
}

/* The velocity of a particle with an acceleration of its own, which acts before those of all. */
PBF_FN pbf_vec pbf_add_acceleration(const pbf_forces *f, pbf_vec v, pbf_vec acceleration) {
  return pbf_add_scaled(v, f->time_step, acceleration);
}

/* Line 2: the velocity that the forces leave a particle at x. */
PBF_FN pbf_vec pbf_apply_forces(const pbf_forces *f, pbf_vec x, pbf_vec v) {
  pbf_vec acceleration = f->gravity;
  if (f->attraction != 0)
    acceleration = pbf_add_scaled(acceleration, -f->attraction, pbf_sub(x, f->attraction_center));
  return pbf_add_scaled(v, f->time_step, acceleration);
}

/* Lines 2 and 3: the predicted position of a particle at x with velocity v. */
PBF_FN pbf_vec pbf_predict(const pbf_forces *f, pbf_vec x, pbf_vec v) {
  pbf_vec velocity = pbf_apply_forces(f, x, v);
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real sign = velocity.c[k] < 0 ? (pbf_real)-1 : (pbf_real)1;
    pbf_real way = f->time_step * (sign * velocity.c[k]);
    way += f->rounding * pbf_last_bit(x.c[k]);
    x.c[k] += sign * pbf_real_min(way < 0 ? 0 : way, f->max_way);
  }
  return x;
}

/* The velocity that goes with it: obstacles may have moved what was `predicted` to `after`. What is
 * no number becomes one. */
PBF_FN pbf_vec pbf_predicted_velocity(const pbf_forces *f, pbf_vec x, pbf_vec v, pbf_vec predicted,
                                      pbf_vec after) {
  pbf_vec moved = pbf_sub(after, predicted);
  pbf_vec velocity = pbf_add_scaled(pbf_apply_forces(f, x, v), f->inv_time_step, moved);
  for (int k = 0; k < PBF_DIM; ++k)
    velocity.c[k] = pbf_real_max(-f->max_speed, pbf_real_min(velocity.c[k], f->max_speed));
  return velocity;
}

#endif
