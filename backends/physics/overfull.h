/* A domain, or a container in it, with less room than its fluid takes at rest. No place of the
 * particles has rest density then, and a solve that goes on as if there were one shakes them, or
 * holds them between large pressures: it is to find the density that there is room for. */
#ifndef PBF_PHYSICS_OVERFULL_H
#define PBF_PHYSICS_OVERFULL_H

#include "physics/constants.h"
#include "physics/containers.h"
#include "physics/motion.h"
#include "physics/schedule.h"

/* Density, over that at rest, with which the fluid fills all room between the walls, or
 * `min_volume`, that of the smallest container; 1 where there is more. 1.5 % more: no disordered
 * fluid is as even as a lattice, and the mean density of a stirred one is 1.1 to 1.4 % above that
 * of the room. In full tanks, where that pressed all against all, flow was lost to it in no time,
 * or gained a hundred times its energy; with 0.5 % eddies in short steps still stopped. */
static inline double pbf_density_in_volume(const pbf_params *params, uint32_t count,
                                           double min_volume, double time) {
  const double unevenness = 0.015;
  double between = 1, volume = 1, spacing = pbf_derive_spacing(params);
  for (int k = 0; k < PBF_DIM; ++k) {
    double beyond = pbf_is_periodic(params, k) ? 0 : pbf_reach_beyond_walls(params);
    double lower = pbf_motion_wall(params, 2 * k, time) - beyond;
    double upper = pbf_motion_wall(params, 2 * k + 1, time) + beyond;
    between *= fmax(upper - lower, 0);
    volume *= spacing;
  }
  if (params->particle_volume > 0) volume = params->particle_volume;
  double density = (1 + unevenness) * count * volume / fmin(between, min_volume);
  return fmin(fmax(density, 1), 1e6);
}

/* Pairs carry all weight there. Under a pressure grid, or where shear stress is corrected, water at
 * rest is as calm with the last pressure as without. */
static inline bool pbf_smooths_pressure(const pbf_constants *usual, const pbf_schedule *has) {
  const bool corrects_shear = has->corrects_shear && usual->shear_stress_part > 0;
  return !has->runs[PBF_STAGE_GRID] && !corrects_shear;
}

/* What serves in the step that ends at `time`, of the constants `usual`. In colliders water may be
 * too deep for the iterations, of which no grid over the domain can relieve them: between four
 * boxes in a wide domain 60 layers gained energy with 3 / stiffness an iteration, trembled with
 * 1.9, and settle with 1.7. And disordered water around them has larger eigenvalues than its
 * lattice, beyond the room for disorder: where a ball had been lowered into it, 4 iterations kept
 * it moving for ever, by 0.12 sqrt(g d), and do not below 0.95 of the step size. */
static inline void pbf_set_constants_of_step(pbf_constants *c, const pbf_constants *usual,
                                             const pbf_params *params, uint32_t count,
                                             const pbf_schedule *has, double time) {
  double all = pbf_max_change_of(params), max_change = all, target = 1;
  if (has->colliders) {
    max_change = fmin(max_change, 1.6);
    c->step_size = (pbf_real)0.9 * usual->step_size;
  }
  if (usual->accelerated) target = pbf_density_in_volume(params, count, has->min_volume, time);
  c->smoothing = pbf_smooths_pressure(usual, has) ? usual->smoothing : 0;
  c->max_change = usual->max_change * (pbf_real)(max_change / all);
  c->target = (pbf_real)target;
  c->tension_min_density = usual->tension_min_density + (pbf_real)(target - 1);
}

/* How many of these steps are like the first in this. */
static inline uint32_t pbf_steps_alike(const pbf_params *params, uint32_t count, double min_volume,
                                       const pbf_step_times *times, uint32_t steps) {
  double target = pbf_density_in_volume(params, count, min_volume, pbf_time_after(times, 1));
  uint32_t k = 1;
  while (k < steps &&
         pbf_density_in_volume(params, count, min_volume, pbf_time_after(times, k + 1)) == target)
    ++k;
  return k;
}

#endif
