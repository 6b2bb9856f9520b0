/* How far a push of a particle's constraint goes, over what it does where all have the reference's
 * mass: what lambda is divided by, where phases differ. Of the sum in eq. 11 each neighbour's part
 * is by its mobility, and of the particle's own part no more than its own. */
#ifndef PBF_PHYSICS_PASSES_MOBILITY_H
#define PBF_PHYSICS_PASSES_MOBILITY_H

#include "physics/passes/lambda.h"

namespace {

template <class Features>
struct mobility_pass {
  enum { NUMBER = 1 /* mobility */, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L density; /* times numbers, where that is asked for: placed_density_pass */
    L slope2, mobile;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(0), ops<L>::set(0), ops<L>::set(0)};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j) const {
    L value, slope;
    kernel_and_slope(features, c, j.r2, &value, &slope);
    const L slope2 = slope * j.r2 * slope;
    s->density = ops<L>::multiply_add(value, j.number, s->density);
    s->slope2 = s->slope2 + slope2;
    s->mobile = ops<L>::multiply_add(slope2, j.number, s->mobile);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_real finish(const sums<pbf_real> &s, pbf_real mobility) const {
    return s.slope2 > 0 ? pbf_real_max(mobility, s.mobile / s.slope2) : mobility;
  }
};

/* Lambda's sums, and these of neighbours, in one loop; ghosts have no part in mobilities. */
template <class L>
struct mobile_lambda_sums {
  lambda_sums<L> lambda;
  L slope2, mobile; /* of mobility_pass */
};

template <class Features, scaling SCALING>
struct mobile_lambda_pass {
  enum { NUMBER = 1 /* mobility */, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    L mobility;
  };
  template <class L>
  using sums = mobile_lambda_sums<L>;

  PBF_IN lambda_pass<Features, SCALING> of_lambda() const { return {c, features}; }

  template <class L>
  PBF_IN sums<L> begin() const {
    return {of_lambda().template begin<L>(), ops<L>::set(0), ops<L>::set(0)};
  }

  template <class L, class Weight = unweighted>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j, Weight weight = {}) const {
    const pair_kernel<L> kernel = of_lambda().pair(&s->lambda, {}, j, weight);
    if constexpr (!is_of_ghosts<Weight>::value) {
      const L slope2 = kernel.slope * j.r2 * kernel.slope;
      s->slope2 = s->slope2 + slope2;
      s->mobile = ops<L>::multiply_add(slope2, j.number, s->mobile);
    }
  }

  template <class L>
  PBF_IN void end(sums<L> *s) const {
    of_lambda().end(&s->lambda);
  }
};

}  // namespace

/* From a lambda in which neighbours have the reference's mass. */
PBF_FN pbf_real pbf_lambda_for(pbf_real mobility, pbf_real lambda) { return lambda / mobility; }

/* pbf_accelerate, its bounds being those of what particles are moved by. */
PBF_FN void pbf_accelerate_for(const pbf_constants *c, pbf_real mobility, pbf_real density,
                               pbf_real lambda, pbf_real *total, pbf_real *change) {
  *total *= mobility;
  *change *= mobility;
  pbf_accelerate(c, density, lambda, total, change);
  *total /= mobility;
  *change /= mobility;
}

#endif
