/* The end of a step's solve: its pressure takes over a part of that of the step before.
 *
 * What an iteration leaves of an error with its sign reversed comes back reversed from step to
 * step, since particles go on as they were pushed, and from a third on for ever. With a part b of
 * the last pressure in each, that takes (1 + 7 b) / (3 - 3 b). Pressure that does not change stays
 * what it is, and so does what carries weight. */
#ifndef PBF_PHYSICS_PASSES_SMOOTH_PRESSURE_H
#define PBF_PHYSICS_PASSES_SMOOTH_PRESSURE_H

#include "physics/constants.h"

/* From the lambda of a step, over its length squared, so that it stays what it is where the next
 * one has another length. What pulls has none. */
PBF_FN pbf_real pbf_pressure_to_keep(const pbf_constants *c, pbf_real lambda) {
  return c->smoothing > 0 ? pbf_real_max(-lambda, 0) * c->inv_time_step2 : 0;
}

/* Once an iteration has added *change to *total; `last_pressure` is that of the step before, or 0
 * before the last iteration. What has grown to more than three times that counts as three times,
 * and what has fallen to less than a third as a third: where nothing pressed before, an impact is
 * met in full, and nothing is pushed on that has come free. */
PBF_FN void pbf_smooth_pressure(const pbf_constants *c, pbf_real last_pressure, pbf_real *total,
                                pbf_real *change) {
  const pbf_real before = last_pressure * c->time_step2, now = pbf_real_max(-*total, 0);
  const pbf_real difference = pbf_real_min(pbf_real_max(before - now, -2 * before), 2 * now);
  const pbf_real add = -c->smoothing * difference;
  *total += add;
  *change += add;
}

#endif
