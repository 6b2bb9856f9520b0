/* Where the domain's walls and the colliders are at a time: closed forms, so that no error
 * accumulates and any number of steps may run without asking the caller. Host only, float64. */
#ifndef PBF_PHYSICS_MOTION_H
#define PBF_PHYSICS_MOTION_H

#include <math.h>
#include <stdint.h>

#include <pbf/pbf.h>

/* When steps end: the same number whatever call a step is in. */
typedef struct pbf_step_times {
  double time; /* `before` steps before the first */
  uint64_t before;
  double time_step;
} pbf_step_times;

/* The time after `steps` of them. */
static inline double pbf_time_after(const pbf_step_times *t, uint32_t steps) {
  return t->time + (double)(t->before + steps) * t->time_step;
}

static inline double pbf_motion_wall(const pbf_params *params, int wall, double time) {
  const double *bounds = (wall & 1) ? params->domain_max : params->domain_min;
  return bounds[wall / 2] + params->wall_velocity[wall] * time +
         params->wall_amplitude[wall] *
             sin(params->wall_frequency[wall] * time + params->wall_phase[wall]);
}

/* a * b, quaternions as x, y, z, w */
static inline void pbf_motion_quaternion_product(const double a[4], const double b[4],
                                                 double product[4]) {
  product[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  product[1] = a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2];
  product[2] = a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0];
  product[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

/* The pose `elapsed` after the one in *at_set, both velocities constant. */
static inline void pbf_motion_collider(const pbf_collider *at_set, double elapsed,
                                       pbf_collider *now) {
  *now = *at_set;
  const double *w = at_set->angular_velocity;
  double speed = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  for (int a = 0; a < 3; ++a) now->position[a] += elapsed * at_set->velocity[a];
  if (speed > 0 && speed < 1e150) { /* no angle is known of what turns faster */
    double s = sin(0.5 * speed * elapsed) / speed;
    double turn[4] = {s * w[0], s * w[1], s * w[2], cos(0.5 * speed * elapsed)};
    pbf_motion_quaternion_product(turn, at_set->orientation, now->orientation);
  }
}

#endif
