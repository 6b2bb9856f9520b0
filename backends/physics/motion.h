/* Where the domain's walls and the colliders are at a time: closed forms, so that no error
 * accumulates and any number of steps may run without asking the caller. Host only, float64. */
#ifndef PBF_PHYSICS_MOTION_H
#define PBF_PHYSICS_MOTION_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <pbf/pbf.h>

#include "physics/elementary.h"

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

/* Which one the last of so many is since the time step has changed, from 1. */
static inline uint64_t pbf_nth_after(const pbf_step_times *t, uint32_t steps) {
  return t->before + steps;
}

static inline double pbf_motion_wall(const pbf_params *params, int wall, double time) {
  const double *bounds = (wall & 1) ? params->domain_max : params->domain_min;
  return bounds[wall / 2] + params->wall_velocity[wall] * time +
         params->wall_amplitude[wall] *
             pbf_sin(params->wall_frequency[wall] * time + params->wall_phase[wall]);
}

/* By how much it moves more in the step that ends at a time than in the one before: 0 for one that
 * stands or moves evenly, to the bit. */
static inline double pbf_motion_wall_gain(const pbf_params *params, int wall, double time) {
  const double frequency = params->wall_frequency[wall], dt = params->time_step;
  if (!(params->wall_amplitude[wall] != 0)) return 0;
  const double sine = pbf_sin(0.5 * frequency * dt);
  return -4 * params->wall_amplitude[wall] * sine * sine *
         pbf_sin(frequency * (time - dt) + params->wall_phase[wall]);
}

/* a * b, quaternions as x, y, z, w */
static inline void pbf_motion_quaternion_product(const double a[4], const double b[4],
                                                 double product[4]) {
  product[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  product[1] = a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2];
  product[2] = a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0];
  product[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

static inline double pbf_motion_length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* v turned by the angle about a unit axis (Rodrigues). */
static inline void pbf_motion_turned(const double v[3], const double axis[3], double angle,
                                     double turned[3]) {
  const double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
  const double cosine = pbf_cos(angle), sine = pbf_sin(angle);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const double across = v[a] - along * axis[a], round = axis[b] * v[c] - axis[c] * v[b];
    turned[a] = along * axis[a] + cosine * across + sine * round;
  }
}

/* ---- Screws --------------------------------------------------------------------------------- */

/* What turns at a constant rate while its velocity turns with it is on a screw: it turns about an
 * axis that stands in space, and goes along it. So does every point of a rigid body, each with its
 * own velocity: parts of one keep their distances, as they do not on straight ways between the same
 * poses (Murray, Li & Sastry 1994, section 2.3). */

/* Way in a time, the integral of the velocity v that turns with the rate w. */
static inline void pbf_motion_screw_way(const double v[3], const double w[3], double time,
                                        double way[3]) {
  const double rate = pbf_motion_length(w), angle = rate * time;
  const double sine = pbf_sin(angle) / rate, sine_of_half = pbf_sin(0.5 * angle);
  const double versine = 2 * sine_of_half * sine_of_half / rate;
  const double axis[3] = {w[0] / rate, w[1] / rate, w[2] / rate};
  const double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const double round = axis[b] * v[c] - axis[c] * v[b], straight = along * axis[a];
    way[a] = straight * time + sine * (v[a] - straight) + versine * round;
  }
}

/* The velocity to begin with of what so goes that way, turning by less than a whole turn. */
static inline void pbf_motion_screw_velocity(const double way[3], const double w[3], double time,
                                             double v[3]) {
  const double rate = pbf_motion_length(w), half = 0.5 * rate * time;
  for (int a = 0; a < 3; ++a) v[a] = way[a] / time;
  if (!(half > 0)) return;
  /* Across the axis it turns by half the angle in the mean, and cancels a part of itself. */
  const double axis[3] = {w[0] / rate, w[1] / rate, w[2] / rate};
  const double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
  double across[3];
  for (int a = 0; a < 3; ++a) across[a] = (v[a] - along * axis[a]) * half / pbf_sin(half);
  pbf_motion_turned(across, axis, -half, v);
  for (int a = 0; a < 3; ++a) v[a] += along * axis[a];
}

/* The rate at which a turn between two orientations takes a time, the short way. */
static inline void pbf_motion_turn_rate(const double from[4], const double to[4], double time,
                                        double w[3]) {
  const double conjugate[4] = {-from[0], -from[1], -from[2], from[3]};
  double turn[4];
  pbf_motion_quaternion_product(to, conjugate, turn);
  const double sign = turn[3] < 0 ? -1 : 1, sine = pbf_motion_length(turn);
  const double angle = sine > 0 ? 2 * pbf_angle(sine, sign * turn[3]) : 0;
  for (int a = 0; a < 3; ++a) w[a] = sine > 0 ? sign * turn[a] / sine * angle / time : 0;
}

/* ---- Colliders ------------------------------------------------------------------------------ */

/* An angle is known of what does not turn too fast for that. */
static inline int pbf_motion_turns(const pbf_collider *collider) {
  const double rate = pbf_motion_length(collider->angular_velocity);
  return rate > 0 && rate < 1e150;
}

/* How long it has been moving, `elapsed` after it was set. */
static inline double pbf_motion_time(const pbf_collider *at_set, double elapsed) {
  return at_set->duration > 0 && elapsed > at_set->duration ? at_set->duration : elapsed;
}

static inline int pbf_motion_has_ended(const pbf_collider *at_set, double elapsed) {
  return at_set->duration > 0 && elapsed >= at_set->duration;
}

static inline double pbf_motion_size(double size, double rate, double time) {
  const double grown = size + rate * time;
  return rate != 0 && !(grown > 0) ? 0 : grown;
}

/* Where it is `elapsed` after the place in *at_set, on such a path. */
static inline void pbf_motion_position(const pbf_collider *at_set, uint32_t path, double elapsed,
                                       double position[3]) {
  const double time = pbf_motion_time(at_set, elapsed);
  double way[3];
  for (int a = 0; a < 3; ++a) way[a] = time * at_set->velocity[a];
  if (path == PBF_PATH_SCREW && pbf_motion_turns(at_set))
    pbf_motion_screw_way(at_set->velocity, at_set->angular_velocity, time, way);
  for (int a = 0; a < 3; ++a) position[a] = at_set->position[a] + way[a];
}

/* Its pose and sizes `elapsed` after those in *at_set. */
static inline void pbf_motion_collider(const pbf_collider *at_set, double elapsed,
                                       pbf_collider *now) {
  const double time = pbf_motion_time(at_set, elapsed);
  const double *w = at_set->angular_velocity;
  *now = *at_set;
  pbf_motion_position(at_set, at_set->path, elapsed, now->position);
  for (int a = 0; a < 3; ++a)
    now->half_extents[a] =
        pbf_motion_size(at_set->half_extents[a], at_set->half_extents_rate[a], time);
  now->radius = pbf_motion_size(at_set->radius, at_set->radius_rate, time);
  now->half_length = pbf_motion_size(at_set->half_length, at_set->half_length_rate, time);
  now->scale = pbf_motion_size(at_set->scale, at_set->scale_rate, time);
  if (!pbf_motion_turns(at_set)) return;
  const double rate = pbf_motion_length(w);
  double s = pbf_sin(0.5 * rate * time) / rate;
  double turn[4] = {s * w[0], s * w[1], s * w[2], pbf_cos(0.5 * rate * time)};
  pbf_motion_quaternion_product(turn, at_set->orientation, now->orientation);
}

/* The same with how it goes on from there. */
static inline void pbf_motion_collider_state(const pbf_collider *at_set, double elapsed,
                                             pbf_collider *now) {
  pbf_motion_collider(at_set, elapsed, now);
  if (pbf_motion_has_ended(at_set, elapsed)) {
    for (int a = 0; a < 3; ++a)
      now->velocity[a] = now->angular_velocity[a] = now->half_extents_rate[a] = 0;
    now->radius_rate = now->half_length_rate = now->scale_rate = now->duration = 0;
    return;
  }
  if (at_set->duration > 0) now->duration = at_set->duration - elapsed;
  if (at_set->path != PBF_PATH_SCREW || !pbf_motion_turns(at_set)) return;
  const double rate = pbf_motion_length(at_set->angular_velocity);
  double axis[3];
  for (int a = 0; a < 3; ++a) axis[a] = at_set->angular_velocity[a] / rate;
  pbf_motion_turned(at_set->velocity, axis, rate * elapsed, now->velocity);
}

/* The velocities with which it has come to where it is `elapsed` after it was set, at a position:
 * of a motion that has ended in this last step, those that it had until then. */
static inline void pbf_motion_last_velocities(const pbf_collider *at_set, double elapsed,
                                              double time_step, const double position[3],
                                              double velocity[3], double angular_velocity[3]) {
  pbf_collider goes_on = *at_set, now;
  const double *w = now.angular_velocity;
  if (!(elapsed > 0)) {
    memcpy(velocity, at_set->last_velocity, sizeof at_set->last_velocity);
    memcpy(angular_velocity, at_set->last_angular_velocity, sizeof at_set->last_angular_velocity);
    return;
  }
  if (elapsed - 0.5 * time_step < at_set->duration) goes_on.duration = 0;
  pbf_motion_collider_state(&goes_on, elapsed, &now);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    velocity[a] = now.velocity[a] + w[b] * (position[c] - now.position[c]) -
                  w[c] * (position[b] - now.position[b]);
    angular_velocity[a] = w[a];
  }
}

/* What it moves more in a step that ends then than in the one before, by its velocity and by its
 * rate of turning: 0, to the bit, for one that goes on evenly. Where it was set anew, that comes
 * from what it had before. */
static inline void pbf_motion_gain(const pbf_collider *at_set, double elapsed, double time_step,
                                   double way[3], double turn[3]) {
  const double starts = fmax(elapsed - time_step, 0), began = fmax(starts - time_step, 0);
  const double moved = pbf_motion_time(at_set, elapsed), before = pbf_motion_time(at_set, starts);
  const double *v = at_set->velocity, *w = at_set->angular_velocity;
  for (int a = 0; a < 3; ++a) way[a] = turn[a] = 0;
  if (!(time_step > 0 && elapsed > 0)) return;
  /* Steps before may have been shorter: what counts is the part of one that it moves. */
  const int is_first = starts < 1e-4 * time_step;
  double part = (moved - before) / time_step - 1;
  if (!is_first) part += 1 - (before - pbf_motion_time(at_set, began)) / (starts - began);
  const double more = fabs(part) > 1e-6 ? part * time_step : 0;
  for (int a = 0; a < 3; ++a) {
    way[a] = more * v[a];
    turn[a] = more * w[a];
  }
  if (!is_first) return;
  const double rounding =
      1e-12 * (pbf_motion_length(v) + pbf_motion_length(w) * pbf_motion_length(at_set->position));
  for (int a = 0; a < 3; ++a) {
    const double faster = v[a] - at_set->last_velocity[a];
    if (fabs(faster) > rounding) way[a] += time_step * faster;
    turn[a] += time_step * (w[a] - at_set->last_angular_velocity[a]);
  }
}

/* Lets *from, a collider as it stands, come to a target in a time, and stop there. */
static inline void pbf_motion_towards(pbf_collider *from, const pbf_collider *target,
                                      double duration) {
  double way[3], norm = 0;
  for (int k = 0; k < 4; ++k) norm += from->orientation[k] * from->orientation[k];
  for (int k = 0; k < 4; ++k) from->orientation[k] /= sqrt(norm);
  for (int a = 0; a < 3; ++a) way[a] = target->position[a] - from->position[a];
  pbf_motion_turn_rate(from->orientation, target->orientation, duration, from->angular_velocity);
  pbf_motion_screw_velocity(way, from->angular_velocity, duration, from->velocity);
  for (int a = 0; a < 3; ++a)
    from->half_extents_rate[a] = (target->half_extents[a] - from->half_extents[a]) / duration;
  from->radius_rate = (target->radius - from->radius) / duration;
  from->half_length_rate = (target->half_length - from->half_length) / duration;
  from->scale_rate = (target->scale - from->scale) / duration;
  from->path = PBF_PATH_SCREW;
  from->duration = duration;
}

#endif
