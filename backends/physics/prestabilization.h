/* Measures of pre-stabilization: how wrong the densities of placed particles are, and what can make
 * them wrong. lib/solver/prestabilize.c asks for them and has the backend project. Host only,
 * float64; C17 and C++17. */
#ifndef PBF_PHYSICS_PRESTABILIZATION_H
#define PBF_PHYSICS_PRESTABILIZATION_H

#include <math.h>

#include "physics/motion.h"

/* The density error of all particles as one number. Their mean hides a few particles that were
 * placed where others are: the max counts, too, as the error of one particle in 25. Flows have
 * larger errors than that only where they collide. */
static inline double pbf_density_error(const pbf_stats *stats) {
  const double particles_a_max = 25;
  return fmax(stats->density_error_mean, stats->density_error_max / particles_a_max);
}

/* Whether `placed` of `count` particles can raise the mean error to params->prestabilization: a
 * particle that is placed where others are has an error of 1 there and adds as much to theirs. */
static inline int pbf_placed_can_matter(const pbf_params *params, uint32_t placed, uint32_t count) {
  return 2.0 * placed >= fmin(params->prestabilization, 1) * count;
}

/* Whether the density at a place can differ between two sets of parameters. */
static inline int pbf_densities_change(const pbf_params *before, const pbf_params *after) {
  return before->kernel != after->kernel || before->smoothing_radius != after->smoothing_radius ||
         before->spacing != after->spacing || before->particle_volume != after->particle_volume ||
         before->wall_density != after->wall_density;
}

/* Whether a wall jumps into the domain: farther than a moving wall goes in a step. */
static inline int pbf_walls_jump(const pbf_params *before, const pbf_params *after,
                                 uint32_t dimension, double time) {
  double max_advance = 0;
  for (int wall = 0; wall < 2 * (int)dimension; ++wall) {
    double advance = pbf_motion_wall(after, wall, time) - pbf_motion_wall(before, wall, time);
    max_advance = fmax(max_advance, wall % 2 ? -advance : advance);
  }
  return max_advance > 0.5 * after->smoothing_radius;
}

#endif
