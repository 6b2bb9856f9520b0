/* What solids take of the velocities of fluid that sticks to them, as a part of their loads. */
#ifndef PBF_PHYSICS_NO_SLIP_LOADS_H
#define PBF_PHYSICS_NO_SLIP_LOADS_H

#include "physics/friction.h"
#include "physics/no_slip.h"

namespace {

/* Calls take(plane, share) for each that takes a part of what viscosity has left of a velocity, at
 * the place x where the solve looks at the particle. It is not in the particle's push, which is
 * along normals. `part`: of the viscosity, that the particle has. */
template <class Obstacles, class NoSlip, class Take>
PBF_FN void share_no_slip(const pbf_constants *c, const Obstacles &o, const NoSlip &n, pbf_vec x,
                          pbf_vec v, Take take, pbf_real part = 1) {
  const no_slip_planes planes = find_no_slip_planes(c, o, n, x);
  for (int i = 0; i < planes.count; ++i) {
    const no_slip_plane &p = planes.of[i];
    const pbf_vec relative = relative_to_surface(o, n, p.surface, x, v);
    const pbf_vec along = pbf_add_scaled(relative, -pbf_dot(relative, p.normal), p.normal);
    const int solid =
        p.surface < 0 ? -1 - p.surface : PBF_WALLS + pbf_surface_number(o.surfaces, p.surface);
    const pbf_load_plane plane = {solid, p.distance, 0, 1, p.normal};
    load_share share = {{0}, {0}, {0}};
    for (int k = 0; k < PBF_DIM; ++k)
      share.change[k] = -(double)(part * p.rate) * (double)along.c[k];
    take(plane, share);
  }
}

}  // namespace

#endif
