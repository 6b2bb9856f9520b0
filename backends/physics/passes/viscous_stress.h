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

/* What pairs make of a particle's own velocity, the block of it: the sum of w x x. Where particles
 * are crowded it is larger than the solve is for, and so much of the viscosity of pairs is left out
 * that it is not. It is left out of a pair as a whole, for both of its particles: so what they
 * exchange is conserved. */
struct crowding_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L block[PBF_SYMMETRIC_DIM];
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s;
    for (int k = 0; k < PBF_SYMMETRIC_DIM; ++k) s.block[k] = ops<L>::set(0);
    return s;
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j) const {
    const L weight = viscous_weight(c, j.r2);
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

  /* The part of the viscosity that is left out. No eigenvalue is farther from their mean than this
   * times the size of the deviator, in 2D exactly. All over the most that the solve is for, so that
   * squares hold in any units. */
  PBF_IN pbf_real finish(const sums<pbf_real> &s) const {
    const pbf_real per_most = 1 / c->viscosity_max_spread;
    pbf_real mean = 0, deviator2 = 0;
    for (int k = 0; k < PBF_DIM; ++k)
      mean += per_most * s.block[pbf_symmetric_entry(k, k)] / PBF_DIM;
    for (int k = 0; k < PBF_DIM; ++k)
      for (int l = 0; l <= k; ++l) {
        const pbf_real entry = per_most * s.block[pbf_symmetric_entry(k, l)] - (k == l ? mean : 0);
        deviator2 += (k == l ? 1 : 2) * (entry * entry);
      }
    const pbf_real most = mean + pbf_real_sqrt((pbf_real)((PBF_DIM - 1.0) / PBF_DIM) * deviator2);
    return most > 1 ? 1 - 1 / most : 0;
  }
};

/* A stage: of the velocities, and then of what they change by. */
struct viscous_stress_pass {
  enum { NUMBER = 1 /* what crowding leaves out */, VECTOR = 1 /* velocity */ };
  const pbf_constants *c;

  template <class L>
  struct own {
    L left_out;
    lane_vector<L> v;
  };
  template <class L>
  struct sums {
    lane_vector<L> change;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L part = ops<L>::set(1) - ops<L>::max(i.left_out, j.number);
    L parting = ops<L>::set(0);
    for (int k = 0; k < PBF_DIM; ++k)
      parting = ops<L>::multiply_add(j.vector.c[k] - i.v.c[k], j.x_ij.c[k], parting);
    s->change.add_scaled(viscous_weight(c, j.r2) * part * parting, j.x_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* The system at a particle: `rest` and what pairs do are what is left of it. The multiple of the
   * unit matrix is the same for all: what pairs exchange is then conserved in each stage, converged
   * or not. `scale` is pbf_viscous_scale's where phases differ. */
  PBF_IN pbf_viscous_system system(const sums<pbf_real> &s, pbf_vec rest,
                                   pbf_real scale = 1) const {
    pbf_viscous_system system;
    system.residual = pbf_add_scaled(rest, c->viscosity_step * scale, vec_of(s.change));
    for (int k = 0; k < PBF_DIM; ++k)
      for (int l = 0; l <= k; ++l)
        system.block[pbf_symmetric_entry(k, l)] = k == l ? c->viscosity_diagonal : 0;
    return system;
  }

  /* The change after a stage, from that before it and the one before that. Where no solid has added
   * to it the block is a multiple of the unit matrix. */
  PBF_IN pbf_vec finish(const pbf_viscous_system &system, int with_solids,
                        const pbf_viscosity_weights &w, pbf_vec change, pbf_vec before) const {
    pbf_vec next =
        with_solids ? pbf_add_scaled(change, w.residual, pbf_viscous_step(system))
                    : pbf_add_scaled(change, w.residual / c->viscosity_diagonal, system.residual);
    if (w.before > 0) next = pbf_add_scaled(next, w.before, pbf_sub(change, before));
    return next;
  }
};

}  // namespace

#endif
