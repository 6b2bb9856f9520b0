/* Viscosity as a fluid has it: pairs exchange momentum along the line between them, as fast as they
 * approach each other or part (Monaghan 2005, Smoothed particle hydrodynamics, section 4.2). So
 * angular momentum is conserved as linear momentum is, solid rotation, in which no pair does
 * either, is not damped, and what is damped in a time unit does not depend on the step. One stage
 * of viscosity_stages.h. */
#ifndef PBF_PHYSICS_PASSES_VISCOUS_STRESS_H
#define PBF_PHYSICS_PASSES_VISCOUS_STRESS_H

#include "physics/constants.h"
#include "physics/passes/pass.h"

namespace {

template <class Features>
struct viscous_stress_pass {
  enum { NUMBER = 0, VECTOR = 1 /* velocity */ };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    lane_vector<L> v;
  };
  template <class L>
  struct sums {
    L spread; /* V W r² */
    lane_vector<L> change;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(0), lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L value = kernel_value(features, c, j.r2);
    L parting = ops<L>::set(0);
    for (int k = 0; k < PBF_DIM; ++k)
      parting = ops<L>::multiply_add(j.vector.c[k] - i.v.c[k], j.x_ij.c[k], parting);
    s->spread = ops<L>::multiply_add(value, j.r2, s->spread);
    s->change.add_scaled(value * parting, j.x_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* The velocity after stage k, from that after stage k - 1 and k - 2. In crowds of more than twice
   * the rest density less is exchanged: the stages are stable up to there. */
  PBF_IN pbf_vec finish(const sums<pbf_real> &s, const pbf_viscosity_weights &w, pbf_vec v,
                        pbf_vec before) const {
    const pbf_real part = c->viscosity_max_spread / pbf_real_max(s.spread, c->viscosity_max_spread);
    pbf_vec next = {{0}};
    next = pbf_add_scaled(next, w.last, v);
    if (w.before < 0) next = pbf_add_scaled(next, w.before, before);
    return pbf_add_scaled(next, w.change * part, vec_of(s.change));
  }
};

}  // namespace

#endif
