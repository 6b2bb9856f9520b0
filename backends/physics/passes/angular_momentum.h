/* Conservation of angular momentum: gives back what pushes lack of it (torque.h), less what
 * damping_compensation.h has given back already.
 *
 * Each particle rotates the pairs around it. The rate follows from their moments of inertia, so
 * that they get the particle's part of the torque deficit: inertia * rate = torque. A pair gets the
 * velocity of the sum of its particles' rates, opposite and equal for the two, so linear momentum
 * is conserved, too. Only velocities change. */
#ifndef PBF_PHYSICS_PASSES_ANGULAR_MOMENTUM_H
#define PBF_PHYSICS_PASSES_ANGULAR_MOMENTUM_H

#include "physics/constants.h"
#include "physics/passes/pass.h"

namespace {

/* Of a pair, in the moments of inertia and in the velocity: (1 - r²/h²)². */
template <class L>
PBF_FN L rotation_weight(const pbf_constants *c, L r2) {
  const L near = ramp(r2, ops<L>::set(-c->inv_h2));
  return near * near;
}

/* The rate of rotation of pairs with these sums of weight x_k x_m that gives them a torque: in
 * three dimensions (trace - moments) rate = torque, by Cramer's rule. A pair alone cannot be
 * rotated about its own axis: a few roundings are added to the diagonal. */
PBF_FN_HOST_NOINLINE pbf_curl rotation_rate(const pbf_real moments[PBF_MOMENTS], pbf_curl torque) {
  pbf_curl rate = {{0}};
#if PBF_DIM == 2
  pbf_real inertia = moments[0] + moments[2];
  if (inertia > 0) rate.c[0] = torque.c[0] / inertia;
#else
  pbf_real trace = moments[0] + moments[2] + moments[5];
  if (!(trace > 0)) return rate;
  const pbf_real regularization = (pbf_real)(sizeof(pbf_real) == sizeof(float) ? 1e-6 : 1e-13);
  pbf_real per = 1 / trace, own = 1 + regularization;
  pbf_real xx = own - per * moments[0], yy = own - per * moments[2], zz = own - per * moments[5];
  pbf_real xy = -per * moments[1], xz = -per * moments[3], yz = -per * moments[4];
  pbf_real ax = yy * zz - yz * yz, ay = xz * yz - xy * zz, az = xy * yz - xz * yy;
  pbf_real scale = per / (xx * ax + xy * ay + xz * az);
  pbf_real bx = torque.c[0], by = torque.c[1], bz = torque.c[2];
  rate.c[0] = scale * (ax * bx + ay * by + az * bz);
  rate.c[1] = scale * (ay * bx + (xx * zz - xz * xz) * by + (xy * xz - xx * yz) * bz);
  rate.c[2] = scale * (az * bx + (xy * xz - xx * yz) * by + (xx * yy - xy * xy) * bz);
#endif
  return rate;
}

/* How fast the pairs around a particle are to rotate. */
struct rotation_rate_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L moments[PBF_MOMENTS]; /* xx, xy, yy, xz, yz, zz */
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s;
    for (int k = 0; k < PBF_MOMENTS; ++k) s.moments[k] = ops<L>::set(0);
    return s;
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j) const {
    const L weight = rotation_weight(c, j.r2);
    for (int k = 0, entry = 0; k < PBF_DIM; ++k)
      for (int m = 0; m <= k; ++m, ++entry)
        s->moments[entry] =
            ops<L>::multiply_add(weight * j.x_ij.c[k], j.x_ij.c[m], s->moments[entry]);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* `torque`: the deficit. In two dimensions the rate is the vector's first component. */
  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_curl torque) const {
    pbf_vec rate = {{0}};
    for (int k = 0; k < PBF_CURL_DIM; ++k) torque.c[k] *= c->torque_part;
    torque = rotation_rate(s.moments, torque);
    for (int k = 0; k < PBF_CURL_DIM; ++k) rate.c[k] = torque.c[k];
    return rate;
  }
};

/* The velocity that this gives it. */
struct rotation_pass {
  enum { NUMBER = 0, VECTOR = 1 /* rate of rotation */ };
  const pbf_constants *c;

  template <class L>
  struct own {
    lane_vector<L> rate;
  };
  template <class L>
  struct sums {
    lane_vector<L> velocity;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  /* weight (rate_i + rate_j) x x_ij */
  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L weight = rotation_weight(c, j.r2);
    lane_vector<L> rate;
    for (int k = 0; k < PBF_DIM; ++k) rate.c[k] = i.rate.c[k] + j.vector.c[k];
    if constexpr (PBF_DIM == 3) {
      add_cross(s->velocity.c, weight, rate, j.x_ij);
    } else {
      s->velocity.c[0] = s->velocity.c[0] - weight * rate.c[0] * j.x_ij.c[1];
      s->velocity.c[1] = s->velocity.c[1] + weight * rate.c[0] * j.x_ij.c[0];
    }
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_vec v, pbf_real mobility = 1) const {
    return pbf_add_scaled(v, mobility, vec_of(s.velocity));
  }
};

}  // namespace

#endif
