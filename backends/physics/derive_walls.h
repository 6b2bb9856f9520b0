/* What walls contribute to the density, and how hard they push, such that a lattice before a wall
 * is at rest. Host only, float64. */
#ifndef PBF_PHYSICS_DERIVE_WALLS_H
#define PBF_PHYSICS_DERIVE_WALLS_H

#include "physics/derived.h"
#include "physics/rest_lattice.h"

/* Integral of the kernel over the half-space beyond a plane at the distance t h, by Simpson's rule:
 * a plane at height z cuts out  f(z) = 2 int W r dr (r from z to h; in 2D  2 int W dx), and this is
 * its integral from t to 1. */
static inline double pbf_half_space(uint32_t kernel, uint32_t dimension, double t) {
  enum { N = 24 };
  double outer = 0, norm = pbf_norm_value(kernel, dimension, 1);
  for (int i = 0; i <= N; ++i) {
    double z = t + (1 - t) * i / N, radius = sqrt(fmax(0, 1 - z * z)), inner = 0;
    for (int k = 0; k <= N; ++k) {
      double x = radius * k / N, q = sqrt(z * z + x * x);
      double w = pbf_shape_value(kernel, q) * (dimension == 3 ? 2 * PBF_PI * x : 2);
      inner += w * (k == 0 || k == N ? 1 : k % 2 ? 4 : 2) * radius / (3 * N);
    }
    outer += inner * (i == 0 || i == N ? 1 : i % 2 ? 4 : 2) * (1 - t) / (3 * N);
  }
  return t < 1 ? norm * outer : 0;
}

/* A lattice that fills the space before a wall has its first layer half a spacing off. What that
 * layer lacks, the half-space must contribute: its t h there, less the half spacing. */
static inline double pbf_wall_offset(uint32_t kernel, uint32_t dimension, double h, double d,
                                     double volume) {
  double missing = 0;
  int n = (int)ceil(h / d), nz = dimension == 3 ? n : 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = 1; j <= n; ++j)
      for (int i = -n; i <= n; ++i)
        missing += volume * pbf_norm_value(kernel, dimension, h) *
                   pbf_shape_value(kernel, d / h * sqrt((double)(i * i + j * j + k * k)));
  double low = 0, high = 1;
  for (int step = 0; step < 40; ++step) {
    double middle = 0.5 * (low + high);
    if (pbf_half_space(kernel, dimension, middle) > missing)
      low = middle;
    else
      high = middle;
  }
  return low * h - 0.5 * d;
}

/* The layers of a lattice, from 1, that one of its layers lacks at a wall with ghosts. They
 * would contribute `density`. A particle that moves alone towards the wall changes that by `rate`:
 * with its distances from the others' ghosts, and twice as fast with that from its own. And its
 * neighbours and the ghosts push it with lambda_i + lambda_j, 2 for lambda = 1, so that it takes
 * `force` to hold it against those inside. That is more than `rate`, which is all that its own
 * constraint gives: the rest is from the neighbours' constraints. */
typedef struct pbf_missing {
  double density, rate, force;
  double across, along; /* of shear_stress.h's M */
} pbf_missing;

static inline pbf_missing pbf_wall_lattice(uint32_t kernel, uint32_t dimension, double h, double d,
                                           double volume, int layer) {
  const double e = 1e-3;
  pbf_missing missing = {0, 0, 0, 0, 0};
  int n = (int)ceil(h / d), nz = dimension == 3 ? n : 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = layer; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        double r = d * sqrt((double)(i * i + j * j + k * k)), q = r / h;
        double along = volume * j * d / r, own = i == 0 && j == 2 * layer - 1 && k == 0 ? 2 : 1;
        double value = volume * pbf_norm_value(kernel, dimension, h);
        missing.density += value * pbf_shape_value(kernel, q);
        missing.rate += own * along * pbf_norm_value(kernel, dimension, h) *
                        (pbf_shape_value(kernel, q - e) - pbf_shape_value(kernel, q + e)) /
                        (2 * e * h);
        missing.force +=
            2 * along * pbf_norm_slope(kernel, dimension, h) * pbf_shape_slope(kernel, q);
        double fabric = volume * pbf_norm_slope(kernel, dimension, h) * pbf_shape_slope(kernel, q);
        missing.across += fabric * (j * d) * (j * d) / r;
        missing.along += fabric * (i * d) * (i * d) / r;
      }
  return missing;
}

static inline double pbf_half_space_slope(uint32_t kernel, uint32_t dimension, double t) {
  const double e = 1e-3;
  return (pbf_half_space(kernel, dimension, t + e) - pbf_half_space(kernel, dimension, t - e)) /
         (2 * e);
}

/* What a wall contributes at a distance t h and its derivative, over that at the first layer: what
 * the half-space would, f, with the exponent wall_steepness, from that layer on
 * 1 + (wall_steepness - 1) wall_fade^x at x spacings beyond. */
static inline double pbf_wall_contribution(const pbf_derived *d, uint32_t kernel,
                                           uint32_t dimension, double t, double *slope) {
  double f = pbf_half_space(kernel, dimension, t) / d->wall_first_density;
  double change = pbf_half_space_slope(kernel, dimension, t) / d->wall_first_density;
  double exponent = d->wall_steepness, bends = 0;
  if (t > d->wall_first && d->wall_fade < 1) {
    double x = (t - d->wall_first) * d->h / d->spacing;
    double above = (d->wall_steepness - 1) * pbf_pow(d->wall_fade, x);
    exponent = 1 + above;
    bends = above * pbf_log(d->wall_fade) * d->h / d->spacing * pbf_log(f);
  }
  double value = pbf_pow(f, exponent);
  *slope = exponent * pbf_pow(f, exponent - 1) * change + bends * value;
  return value;
}

/* That wall_fade with which the second layer gets what it lacks, over what the first does; 1 where
 * it lacks next to nothing. */
static inline double pbf_wall_fade(const pbf_derived *d, uint32_t kernel, uint32_t dimension,
                                   double lacks) {
  double t = d->wall_first + d->spacing / d->h;
  double f = pbf_half_space(kernel, dimension, t) / d->wall_first_density;
  if (!(f > 0 && lacks > 0 && d->wall_steepness > 1)) return 1;
  return fmin(fmax((pbf_log(lacks) / pbf_log(f) - 1) / (d->wall_steepness - 1), 0.05), 1);
}

/* The density that walls contribute is right at a lattice's first two layers, with `rate` at the
 * first. They push with its slope times wall_gradient_scale, from the second layer on
 * wall_gradient_scale_far, so that a lattice is balanced but for a thirtieth: balanced in full,
 * fluid of wide kernels moves half as fast again at rest. Where the second layer lacks little its
 * balance counts less. */
static inline void pbf_derive_wall(uint32_t kernel, uint32_t dimension, pbf_missing first,
                                   pbf_derived *d) {
  const double share = 0.965;
  pbf_missing second = pbf_wall_lattice(kernel, dimension, d->h, d->spacing, d->volume, 2);
  d->wall_offset = pbf_wall_offset(kernel, dimension, d->h, d->spacing, d->volume);
  d->wall_first = (0.5 * d->spacing + d->wall_offset) / d->h;
  d->wall_first_density = pbf_half_space(kernel, dimension, d->wall_first);
  double slope = -pbf_half_space_slope(kernel, dimension, d->wall_first) / d->h;
  d->wall_steepness = fmin(fmax(first.rate / slope, 1), 4);
  d->wall_gradient_scale = fmin(fmax(share * first.force / slope, 1), 4) / d->wall_steepness;
  d->wall_gradient_scale_far = d->wall_gradient_scale;
  d->wall_fade = pbf_wall_fade(d, kernel, dimension, second.density / first.density);
  if (!(d->wall_fade < 1)) return;
  double fall, t = d->wall_first + d->spacing / d->h, counts = fmin(1, 4 * (1 - d->wall_fade));
  pbf_wall_contribution(d, kernel, dimension, t, &fall);
  double balance = -share * second.force * d->h / (d->wall_first_density * fall);
  d->wall_gradient_scale_far += counts * fmin(fmax(balance - d->wall_gradient_scale, 0), 4);
}

#endif
