/* Surface tension: a particle that lacks neighbours is pulled to those that it has.
 *
 * The energy is a sum over particles of K/2 m², with m = max(1 - PBF_UNMISSED - n, 0) what a
 * particle lacks of the neighbours n that it has in a lattice, n = sum of (1 - r²/h²)² over the
 * others by that sum in the lattice. Free energies of the density that particles see are from
 * Pagonabarraga and Frenkel, Dissipative particle dynamics for interacting systems, 2001. A pair is
 * pulled together with K (m_i + m_j) |dn/dr|: along the line between the two, opposite and equal,
 * so that linear and angular momentum are kept to rounding, and only near surfaces: inside, m is 0,
 * and the pressure there is that of the surface's curvature. Solids count as fluid at rest behind
 * their surface does, so that fluid is not pulled away from them as from air, and do not pull: they
 * hold no drop, and their contact angle is 180 degrees. */
#ifndef PBF_PHYSICS_PASSES_SURFACE_TENSION_H
#define PBF_PHYSICS_PASSES_SURFACE_TENSION_H

#include "physics/boundary.h"
#include "physics/passes/pass.h"

/* What arrangements inside a fluid lack by their disorder. */
#define PBF_UNMISSED 0.05

namespace {

struct missing_neighbors_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L neighbors;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(0)};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j) const {
    const L near = ramp(j.r2, ops<L>::set(-c->inv_h2));
    s->neighbors = ops<L>::multiply_add(near, near, s->neighbors);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* `solids`: the density that these contribute. */
  PBF_IN pbf_real finish(const sums<pbf_real> &s, pbf_real solids) const {
    const pbf_real has = c->per_neighbor * s.neighbors + c->neighbors_of_solids * solids;
    return pbf_real_max((pbf_real)(1 - PBF_UNMISSED) - has, 0);
  }
};

struct surface_tension_pass {
  enum { NUMBER = 1 /* what it lacks */, VECTOR = 0 };
  const pbf_constants *c;

  template <class L>
  struct own {
    L missing;
  };
  template <class L>
  struct sums {
    lane_vector<L> pull;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    const L near = ramp(j.r2, ops<L>::set(-c->inv_h2));
    s->pull.add_scaled((i.missing + j.number) * near, j.x_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_vec v) const {
    return pbf_add_scaled(v, -c->surface_pull, vec_of(s.pull));
  }
};

/* The density that solids contribute at x, walls that have ghosts included, for which these are
 * not needed. */
template <class Obstacles>
PBF_FN_HOST_NOINLINE pbf_real pbf_density_of_solids(const pbf_constants *c, const Obstacles &o,
                                                    pbf_vec x) {
  pbf_domain walls = o.domain;
  walls.ghost_reach = 0;
  pbf_boundary boundary = pbf_boundary_of_domain(c, &walls, x);
  if (pbf_surface_count(o) > 0)
    pbf_accumulate_surfaces(c, &walls, x, all_surfaces_of(o), &boundary);
  return boundary.overlapping + boundary.additive;
}

}  // namespace

#endif
