/* Vorticity confinement (eq. 16). */
#ifndef PBF_PHYSICS_PASSES_CONFINEMENT_H
#define PBF_PHYSICS_PASSES_CONFINEMENT_H

#include "physics/passes/pass.h"

/* The change of the velocity: dt e (N x curl), N = eta/|eta|. `dt_strength` is dt e. */
PBF_FN pbf_vec pbf_confine(pbf_real dt_strength, pbf_vec eta, pbf_curl curl) {
  pbf_real size = pbf_real_sqrt(pbf_dot(eta, eta));
  pbf_real s = size > 0 ? dt_strength / size : 0;
  pbf_vec dv;
#if PBF_DIM == 3
  dv.c[0] = s * (eta.c[1] * curl.c[2] - eta.c[2] * curl.c[1]);
  dv.c[1] = s * (eta.c[2] * curl.c[0] - eta.c[0] * curl.c[2]);
  dv.c[2] = s * (eta.c[0] * curl.c[1] - eta.c[1] * curl.c[0]);
#else
  dv.c[0] = s * eta.c[1] * curl.c[0];
  dv.c[1] = -s * eta.c[0] * curl.c[0];
#endif
  return dv;
}

namespace {

/* eta is the gradient of |curl|: the sum over the others of |curl|_j V grad_i W. */
template <class Features>
struct confinement_pass {
  enum { NUMBER = 1 /* size of the curl */, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    lane_vector<L> eta;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j) const {
    s->eta.add_scaled(j.number * kernel_slope(features, c, j.r2), j.x_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_curl curl, pbf_vec v) const {
    return pbf_add_scaled(v, 1, pbf_confine(c->confinement, vec_of(s.eta), curl));
  }
};

}  // namespace

#endif
