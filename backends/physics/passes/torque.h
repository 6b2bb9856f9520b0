/* The torque deficit: what pushes of a step lack of angular momentum, which angular_momentum.h
 * gives back.
 *
 * A step conserves angular momentum if the two particles of a pair push each other along the line
 * between their positions at the step's start: the torque of a push p is x_ij x p with that x_ij.
 * An iteration pushes along the line between the positions x* that it works on. With the factor
 * (lambda_i + lambda_j + s_ij) V slope of eqs. 12 to 14, p = factor x*_ij, a pair gains the angular
 * momentum x_ij x p that it should not, and lacks factor x*_ij x x_ij. The sums hold it for the
 * pair as a whole, so that either particle answers for half of them. They add up over the
 * iterations of a step. Pushes of walls, colliders and ghosts are external: their torque stays. */
#ifndef PBF_PHYSICS_PASSES_TORQUE_H
#define PBF_PHYSICS_PASSES_TORQUE_H

#include "physics/constants.h"
#include "physics/passes/pass.h"

namespace {

template <class Features>
struct torque_pass {
  enum { NUMBER = 1 /* lambda */, VECTOR = 1 /* position at the start of the step */ };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    L lambda;
    lane_vector<L> start;
  };
  template <class L>
  struct sums {
    L torque[PBF_CURL_DIM];
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s;
    for (int k = 0; k < PBF_CURL_DIM; ++k) s.torque[k] = ops<L>::set(0);
    return s;
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const lane_vector<L> start_ij = i.start - j.vector;
    L value, slope, lambdas = i.lambda + j.number;
    kernel_and_slope(features, c, j.r2, &value, &slope);
    if (features & PBF_FEATURE_SCORR) lambdas = lambdas + artificial_pressure(c, value);
    add_cross(s->torque, lambdas * slope, j.x_ij, start_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}
};

}  // namespace

#endif
