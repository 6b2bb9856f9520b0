/* How a particle's push is shared out among the solids near it (loads.h). */
#ifndef PBF_PHYSICS_LOAD_SHARES_H
#define PBF_PHYSICS_LOAD_SHARES_H

#include "physics/elementary.h"
#include "physics/load_sums.h"
#include "physics/passes/predict.h"

/* Planes near a particle that share its push, the first ones of all: more than a corner has. */
enum { PBF_LOAD_PLANES = 12 };

/* What all particles of a step have in common. */
typedef struct pbf_load_scales {
  double velocity; /* units */
  double spacing;
  double reach;     /* solids farther away have no part in a push */
  double by_lambda; /* from lambda times the gradient of a density to a change of velocity; 0 where
                       lambda does not add up over a step */
  double mass;      /* of a particle, over rest density */
  double time_step;
  pbf_periods periods; /* of the domain */
} pbf_load_scales;

/* A particle has the mass of the cell that it fills in a fluid at rest, or what the caller says. */
static inline double pbf_particle_mass(const pbf_params *params) {
  const double given = params->particle_volume;
  return given > 0 ? given : pbf_whole_power(pbf_derive_spacing(params), PBF_DIM);
}

/* Sums are of momenta, over the reference's mass: velocities times the particle's mass. */
PBF_FN double pbf_units_of_momentum(const pbf_constants *c, const pbf_forces *f) {
  return pbf_units_of_velocity((double)f->max_speed * c->phases.heaviest);
}

static inline pbf_load_scales pbf_load_scales_of(const pbf_constants *c, const pbf_forces *f,
                                                 const pbf_params *params) {
  pbf_load_scales s;
  s.velocity = pbf_units_of_momentum(c, f);
  s.spacing = pbf_derive_spacing(params);
  s.reach = fmax(params->smoothing_radius, 2 * s.spacing);
  s.by_lambda = c->accelerated ? (double)c->omega * pbf_per_time_step(params) : 0;
  s.mass = pbf_particle_mass(params);
  s.time_step = params->time_step;
  s.periods = pbf_periods_of(params);
  return s;
}

/* A plane of a solid near a particle, and the slope of the density that it contributes. */
typedef struct pbf_load_plane {
  int solid;
  pbf_real distance, slope;
  pbf_real part; /* that faces before it leave of it: near_faces.h */
  pbf_vec normal;
} pbf_load_plane;

namespace {

/* A particle at the end of a step. */
struct load_particle {
  pbf_vec x;
  pbf_vec change;  /* of its velocity, or the velocity: what is summed up of all */
  pbf_vec push;    /* by solids, of that */
  pbf_real lambda; /* of the iterations */
  bool has_grid;   /* its pressure is to be added */
};

/* Of a particle with this mobility what changes its momentum, in place of its velocity; the pushes
 * of lambda are of momentum already. */
PBF_FN load_particle with_mass(load_particle of, pbf_real mobility) {
  for (int k = 0; k < PBF_DIM; ++k) {
    of.change.c[k] /= mobility;
    of.push.c[k] /= mobility;
  }
  return of;
}

PBF_FN pbf_load_plane load_plane_of_wall(const pbf_constants *c, const pbf_domain *domain, int wall,
                                         pbf_vec x) {
  pbf_load_plane p = {wall, pbf_wall_distance(domain, wall, x), 0, 1, {{0}}};
  p.normal.c[wall / 2] = wall % 2 ? (pbf_real)-1 : (pbf_real)1;
  pbf_wall_density(c, p.distance, &p.slope);
  return p;
}

PBF_FN pbf_load_plane load_plane_of_face(const pbf_constants *c, const pbf_near_face &face,
                                         pbf_real part) {
  pbf_load_plane p = {face.solid, face.distance, 0, part, face.normal};
  pbf_face_density(c, face, &p.slope);
  p.slope *= part;
  return p;
}

PBF_FN pbf_load_plane load_plane_of_surface(const pbf_constants *c, const pbf_surface *s, int solid,
                                            pbf_vec x) {
  pbf_vec normal;
  const pbf_real distance = pbf_surface_distance(s, x, &normal);
  return load_plane_of_face(c, pbf_face_of_surface(s, solid, distance, normal), 1);
}

/* The surfaces that a particle may be near. An executor that knows more has another one. */
struct all_surfaces {
  template <class Visit>
  PBF_IN void each(int all, Visit visit) const {
    for (int k = 0; k < all; ++k) visit(k);
  }
};

/* Calls visit(surface, number) for those. */
template <class Surfaces, class Near>
struct each_near_surface {
  Surfaces surfaces;
  int count;
  Near near;

  template <class Visit>
  PBF_IN void operator()(Visit visit) const {
    near.each(count, [&](int k) { visit(surfaces[k], PBF_WALLS + k); });
  }
};

/* Those within reach, of one solid after another; their number. */
template <class Obstacles, class Near>
PBF_FN_HOST_NOINLINE int find_load_planes(const pbf_constants *c, const Obstacles &o,
                                          const Near &near, pbf_vec x, pbf_real reach,
                                          pbf_load_plane planes[PBF_LOAD_PLANES]) {
  int count = 0;
  for (int wall = 0; wall < 2 * PBF_DIM; ++wall)
    if (pbf_wall_distance(&o.domain, wall, x) < reach)
      planes[count++] = load_plane_of_wall(c, &o.domain, wall, x);
  const each_near_surface<decltype(o.surfaces), Near> all = {o.surfaces, pbf_surface_count(o),
                                                             near};
  pbf_each_near_plane(c, &o.domain, x, reach, all, [&](const pbf_near_face &face, pbf_real part) {
    if (count < PBF_LOAD_PLANES) planes[count++] = load_plane_of_face(c, face, part);
  });
  return count;
}

/* A symmetric positive system: what solids take of a push is to be found from it. */
struct load_system {
  double matrix[PBF_DIM][PBF_DIM], right[PBF_DIM];
};

/* So much of what is across its normal a plane takes as well, where no other normal does. */
PBF_FN double load_across() { return 1e-3; }

/* The nearer a plane, the more it takes of what others could take as well. */
PBF_FN double load_weight(const pbf_load_scales *s, const pbf_load_plane &p) {
  const double near = 1 - pbf_max((double)p.distance, 0) / s->reach;
  return (double)p.part * near * near;
}

PBF_FN void add_to_system(load_system *to, double weight, pbf_vec normal) {
  for (int j = 0; j < PBF_DIM; ++j)
    for (int k = 0; k < PBF_DIM; ++k)
      to->matrix[j][k] +=
          weight * ((double)normal.c[j] * (double)normal.c[k] + (j == k ? load_across() : 0));
}

/* By Gauss's elimination; `right` is then the solution. */
PBF_FN void solve_system(load_system *s) {
  for (int k = 0; k < PBF_DIM; ++k)
    for (int j = k + 1; j < PBF_DIM; ++j) {
      const double factor = s->matrix[j][k] / s->matrix[k][k];
      for (int m = k; m < PBF_DIM; ++m) s->matrix[j][m] -= factor * s->matrix[k][m];
      s->right[j] -= factor * s->right[k];
    }
  for (int k = PBF_DIM - 1; k >= 0; --k) {
    for (int m = k + 1; m < PBF_DIM; ++m) s->right[k] -= s->matrix[k][m] * s->right[m];
    s->right[k] /= s->matrix[k][k];
  }
}

/* The nearest of all planes, where none is within reach of what has been pushed. */
template <class Obstacles>
PBF_FN_NOINLINE pbf_load_plane nearest_load_plane(const pbf_constants *c, const Obstacles &o,
                                                  pbf_vec x) {
  pbf_load_plane nearest = load_plane_of_wall(c, &o.domain, 0, x);
  for (int wall = 1; wall < 2 * PBF_DIM; ++wall) {
    const pbf_load_plane p = load_plane_of_wall(c, &o.domain, wall, x);
    if (p.distance < nearest.distance) nearest = p;
  }
  for (int k = 0; k < pbf_surface_count(o); ++k) {
    const pbf_load_plane p = load_plane_of_surface(c, &o.surfaces[k], PBF_WALLS + k, x);
    if (p.distance < nearest.distance) nearest = p;
  }
  return nearest;
}

/* A plane's part in a push; of a wall, what it does along itself apart. And its part in what one
 * pressure everywhere would do, in faces of a particle. */
struct load_share {
  double change[PBF_DIM], along[PBF_DIM], open[PBF_DIM];
};

/* Of the particle's push so far as it is not by lambda, `left` being the solution for it;
 * `by_lambda` is the size of what is. */
PBF_FN load_share load_share_of_plane(const pbf_load_plane &p, double weight, double by_lambda,
                                      const double left[PBF_DIM]) {
  load_share share;
  double normal = 0;
  for (int k = 0; k < PBF_DIM; ++k) normal += (double)p.normal.c[k] * left[k];
  for (int k = 0; k < PBF_DIM; ++k) {
    const double n = (double)p.normal.c[k];
    const double along = weight * load_across() * (left[k] - normal * n);
    share.change[k] = (by_lambda + weight * (1 + load_across()) * normal) * n;
    share.change[k] += p.solid < PBF_WALLS ? 0 : along;
    share.along[k] = p.solid < PBF_WALLS ? along : 0;
    share.open[k] = 0;
  }
  return share;
}

/* The only plane takes all of what is not by lambda, `push`: what the system comes to. */
PBF_FN load_share load_share_of_one(const pbf_load_plane &p, double by_lambda,
                                    const double push[PBF_DIM]) {
  load_share share;
  double normal = 0;
  for (int k = 0; k < PBF_DIM; ++k) normal += (double)p.normal.c[k] * push[k];
  for (int k = 0; k < PBF_DIM; ++k) {
    const double n = (double)p.normal.c[k], along = push[k] - normal * n;
    share.change[k] = (by_lambda + normal) * n + (p.solid < PBF_WALLS ? 0 : along);
    share.along[k] = p.solid < PBF_WALLS ? along : 0;
    share.open[k] = 0;
  }
  return share;
}

/* Of a particle with this mobility, of its momentum. */
PBF_FN load_share with_mass(load_share share, pbf_real mobility) {
  for (int k = 0; k < PBF_DIM; ++k) {
    share.change[k] /= (double)mobility;
    share.along[k] /= (double)mobility;
  }
  return share;
}

/* All of a push. */
PBF_FN load_share load_share_of_all(const double push[PBF_DIM]) {
  load_share share = {{0}, {0}, {0}};
  for (int k = 0; k < PBF_DIM; ++k) share.change[k] = push[k];
  return share;
}

/* Calls take(plane, share) for each plane that has a part in what has changed the velocity of a
 * particle: its push, of which lambda of the iterations is the most, and what that of the pressure
 * grid does beside. */
template <class Obstacles, class Near, class GridLambda, class Take>
PBF_FN void share_push(const pbf_constants *c, const pbf_load_scales *s, const Obstacles &o,
                       const Near &near, const load_particle &of, GridLambda grid_lambda,
                       Take take) {
  load_system system = {{{0}}, {0}};
  const double own = s->by_lambda * (double)of.lambda;
  const pbf_vec x = of.x;
  pbf_load_plane planes[PBF_LOAD_PLANES];
  const int count = find_load_planes(c, o, near, x, (pbf_real)s->reach, planes);
  bool pushed = false;
  for (int k = 0; k < PBF_DIM; ++k) {
    system.right[k] = (double)of.push.c[k];
    pushed = pushed || of.push.c[k] < 0 || of.push.c[k] > 0;
  }
  for (int i = 0; i < count; ++i) {
    const pbf_load_plane &p = planes[i];
    for (int k = 0; k < PBF_DIM; ++k)
      system.right[k] -= own * (double)p.slope * (double)p.normal.c[k];
  }
  if (!count) {
    if (pushed) take(nearest_load_plane(c, o, x), load_share_of_all(system.right));
    return;
  }
  const double all = own + s->by_lambda * (of.has_grid ? (double)grid_lambda() : 0);
  if (count == 1) {
    take(planes[0], load_share_of_one(planes[0], all * (double)planes[0].slope, system.right));
    return;
  }
  for (int i = 0; i < count; ++i)
    add_to_system(&system, load_weight(s, planes[i]), planes[i].normal);
  solve_system(&system);
  for (int k = 0; k < count; ++k) {
    const pbf_load_plane &p = planes[k];
    take(p, load_share_of_plane(p, load_weight(s, p), all * (double)p.slope, system.right));
  }
}

/* One that sleeps: what its lambda makes of the density of solids. What that of the grid makes of
 * it is in the sum of all, and solids have it from the grid (grid_loads.h). */
template <class Obstacles, class Near, class GridLambda>
PBF_FN load_particle sleeping_load_particle(const pbf_constants *c, const pbf_load_scales *s,
                                            const Obstacles &o, const Near &near, load_particle of,
                                            GridLambda grid_lambda) {
  const double own = s->by_lambda * (double)of.lambda;
  const double all = own + s->by_lambda * (of.has_grid ? (double)grid_lambda() : 0);
  of.push = of.change = {{0}};
  pbf_load_plane planes[PBF_LOAD_PLANES];
  const int count = find_load_planes(c, o, near, of.x, (pbf_real)s->reach, planes);
  for (int k = 0; k < count; ++k) {
    const pbf_load_plane &p = planes[k];
    of.push = pbf_add_scaled(of.push, (pbf_real)own * p.slope, p.normal);
    of.change = pbf_add_scaled(of.change, (pbf_real)all * p.slope, p.normal);
  }
  return of;
}

}  // namespace

#endif
