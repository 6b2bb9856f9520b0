/* Eigenvalues and eigenvectors of a symmetric matrix of two or three rows, by Jacobi's rotations.
 */
#ifndef PBF_LIB_PARTICLES_EIGEN_H
#define PBF_LIB_PARTICLES_EIGEN_H

#include <math.h>
#include <stdint.h>

/* Turns rows and columns p and q of `a` so that a[p][q] becomes 0, and `vectors` with them. */
static inline void pbf_jacobi_rotate(double a[3][3], double vectors[3][3], uint32_t n, uint32_t p,
                                     uint32_t q) {
  if (!(fabs(a[p][q]) > 0)) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c, step = t * a[p][q];
  a[p][p] -= step;
  a[q][q] += step;
  a[p][q] = a[q][p] = 0;
  for (uint32_t k = 0; k < n; ++k) {
    if (k != p && k != q) {
      const double kp = a[k][p], kq = a[k][q];
      a[k][p] = a[p][k] = c * kp - s * kq;
      a[k][q] = a[q][k] = s * kp + c * kq;
    }
    const double vp = vectors[k][p], vq = vectors[k][q];
    vectors[k][p] = c * vp - s * vq;
    vectors[k][q] = s * vp + c * vq;
  }
}

/* `a` is overwritten: its diagonal has the eigenvalues. Column k of `vectors` belongs to a[k][k].
 */
static inline void pbf_eigen(double a[3][3], double vectors[3][3], uint32_t n) {
  enum { SWEEPS = 10 }; /* it converges quadratically: five are enough for float64 */
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t k = 0; k < n; ++k) vectors[i][k] = i == k;
  for (uint32_t sweep = 0; sweep < SWEEPS; ++sweep)
    for (uint32_t p = 0; p + 1 < n; ++p)
      for (uint32_t q = p + 1; q < n; ++q) pbf_jacobi_rotate(a, vectors, n, p, q);
}

#endif
