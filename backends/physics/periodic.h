/* Axes along which the domain is periodic: its two faces are one. Positions are those inside it,
 * and a pair is as far apart as the nearest of their images. The domain is at least
 * four h wide (lib/params.c): no two images of a pair are within h, and three cells fit. */
#ifndef PBF_PHYSICS_PERIODIC_H
#define PBF_PHYSICS_PERIODIC_H

#include <stdint.h>

#include <pbf/pbf.h>

#include "physics/real.h"

static inline int pbf_is_periodic(const pbf_params *params, int axis) {
  return (params->periodic >> axis & 1) != 0;
}

/* Along an axis; 0 between walls. */
static inline pbf_real pbf_period_of(const pbf_params *params, int axis) {
  if (!pbf_is_periodic(params, axis)) return 0;
  return (pbf_real)(params->domain_max[axis] - params->domain_min[axis]);
}

/* A difference of two positions along an axis, to the nearest image. */
PBF_FN pbf_real pbf_nearest_image(pbf_real period, pbf_real difference) {
  const pbf_real half = (pbf_real)0.5 * period;
  if (difference > half) return difference - period;
  return difference < -half ? difference + period : difference;
}

PBF_FN pbf_vec pbf_nearest_image(pbf_vec period, pbf_vec difference) {
  for (int k = 0; k < PBF_DIM; ++k)
    if (period.c[k] > 0) difference.c[k] = pbf_nearest_image(period.c[k], difference.c[k]);
  return difference;
}

/* Where the faces of periodic axes are; lengths are 0 between walls. */
typedef struct pbf_periods {
  int any;
  pbf_vec lower, upper, length;
} pbf_periods;

static inline pbf_periods pbf_periods_of(const pbf_params *params) {
  pbf_periods of;
  of.any = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    of.lower.c[k] = (pbf_real)params->domain_min[k];
    of.upper.c[k] = (pbf_real)params->domain_max[k];
    of.length.c[k] = pbf_period_of(params, k);
    of.any = of.any || pbf_is_periodic(params, k);
  }
  return of;
}

/* The image of x inside the domain. What is no number, or too far away to say, comes to a face. */
PBF_FN pbf_vec pbf_image_inside(const pbf_periods *of, pbf_vec x) {
  const pbf_real most = 1e6;
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real lower = of->lower.c[k], upper = of->upper.c[k], length = of->length.c[k];
    if (!(length > 0) || (x.c[k] >= lower && x.c[k] <= upper)) continue;
    const pbf_real turns = pbf_real_max(pbf_real_min((x.c[k] - lower) / length, most), -most);
    pbf_real whole = (pbf_real)(int32_t)turns;
    if (whole > turns) whole -= 1;
    x.c[k] = pbf_real_max(pbf_real_min(x.c[k] - whole * length, upper), lower);
  }
  return x;
}

#endif
