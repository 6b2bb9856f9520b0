/* What follows from the parameters before any particle is looked at: the kernels' normalisation,
 * the rest volume, the relaxation. Host only, float64. */
#ifndef PBF_PHYSICS_DERIVE_H
#define PBF_PHYSICS_DERIVE_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <pbf/pbf.h>

#include "physics/capillary.h"
#include "physics/elementary.h"
#include "physics/spacing.h"

#define PBF_PI 3.14159265358979323846

/* Nodes of what a solid does to the fluid before it, from its plane to a distance of h. */
enum { PBF_VISCOUS_WALL_NODES = 17 };

/* Of the weights w of passes/viscous_stress.h: how steep they are; on the rest lattice sum w r²,
 * and the factor on sum w (v_ji · x_ij) x_ij that makes it the laplacian of v: averaged over
 * directions x² y² is r⁴ / (d (d + 2)). Of the half-space behind a plane in the distance y the sum
 * of w x_t² x_n h / y: x_n across the plane, x_t along it. */
typedef struct pbf_viscosity_lattice {
  double falloff, spread, to_laplacian;
  double wall[PBF_VISCOUS_WALL_NODES];
} pbf_viscosity_lattice;

/* Everything the pair terms need, in units of 1/h: V W = value_scale * shape(r/h). */
typedef struct pbf_derived {
  pbf_params from; /* see pbf_params_to_derive_from */
  double h;
  double spacing;
  double volume;         /* V */
  double value_scale;    /* V times the kernel's norm: V W(0) for both kernels */
  double gradient_scale; /* V times the gradient's norm, see kernels.h */
  double cfm;            /* 1/length² */
  double omega;
  double scorr_k;
  double scorr_inv_w;   /* 1 / (V W(delta q)) */
  double scorr_dq2;     /* (delta q)² in units of h² */
  double diagonal;      /* V² sum |grad W|² on the lattice */
  double stiffness;     /* largest curvature of a pressed lattice for lambda = 1, 1/length² */
  double pressure;      /* of a lattice for lambda = -1 and a time step of 1, over rest density */
  double surface_lacks; /* density that the outermost layer of a lattice lacks */
  double wall_offset;   /* from a particle's distance to a wall to the t h that its density is taken
                           at */
  double wall_first,
      wall_first_density; /* t of a lattice's first layer, and the half-space's density there */
  double wall_steepness, wall_fade, wall_gradient_scale,
      wall_gradient_scale_far; /* see pbf_derive_wall */
  double wall_fabric_across,
      wall_fabric_along; /* what a first layer lacks of shear_stress.h's M, across and along */
  pbf_viscosity_lattice viscosity;
  double per_neighbor, neighbors_of_solids; /* see passes/surface_tension.h */
} pbf_derived;

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

/* A weight of passes/viscous_stress.h, of u = 1 - r/h; with a falloff of 0 and 1 those that it is
 * between. */
static inline double pbf_viscous_weight_of(double falloff, double u) {
  return u * (1 - falloff + falloff * 0.5 * u * u * (1 + u));
}

/* Moments on the rest lattice: sum of w r², w r⁴ and w x_k⁴ over all axes, and, of what is on one
 * side, w x_t² x_n. */
typedef struct pbf_viscosity_moments {
  double second, fourth, axial, wall;
} pbf_viscosity_moments;

static inline pbf_viscosity_moments pbf_viscosity_moments_of(const pbf_derived *d, double falloff,
                                                             uint32_t dimension) {
  const int n = (int)ceil(d->h / d->spacing), nz = dimension == 3 ? n : 0;
  pbf_viscosity_moments m = {0, 0, 0, 0};
  for (int k = -nz; k <= nz; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const double x = d->spacing * i, y = d->spacing * j, z = d->spacing * k;
        const double r2 = x * x + y * y + z * z, u = 1 - sqrt(r2) / d->h;
        if (!(u > 0)) continue;
        const double w = pbf_viscous_weight_of(falloff, u);
        m.second += w * r2;
        m.fourth += w * r2 * r2;
        m.axial += w * (x * x * x * x + y * y * y * y + z * z * z * z);
        if (x > 0) m.wall += w * x * (y * y + z * z) / (dimension - 1.0);
      }
  return m;
}

/* How much more there is of x_k⁴ than of 3 x_k² x_l². */
static inline double pbf_viscosity_anisotropy(const pbf_viscosity_moments *m, uint32_t dimension) {
  return m->axial - 3 / (dimension - 1.0) * (m->fourth - m->axial);
}

/* The falloff with which fourth moments are isotropic on the rest lattice, or next to it. */
static inline double pbf_viscosity_falloff(const pbf_derived *d, uint32_t dimension) {
  const pbf_viscosity_moments m[2] = {pbf_viscosity_moments_of(d, 0, dimension),
                                      pbf_viscosity_moments_of(d, 1, dimension)};
  const double flat = pbf_viscosity_anisotropy(&m[0], dimension);
  const double steep = pbf_viscosity_anisotropy(&m[1], dimension);
  if (flat * steep < 0) return flat / (flat - steep);
  return fabs(flat) * m[1].fourth < fabs(steep) * m[0].fourth ? 0 : 1;
}

/* The integral over all that is farther than t h across a plane, over h^(d + 3): the angles' part
 * is in closed form, the distances' by Simpson's rule. */
static inline double pbf_viscous_half_space(double falloff, double t, uint32_t dimension) {
  enum { PARTS = 32 };
  double sum = 0;
  for (int k = 0; k <= PARTS; ++k) {
    const double q = t + (1 - t) * k / PARTS, u = 1 - q, rest = q * q - t * t;
    const double angles =
        dimension == 3 ? 0.25 * PBF_PI * rest * rest : 2.0 / 3 * rest * sqrt(rest > 0 ? rest : 0);
    const double simpson = k == 0 || k == PARTS ? 1 : k % 2 ? 4 : 2;
    sum += simpson * pbf_viscous_weight_of(falloff, u) * q * angles;
  }
  return sum * (1 - t) / (3 * PARTS);
}

/* As much as on the lattice before its first layer, which is half a spacing off. */
static inline void pbf_set_viscous_wall(const pbf_derived *d, double first_layer,
                                        uint32_t dimension, pbf_viscosity_lattice *l) {
  const double per_h = d->h / d->spacing,
               number = dimension == 3 ? per_h * per_h * per_h : per_h * per_h;
  const double scale = number * d->h * d->h;
  const double first = scale * d->h * pbf_viscous_half_space(l->falloff, 0.5 / per_h, dimension);
  const double share = fmin(fmax(first_layer / first, 0.5), 2);
  for (int k = 0; k < PBF_VISCOUS_WALL_NODES; ++k)
    l->wall[k] = share * scale *
                 pbf_viscous_half_space(l->falloff, k / (PBF_VISCOUS_WALL_NODES - 1.0), dimension);
}

static inline pbf_viscosity_lattice pbf_viscosity_lattice_of(const pbf_derived *d,
                                                             uint32_t dimension) {
  pbf_viscosity_lattice l;
  l.falloff = pbf_viscosity_falloff(d, dimension);
  const pbf_viscosity_moments m = pbf_viscosity_moments_of(d, l.falloff, dimension);
  l.spread = m.second;
  l.to_laplacian = 2.0 * dimension * (dimension + 2) / m.fourth;
  pbf_set_viscous_wall(d, m.wall, dimension, &l);
  return l;
}

/* The parameters that all derived ones follow from, and the tables of walls; all others 0. */
static inline pbf_params pbf_params_to_derive_from(const pbf_params *params) {
  pbf_params from;
  memset(&from, 0, sizeof from);
  from.kernel = params->kernel;
  from.solver = params->solver;
  from.smoothing_radius = params->smoothing_radius;
  from.spacing = params->spacing;
  from.particle_volume = params->particle_volume;
  from.wall_density = params->wall_density;
  from.cfm = params->cfm;
  from.over_relaxation = params->over_relaxation;
  from.scorr_k = params->scorr_k;
  from.scorr_dq = params->scorr_dq;
  return from;
}

/* What a particle that has all its neighbours has of them is 1, also where solids stand for those
 * of a lattice's first layer. */
static inline void pbf_derive_neighbors(uint32_t dimension, pbf_derived *d) {
  const pbf_neighbor_weights of = pbf_lattice_neighbors(dimension, d->h, d->spacing);
  d->per_neighbor = of.all > 0 ? 1 / of.all : 0;
  d->neighbors_of_solids =
      d->surface_lacks > 0 ? of.beyond * d->per_neighbor / d->surface_lacks : 0;
}

/* volume / unit^dimension. */
static inline double pbf_volume_in(double unit, double volume, uint32_t dimension) {
  for (uint32_t k = 0; k < dimension; ++k) volume /= unit;
  return volume;
}

static inline pbf_derived pbf_derive_from(const pbf_params *params, uint32_t dimension) {
  pbf_derived d;
  memset(&d, 0, sizeof d);
  d.from = *params;
  uint32_t kernel = params->kernel;
  double h = params->smoothing_radius, no_wave[3] = {0, 0, 0};
  d.h = h;
  d.spacing = pbf_derive_spacing(params);
  /* Slopes of kernels go as h to the power of -4: squares of them are no numbers from 1e39 on. */
  const double unit = pbf_unit_near(h), one_h = h / unit, one_spacing = d.spacing / unit;
  pbf_lattice_sums sums = pbf_lattice(kernel, dimension, one_h, one_spacing, no_wave);
  d.volume = params->particle_volume > 0 ? params->particle_volume
                                         : pbf_volume_in(1 / unit, 1 / sums.density, dimension);
  const double one_volume = pbf_volume_in(unit, d.volume, dimension);
  d.value_scale = d.volume * pbf_norm_value(kernel, dimension, h);
  d.gradient_scale = d.volume * pbf_norm_slope(kernel, dimension, h);
  d.diagonal = one_volume * one_volume * sums.slope2 / unit / unit;
  d.pressure = one_volume * sums.pull;
  if (params->solver == PBF_SOLVER_CHEBYSHEV)
    d.stiffness = d.volume * pbf_lattice_stiffness(kernel, dimension, h, d.spacing);
  pbf_missing first = pbf_wall_lattice(kernel, dimension, h, d.spacing, d.volume, 1);
  d.surface_lacks = first.density;
  d.wall_fabric_across = first.across;
  d.wall_fabric_along = first.along;
  if (params->wall_density > 0) pbf_derive_wall(kernel, dimension, first, &d);
  d.cfm = params->cfm / (h * h);
  d.omega =
      params->over_relaxation > 0
          ? params->over_relaxation
          : PBF_SAFE_RELAXATION / pbf_lattice_lambda_max(kernel, dimension, one_h, one_spacing);
  d.scorr_k = params->scorr_k;
  d.scorr_dq2 = params->scorr_dq * params->scorr_dq;
  if (params->scorr_k > 0)
    d.scorr_inv_w = 1 / (d.value_scale * pbf_shape_value(kernel, params->scorr_dq));
  d.viscosity = pbf_viscosity_lattice_of(&d, dimension);
  pbf_derive_neighbors(dimension, &d);
  return d;
}

static inline pbf_derived pbf_derive(const pbf_params *params, uint32_t dimension) {
  const pbf_params from = pbf_params_to_derive_from(params);
  return pbf_derive_from(&from, dimension);
}

#endif
