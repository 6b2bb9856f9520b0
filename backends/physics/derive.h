/* What follows from the parameters before any particle is looked at: the kernels' normalisation,
 * the rest volume, the relaxation. Host only, float64. */
#ifndef PBF_PHYSICS_DERIVE_H
#define PBF_PHYSICS_DERIVE_H

#include <string.h>

#include "physics/capillary.h"
#include "physics/derive_viscosity.h"
#include "physics/derive_walls.h"
#include "physics/spacing.h"

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
