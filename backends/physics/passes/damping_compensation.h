/* Compensation of the damping that long steps cause, once a step is solved.
 *
 * A step pushes the particles of a pair along the line between them at its end, x*, which is
 * implicit Euler. That damps the motion of single particles, without which a few iterations of a
 * constraint would leave noise, but it damps the motion of the fluid, too: fluid that rotates at
 * the rate w loses w² dt of its angular momentum in a time unit. Pushes along the line at the
 * step's start, as in SHAKE (Ryckaert, Ciccotti and Berendsen 1977), would conserve both. So
 * velocities, not positions, get the difference between a push at the start and the same push at
 * the end.
 *
 * The start of a pair is not where its particles were, but where the mean flow around them had
 * them. The mean flow at a particle leaves out its own velocity: with narrow kernels, of which that
 * would be the largest part, the noise of single particles would come back, and impacts would gain
 * energy. The difference is opposite and equal for the two of a pair, so linear momentum is
 * conserved. Where the flow moves the two relative to each other by more than a tenth of h in a
 * step, ever less of it is compensated: such a flow is not resolved. */
#ifndef PBF_PHYSICS_PASSES_DAMPING_COMPENSATION_H
#define PBF_PHYSICS_PASSES_DAMPING_COMPENSATION_H

#include "physics/boundary.h"
#include "physics/passes/move.h"

namespace {

/* With PBF_FEATURE_TORQUE among the features it sums up the torque that it exerts. */
template <class Features>
struct damping_compensation_pass {
  enum { NUMBER = 1 /* lambda of the step */, VECTOR = 1 /* mean flow */ };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    L lambda;
    lane_vector<L> flow;
  };
  template <class L>
  struct sums {
    lane_vector<L> end, start; /* pushes as they are at the step's end and its start */
    L torque[PBF_CURL_DIM];    /* of the latter, for both particles of each pair */
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s = {lane_vector<L>::zero(), lane_vector<L>::zero(), {}};
    for (int k = 0; k < PBF_CURL_DIM; ++k) s.torque[k] = ops<L>::set(0);
    return s;
  }

  /* Adds `lambdas` V grad W at x; returns its factor on x. */
  template <class L>
  PBF_IN L add_push(lane_vector<L> *sum, L lambdas, const lane_vector<L> &x, L r2) const {
    const L push = lambdas * kernel_slope(features, c, r2);
    sum->add_scaled(push, x);
    return push;
  }

  /* A pair that does not push at the end, beyond h, where `within` is 0, does not at the start. */
  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L time = ops<L>::set(c->flow_time), most2 = ops<L>::set(c->max_mean_flow2);
    const L near = ramp(j.r2, ops<L>::set(-c->inv_h2));
    const L within = -ops<L>::max(near * ops<L>::set((pbf_real)-1e6), ops<L>::set(-1));
    const L lambdas = (i.lambda + j.number) * within;
    const lane_vector<L> flow_ij = i.flow - j.vector;
    L way2 = ops<L>::set(0), r2 = ops<L>::set(0);
    for (int k = 0; k < PBF_DIM; ++k)
      way2 = ops<L>::multiply_add(time * flow_ij.c[k], time * flow_ij.c[k], way2);
    const L root = ops<L>::over_root(ops<L>::set(1), way2 + most2),
            back = time * (most2 * root * root);
    lane_vector<L> start;
    for (int k = 0; k < PBF_DIM; ++k) {
      start.c[k] = j.x_ij.c[k] - back * flow_ij.c[k];
      r2 = ops<L>::multiply_add(start.c[k], start.c[k], r2);
    }
    add_push(&s->end, lambdas, j.x_ij, j.r2);
    const L push = add_push(&s->start, lambdas, start, r2);
    if (features & PBF_FEATURE_TORQUE) add_cross(s->torque, push, j.x_ij, start);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* The change of the sum of a particle's pushes, away from obstacles. */
  PBF_IN pbf_vec change(const sums<pbf_real> &s) const {
    return pbf_sub(vec_of(s.start), vec_of(s.end));
  }

  /* Its velocity, from that. */
  PBF_IN pbf_vec finish(pbf_real inv_time_step, pbf_vec v, pbf_vec change) const {
    return pbf_push(c, inv_time_step, v, change);
  }
};

/* `to` with the length of `from`; `from` where that is a thousand times as long: `to` is at the end
 * of a wall's reach, where rounding makes its direction and the division overflows. */
PBF_FN pbf_vec redirected(pbf_vec from, pbf_vec to) {
  const pbf_vec none = {{0}};
  const pbf_real from2 = pbf_dot(from, from), to2 = pbf_dot(to, to);
  if (!(to2 > (pbf_real)1e-6 * from2)) return from;
  return pbf_add_scaled(none, pbf_real_sqrt(from2 / to2), to);
}

/* The change of the pushes of a particle at x near obstacles that contribute density, from its sums
 * over pairs. What obstacles push with is redirected as it was at the step's start, where the mean
 * flow had the particle and the colliders were; the domain's walls do not rotate. Beyond the reach
 * of all obstacles at the end nothing is redirected. */
template <class Obstacles>
PBF_FN pbf_vec change_near_obstacles(const pbf_constants *c, const Obstacles &o, pbf_vec x,
                                     pbf_vec flow, pbf_real lambda, pbf_vec end, pbf_vec start) {
  pbf_boundary boundary = pbf_boundary_at_time(c, o, x, x, 0);
  if (!(boundary.rest > 0)) return pbf_sub(start, end);
  pbf_vec gradient = pbf_boundary_gradient(&boundary);
  end = pbf_boundary_correction(end, lambda, boundary.rest, gradient);
  if (pbf_surface_count(o) > 0) {
    const pbf_vec at = pbf_add_scaled(x, -c->flow_time, flow);
    boundary = pbf_boundary_at_time(c, o, x, at, 1);
    gradient = redirected(gradient, pbf_boundary_gradient(&boundary));
  }
  start = pbf_boundary_correction(start, lambda, boundary.rest, gradient);
  return pbf_sub(start, end);
}

}  // namespace

#endif
