/* The vorticity around a particle (eq. 15). */
#ifndef PBF_PHYSICS_PASSES_CURL_H
#define PBF_PHYSICS_PASSES_CURL_H

#include "physics/passes/pass.h"

PBF_FN pbf_real pbf_curl_size(pbf_curl curl) {
  pbf_real sum = 0;
  for (int k = 0; k < PBF_CURL_DIM; ++k) sum += curl.c[k] * curl.c[k];
  return pbf_real_sqrt(sum);
}

namespace {

/* The curl of the velocity: the sum over the others of (v_j - v_i) x V grad_j W, where V grad_j W
 * is -slope (x_i - x_j). */
template <class Features>
struct curl_pass {
  enum { NUMBER = 0, VECTOR = 1 /* velocity */ };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    lane_vector<L> v;
  };
  template <class L>
  struct sums {
    L curl[PBF_CURL_DIM];
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s;
    for (int k = 0; k < PBF_CURL_DIM; ++k) s.curl[k] = ops<L>::set(0);
    return s;
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    add_cross(s->curl, kernel_slope(features, c, j.r2), j.x_ij, j.vector - i.v);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_curl finish(const sums<pbf_real> &s) const { return curl_of(s.curl); }
};

}  // namespace

#endif
