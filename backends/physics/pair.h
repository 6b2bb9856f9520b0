/* Pair terms: pure functions of two particles, i and j, at the distance r = |x_i - x_j|.
 *
 * A term is the same for one pair and for sixteen at once: this file is included once per lane
 * type, with
 *   PBF_LANE        pbf_real, or a vector of them with operators
 *   PBF_LANE_(op)   the name of lane operation sqrt(a), rsqrt(a), max(a, b), set(real),
 *                   fma(a, b, c) = a b + c or ramp(a, b) = max(a b + 1, 0), where a b <= 0
 *   PBF_PAIR(term)  the name that a term gets
 * and undefines them at its end. Beyond r = h every term is exactly 0, without a test.
 */
#include "physics/constants.h"
#include "physics/mirrors.h"

/* 1 - r/h, or 0 beyond h. */
PBF_FN PBF_LANE PBF_PAIR(closeness)(const pbf_constants *c, PBF_LANE r) {
  return PBF_LANE_(ramp)(r, PBF_LANE_(set)(-c->inv_h));
}

/* poly6: u³, u = 1 - r²/h². */
PBF_FN PBF_LANE PBF_PAIR(poly6)(const pbf_constants *c, PBF_LANE scale, PBF_LANE r2) {
  PBF_LANE u = PBF_LANE_(ramp)(r2, PBF_LANE_(set)(-c->inv_h2));
  return scale * u * (u * u);
}

/* Wendland C2: (1 - q)⁴ (4 q + 1) with u = 1 - q is u⁴ (5 - 4 u). */
PBF_FN PBF_LANE PBF_PAIR(wendland)(PBF_LANE scale, PBF_LANE u) {
  PBF_LANE u2 = u * u;
  return scale * (u2 * u2) * PBF_LANE_(fma)(PBF_LANE_(set)(-4), u, PBF_LANE_(set)(5));
}

/* V W_ij alone, for the stages that need no gradient. */
PBF_FN PBF_LANE PBF_PAIR(density)(int features, const pbf_constants *c, PBF_LANE r2) {
  PBF_LANE scale = PBF_LANE_(set)(c->value_scale);
  if (features & PBF_FEATURE_POLY6) return PBF_PAIR(poly6)(c, scale, r2);
  return PBF_PAIR(wendland)(scale, PBF_PAIR(closeness)(c, PBF_LANE_(sqrt)(r2)));
}

/* The kernel for given scales: with those of 1, sums can be scaled as a whole instead of pair by
 * pair. Coincident particles have no direction: there x_i - x_j is 0 and the slope finite. */
PBF_FN void PBF_PAIR(scaled)(int features, const pbf_constants *c, PBF_LANE value_scale,
                             PBF_LANE slope_scale, PBF_LANE r2, PBF_LANE *value, PBF_LANE *slope) {
  PBF_LANE safe2 = PBF_LANE_(max)(r2, PBF_LANE_(set)(c->tiny2));
  PBF_LANE inv_r = PBF_LANE_(rsqrt)(safe2);
  PBF_LANE u = PBF_PAIR(closeness)(c, safe2 * inv_r);
  if (features & PBF_FEATURE_POLY6) {
    *value = PBF_PAIR(poly6)(c, value_scale, r2);
    *slope = slope_scale * (u * u) * inv_r;
  } else {
    *value = PBF_PAIR(wendland)(value_scale, u);
    *slope = slope_scale * (u * u * u);
  }
}

/* *value = V W_ij, and *slope such that V grad_i W_ij = *slope (x_i - x_j). */
PBF_FN void PBF_PAIR(kernel)(int features, const pbf_constants *c, PBF_LANE r2, PBF_LANE *value,
                             PBF_LANE *slope) {
  PBF_LANE value_scale = PBF_LANE_(set)(c->value_scale);
  PBF_LANE slope_scale = PBF_LANE_(set)(pbf_slope_scale(features, c));
  PBF_PAIR(scaled)(features, c, value_scale, slope_scale, r2, value, slope);
}

/* Artificial pressure, eq. 13: -k (W(r)/W(dq))^n, from value = V W_ij. */
PBF_FN PBF_LANE PBF_PAIR(scorr)(const pbf_constants *c, PBF_LANE value) {
  PBF_LANE ratio = value * PBF_LANE_(set)(c->scorr_inv_w);
  if (c->scorr_n == 4) {
    PBF_LANE square = ratio * ratio;
    return PBF_LANE_(set)(-c->scorr_k) * (square * square);
  }
  PBF_LANE power = PBF_LANE_(set)(-c->scorr_k);
  for (int n = 0; n < c->scorr_n; ++n) power = power * ratio;
  return power;
}

#undef PBF_LANE
#undef PBF_LANE_
#undef PBF_PAIR
