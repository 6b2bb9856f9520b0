/* Lines 9 to 11: the density constraint (eqs. 1 and 11), and lambda. */
#ifndef PBF_PHYSICS_PASSES_LAMBDA_H
#define PBF_PHYSICS_PASSES_LAMBDA_H

#include "physics/constants.h"
#include "physics/passes/pass.h"

/* Line 10, eqs. 1 and 11, from density = V sum W (the particle itself included), gradient = sum
 * over the others of V grad W, slope2 = sum over the others of |V grad W|². In a crowd the
 * eigenvalues of the iteration grow with the density, and a step that is to stay inside them has to
 * shrink with it. The error itself is not bounded: a crowd that pushes less the denser it is draws
 * in what is around it. `residual_density` is 0 or pbf_residual_density's. */
PBF_FN pbf_real pbf_lambda(const pbf_constants *c, pbf_real residual_density, pbf_real density,
                           pbf_real slope2, pbf_vec gradient) {
  pbf_real constraint = density - c->target - residual_density;
  pbf_real diagonal = slope2 + pbf_dot(gradient, gradient) + c->cfm;
  if (constraint < 0) constraint *= c->tension;
  if (constraint > 0 && constraint < c->rounding) constraint = 0;
  diagonal = pbf_real_max(diagonal, c->min_diagonal);
  if ((PBF_BUILT & PBF_FEATURE_CHEBYSHEV) && c->accelerated) diagonal *= pbf_real_max(density, 1);
  return -constraint / diagonal;
}

/* A particle's part of the density error that ends a solve, in units of 2^-24: the sum of integers
 * is the same in any order. Above 64, and what is no number, it counts as 64, and as nothing. */
PBF_FN int32_t pbf_error_units(const pbf_constants *c, pbf_real residual_density,
                               pbf_real density) {
  const pbf_real maximum = 64, unit = (pbf_real)(1 << 24);
  return (int32_t)(pbf_real_min(pbf_real_max(density - c->target - residual_density, 0), maximum) *
                   unit);
}

/* The part of a particle that does not solve, and so has no say in when the others have done. */
static inline int32_t pbf_inactive_error_units(const pbf_params *params) {
  return (int32_t)(fmin(params->tolerance, 64) * (1 << 24));
}

/* What the sum over all particles may be when the solve ends. */
static inline int64_t pbf_error_units_limit(const pbf_params *params, uint32_t count) {
  return (int64_t)fmin(params->tolerance * count * (1 << 24), 0x1p62);
}

/* One Chebyshev step: `lambda` is pbf_lambda's; *total is the lambda that has added up, *change
 * what the iteration adds to it and moves particles by (both 0 at the start of a step).
 *
 * Where fluid is pressed hard, the large forces of a particle's neighbours cancel, and what is left
 * when one is out of place grows like stiffness * |lambda|. So no iteration adds more than a few
 * parts of 1 / stiffness, at places where neighbours have moved by as much: momentum is kept to
 * rounding however hard. Nothing pulls, lambda > 0, but as pbf_set_tension says. */
PBF_FN void pbf_accelerate(const pbf_constants *c, pbf_real density, pbf_real lambda,
                           pbf_real *total, pbf_real *change) {
  const pbf_real crowd = (pbf_real)1.5;
  pbf_real maximum = c->max_change / pbf_real_max(density / crowd, 1);
  pbf_real add = (c->weight - 1) * *change + c->weight * c->step_size * lambda;
  add = pbf_real_max(pbf_real_min(add, maximum), -maximum);
  pbf_real next = *total + add;
  next = pbf_real_min(next, density > c->tension_min_density ? c->max_tension : 0);
  *change = next - *total;
  *total = next;
}

/* Pressure over rest density of a step, from the lambda that has added up. A step moves a pair by
 * V (lambda_i + lambda_j) grad W: forces, once divided by dt², of which a plane through the rest
 * lattice transmits -pbf_derived.pressure * lambda / dt² an area (the virial; for a wide kernel the
 * factor is 1). `scale` is that factor over dt², or 0 with no step to speak of. */
PBF_FN pbf_real pbf_pressure(pbf_real scale, pbf_real total) {
  return scale > 0 ? 0 - scale * total : 0;
}

namespace {

template <class L>
struct lambda_sums {
  L density, slope2;
  lane_vector<L> gradient;
};

template <class Features, scaling SCALING>
struct lambda_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  using sums = lambda_sums<L>;

  PBF_IN pbf_real value_scale() const { return SCALING == SCALED_SUMS ? 1 : c->value_scale; }
  PBF_IN pbf_real slope_scale() const {
    return SCALING == SCALED_SUMS ? 1 : pbf_slope_scale(features, c);
  }

  /* The particle itself is part of its density. */
  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(value_scale()), ops<L>::set(0), lane_vector<L>::zero()};
  }

  /* Returns the pair's kernel, of which a driver may have another use. */
  template <class L, class Weight = unweighted>
  PBF_IN pair_kernel<L> pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j,
                             Weight weight = {}) const {
    L value, slope;
    kernel_and_slope(features, c, value_scale(), slope_scale(), j.r2, &value, &slope);
    s->density = s->density + weight * value;
    s->slope2 = ops<L>::multiply_add(weight * slope * j.r2, slope, s->slope2);
    s->gradient.add_scaled(weight * slope, j.x_ij);
    return {value, slope};
  }

  template <class L>
  PBF_IN void end(sums<L> *s) const {
    if (SCALING == SCALED_PAIRS) return;
    const L scale = ops<L>::set(pbf_slope_scale(features, c));
    s->density = s->density * ops<L>::set(c->value_scale);
    s->slope2 = s->slope2 * scale * scale;
    s->gradient.scale(scale);
  }

  PBF_IN pbf_real finish(const sums<pbf_real> &s, pbf_real residual_density) const {
    return pbf_lambda(c, residual_density, s.density, s.slope2, vec_of(s.gradient));
  }
};

}  // namespace

#endif
