/* XSPH (eq. 17), and what else asks for the mean velocity around a particle. */
#ifndef PBF_PHYSICS_PASSES_VISCOSITY_H
#define PBF_PHYSICS_PASSES_VISCOSITY_H

#include "physics/constants.h"
#include "physics/passes/pass.h"

/* A viscosity that leads to the mean velocity of the others. */
#define PBF_TO_MEAN ((pbf_real)1e30)

/* XSPH (eq. 17): v, and of `sum`, that of V W (v_j - v) over the others, as much as `viscosity`
 * says, but no more than leads to their mean: with `weight`, the sum of V W, which is below 1 but
 * in crowds. So no velocity ends beyond all of those around it, however viscous and dense. */
PBF_FN pbf_vec pbf_smooth(pbf_real viscosity, pbf_vec v, pbf_vec sum, pbf_real weight) {
  const pbf_real tiny = (pbf_real)1e-20;
  return pbf_add_scaled(v, pbf_real_min(viscosity, 1 / pbf_real_max(weight, tiny)), sum);
}

namespace {

template <class Features>
struct viscosity_pass {
  enum { NUMBER = 0, VECTOR = 1 /* velocity */ };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    lane_vector<L> v;
  };
  template <class L>
  struct sums {
    L weight;
    lane_vector<L> sum;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(0), lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L value = kernel_value(features, c, j.r2);
    s->weight = s->weight + value;
    for (int k = 0; k < PBF_DIM; ++k)
      s->sum.c[k] = ops<L>::multiply_add(value, j.vector.c[k] - i.v.c[k], s->sum.c[k]);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_real viscosity, pbf_vec v) const {
    return pbf_smooth(viscosity, v, vec_of(s.sum), s.weight);
  }
};

}  // namespace

#endif
