/* The real type and dimension of this translation unit's variant, PBF_REAL and PBF_DIM from the
 * build, and vectors of them. Two dimensions carry no third coordinate. */
#ifndef PBF_PHYSICS_REAL_H
#define PBF_PHYSICS_REAL_H

#include <math.h>
#include <string.h>

#include "physics/features.h"

typedef PBF_REAL pbf_real;

typedef struct pbf_vec {
  pbf_real c[PBF_DIM];
} pbf_vec;

/* What curls are: a scalar in two dimensions. */
enum { PBF_CURL_DIM = PBF_DIM == 3 ? 3 : 1, PBF_MOMENTS = PBF_DIM * (PBF_DIM + 1) / 2 };
typedef struct pbf_curl {
  pbf_real c[PBF_CURL_DIM];
} pbf_curl;

#if defined(__CUDACC__)
PBF_FN float pbf_sqrt_of(float a) { return sqrtf(a); }
PBF_FN double pbf_sqrt_of(double a) { return sqrt(a); }
PBF_FN pbf_real pbf_real_sqrt(pbf_real a) { return pbf_sqrt_of(a); }
#else
PBF_FN pbf_real pbf_real_sqrt(pbf_real a) {
  return sizeof a == sizeof(float) ? (pbf_real)sqrtf((float)a) : (pbf_real)sqrt((double)a);
}
#endif
/* a b + c, which a device rounds once, and a CPU as it is written. */
#if defined(__CUDA_ARCH__)
PBF_FN float pbf_fused(float a, float b, float c) { return fmaf(a, b, c); }
PBF_FN double pbf_fused(double a, double b, double c) { return fma(a, b, c); }
PBF_FN pbf_real pbf_multiply_add(pbf_real a, pbf_real b, pbf_real c) { return pbf_fused(a, b, c); }
#else
PBF_FN pbf_real pbf_multiply_add(pbf_real a, pbf_real b, pbf_real c) { return a * b + c; }
#endif
PBF_FN pbf_real pbf_real_max(pbf_real a, pbf_real b) { return a > b ? a : b; }
PBF_FN pbf_real pbf_real_min(pbf_real a, pbf_real b) { return a < b ? a : b; }
PBF_FN double pbf_max(double a, double b) { return a > b ? a : b; }
PBF_FN double pbf_min(double a, double b) { return a < b ? a : b; }

/* The last bit of a float32, by which its neighbour above is apart; 0 for a float64, whose own
 * nothing here needs. */
PBF_FN pbf_real pbf_last_bit(pbf_real a) {
  if (sizeof a != sizeof(float)) return 0;
  const float value = (float)a;
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  bits &= 0x7f800000u;
  float power;
  memcpy(&power, &bits, sizeof power);
  return (pbf_real)(power * 0x1p-23f);
}

PBF_FN pbf_real pbf_dot(pbf_vec a, pbf_vec b) {
  pbf_real sum = a.c[0] * b.c[0];
  for (int k = 1; k < PBF_DIM; ++k) sum = pbf_multiply_add(a.c[k], b.c[k], sum);
  return sum;
}

PBF_FN pbf_vec pbf_sub(pbf_vec a, pbf_vec b) {
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] -= b.c[k];
  return a;
}

PBF_FN pbf_vec pbf_scaled(pbf_vec a, pbf_real s) {
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] *= s;
  return a;
}

/* a + s b */
PBF_FN pbf_vec pbf_add_scaled(pbf_vec a, pbf_real s, pbf_vec b) {
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = pbf_multiply_add(s, b.c[k], a.c[k]);
  return a;
}

#endif
