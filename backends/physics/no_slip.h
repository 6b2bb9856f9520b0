/* Fluid that sticks to solids: what viscosity does between a particle and a solid near it.
 *
 * Behind the plane of the solid there is as much fluid as before it, with the velocities that go on
 * linearly from the particle's through the solid's own at the plane (Morris, Fox and Zhu 1997,
 * Modeling low Reynolds number incompressible flows using SPH, section 3.3). What pairs with it
 * exchange is the integral of passes/viscous_stress.h over the half-space, of the velocity along
 * the plane alone: -m (v - v_solid), m a function of the distance. Across the plane nothing is
 * done: there a solid takes what it takes by pressure and collisions. */
#ifndef PBF_PHYSICS_NO_SLIP_H
#define PBF_PHYSICS_NO_SLIP_H

#include "physics/boundary.h"
#include "physics/project.h"

enum { PBF_SYMMETRIC_DIM = PBF_DIM * (PBF_DIM + 1) / 2 };

/* Of a symmetric matrix, l <= k. */
PBF_FN int pbf_symmetric_entry(int k, int l) { return k * (k + 1) / 2 + l; }

/* Of the implicit step at a particle: what is left of it, and what a change of the particle's own
 * velocity makes of that. */
typedef struct pbf_viscous_system {
  pbf_vec residual;
  pbf_real block[PBF_SYMMETRIC_DIM];
} pbf_viscous_system;

/* block⁻¹ residual, by Cholesky's decomposition: blocks are 1 and more. */
PBF_FN pbf_vec pbf_viscous_step(const pbf_viscous_system &s) {
  pbf_real lower[PBF_SYMMETRIC_DIM];
  pbf_vec x = s.residual;
  for (int k = 0; k < PBF_DIM; ++k)
    for (int l = 0; l <= k; ++l) {
      pbf_real value = s.block[pbf_symmetric_entry(k, l)];
      for (int m = 0; m < l; ++m)
        value -= lower[pbf_symmetric_entry(k, m)] * lower[pbf_symmetric_entry(l, m)];
      lower[pbf_symmetric_entry(k, l)] =
          k == l ? 1 / pbf_real_sqrt(value) : value * lower[pbf_symmetric_entry(l, l)];
    }
  for (int k = 0; k < PBF_DIM; ++k) {
    for (int l = 0; l < k; ++l) x.c[k] -= lower[pbf_symmetric_entry(k, l)] * x.c[l];
    x.c[k] *= lower[pbf_symmetric_entry(k, k)];
  }
  for (int k = PBF_DIM; k-- > 0;) {
    for (int l = k + 1; l < PBF_DIM; ++l) x.c[k] -= lower[pbf_symmetric_entry(l, k)] * x.c[l];
    x.c[k] *= lower[pbf_symmetric_entry(k, k)];
  }
  return x;
}

/* m at a distance from the plane. */
PBF_FN pbf_real pbf_no_slip_rate(const pbf_constants *c, pbf_real distance) {
  enum { LAST = PBF_VISCOUS_WALL_NODES - 1 };
  const pbf_real near = pbf_real_max(distance * c->inv_h, c->viscosity_wall_nearest);
  const pbf_real t = near * LAST;
  if (!(t < LAST)) return 0;
  const int k = (int)t;
  const pbf_real part = t - (pbf_real)k;
  return ((1 - part) * c->viscosity_wall[k] + part * c->viscosity_wall[k + 1]) / near;
}

/* Adds a plane that takes so much of a velocity relative to it. */
PBF_FN void pbf_add_no_slip_plane(pbf_real rate, pbf_vec normal, pbf_vec relative,
                                  pbf_viscous_system *s) {
  const pbf_vec along = pbf_add_scaled(relative, -pbf_dot(relative, normal), normal);
  s->residual = pbf_add_scaled(s->residual, -rate, along);
  for (int k = 0; k < PBF_DIM; ++k)
    for (int l = 0; l <= k; ++l)
      s->block[pbf_symmetric_entry(k, l)] +=
          rate * ((k == l ? (pbf_real)1 : 0) - normal.c[k] * normal.c[l]);
}

struct pbf_collider_no_slip {
  const pbf_collider *colliders;

  PBF_IN pbf_real operator[](int k) const { return (pbf_real)colliders[k].no_slip; }
};

/* How much fluid sticks to each solid. Surfaces have none of it: steps without copy them. A backend
 * may hold it elsewhere, in a struct with members of the same names. */
typedef struct pbf_no_slip {
  pbf_real walls, inv_time_step;
  pbf_collider_no_slip of;
} pbf_no_slip;

static inline pbf_no_slip pbf_no_slip_of(const pbf_params *params, const pbf_collider *colliders) {
  const pbf_no_slip n = {
      (pbf_real)params->wall_no_slip, (pbf_real)pbf_per_time_step(params), {colliders}};
  return n;
}

/* The velocity, without what it grows by, of a point that moves with a collider: of one at rest 0,
 * since differences are those of its own places. */
PBF_FN pbf_vec pbf_surface_velocity(const pbf_surface *s, pbf_real inv_time_step, pbf_vec x) {
  const pbf_vec p = pbf_sub(x, s->center);
  pbf_vec way = pbf_sub(s->center, s->start_center), v = {{0}};
  for (int row = 0; row < PBF_DIM; ++row) {
    const pbf_real along = pbf_dot(p, s->frame[row]);
    const pbf_real long2 = pbf_dot(s->start_frame[row], s->start_frame[row]);
    const bool grows = !(long2 > (pbf_real)0.9999 && long2 < (pbf_real)1.0001);
    way = pbf_add_scaled(way, along, s->frame[row]);
    way = pbf_add_scaled(way, grows ? -along / pbf_real_sqrt(long2) : -along, s->start_frame[row]);
  }
  return pbf_add_scaled(v, inv_time_step, way);
}

namespace {

/* A plane that fluid sticks to: of the k-th of the obstacles' surfaces; of wall k it is -1 - k. */
struct no_slip_plane {
  int surface;
  pbf_real rate, distance;
  pbf_vec normal;
};

/* As many as are looked at of a place: more than a corner has. */
enum { PBF_NO_SLIP_PLANES = 12 };

struct no_slip_planes {
  int count;
  no_slip_plane of[PBF_NO_SLIP_PLANES];
};

PBF_FN void put_no_slip_plane(const pbf_constants *c, int surface, pbf_real no_slip,
                              pbf_real distance, pbf_vec normal, no_slip_planes *planes) {
  const pbf_real rate = no_slip * pbf_no_slip_rate(c, distance);
  if (rate > 0 && planes->count < PBF_NO_SLIP_PLANES)
    planes->of[planes->count++] = {surface, rate, distance, normal};
}

/* Calls visit(surface, number) for all but fields. */
template <class Surfaces>
struct each_surface_but_fields {
  each_surface<Surfaces> all;

  template <class Visit>
  PBF_IN void operator()(Visit visit) const {
    all([&](const auto &s, int k) {
      if (!pbf_surface_is_field(&s)) visit(s, k);
    });
  }
};

/* Those of colliders; of fields the nearest alone. */
template <class Obstacles, class NoSlip>
PBF_FN void find_no_slip_surfaces(const pbf_constants *c, const Obstacles &o, const NoSlip &n,
                                  pbf_vec x, no_slip_planes *planes) {
  const auto no_slip_of = [&](int k) { return n.of[pbf_surface_number(o.surfaces, k)]; };
  const auto every = all_surfaces_of(o);
  bool any = false;
  for (int k = 0; k < pbf_surface_count(o); ++k) {
    const auto &s = o.surfaces[k];
    if (!(no_slip_of(k) > 0)) continue;
    any = true;
    if (!pbf_surface_is_field(&s) || pbf_surface_is_beyond(&s, x, c->h)) continue;
    pbf_facet plane = {{{0}}, 0, 1};
    plane.distance = pbf_look_at_surface(&s, x, &plane.normal);
    if (!(plane.distance < c->h)) continue;
    const pbf_real part = pbf_part_beside_others(&s, k, x, c->h, every, &plane);
    put_no_slip_plane(c, k, part * no_slip_of(k), plane.distance, plane.normal, planes);
  }
  if (!any) return;
  const each_surface_but_fields<decltype(o.surfaces)> all = {every};
  pbf_each_near_plane(c, &o.domain, x, c->h, all, [&](const pbf_near_face &face, pbf_real part) {
    put_no_slip_plane(c, face.solid, part * no_slip_of(face.solid), face.distance, face.normal,
                      planes);
  });
}

/* All within reach of x. */
template <class Obstacles, class NoSlip>
PBF_FN_HOST_NOINLINE no_slip_planes find_no_slip_planes(const pbf_constants *c, const Obstacles &o,
                                                        const NoSlip &n, pbf_vec x) {
  no_slip_planes planes;
  planes.count = 0;
  const int near_walls = n.walls > 0 && pbf_domain_distance(&o.domain, x) < c->h;
  for (int wall = 0; near_walls && wall < 2 * PBF_DIM; ++wall) {
    pbf_vec normal = {{0}};
    normal.c[wall / 2] = 1;
    put_no_slip_plane(c, -1 - wall, n.walls, pbf_wall_distance(&o.domain, wall, x), normal,
                      &planes);
  }
  find_no_slip_surfaces(c, o, n, x, &planes);
  return planes;
}

/* A velocity relative to a surface's at x. */
template <class Obstacles, class NoSlip>
PBF_FN pbf_vec relative_to_surface(const Obstacles &o, const NoSlip &n, int surface, pbf_vec x,
                                   pbf_vec v) {
  if (surface < 0) return v;
  return pbf_sub(v, pbf_surface_velocity(&o.surfaces[surface], n.inv_time_step, x));
}

/* Adds all solids to what pairs make of the system of a particle at x with this velocity, or, not
 * `moves`, with this change of it, which has this part of the viscosity; 0: none is in reach. */
template <class Obstacles, class NoSlip>
PBF_FN int add_no_slip(const pbf_constants *c, const Obstacles &o, const NoSlip &n, bool moves,
                       pbf_vec x, pbf_vec v, pbf_viscous_system *s, pbf_real part = 1) {
  const no_slip_planes planes = find_no_slip_planes(c, o, n, x);
  for (int k = 0; k < planes.count; ++k) {
    const no_slip_plane &p = planes.of[k];
    const pbf_vec relative = moves ? relative_to_surface(o, n, p.surface, x, v) : v;
    pbf_add_no_slip_plane(part * p.rate, p.normal, relative, s);
  }
  return planes.count > 0;
}

}  // namespace

#endif
