/* What sums over the rest lattice say of a kernel: the density, how far an iteration may go, and
 * how stiff the lattice is under pressure. Host only, float64. */
#ifndef PBF_PHYSICS_REST_LATTICE_H
#define PBF_PHYSICS_REST_LATTICE_H

#include <math.h>
#include <stdint.h>

#include <pbf/pbf.h>

#include "physics/elementary.h"

#define PBF_PI 3.14159265358979323846

/* Kernel value at q = r/h over its norm (Müller et al. 2003; Wendland 1995). */
static inline double pbf_shape_value(uint32_t kernel, double q) {
  if (q >= 1) return 0;
  double u = kernel == PBF_KERNEL_POLY6_SPIKY ? 1 - q * q : 1 - q;
  return kernel == PBF_KERNEL_POLY6_SPIKY ? u * u * u : u * u * u * u * (4 * q + 1);
}

/* Magnitude of the gradient at q, over its norm; it points towards the other particle. */
static inline double pbf_shape_slope(uint32_t kernel, double q) {
  if (q >= 1) return 0;
  double u = 1 - q;
  return kernel == PBF_KERNEL_POLY6_SPIKY ? u * u : q * u * u * u;
}

static inline double pbf_norm_value(uint32_t kernel, uint32_t dimension, double h) {
  if (kernel == PBF_KERNEL_POLY6_SPIKY)
    return dimension == 2 ? 4 / (PBF_PI * h * h) : 315 / (64 * PBF_PI * h * h * h);
  return dimension == 2 ? 7 / (PBF_PI * h * h) : 21 / (2 * PBF_PI * h * h * h);
}

static inline double pbf_norm_slope(uint32_t kernel, uint32_t dimension, double h) {
  if (kernel == PBF_KERNEL_POLY6_SPIKY)
    return dimension == 2 ? 30 / (PBF_PI * h * h * h) : 45 / (PBF_PI * h * h * h * h);
  return 20 * pbf_norm_value(kernel, dimension, h) / h;
}

/* Calls for each point of the square or cubic lattice within h, the origin included; sums
 *   density   sum W,   slope2   sum |grad W|²,   pull   sum of -r · grad W over dimensions,
 *   symbol[0] sum grad W · k sin(k·r) with W's own gradient, symbol[1] the same with the one that
 *   moves particles, both along the direction of the wave vector k. */
typedef struct pbf_lattice_sums {
  double density, slope2, pull, symbol[2];
} pbf_lattice_sums;

static inline double pbf_shape_own_slope(uint32_t kernel, double q) {
  if (kernel != PBF_KERNEL_POLY6_SPIKY) return pbf_shape_slope(kernel, q);
  double u = q < 1 ? 1 - q * q : 0;
  return 6 * q * u * u;
}

static inline pbf_lattice_sums pbf_lattice(uint32_t kernel, uint32_t dimension, double h, double d,
                                           const double wave[3]) {
  pbf_lattice_sums sums = {0, 0, 0, {0, 0}};
  int n = (int)ceil(h / d), nz = dimension == 3 ? n : 0;
  double value = pbf_norm_value(kernel, dimension, h), slope = pbf_norm_slope(kernel, dimension, h);
  double own = kernel == PBF_KERNEL_POLY6_SPIKY ? value / h : slope;
  double length = sqrt(wave[0] * wave[0] + wave[1] * wave[1] + wave[2] * wave[2]);
  for (int k = -nz; k <= nz; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        double r = d * sqrt((double)(i * i + j * j + k * k)), q = r / h;
        if (q >= 1) continue;
        double g = slope * pbf_shape_slope(kernel, q);
        sums.density += value * pbf_shape_value(kernel, q);
        if (r <= 0) continue;
        sums.slope2 += g * g;
        sums.pull += g * r / dimension;
        if (length <= 0) continue;
        double phase = d * (wave[0] * i + wave[1] * j + wave[2] * k);
        double along = phase / (length * r) * pbf_sin(phase);
        sums.symbol[0] += own * pbf_shape_own_slope(kernel, q) * along;
        sums.symbol[1] += g * along;
      }
  return sums;
}

/* Largest eigenvalue of the Jacobi iteration's matrix over the waves along the lattice's axes and
 * diagonals. A wave lambda exp(i k·x) moves particles along k by symbol[1], which changes the
 * density by symbol[0]; the diagonal is slope2. */
static inline double pbf_lattice_lambda_max(uint32_t kernel, uint32_t dimension, double h,
                                            double d) {
  enum { SAMPLES = 48 };
  double largest = 0;
  for (uint32_t axes = 1; axes <= dimension; ++axes)
    for (int s = 1; s <= SAMPLES; ++s) {
      double k = PBF_PI / d * s / SAMPLES;
      double wave[3] = {k, axes > 1 ? k : 0, axes > 2 ? k : 0};
      pbf_lattice_sums sums = pbf_lattice(kernel, dimension, h, d, wave);
      double eigenvalue = fabs(sums.symbol[0] * sums.symbol[1]) / sums.slope2;
      if (eigenvalue > largest) largest = eigenvalue;
    }
  return largest;
}

/* Derivative of pbf_shape_slope. */
static inline double pbf_shape_slope_rate(uint32_t kernel, double q) {
  if (q >= 1) return 0;
  double u = 1 - q;
  return kernel == PBF_KERNEL_POLY6_SPIKY ? -2 * u : u * u * (1 - 4 * q);
}

/* A lattice under an even pressure lambda_i = lambda_j = -1 pushes back when a wave displaces its
 * particles along the unit vector `along`: by this times the displacement, for V = 1. */
static inline double pbf_lattice_curvature(uint32_t kernel, uint32_t dimension, double h, double d,
                                           const double wave[3], const double along[3]) {
  int n = (int)ceil(h / d), nz = dimension == 3 ? n : 0;
  double norm = pbf_norm_slope(kernel, dimension, h), sum = 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        double r = d * sqrt((double)(i * i + j * j + k * k)), q = r / h;
        if (q >= 1 || r <= 0) continue;
        double cosine = d / r * (along[0] * i + along[1] * j + along[2] * k), c2 = cosine * cosine;
        double second =
            pbf_shape_slope_rate(kernel, q) / h * c2 + pbf_shape_slope(kernel, q) / r * (1 - c2);
        sum -= 2 * norm * second * (1 - pbf_cos(d * (wave[0] * i + wave[1] * j + wave[2] * k)));
      }
  return sum;
}

/* Its largest value over the waves along the lattice's axes and diagonals, lengthwise and across.
 */
static inline double pbf_lattice_stiffness(uint32_t kernel, uint32_t dimension, double h,
                                           double d) {
  enum { SAMPLES = 12 };
  double largest = 0;
  for (uint32_t axes = 1; axes <= dimension; ++axes)
    for (int s = 1; s <= SAMPLES; ++s) {
      double k = PBF_PI / d * s / SAMPLES, part = 1 / sqrt((double)axes), across = sqrt(0.5);
      double wave[3] = {k, axes > 1 ? k : 0, axes > 2 ? k : 0};
      double lengthwise[3] = {part, axes > 1 ? part : 0, axes > 2 ? part : 0};
      double crosswise[3] = {axes > 1 ? across : 0, axes > 1 ? -across : 1, 0};
      largest = fmax(largest, pbf_lattice_curvature(kernel, dimension, h, d, wave, lengthwise));
      largest = fmax(largest, pbf_lattice_curvature(kernel, dimension, h, d, wave, crosswise));
    }
  return largest;
}

/* Jacobi is stable below 2 / largest eigenvalue; compression raises the eigenvalue a little. */
#define PBF_SAFE_RELAXATION 1.5

#endif
