/* Solids that fluid with a surface tension adheres to.
 *
 * At a solid without adhesion what fluid lacks of neighbours counts as there, and pulls nothing:
 * the contact angle is 180 degrees. One with adhesion has two parts in the energy of
 * passes/surface_tension.h. The first is that the solid's neighbours pull, too, as those of the
 * fluid do: K m times the slope of what the solid counts as. Fluid on it then has no surface there,
 * and the angle is 90 degrees. The second is -sigma cos(angle) for each area that is wet (Young
 * 1805, An essay on the cohesion of fluids), as a potential of the distance d: -K b cos(angle) (1 -
 * d/h)². Both act along the solid's normal alone; along it the layer that is pressed on by the
 * potential spreads. */
#ifndef PBF_PHYSICS_ADHESION_H
#define PBF_PHYSICS_ADHESION_H

#include "physics/load_shares.h"

/* b, with an attracting solid and one that repels. Measured on drops of some 14 spacings radius in
 * 2D and 8 in 3D. */
#define PBF_WETTING (PBF_DIM == 3 ? 0.03 : 0.07)
#define PBF_DEWETTING (PBF_DIM == 3 ? 0.052 : 0.075)

/* Of each solid. A backend may hold it elsewhere, in a struct with members of the same names. */
struct pbf_solid_adhesion {
  pbf_real walls;
  const pbf_collider *colliders;

  PBF_IN pbf_real operator[](int solid) const {
    return solid < PBF_WALLS ? walls : (pbf_real)colliders[solid - PBF_WALLS].adhesion;
  }
};

typedef struct pbf_adhesion_scales {
  pbf_load_scales loads;
  pbf_real pull; /* dt K */
  pbf_solid_adhesion of;
} pbf_adhesion_scales;

static inline pbf_adhesion_scales pbf_adhesion_scales_of(const pbf_constants *c,
                                                         const pbf_forces *forces,
                                                         const pbf_params *params,
                                                         const pbf_collider *colliders) {
  pbf_adhesion_scales s;
  s.loads = pbf_load_scales_of(c, forces, params);
  s.pull = (pbf_real)((double)c->surface_pull * (double)c->h2 / (4 * (double)c->per_neighbor));
  s.of.walls = (pbf_real)params->wall_adhesion;
  s.of.colliders = colliders;
  return s;
}

/* How much less a plane counts of neighbours for each length that it is farther away. */
PBF_FN pbf_real pbf_neighbors_fall(const pbf_constants *c, pbf_real distance) {
  const pbf_real t = pbf_wall_node(c, distance);
  if (!(t < PBF_WALL_LAST)) return 0;
  const int k = (int)pbf_real_max(t, 0);
  pbf_real slope;
  pbf_wall_interpolated(pbf_real_max(t, 0) - (pbf_real)k, c->wall_value[k], c->wall_value[k + 1],
                        c->wall_slope[k], c->wall_slope[k + 1], &slope);
  return -slope * c->inv_h * PBF_WALL_LAST * c->neighbors_of_solids;
}

/* What a plane before it with this adhesion pulls a particle with, that lacks so much of its
 * neighbours: over K. */
PBF_FN pbf_real pbf_adhesive_pull(const pbf_constants *c, pbf_real adhesion, pbf_real missing,
                                  pbf_real distance) {
  const pbf_real cosine = 2 * adhesion - 1;
  const pbf_real near = pbf_real_max(1 - distance * c->inv_h, 0);
  const pbf_real b = (pbf_real)(cosine > 0 ? PBF_WETTING : PBF_DEWETTING);
  return missing * pbf_neighbors_fall(c, distance) + 2 * b * cosine * near * c->inv_h;
}

namespace {

/* What solids change the velocity of a particle at x by. Calls take(plane, share) for what each
 * plane does. */
template <class Scales, class Obstacles, class Near, class Take>
PBF_FN pbf_vec adhesion_change(const pbf_constants *c, const Scales &s, const Obstacles &o,
                               const Near &near, pbf_vec x, pbf_real missing, Take take) {
  pbf_vec change = {{0}};
  pbf_load_plane planes[PBF_LOAD_PLANES];
  const int count = find_load_planes(c, o, near, x, c->h, planes);
  for (int i = 0; i < count; ++i) {
    const pbf_load_plane &p = planes[i];
    const pbf_real adhesion = s.of[p.solid];
    if (!(adhesion > 0) || p.distance < 0) continue;
    const pbf_real pull = s.pull * p.part * pbf_adhesive_pull(c, adhesion, missing, p.distance);
    load_share share = {{0}, {0}, {0}};
    for (int k = 0; k < PBF_DIM; ++k) share.change[k] = -(double)(pull * p.normal.c[k]);
    change = pbf_add_scaled(change, -pull, p.normal);
    take(p, share);
  }
  return change;
}

}  // namespace

#endif
