/* rho/rho0 at a particle (eq. 2), V sum W with the particle itself: for statistics; at the start of
 * very short steps, which leave a part of its error; and where the pressure grid sums errors up
 * (pressure_grid/grid.h). Walls and colliders add theirs. */
#ifndef PBF_PHYSICS_PASSES_DENSITY_H
#define PBF_PHYSICS_PASSES_DENSITY_H

#include "physics/passes/pass.h"

namespace {

template <class Features>
struct density_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L density;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(c->value_scale)};
  }

  template <class L, class Weight = unweighted>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j, Weight weight = {}) const {
    s->density = s->density + weight * kernel_value(features, c, j.r2);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}
};

}  // namespace

/* What a step leaves of the density error at its start. */
PBF_FN pbf_real pbf_residual_density(const pbf_constants *c, pbf_real density) {
  pbf_real error = pbf_real_max(density - c->target, 0);
  return pbf_real_max(c->residual_density * error, c->max_residual_part * error - c->max_undone);
}

#endif
