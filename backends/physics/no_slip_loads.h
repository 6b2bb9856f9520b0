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
  each_no_slip_plane(
      c, o, n, x, [&](int surface, pbf_real rate, pbf_real distance, pbf_vec normal) {
        const pbf_vec relative = relative_to_surface(o, n, surface, x, v);
        const pbf_vec along = pbf_add_scaled(relative, -pbf_dot(relative, normal), normal);
        const int solid =
            surface < 0 ? -1 - surface : PBF_WALLS + pbf_surface_number(o.surfaces, surface);
        pbf_load_plane plane = {solid, distance, 0, 1, normal};
        load_share share = {{0}, {0}};
        for (int k = 0; k < PBF_DIM; ++k)
          share.change[k] = -(double)(part * rate) * (double)along.c[k];
        take(plane, share);
      });
}

}  // namespace

#endif
