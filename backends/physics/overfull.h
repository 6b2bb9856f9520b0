/* A domain, or a container in it, with less room than its fluid takes at rest. No place of the
 * particles has rest density then, and a solve that goes on as if there were one shakes them, or
 * holds them between large pressures: it is to find the density that there is room for. */
#ifndef PBF_PHYSICS_OVERFULL_H
#define PBF_PHYSICS_OVERFULL_H

#include "physics/constants.h"
#include "physics/fullness.h"
#include "physics/schedule.h"

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
