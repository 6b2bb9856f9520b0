/* Friction between the fluid and solids, once a step is solved.
 *
 * Coulomb's: what a solid pushes a particle with along its normal in the step (loads.h) lets it
 * take as much of the velocity along itself as that times a coefficient: all of it up to the static
 * one, and else as much as the kinetic one gives. So it holds in any step, and a particle on a
 * slope rests or slides as a body does. */
#ifndef PBF_PHYSICS_FRICTION_H
#define PBF_PHYSICS_FRICTION_H

#include "physics/load_shares.h"

/* Of a solid. Surfaces have none of it: steps without friction copy them. */
typedef struct pbf_friction {
  pbf_real kinetic, at_rest;
} pbf_friction;

PBF_FN pbf_friction pbf_friction_of(double kinetic, double at_rest) {
  const pbf_friction f = {(pbf_real)kinetic, (pbf_real)fmax(at_rest, kinetic)};
  return f;
}

/* Of each solid. A backend may hold it elsewhere, in a struct with members of the same names. */
struct pbf_solid_friction {
  pbf_friction walls;
  const pbf_collider *colliders;

  PBF_IN pbf_friction operator[](int solid) const {
    if (solid < PBF_WALLS) return walls;
    const pbf_collider *c = &colliders[solid - PBF_WALLS];
    return pbf_friction_of(c->friction, c->static_friction);
  }
};

typedef struct pbf_friction_scales {
  pbf_load_scales loads;
  pbf_solid_friction of;
} pbf_friction_scales;

static inline pbf_friction_scales pbf_friction_scales_of(const pbf_constants *c,
                                                         const pbf_forces *forces,
                                                         const pbf_params *params,
                                                         const pbf_collider *colliders) {
  pbf_friction_scales s;
  s.loads = pbf_load_scales_of(c, forces, params);
  s.of.walls = pbf_friction_of(params->wall_friction, params->wall_static_friction);
  s.of.colliders = colliders;
  return s;
}

namespace {

/* The velocity of a point that moves with a surface. */
PBF_FN void surface_velocity(const pbf_surface *s, double time_step, pbf_vec x, double v[PBF_DIM]) {
  const pbf_vec p = pbf_sub(x, s->center);
  pbf_vec before = s->start_center;
  for (int row = 0; row < PBF_DIM; ++row) {
    const pbf_vec start = s->start_frame[row]; /* as long as it has grown */
    before = pbf_add_scaled(before, pbf_dot(p, s->frame[row]) / pbf_dot(start, start), start);
  }
  for (int k = 0; k < PBF_DIM; ++k) v[k] = ((double)x.c[k] - (double)before.c[k]) / time_step;
}

/* The part of a velocity along a plane that it takes, of the size `speed`, by what it pushes with.
 */
PBF_FN double friction_part(const pbf_friction &f, double push, double speed) {
  if (!(push > 0) || !(speed > 0)) return 0;
  return speed <= (double)f.at_rest * push ? 1 : fmin(1.0, (double)f.kinetic * push / speed);
}

/* What friction changes a particle's velocity by. Calls take(plane, share) for what each plane
 * does.
 */
template <class Scales, class Obstacles, class Near, class GridLambda, class Take>
PBF_FN pbf_vec friction_change(const pbf_constants *c, const Scales &s, const Obstacles &o,
                               const Near &near, const load_particle &of, GridLambda grid_lambda,
                               Take take) {
  double v[PBF_DIM];
  pbf_vec change = {{0}};
  for (int k = 0; k < PBF_DIM; ++k) v[k] = (double)of.change.c[k];
  share_push(c, &s.loads, o, near, of, grid_lambda,
             [&](const pbf_load_plane &p, const load_share &pushed) {
               const bool is_wall = p.solid < PBF_WALLS;
               const pbf_friction f = s.of[p.solid];
               double own[PBF_DIM] = {0}, along[PBF_DIM], across = 0, push = 0, speed2 = 0;
               if (!(f.at_rest > 0)) return;
               if (!is_wall)
                 surface_velocity(&o.surfaces[p.solid - PBF_WALLS], s.loads.time_step, of.x, own);
               for (int k = 0; k < PBF_DIM; ++k) {
                 across += (v[k] - own[k]) * (double)p.normal.c[k];
                 push += pushed.change[k] * (double)p.normal.c[k];
               }
               for (int k = 0; k < PBF_DIM; ++k) {
                 along[k] = v[k] - own[k] - across * (double)p.normal.c[k];
                 speed2 += along[k] * along[k];
               }
               const double part = friction_part(f, push, sqrt(speed2));
               load_share share = {{0}, {0}, {0}};
               for (int k = 0; k < PBF_DIM; ++k) {
                 share.change[k] = -part * along[k];
                 v[k] += share.change[k];
                 change.c[k] += (pbf_real)share.change[k];
               }
               if (part > 0) take(p, share);
             });
  return change;
}

}  // namespace

#endif
