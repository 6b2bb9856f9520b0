/* How long a step may be. Host only, float64; C17 and C++17: lib/ asks. */
#ifndef PBF_PHYSICS_STEP_LIMIT_H
#define PBF_PHYSICS_STEP_LIMIT_H

#include <math.h>

#include "physics/elementary.h"
#include "physics/motion.h"
#include "physics/spacing.h"

#define PBF_LIMIT_PI 3.14159265358979323846

/* The most of g dt² / d, twice the way of a fall in a step: still water of millimetres stood to
 * within 4 % at 0.55, and lay down at 1.4. Iterations carry pressure a layer each, so more of it
 * leaves more of a layer's weight to every one above (depth.h). */
static inline double pbf_limit_of_acceleration(double spacing, double acceleration) {
  const double most = 0.5;
  return acceleration > 0 ? sqrt(most * spacing / acceleration) : INFINITY;
}

/* The most of v dt / d, the way of what moves in a step, as of Courant, Friedrichs and Lewy (1928):
 * before a piston at 1 a step fluid was squeezed by 8 %, at 1.5 by 19 %, at 3 by 73 %. What hits a
 * wall is to it what a wall is that hits fluid. */
static inline double pbf_limit_of_speed(double spacing, double speed) {
  const double most = 1;
  return speed > 0 ? most * spacing / speed : INFINITY;
}

/* The acceleration by an attraction where it presses `count` particles: at the surface of the ball
 * that they gather to, or of the part of one at the walls next to its centre; of a repulsion in the
 * farthest corner. */
static inline double pbf_attraction_acceleration(const pbf_params *params, uint32_t dimension,
                                                 uint32_t count, double time) {
  double near2 = 0, far2 = 0, inside = INFINITY, spacing = pbf_derive_spacing(params);
  for (uint32_t k = 0; k < dimension; ++k) {
    double center = params->attraction_center[k];
    double above = center - pbf_motion_wall(params, (int)(2 * k), time);
    double below = pbf_motion_wall(params, (int)(2 * k + 1), time) - center;
    double out = fmax(0, fmax(-above, -below)), far = fmax(fabs(above), fabs(below));
    near2 += out * out;
    far2 += far * far;
    inside = fmin(inside, fmin(above, below));
  }
  double ball = pbf_side_of((dimension == 3 ? 0.75 : 1) * count / PBF_LIMIT_PI, (int)dimension);
  double reach = sqrt(near2) + (inside < ball * spacing ? 2 : 1) * ball * spacing;
  return fabs(params->attraction) * (params->attraction > 0 ? fmin(reach, sqrt(far2)) : sqrt(far2));
}

static inline double pbf_fastest_wall(const pbf_params *params, uint32_t dimension) {
  double most = 0;
  for (uint32_t wall = 0; wall < 2 * dimension; ++wall)
    most = fmax(most, fabs(params->wall_velocity[wall]) +
                          fabs(params->wall_amplitude[wall] * params->wall_frequency[wall]));
  return most;
}

static inline void pbf_cross(const double a[3], const double b[3], double product[3]) {
  for (int k = 0; k < 3; ++k)
    product[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* By a unit quaternion, or back. */
static inline void pbf_turned(const double q[4], int back, const double v[3], double to[3]) {
  const double axis[3] = {back ? -q[0] : q[0], back ? -q[1] : q[1], back ? -q[2] : q[2]};
  double across[3], again[3];
  pbf_cross(axis, v, across);
  pbf_cross(axis, across, again);
  for (int k = 0; k < 3; ++k) to[k] = v[k] + 2 * (q[3] * across[k] + again[k]);
}

/* Of the corner of a box that its turn moves fastest. */
static inline double pbf_fastest_corner(const pbf_collider *c, const double rate[3],
                                        uint32_t dimension) {
  double most = 0;
  for (int corner = 0; corner < 4; ++corner) { /* the other four go as their opposites */
    const double at[3] = {c->half_extents[0], c->half_extents[1] * (corner & 1 ? -1 : 1),
                          dimension == 3 ? c->half_extents[2] * (corner & 2 ? -1 : 1) : 0};
    double speed[3];
    pbf_cross(rate, at, speed);
    most = fmax(most, pbf_motion_length(speed));
  }
  return most;
}

/* How fast a collider's surface moves as it turns: not at all what is round, a plane up to where
 * the domain ends. About a fixed axis its parts keep their speed. */
static inline double pbf_turning_speed(const pbf_collider *c, const pbf_params *params,
                                       uint32_t dimension) {
  double length = pbf_motion_length(c->axis), rate[3], speed[3], far[3] = {0, 0, 0};
  pbf_turned(c->orientation, 1, c->angular_velocity, rate);
  pbf_cross(rate, c->axis, speed);
  for (uint32_t k = 0; k < dimension; ++k)
    far[k] = fmax(fabs(params->domain_min[k] - c->position[k]),
                  fabs(params->domain_max[k] - c->position[k]));
  if (c->shape == PBF_COLLIDER_BOX) return pbf_fastest_corner(c, rate, dimension);
  if (c->shape == PBF_COLLIDER_SHAPE)
    return pbf_motion_length(rate) * c->scale * c->geometry->bound;
  if (c->shape == PBF_COLLIDER_CAPSULE) return pbf_motion_length(speed) / length * c->half_length;
  if (c->shape == PBF_COLLIDER_PLANE)
    return pbf_motion_length(speed) / length * pbf_motion_length(far);
  return 0;
}

/* How fast it grows or shrinks, at most. */
static inline double pbf_growing_speed(const pbf_collider *c) {
  if (c->shape == PBF_COLLIDER_BOX) return pbf_motion_length(c->half_extents_rate);
  if (c->shape == PBF_COLLIDER_PLANE) return 0;
  if (c->shape == PBF_COLLIDER_SHAPE) return fabs(c->scale_rate) * c->geometry->bound;
  return fabs(c->radius_rate) + (c->shape == PBF_COLLIDER_CAPSULE ? fabs(c->half_length_rate) : 0);
}

/* As they are now. In 2D the components that it has not are 0. */
static inline double pbf_fastest_collider(const pbf_params *params, uint32_t dimension,
                                          uint32_t count, const pbf_collider *colliders) {
  double most = 0;
  for (uint32_t k = 0; k < count; ++k)
    most = fmax(most, pbf_motion_length(colliders[k].velocity) + pbf_growing_speed(&colliders[k]) +
                          pbf_turning_speed(&colliders[k], params, dimension));
  return most;
}

#endif
