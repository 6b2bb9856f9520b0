/* The pair terms on one pair: pbf_pair_kernel, pbf_pair_density, pbf_pair_scorr, … */
#ifndef PBF_PHYSICS_SCALAR_H
#define PBF_PHYSICS_SCALAR_H

#include "physics/real.h"

PBF_FN pbf_real pbf_scalar_sqrt(pbf_real a) { return pbf_real_sqrt(a); }
PBF_FN pbf_real pbf_scalar_set(pbf_real a) { return a; }
#if defined(__CUDA_ARCH__)
/* One instruction each; of a number that is none fmaxf takes the other one, as a > b ? a : b does
 * for a. */
PBF_FN float pbf_max_of(float a, float b) { return fmaxf(a, b); }
PBF_FN double pbf_max_of(double a, double b) { return a > b ? a : b; }
PBF_FN float pbf_ramp_of(float a, float b) {
  float kept;
  asm("fma.rn.ftz.sat.f32 %0, %1, %2, 0f3f800000;" : "=f"(kept) : "f"(a), "f"(b));
  return kept;
}
PBF_FN double pbf_ramp_of(double a, double b) { return pbf_max_of(fma(a, b, 1.0), 0.0); }
PBF_FN pbf_real pbf_scalar_max(pbf_real a, pbf_real b) { return pbf_max_of(a, b); }
PBF_FN pbf_real pbf_scalar_ramp(pbf_real a, pbf_real b) { return pbf_ramp_of(a, b); }
/* rsqrtf is within 2 ulp (CUDA C++ Programming Guide, mathematical functions). */
PBF_FN float pbf_rsqrt_of(float a) { return rsqrtf(a); }
PBF_FN double pbf_rsqrt_of(double a) { return rsqrt(a); }
PBF_FN float pbf_fma_of(float a, float b, float c) { return fmaf(a, b, c); }
PBF_FN double pbf_fma_of(double a, double b, double c) { return fma(a, b, c); }
PBF_FN pbf_real pbf_scalar_rsqrt(pbf_real a) { return pbf_rsqrt_of(a); }
PBF_FN pbf_real pbf_scalar_fma(pbf_real a, pbf_real b, pbf_real c) { return pbf_fma_of(a, b, c); }
#else
PBF_FN pbf_real pbf_scalar_max(pbf_real a, pbf_real b) { return pbf_real_max(a, b); }
PBF_FN pbf_real pbf_scalar_ramp(pbf_real a, pbf_real b) { return pbf_real_max(a * b + 1, 0); }
PBF_FN pbf_real pbf_scalar_rsqrt(pbf_real a) { return 1 / pbf_real_sqrt(a); }
PBF_FN pbf_real pbf_scalar_fma(pbf_real a, pbf_real b, pbf_real c) { return a * b + c; }
#endif

#define PBF_LANE pbf_real
#define PBF_LANE_(operation) pbf_scalar_##operation
#define PBF_PAIR(term) pbf_pair_##term
#include "physics/pair.h"

#endif
