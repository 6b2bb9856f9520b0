/* Correction of the shear stress that pushes along pairs have under pressure, once a step is
 * solved.
 *
 * Pairs that push with lambda_i + lambda_j have, where lambda is the same all around, the stress
 * lambda M_i, M_i = -sum V grad W (x) x_ij. M is isotropic only where the arrangement of the
 * neighbours is; shear makes it anisotropic, and so pressure resists shear: as an elastic solid
 * first, with a modulus in proportion to the pressure, then as a plastic one. Slow eddies under
 * pressure swing back instead of turning on.
 *
 * So once a step is solved particles get the difference to an isotropic push with the same
 * pressure, as velocity, and move by it at once, for displacement is the integral of velocity. The
 * two of a pair push each other with lambda_i D_i + lambda_j D_j, D_i = 1 - M_i dimension / trace
 * M_i, as tensors times V grad W. D fades out towards the surface, where M is not isotropic at rest
 * either. This push is opposite and equal for the two, but the force of no potential, so what it
 * has of noise, in proportion to the pressure, does work: water at rest would boil. Therefore pairs
 * then exchange their pushes, until next to nothing of them differs from particle to particle. That
 * is opposite and equal, too: linear momentum is conserved. */
#ifndef PBF_PHYSICS_PASSES_SHEAR_STRESS_H
#define PBF_PHYSICS_PASSES_SHEAR_STRESS_H

#include "physics/boundary.h"
#include "physics/passes/pass.h"

/* A symmetric tensor without trace: xx, xy, in three dimensions yy, xz, yz, too. The last diagonal
 * element is minus the sum of the others. */
enum { PBF_DEVIATOR_DIM = PBF_DIM == 3 ? 5 : 2 };
typedef struct pbf_deviator {
  pbf_real c[PBF_DEVIATOR_DIM];
} pbf_deviator;

/* How the neighbours of a particle are arranged. */
typedef struct pbf_fabric {
  pbf_real density;
  pbf_real moments[PBF_MOMENTS]; /* M: xx, xy, yy, xz, yz, zz */
  pbf_vec
      wall; /* what walls push with for lambda = 1, or ghosts in them, which have lambdas, too */
} pbf_fabric;

/* Of xx, yy and zz among the moments. */
PBF_FN int pbf_diagonal_entry(int k) { return k * (k + 3) / 2; }
PBF_FN bool pbf_is_diagonal(int entry) { return entry == 0 || entry == 2 || entry == 5; }

namespace {

/* What passes look up of one is a vector and, in three dimensions, two numbers. */
template <class L>
struct lane_deviator {
  L c[PBF_DEVIATOR_DIM];
};

template <class L>
PBF_FN lane_deviator<L> deviator_of(const neighbor_of<L> &j) {
  lane_deviator<L> d;
  for (int k = 0; k < PBF_DIM; ++k) d.c[k] = j.vector.c[k];
  if constexpr (PBF_DIM == 3) {
    d.c[PBF_DEVIATOR_DIM - 2] = j.number;
    d.c[PBF_DEVIATOR_DIM - 1] = j.second;
  }
  return d;
}

PBF_FN lane_deviator<pbf_real> lanes_of(pbf_deviator a) {
  lane_deviator<pbf_real> d;
  for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) d.c[k] = a.c[k];
  return d;
}

template <class L>
PBF_FN lane_vector<L> product(const lane_deviator<L> &d, const lane_vector<L> &x) {
  if constexpr (PBF_DIM == 3) {
    const L *c = d.c;
    return {{c[0] * x.c[0] + c[1] * x.c[1] + c[3] * x.c[PBF_DIM - 1],
             c[1] * x.c[0] + c[2] * x.c[1] + c[4] * x.c[PBF_DIM - 1],
             c[3] * x.c[0] + c[4] * x.c[1] - (c[0] + c[2]) * x.c[PBF_DIM - 1]}};
  } else {
    return {{d.c[0] * x.c[0] + d.c[1] * x.c[1], d.c[1] * x.c[0] - d.c[0] * x.c[1]}};
  }
}

template <class L>
struct fabric_sums {
  L density, moments[PBF_MOMENTS];
  lane_vector<L> wall;
};

PBF_FN pbf_fabric fabric_of(const fabric_sums<pbf_real> &s) {
  pbf_fabric f = {s.density, {}, vec_of(s.wall)};
  for (int k = 0; k < PBF_MOMENTS; ++k) f.moments[k] = s.moments[k];
  return f;
}

/* lambda D, from how the neighbours are arranged. `Features` come first and a scaling second for
 * the drivers of ghosts; this pass scales pairs. */
template <class Features, scaling = SCALED_PAIRS>
struct fabric_pass {
  enum { NUMBER = 0, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  using sums = fabric_sums<L>;

  template <class L>
  PBF_IN sums<L> begin() const {
    sums<L> s = {ops<L>::set(c->value_scale), {}, lane_vector<L>::zero()};
    for (int k = 0; k < PBF_MOMENTS; ++k) s.moments[k] = ops<L>::set(0);
    return s;
  }

  template <class L, class Weight = unweighted>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j, Weight weight = {}) const {
    L value, slope;
    kernel_and_slope(features, c, j.r2, &value, &slope);
    slope = weight * slope;
    s->density = s->density + weight * value;
    for (int k = 0, entry = 0; k < PBF_DIM; ++k)
      for (int m = 0; m <= k; ++m, ++entry)
        s->moments[entry] = s->moments[entry] - slope * j.x_ij.c[k] * j.x_ij.c[m];
    if constexpr (is_of_ghosts<Weight>::value) s->wall.add_scaled(slope + slope, j.x_ij);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* lambda D: inside the fluid, where the density is right; of D at most a half, for crowds are no
   * arrangement. */
  PBF_IN pbf_deviator finish(const pbf_fabric &s, pbf_real lambda) const {
    const pbf_real none = (pbf_real)0.94, full = (pbf_real)0.97, maximum = (pbf_real)0.5;
    pbf_deviator d = {{0}};
    pbf_real mean = 0, size2 = 0;
    for (int k = 0; k < PBF_DIM; ++k) mean += s.moments[pbf_diagonal_entry(k)] / PBF_DIM;
    pbf_real inside = pbf_real_min(pbf_real_max((s.density - none) / (full - none), 0), 1);
    inside = mean > 0 ? inside : 0; /* no branch: lanes are finished together */
    mean = mean > 0 ? mean : 1;
    pbf_unrolled<PBF_MOMENTS>([&](int entry) {
      const bool is_diagonal = pbf_is_diagonal(entry);
      const pbf_real part = is_diagonal - s.moments[entry] / mean;
      if (entry < PBF_DEVIATOR_DIM) d.c[entry] = part;
      size2 += (is_diagonal ? 1 : 2) * part * part;
    });
    inside *= size2 > maximum * maximum ? maximum / pbf_real_sqrt(size2) : 1;
    const pbf_real most = c->shear_stress_max_lambda * (pbf_real)c->phases.heaviest;
    lambda = pbf_real_max(pbf_real_min(lambda, most), -most);
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) d.c[k] *= inside * lambda;
    return d;
  }
};

/* The rows of a lattice behind the walls across an axis, by what these contribute to the density.
 */
PBF_FN void add_wall_rows(const pbf_constants *c, pbf_real value, int axis,
                          pbf_real moments[PBF_MOMENTS]) {
  const pbf_real layers = pbf_real_min(value * c->inv_boundary_rest_density, 2);
  for (int k = 0; k < PBF_DIM; ++k)
    moments[pbf_diagonal_entry(k)] +=
        layers * (k == axis ? c->wall_fabric_across : c->wall_fabric_along);
}

/* What the walls of the domain contribute to the sums of a particle at x. */
PBF_FN void add_walls(const pbf_constants *c, const pbf_domain &domain, pbf_vec x, pbf_fabric *s) {
  const pbf_boundary walls = pbf_boundary_of_domain(c, &domain, x);
  pbf_add_boundary(&walls, &s->density, &s->wall);
  for (int axis = 0; axis < PBF_DIM && !(domain.ghost_reach > 0); ++axis) {
    pbf_real slope, value = pbf_wall_density(c, pbf_wall_distance(&domain, 2 * axis, x), &slope);
    value += pbf_wall_density(c, pbf_wall_distance(&domain, 2 * axis + 1, x), &slope);
    add_wall_rows(c, value, axis, s->moments);
  }
}

/* Whether colliders contribute there, too, which may lie in any way: nothing is corrected then. */
template <class Obstacles>
PBF_FN bool colliders_contribute(const pbf_constants *c, const Obstacles &o, pbf_vec x) {
  if (pbf_surface_count(o) == 0) return false;
  const pbf_boundary walls = pbf_boundary_of_domain(c, &o.domain, x);
  const pbf_boundary all = pbf_boundary_at(c, o, x);
  return all.overlapping + all.additive != walls.overlapping + walls.additive;
}

/* The push that makes up for it. */
template <class Features>
struct shear_push_pass {
  enum { NUMBER = PBF_DIM == 3 ? 2 : 0, VECTOR = 1 /* lambda D */ };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {
    lane_deviator<L> d;
  };
  template <class L>
  struct sums {
    lane_vector<L> push;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    lane_deviator<L> d = deviator_of(j);
    for (int k = 0; k < PBF_DEVIATOR_DIM; ++k) d.c[k] = i.d.c[k] + d.c[k];
    s->push.add_scaled(kernel_slope(features, c, j.r2), product(d, j.x_ij));
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* Walls push across themselves alone. */
  PBF_IN pbf_vec finish(const sums<pbf_real> &s, const lane_deviator<pbf_real> &d,
                        pbf_vec wall) const {
    const pbf_real wall2 = pbf_dot(wall, wall);
    const pbf_real across = pbf_dot(wall, vec_of(product(d, lanes_of(wall))));
    return pbf_add_scaled(vec_of(s.push), wall2 > 0 ? across / wall2 : 0, wall);
  }
};

/* The change of velocity that it gives, once pairs have exchanged so much of their pushes that on
 * the rest lattice a particle's own push goes to its neighbours, and theirs come to it. Where
 * phases differ, `MASSES`, pushes are over masses, and a pair exchanges the momentum of its lighter
 * particle: no heavy one throws a light one. */
template <class Features>
struct shear_stress_pass {
  enum { NUMBER = 1 /* mass */, VECTOR = 1 /* push */ };
  const pbf_constants *c;
  Features features;
  bool masses; /* where these differ */

  template <class L>
  struct own {
    lane_vector<L> push;
    L mass = {};
  };
  template <class L>
  struct sums {
    lane_vector<L> exchanged;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {lane_vector<L>::zero()};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &i, const neighbor_of<L> &j) const {
    L weight = kernel_value(features, c, j.r2);
    if (masses) weight = weight * -ops<L>::max(-i.mass, -j.number);
    s->exchanged.add_scaled(weight, j.vector - i.push);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}

  /* Where h is hardly more than the spacing there are no neighbours on that lattice. */
  PBF_IN pbf_vec finish(const sums<pbf_real> &s, pbf_vec push, pbf_real mobility = 1) const {
    const pbf_real neighbors = pbf_real_max(1 - c->value_scale, (pbf_real)0.1);
    push = pbf_add_scaled(push, mobility / neighbors, vec_of(s.exchanged));
    return pbf_add_scaled(pbf_vec{{0}}, c->shear_stress_part, push);
  }
};

}  // namespace

#endif
