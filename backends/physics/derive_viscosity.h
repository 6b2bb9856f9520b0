/* The weights of passes/viscous_stress.h: such that they are as viscous in all directions of the
 * rest lattice, and before a wall. Host only, float64. */
#ifndef PBF_PHYSICS_DERIVE_VISCOSITY_H
#define PBF_PHYSICS_DERIVE_VISCOSITY_H

#include "physics/derived.h"
#include "physics/rest_lattice.h"

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

#endif
