/* Measures of pre-stabilization: how wrong the densities of placed particles are, and what can make
 * them wrong. lib/solver/prestabilize.c asks for them and has the backend project. Host only,
 * float64; C17 and C++17. */
#ifndef PBF_PHYSICS_PRESTABILIZATION_H
#define PBF_PHYSICS_PRESTABILIZATION_H

#include <math.h>

#include <pbf/pbf.h>

/* The density error of all particles as one number. Their mean hides a few particles that were
 * placed where others are, or too near to a solid that was left out of a lattice: the max counts,
 * too, as the error of one particle in five. A max of 0.5 that was left around a ball in a pool
 * threw particles at 5 m/s in steps of 0.06 sqrt(d / g), one of 0.1 at 0.8 m/s. */
static inline double pbf_density_error(const pbf_stats *stats) {
  const double particles_a_max = 5;
  return fmax(stats->density_error_mean, stats->density_error_max / particles_a_max);
}

/* Whether the density at a place can differ between two sets of parameters. */
static inline int pbf_densities_change(const pbf_params *before, const pbf_params *after) {
  return before->kernel != after->kernel || before->smoothing_radius != after->smoothing_radius ||
         before->spacing != after->spacing || before->particle_volume != after->particle_volume ||
         before->wall_density != after->wall_density;
}

#endif
