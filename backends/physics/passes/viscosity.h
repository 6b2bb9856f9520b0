/* XSPH (eq. 17), and what else asks for the mean velocity around a particle. */
#ifndef PBF_PHYSICS_PASSES_VISCOSITY_H
#define PBF_PHYSICS_PASSES_VISCOSITY_H

#include "physics/passes/pass.h"
#include "physics/stages.h"

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
      s->sum.c[k] = ops<L>::fma(value, j.v.c[k] - i.v.c[k], s->sum.c[k]);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_real viscosity, pbf_vec v) const {
    return pbf_smooth(viscosity, v, vec_of(s.sum), s.weight);
  }
};

}  // namespace

#endif
