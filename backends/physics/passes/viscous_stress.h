/* Viscosity as a fluid has it: pairs exchange momentum along the line between them, as fast as they
 * approach each other or part (Monaghan 2005, Smoothed particle hydrodynamics, section 4.2). So
 * angular momentum is conserved as linear momentum is, and solid rotation, in which no pair does
 * either, is not damped. Implicit, as in Weiler et al. 2018: one stage of viscosity_stages.h. */
#ifndef PBF_PHYSICS_PASSES_VISCOUS_STRESS_H
#define PBF_PHYSICS_PASSES_VISCOUS_STRESS_H

#include "physics/no_slip.h"
#include "physics/passes/pass.h"

namespace {

/* u (1 - a + a (u² + u³) / 2), u = 1 - r/h. On the rest lattice the fourth moments are isotropic
 * with the a of derive.h, so that shear along its axes is resisted as any other is, and where shear
 * has rearranged the fluid they are within 3 % of that. With a density kernel shear is resisted by
 * a third less at h = 2 spacings. */
template <class L>
PBF_FN L viscous_weight(const pbf_constants *c, L r2) {
  const L u = closeness(c, ops<L>::sqrt(r2)),
          steep = ops<L>::set((pbf_real)0.5 * c->viscosity_falloff);
  return u * ops<L>::multiply_add(u * u * steep, u + ops<L>::set(1),
                                  ops<L>::set(1 - c->viscosity_falloff));
}

struct viscous_stress_pass {
  enum { NUMBER = 0, VECTOR = 1 /* velocity */ };
  const pbf_constants *c;

  template <class L>
  struct own {
    lane_vector<L> v;
  };
  template <class L>
  struct sums {
    lane_vector<L> change;
    L block[PBF_SYMMETRIC_DIM]; /* what a particle's own velocity does to the change, but the sign
                                 */
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s;
    s.change = lane_vector<L>::zero();
    for (int k = 0; k < PBF_SYMMETRIC_DIM; ++k) s.block[k] = ops<L>::set(0);
    return s;
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L weight = viscous_weight(c, j.r2);
    L parting = ops<L>::set(0);
    for (int k = 0; k < PBF_DIM; ++k)
      parting = ops<L>::multiply_add(j.vector.c[k] - i.v.c[k], j.x_ij.c[k], parting);
    s->change.add_scaled(weight * parting, j.x_ij);
    for (int k = 0; k < PBF_DIM; ++k) {
      const L along = weight * j.x_ij.c[k];
      for (int l = 0; l <= k; ++l) {
        L *entry = &s->block[pbf_symmetric_entry(k, l)];
        *entry = ops<L>::multiply_add(along, j.x_ij.c[l], *entry);
      }
    }
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* The system at a particle: the residual of v, and a multiple of the unit matrix that is not less
   * than the block (its rows' sums are not, after Gershgorin). It is the same for all particles but
   * those in crowds: what pairs exchange is then conserved in each stage, converged or not. */
  PBF_IN pbf_viscous_system system(const sums<pbf_real> &s, pbf_vec v, pbf_vec start) const {
    pbf_viscous_system system;
    system.residual = pbf_add_scaled(pbf_sub(start, v), c->viscosity_step, vec_of(s.change));
    pbf_real most = 0;
    for (int k = 0; k < PBF_DIM; ++k) {
      pbf_real row = 0;
      for (int l = 0; l < PBF_DIM; ++l) {
        const pbf_real entry =
            s.block[l <= k ? pbf_symmetric_entry(k, l) : pbf_symmetric_entry(l, k)];
        row += pbf_real_max(entry, -entry);
      }
      most = pbf_real_max(most, row);
    }
    most = most * pbf_real_max(most * c->viscosity_inv_max_spread, 1);
    for (int k = 0; k < PBF_DIM; ++k)
      for (int l = 0; l <= k; ++l)
        system.block[pbf_symmetric_entry(k, l)] =
            k == l ? 1 + c->viscosity_step * pbf_real_max(most, c->viscosity_min_spread) : 0;
    return system;
  }

  /* The velocity after a stage, from that before it and the one before that. Where no solid has
   * added to it the block is a multiple of the unit matrix. */
  PBF_IN pbf_vec finish(const pbf_viscous_system &system, int with_solids,
                        const pbf_viscosity_weights &w, pbf_vec v, pbf_vec before) const {
    pbf_vec next = with_solids ? pbf_add_scaled(v, w.residual, pbf_viscous_step(system))
                               : pbf_add_scaled(v, w.residual / system.block[0], system.residual);
    if (w.before > 0) next = pbf_add_scaled(next, w.before, pbf_sub(v, before));
    return next;
  }
};

}  // namespace

#endif
