/* Vectors of three numbers. */
#ifndef PBF_LIB_SHAPE_VECTORS_H
#define PBF_LIB_SHAPE_VECTORS_H

#include <math.h>

static inline void pbf_minus(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = a[k] - b[k];
}

static inline double pbf_inner(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void pbf_outer(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; ++k)
    out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static inline void pbf_add_times(double to[3], double times, const double by[3]) {
  for (int k = 0; k < 3; ++k) to[k] += times * by[k];
}

static inline double pbf_norm(const double a[3]) { return sqrt(pbf_inner(a, a)); }

#endif
