/* Lines 9 to 11: the density constraint (eqs. 1 and 11), and lambda. */
#ifndef PBF_PHYSICS_PASSES_LAMBDA_H
#define PBF_PHYSICS_PASSES_LAMBDA_H

#include "physics/passes/pass.h"
#include "physics/stages.h"

namespace {

template <class Features, scaling SCALING>
struct lambda_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L density, slope2;
    lane_vector<L> gradient;
  };

  PBF_IN pbf_real value_scale() const { return SCALING == SCALED_SUMS ? 1 : c->value_scale; }
  PBF_IN pbf_real slope_scale() const {
    return SCALING == SCALED_SUMS ? 1 : pbf_slope_scale(features, c);
  }

  /* The particle itself is part of its density. */
  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(value_scale()), ops<L>::set(0), lane_vector<L>::zero()};
  }

  template <class L, class Weight = unweighted>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j, Weight weight = {}) const {
    L value, slope;
    kernel_and_slope(features, c, value_scale(), slope_scale(), j.r2, &value, &slope);
    s->density = s->density + weight * value;
    s->slope2 = ops<L>::fma(weight * slope * j.r2, slope, s->slope2);
    s->gradient.add_scaled(weight * slope, j.x_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *s) const {
    if (SCALING == SCALED_PAIRS) return;
    const L scale = ops<L>::set(pbf_slope_scale(features, c));
    s->density = s->density * ops<L>::set(c->value_scale);
    s->slope2 = s->slope2 * scale * scale;
    s->gradient.scale(scale);
  }

  PBF_IN pbf_real finish(const sums<pbf_real> &s, pbf_real slack) const {
    return pbf_lambda(c, slack, s.density, s.slope2, vec_of(s.gradient));
  }
};

}  // namespace

#endif
