/* The smoothing kernels and their gradients, of a pair at the distance r = |x_i - x_j|. Beyond
 * r = h every term is exactly 0, without a test. */
#ifndef PBF_PHYSICS_KERNELS_H
#define PBF_PHYSICS_KERNELS_H

#include "physics/constants.h"
#include "physics/lane_vector.h"

namespace {

/* V W of a pair, and the slope that times x_i - x_j is V grad W. */
template <class L>
struct pair_kernel {
  L value, slope;
};

/* Where a kernel's scales come in: in each pair, or once in the sums, which is faster and rounds
 * otherwise. */
enum scaling { SCALED_PAIRS, SCALED_SUMS };

/* 1 - r/h, or 0 beyond h. */
template <class L>
PBF_FN L closeness(const pbf_constants *c, L r) {
  return ramp(r, ops<L>::set(-c->inv_h));
}

/* poly6: u³, u = 1 - r²/h². */
template <class L>
PBF_FN L poly6(const pbf_constants *c, L scale, L r2) {
  L u = ramp(r2, ops<L>::set(-c->inv_h2));
  return scale * u * (u * u);
}

/* Wendland C2: (1 - q)⁴ (4 q + 1) with u = 1 - q is u⁴ (5 - 4 u). */
template <class L>
PBF_FN L wendland(L scale, L u) {
  L u2 = u * u;
  return scale * (u2 * u2) * ops<L>::multiply_add(ops<L>::set(-4), u, ops<L>::set(5));
}

/* V W_ij alone, for passes that need no gradient. */
template <class L>
PBF_FN L kernel_value(int features, const pbf_constants *c, L r2) {
  L scale = ops<L>::set(c->value_scale);
  if (features & PBF_FEATURE_POLY6) return poly6(c, scale, r2);
  return wendland(scale, closeness(c, ops<L>::sqrt(r2)));
}

/* The kernel for given scales, and the slope that times x_i - x_j is V grad_i W_ij. Coincident
 * particles have no direction: there x_i - x_j is 0 and the slope finite. */
template <class L>
PBF_FN void kernel_and_slope(int features, const pbf_constants *c, pbf_real value_scale,
                             pbf_real slope_scale, L r2, L *value, L *slope) {
  L safe2 = ops<L>::max(r2, ops<L>::set(c->tiny2));
  L u = closeness(c, ops<L>::root(safe2));
  if (features & PBF_FEATURE_POLY6) {
    *value = poly6(c, ops<L>::set(value_scale), r2);
    *slope = ops<L>::over_root(ops<L>::set(slope_scale) * (u * u), safe2);
  } else {
    *value = wendland(ops<L>::set(value_scale), u);
    *slope = ops<L>::set(slope_scale) * (u * u * u);
  }
}

/* V W_ij, and the slope, with their own scales. */
template <class L>
PBF_FN void kernel_and_slope(int features, const pbf_constants *c, L r2, L *value, L *slope) {
  kernel_and_slope(features, c, c->value_scale, pbf_slope_scale(features, c), r2, value, slope);
}

template <class L>
PBF_FN L kernel_slope(int features, const pbf_constants *c, L r2) {
  L value, slope;
  kernel_and_slope(features, c, r2, &value, &slope);
  return slope;
}

/* Eq. 13: -k (W(r)/W(dq))^n, from value = V W_ij. */
template <class L>
PBF_FN L artificial_pressure(const pbf_constants *c, L value) {
  L ratio = value * ops<L>::set(c->scorr_inv_w);
  if (c->scorr_n == 4) {
    L square = ratio * ratio;
    return ops<L>::set(-c->scorr_k) * (square * square);
  }
  L power = ops<L>::set(-c->scorr_k);
  for (int n = 0; n < c->scorr_n; ++n) power = power * ratio;
  return power;
}

}  // namespace

#endif
