/* A domain, or a container in it, with less room than its fluid takes at rest: no place of the
 * particles has rest density, and a solve that goes on as if there were one shakes them, each step
 * by half a spacing. */
#ifndef PBF_PHYSICS_OVERFULL_H
#define PBF_PHYSICS_OVERFULL_H

#include "physics/constants.h"
#include "physics/containers.h"
#include "physics/motion.h"
#include "physics/schedule.h"

/* Room between the walls, or `least_room`, that of the smallest container: too little by more than
 * a rounding and the gaps of a lattice. */
static inline int pbf_is_overfull(const pbf_params *params, uint32_t count, double least_room,
                                  double time) {
  const double tolerance = 1.001, spacing = pbf_derive_spacing(params);
  double between = 1, volume = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    double lower = pbf_motion_wall(params, 2 * k, time);
    between *= fmax(pbf_motion_wall(params, 2 * k + 1, time) - lower, 0);
    volume *= spacing;
  }
  if (params->particle_volume > 0) volume = params->particle_volume;
  return count * volume > tolerance * fmin(between, least_room);
}

/* What of pbf_constants.most_change serves in the step that ends at `time`: where there is a
 * solution the iterations find it sooner with all of it. In an overfull domain no more than
 * 1 / stiffness: from 1.5 on some boil, at 3 every other one. And colliders may hold water that is
 * too deep for the iterations, of which no grid over the domain can relieve them: between four
 * boxes in a wide domain 60 layers gained energy with 3, trembled with 1.9, and settle with 1.7. */
static inline pbf_real pbf_part_of_change(const pbf_params *params, uint32_t count,
                                          const pbf_schedule *has, double time) {
  double all = pbf_most_change_of(params), most = all;
  if (has->colliders) most = fmin(most, 1.6);
  if (pbf_is_overfull(params, count, has->least_room, time)) most = fmin(most, 1);
  return (pbf_real)(most / all);
}

/* How many of these steps, of which the first ends at `time`, are like it in this. */
static inline uint32_t pbf_steps_alike(const pbf_params *params, uint32_t count, double least_room,
                                       double time, uint32_t steps) {
  int is_overfull = pbf_is_overfull(params, count, least_room, time);
  uint32_t k = 1;
  while (k < steps &&
         pbf_is_overfull(params, count, least_room, time + k * params->time_step) == is_overfull)
    ++k;
  return k;
}

#endif
