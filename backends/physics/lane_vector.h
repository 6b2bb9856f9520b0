/* Lanes: a real, or a vector of the processor that holds one of as many particles. What is computed
 * of pairs is written for either, with + - * and these operations. */
#ifndef PBF_PHYSICS_LANE_VECTOR_H
#define PBF_PHYSICS_LANE_VECTOR_H

#include "physics/real.h"

/* Internal linkage: units built for other instruction sets have others of the same names. */
namespace {

/* As static functions: set(real), max(a, b), multiply_add(a, b, c) = a b + c, sqrt(a), and what a
 * device has faster forms of where a > 0: root(a) = sqrt(a) and over_root(b, a) = b / sqrt(a).
 *
 * On CPUs each rounds as IEEE 754 says, product and sum apart: so all instruction sets give the
 * same bits, those without a fused multiply-add and without estimates of roots too. */
template <class L>
struct ops;

#if defined(__CUDA_ARCH__)
/* Of a NaN fmaxf takes the other number, as a > b ? a : b does for a. rsqrtf is within 2 ulp (CUDA
 * C++ Programming Guide, mathematical functions). */
template <>
struct ops<float> {
  static PBF_IN float set(float a) { return a; }
  static PBF_IN float max(float a, float b) { return fmaxf(a, b); }
  static PBF_IN float multiply_add(float a, float b, float c) { return fmaf(a, b, c); }
  static PBF_IN float sqrt(float a) { return sqrtf(a); }
  static PBF_IN float root(float a) { return a * rsqrtf(a); }
  static PBF_IN float over_root(float b, float a) { return b * rsqrtf(a); }
};

template <>
struct ops<double> {
  static PBF_IN double set(double a) { return a; }
  static PBF_IN double max(double a, double b) { return a > b ? a : b; }
  static PBF_IN double multiply_add(double a, double b, double c) { return ::fma(a, b, c); }
  static PBF_IN double sqrt(double a) { return ::sqrt(a); }
  static PBF_IN double root(double a) { return a * ::rsqrt(a); }
  static PBF_IN double over_root(double b, double a) { return b * ::rsqrt(a); }
};
#else
template <>
struct ops<pbf_real> {
  static PBF_IN pbf_real set(pbf_real a) { return a; }
  static PBF_IN pbf_real max(pbf_real a, pbf_real b) { return pbf_real_max(a, b); }
  static PBF_IN pbf_real multiply_add(pbf_real a, pbf_real b, pbf_real c) { return a * b + c; }
  static PBF_IN pbf_real sqrt(pbf_real a) { return pbf_real_sqrt(a); }
  static PBF_IN pbf_real root(pbf_real a) { return pbf_real_sqrt(a); }
  static PBF_IN pbf_real over_root(pbf_real b, pbf_real a) { return b / pbf_real_sqrt(a); }
};
#endif

/* Calls visit(0) … visit(COUNT - 1), not as a loop: around it the compiler makes vectors. */
template <int COUNT, class Visit>
PBF_FN void pbf_unrolled(Visit visit) {
  if constexpr (COUNT > 0) {
    pbf_unrolled<COUNT - 1>(visit);
    visit(COUNT - 1);
  }
}

/* max(a b + 1, 0), where a b <= 0: one instruction of a GPU for a float. */
template <class L>
PBF_FN L ramp(L a, L b) {
#if defined(__CUDA_ARCH__)
  if constexpr (sizeof(L) == sizeof(float)) {
    L kept;
    asm("fma.rn.ftz.sat.f32 %0, %1, %2, 0f3f800000;" : "=f"(kept) : "f"(a), "f"(b));
    return kept;
  } else
#endif
    return ops<L>::max(ops<L>::multiply_add(a, b, ops<L>::set(1)), ops<L>::set(0));
}

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
    for (int k = 0; k < PBF_DIM; ++k) c[k] = ops<L>::multiply_add(s, b.c[k], c[k]);
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

}  // namespace

#endif
