/* Lines 12 to 14 (eqs. 12 to 14): an iteration's move, and the velocity that explains it. */
#ifndef PBF_PHYSICS_PASSES_MOVE_H
#define PBF_PHYSICS_PASSES_MOVE_H

#include "physics/constants.h"
#include "physics/passes/pass.h"

/* Factor on V grad W in the position change (line 13, eqs. 12 and 14) is
 * lambda_i + lambda_j + s_ij; `sum` is the sum of these products over the others. Where lambda adds
 * up it is the iteration's change of it that counts. */
PBF_FN pbf_vec pbf_move(const pbf_constants *c, pbf_vec x, pbf_vec sum) {
  return pbf_add_scaled(x, c->omega, sum);
}

/* Line 21, a move at a time: the velocity that explains it. Dividing x* - x by the time step would
 * round away what a particle does not move in a step, and turn what positions round into speed. */
PBF_FN pbf_vec pbf_push(const pbf_constants *c, pbf_real inv_time_step, pbf_vec velocity,
                        pbf_vec sum) {
  return pbf_add_scaled(velocity, inv_time_step * c->omega, sum);
}

/* A particle that is pressed and yet not moved along an axis, to the last bit, is held by symmetry
 * alone: no pair in a line or plane of particles, or at one point, pushes across it, so that they
 * would stay there however dense. It goes the least way of its own, by its `id`, of which pressure
 * makes more; its velocity does not change. So does along all axes what has been placed in others,
 * `overlaps`: particles at one point are pushed alike by those around them. */
PBF_FN pbf_vec pbf_break_symmetry(const pbf_constants *c, pbf_real lambda, bool overlaps,
                                  pbf_vec change, uint32_t id, pbf_vec x) {
  const uint32_t hash = (id + 1) * 2654435761u; /* Knuth's multiplicative hash */
  if (!(lambda < 0)) return x;
  for (int k = 0; k < PBF_DIM; ++k) {
    const bool is_moved = change.c[k] < 0 || change.c[k] > 0;
    if (is_moved && !overlaps) continue; /* nearly always */
    const pbf_real part = ((pbf_real)(hash >> 8 * k & 255) - (pbf_real)127.5) / (pbf_real)127.5;
    const pbf_real offset = c->symmetry_offset + 2 * pbf_last_bit(x.c[k]);
    x.c[k] += part * offset;
  }
  return x;
}

namespace {

template <class L>
struct move_sums {
  lane_vector<L> change;
};

template <class Features, scaling SCALING>
struct move_pass_of {
  enum { NUMBER = 1 /* lambda */, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    L lambda;
  };
  template <class L>
  using sums = move_sums<L>;

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  template <class L, class Weight = unweighted>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j, Weight weight = {}) const {
    L value, slope, lambdas = i.lambda + j.number;
    kernel_and_slope(features, c, c->value_scale,
                     SCALING == SCALED_SUMS ? 1 : pbf_slope_scale(features, c), j.r2, &value,
                     &slope);
    if (features & PBF_FEATURE_SCORR) lambdas = lambdas + artificial_pressure(c, value);
    s->change.add_scaled(weight * lambdas * slope, j.x_ij);
  }

  /* pair() in two parts, for a driver that keeps V grad W until lambda is known. */
  template <class L>
  PBF_IN void add_artificial_pressure(sums<L> *s, L value, const lane_vector<L> &gradient) const {
    if (features & PBF_FEATURE_SCORR) s->change.add_scaled(artificial_pressure(c, value), gradient);
  }
  template <class L>
  PBF_IN void add_lambdas(sums<L> *s, L lambdas, const lane_vector<L> &gradient) const {
    s->change.add_scaled(lambdas, gradient);
  }

  template <class L>
  PBF_IN void end(sums<L> *s) const {
    if (SCALING == SCALED_SUMS) s->change.scale(ops<L>::set(pbf_slope_scale(features, c)));
  }

  /* Where x goes, once walls have had their say in the change; and its velocity. */
  template <class L>
  PBF_IN void finish(const sums<L> &s, pbf_real inv_time_step, lane_vector<L> *x,
                     lane_vector<L> *v) const {
    const L omega = ops<L>::set(c->omega), push = ops<L>::set(inv_time_step * c->omega);
    for (int k = 0; k < PBF_DIM; ++k) {
      x->c[k] = ops<L>::multiply_add(omega, s.change.c[k], x->c[k]);
      v->c[k] = ops<L>::multiply_add(push, s.change.c[k], v->c[k]);
    }
  }
};

}  // namespace

#endif
