/* What a pass over pairs is: a struct of a few functions, written once, that each backend's own
 * loop over neighbours calls (reference/driver.h, cpu/driver.h, cuda/driver.h). A lane type L is
 * pbf_real or a vector of them. A pass P has
 *
 *   NUMBER, VECTOR             what it looks up of a neighbour beside its place
 *   template own<L>            what it knows of its particle
 *   template sums<L>           what it sums up
 *   begin<L>()                 sums of no neighbour
 *   pair(sums, own, j, w = {}) adds a neighbour, or with a weight w the image of one
 *   end(sums)                  once all are added
 *   finish(…)                  what the particle makes of them; its arguments are the pass's own
 *
 * Features are an int, or fixed<…> where a loop is built for them. */
#ifndef PBF_PHYSICS_PASSES_PASS_H
#define PBF_PHYSICS_PASSES_PASS_H

#include "physics/scalar.h"

/* Internal linkage: units built for other instruction sets have others of the same names. */
namespace {

template <int F>
struct fixed {
  PBF_IN constexpr operator int() const { return F; }
};

/* Operations on lanes. This one: a lane is one real. */
template <class L>
struct ops;

template <>
struct ops<pbf_real> {
  static PBF_IN pbf_real set(pbf_real a) { return a; }
  static PBF_IN pbf_real max(pbf_real a, pbf_real b) { return pbf_scalar_max(a, b); }
  static PBF_IN pbf_real ramp(pbf_real a, pbf_real b) { return pbf_scalar_ramp(a, b); }
  static PBF_IN pbf_real fma(pbf_real a, pbf_real b, pbf_real c) { return pbf_scalar_fma(a, b, c); }
  static PBF_IN pbf_real sqrt(pbf_real a) { return pbf_scalar_sqrt(a); }
  static PBF_IN pbf_real rsqrt(pbf_real a) { return pbf_scalar_rsqrt(a); }
};

/* A vector of lanes. */
template <class L>
struct lane_vector {
  L c[PBF_DIM];

  static PBF_IN lane_vector zero() {
    lane_vector a;
    for (int k = 0; k < PBF_DIM; ++k) a.c[k] = ops<L>::set(0);
    return a;
  }
  PBF_IN void add_scaled(L s, const lane_vector &b) {
    for (int k = 0; k < PBF_DIM; ++k) c[k] = ops<L>::fma(s, b.c[k], c[k]);
  }
  PBF_IN void scale(L s) {
    for (int k = 0; k < PBF_DIM; ++k) c[k] = c[k] * s;
  }
};

template <class L>
PBF_FN lane_vector<L> operator-(const lane_vector<L> &a, const lane_vector<L> &b) {
  lane_vector<L> difference;
  for (int k = 0; k < PBF_DIM; ++k) difference.c[k] = a.c[k] - b.c[k];
  return difference;
}

PBF_FN pbf_vec vec_of(const lane_vector<pbf_real> &a) {
  pbf_vec b;
  for (int k = 0; k < PBF_DIM; ++k) b.c[k] = a.c[k];
  return b;
}

PBF_FN lane_vector<pbf_real> lanes_of(pbf_vec a) {
  lane_vector<pbf_real> b;
  for (int k = 0; k < PBF_DIM; ++k) b.c[k] = a.c[k];
  return b;
}

PBF_FN pbf_curl curl_of(const pbf_real a[PBF_CURL_DIM]) {
  pbf_curl b;
  for (int k = 0; k < PBF_CURL_DIM; ++k) b.c[k] = a[k];
  return b;
}

/* sum += factor a x b, of which there is one component in two dimensions. */
template <class L>
PBF_FN void add_cross(L sum[PBF_CURL_DIM], L factor, const lane_vector<L> &a,
                      const lane_vector<L> &b) {
  if constexpr (PBF_DIM == 3) {
    sum[0] = sum[0] + factor * (a.c[1] * b.c[2] - a.c[2] * b.c[1]);
    sum[1] = sum[1] + factor * (a.c[2] * b.c[0] - a.c[0] * b.c[2]);
    sum[2] = sum[2] + factor * (a.c[0] * b.c[1] - a.c[1] * b.c[0]);
  } else {
    sum[0] = sum[0] + factor * (a.c[0] * b.c[1] - a.c[1] * b.c[0]);
  }
}

/* A neighbour: where it is, and what the pass looks up. */
template <class L>
struct neighbor_of {
  lane_vector<L> x_ij;
  L r2, number;
  lane_vector<L> v;
};

/* The weight of what counts in full. */
struct unweighted {};
template <class L>
PBF_FN L operator*(unweighted, L a) {
  return a;
}

/* V W of a pair, and the slope that times x_i - x_j is V grad W. */
template <class L>
struct pair_kernel {
  L value, slope;
};

/* Where a kernel's scales come in: in each pair, or once in the sums, which is faster and rounds
 * otherwise. */
enum scaling { SCALED_PAIRS, SCALED_SUMS };

/* The terms of pair.h. */
template <class L>
PBF_FN L closeness(const pbf_constants *c, L r) {
  return ops<L>::ramp(r, ops<L>::set(-c->inv_h));
}

template <class L>
PBF_FN L poly6(const pbf_constants *c, L scale, L r2) {
  L u = ops<L>::ramp(r2, ops<L>::set(-c->inv_h2));
  return scale * u * (u * u);
}

template <class L>
PBF_FN L wendland(L scale, L u) {
  L u2 = u * u;
  return scale * (u2 * u2) * ops<L>::fma(ops<L>::set(-4), u, ops<L>::set(5));
}

template <class L>
PBF_FN L kernel_value(int features, const pbf_constants *c, L r2) {
  L scale = ops<L>::set(c->value_scale);
  if (features & PBF_FEATURE_POLY6) return poly6(c, scale, r2);
  return wendland(scale, closeness(c, ops<L>::sqrt(r2)));
}

template <class L>
PBF_FN void kernel_and_slope(int features, const pbf_constants *c, pbf_real value_scale,
                             pbf_real slope_scale, L r2, L *value, L *slope) {
  L safe2 = ops<L>::max(r2, ops<L>::set(c->tiny2));
  L inv_r = ops<L>::rsqrt(safe2);
  L u = closeness(c, safe2 * inv_r);
  if (features & PBF_FEATURE_POLY6) {
    *value = poly6(c, ops<L>::set(value_scale), r2);
    *slope = ops<L>::set(slope_scale) * (u * u) * inv_r;
  } else {
    *value = wendland(ops<L>::set(value_scale), u);
    *slope = ops<L>::set(slope_scale) * (u * u * u);
  }
}

/* V grad_i W_ij is this times x_i - x_j. */
template <class L>
PBF_FN L kernel_slope(int features, const pbf_constants *c, L r2) {
  L value, slope;
  kernel_and_slope(features, c, c->value_scale, pbf_slope_scale(features, c), r2, &value, &slope);
  return slope;
}

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
