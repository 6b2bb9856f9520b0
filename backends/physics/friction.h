/* Friction between the fluid and solids, once a step is solved.
 *
 * Coulomb's: what a solid pushes a particle with along its normal in the step (loads.h) lets it
 * take as much of the velocity along itself as that times a coefficient: all of it up to the static
 * one, and else as much as the kinetic one gives. So it holds in any step, and a particle on a
 * slope rests or slides as a body does.
 *
 * No slip: the fluid at a solid goes with it. A particle y before it is slowed as by the shear of a
 * fluid of its viscosity over y, its layer being a spacing thick: dv/dt = -nu v / (y d), implicit,
 * so that any step is stable. */
#ifndef PBF_PHYSICS_FRICTION_H
#define PBF_PHYSICS_FRICTION_H

#include "physics/loads.h"

/* Of a solid. */
typedef struct pbf_friction {
  double kinetic, at_rest, no_slip;
} pbf_friction;

typedef struct pbf_friction_scales {
  pbf_load_scales loads;
  pbf_friction walls;
  double spread; /* viscosity times the time step */
} pbf_friction_scales;

PBF_FN pbf_friction pbf_friction_of(double kinetic, double at_rest, double no_slip) {
  pbf_friction f = {kinetic, at_rest > kinetic ? at_rest : kinetic, no_slip};
  return f;
}

static inline pbf_friction_scales pbf_friction_scales_of(const pbf_constants *c,
                                                         const pbf_forces *forces,
                                                         const pbf_params *params) {
  pbf_friction_scales s;
  s.loads = pbf_load_scales_of(c, forces, params);
  s.walls =
      pbf_friction_of(params->wall_friction, params->wall_static_friction, params->wall_no_slip);
  s.spread = c->accelerated ? params->viscosity * params->time_step : 0;
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
  return speed <= f.at_rest * push ? 1 : fmin(1.0, f.kinetic * push / speed);
}

/* The part that no slip takes. */
PBF_FN double no_slip_part(const pbf_friction &f, const pbf_friction_scales &s, pbf_real distance) {
  const double d = s.loads.spacing, y = fmax((double)distance, d / 4);
  const double way = (double)distance < d ? f.no_slip * s.spread / (y * d) : 0;
  return way / (1 + way);
}

/* What friction changes a particle's velocity by. Calls take(plane, share) for what each plane
 * does.
 */
template <class Obstacles, class Take>
PBF_FN pbf_vec friction_change(const pbf_constants *c, const pbf_friction_scales &s,
                               const Obstacles &o, const load_particle &of, Take take) {
  double v[PBF_DIM];
  pbf_vec change = {{0}};
  for (int k = 0; k < PBF_DIM; ++k) v[k] = (double)of.change.c[k];
  share_push(c, &s.loads, o, of, [&](const pbf_load_plane &p, const load_share &pushed) {
    const bool is_wall = p.solid < PBF_WALLS;
    pbf_friction f = s.walls;
    double own[PBF_DIM] = {0}, along[PBF_DIM], across = 0, push = 0, speed2 = 0;
    if (!is_wall) {
      const pbf_surface *surface = &o.surfaces[p.solid - PBF_WALLS];
      f = pbf_friction_of((double)surface->friction, (double)surface->static_friction,
                          (double)surface->no_slip);
      surface_velocity(surface, s.loads.time_step, of.x, own);
    }
    if (!(f.at_rest > 0 || f.no_slip > 0)) return;
    for (int k = 0; k < PBF_DIM; ++k) {
      across += (v[k] - own[k]) * (double)p.normal.c[k];
      push += pushed.change[k] * (double)p.normal.c[k];
    }
    for (int k = 0; k < PBF_DIM; ++k) {
      along[k] = v[k] - own[k] - across * (double)p.normal.c[k];
      speed2 += along[k] * along[k];
    }
    const double stick = friction_part(f, push, sqrt(speed2));
    const double part = stick + (1 - stick) * no_slip_part(f, s, p.distance);
    load_share share = {{0}, {0}};
    for (int k = 0; k < PBF_DIM; ++k) {
      share.change[k] = -part * along[k];
      v[k] += share.change[k];
      change.c[k] += (pbf_real)share.change[k];
    }
    if (part > 0) take(p, share);
  });
  return change;
}

/* It as a part of the plane's load: what is wet is counted elsewhere. */
template <class Obstacles>
PBF_FN load_part friction_load(const pbf_load_scales *s, const Obstacles &o, pbf_vec x,
                               const pbf_load_plane &p, const load_share &share) {
  load_part part = load_part_of(s, o, x, p, share);
  for (int k = PBF_LOAD_WET; k < PBF_LOAD_ALONG; ++k) part.of[k] = pbf_wide_of(0);
  part.depth = 0;
  return part;
}

}  // namespace

#endif
