/* Loads: the impulse that the fluid gives to each solid in a step, and where.
 *
 * Two things are measured. Of each particle, its push: the velocity that it has got where walls and
 * colliders act on it by itself, by collisions, by the density that they contribute and by ghosts.
 * And of all particles together, what their velocities have changed by beside forces. Pairs
 * conserve momentum, so the latter is the solids' in all: with what no particle tells, the pressure
 * of a pressure grid first of all.
 *
 * A push is shared out among the solids near its particle. Each gets what the step's lambda makes
 * of the density that it contributes, which is its pressure: so a layer between two plates presses
 * on both. What is left goes to each along its normal, as far as normals span it; colliders also
 * take the rest. But what walls do along themselves stands in for fluid that they cut off
 * (pbf_boundary_correction), the weight of which is on the walls across: they share it, where there
 * are any that the fluid is at. What is then left of the whole is that of a pressure grid, the
 * pressure of which ends some tenths of a spacing above or below where the fluid does. It goes to
 * all as one pressure at all depths would, along normals: to a floor by its area, to a body that
 * floats by the area that it cuts out of the surface, upwards, and to one that is pressed from all
 * sides not at all. What does not fit one pressure goes in proportion to what each has got along
 * the axis in all. So the sum over all solids is the momentum that the fluid has lost, whatever
 * errors the parts have.
 *
 * Sums are of integers: their order, and with it threads, changes no bit. */
#ifndef PBF_PHYSICS_LOADS_H
#define PBF_PHYSICS_LOADS_H

#include <stddef.h>

#include "physics/boundary.h"
#include "physics/elementary.h"
#include "physics/passes/predict.h"

/* Solids by number: the walls, 2 * axis and + 1, and after six of these the colliders. */
enum { PBF_WALLS = 6, PBF_FEW_SOLIDS = PBF_WALLS + PBF_FEW_COLLIDERS };

/* Planes near a particle that share its push, the first ones of all: more than a corner has. */
enum { PBF_LOAD_PLANES = 12 };

/* ---- Sums ----------------------------------------------------------------------------------- */

/* high * 2^32 + low, of 2^31 numbers and more. */
typedef struct pbf_wide_sum {
  int64_t high, low;
} pbf_wide_sum;

/* Of a number in units: at most 2^62 of them, and what is no number counts as none. */
PBF_FN pbf_wide_sum pbf_wide_of(double units) {
  const double limit = 0x1p62;
  units = units > -limit ? units : -limit;
  units = units < limit ? units : limit;
  const int64_t whole = (int64_t)units, low = whole & 0xffffffff;
  pbf_wide_sum sum = {(whole - low) / 0x100000000, low};
  return sum;
}

PBF_FN double pbf_wide_value(pbf_wide_sum sum) {
  return (double)sum.high * 0x1p32 + (double)sum.low;
}

/* What is summed up of a solid, as changes of particles' velocities: the fluid's, opposite to the
 * solid's. In 2D the third components, and of the turn the first two, stay 0. */
enum {
  PBF_LOAD_CHANGE = 0,
  PBF_LOAD_TURN = 3,   /* place before the solid's position x change */
  PBF_LOAD_WET = 6,    /* particles of a wet layer */
  PBF_LOAD_PLACE = 7,  /* their places before the solid's position */
  PBF_LOAD_ALONG = 10, /* what a wall changes along itself, which is not in its change */
  PBF_LOAD_OPEN = 13,  /* what a pressure of one at all depths would change */
  PBF_LOAD_SUMS = 16
};

typedef struct pbf_load_sums {
  pbf_wide_sum of[PBF_LOAD_SUMS];
  uint64_t contacts;
  uint64_t depth; /* the largest, as its bits, which are in order */
} pbf_load_sums;

/* Of a solver. `change` is of all velocities. Arrays are behind it. */
typedef struct pbf_load_tally {
  pbf_wide_sum change[3];
  int solids; /* that there is room for */
  pbf_load_sums *sums;
  pbf_collider_load *loads;
} pbf_load_tally;

/* The same of few colliders, in one piece. */
typedef struct pbf_few_load_tally {
  pbf_wide_sum change[3];
  pbf_load_sums sums[PBF_FEW_SOLIDS];
  pbf_collider_load loads[PBF_FEW_SOLIDS];
} pbf_few_load_tally;

PBF_FN int pbf_tally_solids(const pbf_load_tally *t) { return t->solids; }
PBF_FN int pbf_tally_solids(const pbf_few_load_tally *) { return PBF_FEW_SOLIDS; }

static inline uint64_t pbf_load_tally_bytes(uint64_t colliders) {
  return sizeof(pbf_load_tally) +
         (PBF_WALLS + colliders) * (sizeof(pbf_load_sums) + sizeof(pbf_collider_load));
}

/* In memory of that size, which is 0 but for what it has been before. */
static inline void pbf_place_load_tally(pbf_load_tally *t, uint64_t colliders) {
  t->solids = (int)(PBF_WALLS + colliders);
  t->sums = (pbf_load_sums *)(t + 1);
  t->loads = (pbf_collider_load *)(t->sums + t->solids);
}

PBF_FN void pbf_wide_add(pbf_wide_sum *to, pbf_wide_sum more) {
  to->high += more.high;
  to->low += more.low;
}

/* Units of one, of sums of velocities and of lengths by velocities or by nothing, `lever` being
 * above all of these. A number of the former is at most twice the largest speed that walls stop. */
PBF_FN double pbf_units_of_velocity(double max_speed) { return 0x1p60 / max_speed; }

/* No particle is farther from a solid's position. `periods`: of the axes without walls. */
template <class Obstacles>
PBF_FN double pbf_lever(const Obstacles &o, const pbf_periods &periods, int solid) {
  double lever = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int periodic = periods.length.c[k] > 0;
    const double lower = (double)(periodic ? periods.lower : o.domain.lower).c[k];
    const double upper = (double)(periodic ? periods.upper : o.domain.upper).c[k];
    const double at = solid < PBF_WALLS ? 0 : (double)o.surfaces[solid - PBF_WALLS].center.c[k];
    lever += fabs(upper - lower) + fabs(at - lower);
  }
  return lever;
}

PBF_FN void pbf_load_units(double units_of_velocity, double lever, double units[PBF_LOAD_SUMS]) {
  for (int k = 0; k < 3; ++k) {
    units[PBF_LOAD_CHANGE + k] = units_of_velocity;
    units[PBF_LOAD_TURN + k] = units_of_velocity / lever;
    units[PBF_LOAD_PLACE + k] = 0x1p59 / lever;
    units[PBF_LOAD_ALONG + k] = units_of_velocity;
    units[PBF_LOAD_OPEN + k] = 0x1p54;
  }
  units[PBF_LOAD_WET] = 0x1p59;
}

/* ---- A particle's part ---------------------------------------------------------------------- */

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
  template <class Obstacles, class Visit>
  PBF_IN void each(const Obstacles &o, Visit visit) const {
    for (int k = 0; k < pbf_surface_count(o); ++k) visit(k);
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
  const auto all = [&](auto meet) {
    near.each(o, [&](int k) { meet(o.surfaces[k], PBF_WALLS + k); });
  };
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
  const double near = 1 - fmax((double)p.distance, 0.0) / s->reach;
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

/* A plane's part, in units, as it is added to the sums of its solid. */
struct load_part {
  pbf_wide_sum of[PBF_LOAD_SUMS];
  uint64_t depth;
  bool touches;
};

/* How much of a layer a particle is, such that layers a spacing apart, wherever they are, are one
 * together. */
PBF_FN double wet_part(const pbf_load_scales *s, pbf_real distance) {
  return fmax(0.0, 1 - fmax((double)distance, 0.0) / (2 * s->spacing));
}

/* What the sums of a solid are told in: their units, and from where places are. */
struct load_measure {
  double units[PBF_LOAD_SUMS], origin[PBF_DIM];
};

template <class Obstacles>
PBF_FN load_measure load_measure_of(const pbf_load_scales *s, const Obstacles &o, int solid) {
  load_measure m;
  for (int k = 0; k < PBF_DIM; ++k)
    m.origin[k] = solid < PBF_WALLS ? 0 : (double)o.surfaces[solid - PBF_WALLS].center.c[k];
  pbf_load_units(s->velocity, pbf_lever(o, s->periods, solid), m.units);
  return m;
}

/* A plane's part in these sums. */
struct load_numbers {
  double of[PBF_LOAD_SUMS];
  uint64_t depth;
  bool touches;
};

PBF_FN load_numbers load_numbers_of(const pbf_load_scales *s, const load_measure &m, pbf_vec x,
                                    const pbf_load_plane &p, const load_share &share) {
  load_numbers number = {{0}, 0, (double)p.distance < s->spacing};
  double r[3] = {0}, u[3] = {0};
  const double depth = fmax(0.0, -(double)p.distance);
  for (int k = 0; k < PBF_DIM; ++k) {
    u[k] = share.change[k];
    number.of[PBF_LOAD_ALONG + k] = share.along[k];
    number.of[PBF_LOAD_OPEN + k] = share.open[k];
    r[k] = (double)x.c[k] - m.origin[k];
  }
  number.of[PBF_LOAD_WET] = wet_part(s, p.distance);
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    number.of[PBF_LOAD_CHANGE + k] = u[k];
    number.of[PBF_LOAD_TURN + k] = r[a] * u[b] - r[b] * u[a];
    number.of[PBF_LOAD_PLACE + k] = number.of[PBF_LOAD_WET] * r[k];
  }
  memcpy(&number.depth, &depth, sizeof number.depth);
  return number;
}

/* Of a force beside pushes: what is wet is counted with these. */
PBF_FN load_numbers without_wet(load_numbers number) {
  for (int k = PBF_LOAD_WET; k < PBF_LOAD_ALONG; ++k) number.of[k] = 0;
  number.depth = 0;
  return number;
}

PBF_FN bool is_none(double number) { return !(number > 0 || number < 0); }

PBF_FN load_part load_part_in(const load_measure &m, const load_numbers &number) {
  load_part part;
  for (int k = 0; k < PBF_LOAD_SUMS; ++k)
    part.of[k] =
        is_none(number.of[k]) ? pbf_wide_sum{0, 0} : pbf_wide_of(number.of[k] * m.units[k]);
  part.depth = number.depth;
  part.touches = number.touches;
  return part;
}

template <class Obstacles>
PBF_FN load_part load_part_of(const pbf_load_scales *s, const Obstacles &o, pbf_vec x,
                              const pbf_load_plane &p, const load_share &share) {
  const load_measure m = load_measure_of(s, o, p.solid);
  return load_part_in(m, load_numbers_of(s, m, x, p, share));
}

template <class Obstacles>
PBF_FN load_part load_part_beside(const pbf_load_scales *s, const Obstacles &o, pbf_vec x,
                                  const pbf_load_plane &p, const load_share &share) {
  const load_measure m = load_measure_of(s, o, p.solid);
  return load_part_in(m, without_wet(load_numbers_of(s, m, x, p, share)));
}

/* Most of a part is nothing. */
PBF_FN void add_numbers(pbf_load_sums *to, const load_measure &m, const load_numbers &number,
                        bool counts) {
  for (int k = 0; k < PBF_LOAD_SUMS; ++k)
    if (!is_none(number.of[k])) pbf_wide_add(&to->of[k], pbf_wide_of(number.of[k] * m.units[k]));
  to->contacts += counts;
  to->depth = to->depth > number.depth ? to->depth : number.depth;
}

PBF_FN void add_part(pbf_load_sums *to, const load_part &part, bool counts) {
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) pbf_wide_add(&to->of[k], part.of[k]);
  to->contacts += counts;
  to->depth = to->depth > part.depth ? to->depth : part.depth;
}

/* ---- The end of a step ---------------------------------------------------------------------- */

/* What is left of the whole along an axis, in units, and by which of their sums solids share it:
 * what they have got, or how much of them is wet where none has got anything, in proportion to its
 * size. */
typedef struct load_rest {
  double change, sum;
  int by;
} load_rest;

template <class Tally>
PBF_FN double load_sum_over(const Tally *t, int solids, int which) {
  double sum = 0;
  for (int solid = 0; solid < solids; ++solid) sum += pbf_wide_value(t->sums[solid].of[which]);
  return sum;
}

/* Of their sizes. */
template <class Tally>
PBF_FN double load_size_over(const Tally *t, int solids, int which) {
  double sum = 0;
  for (int solid = 0; solid < solids; ++solid)
    sum += fabs(pbf_wide_value(t->sums[solid].of[which]));
  return sum;
}

/* How the first `solids` of all share a change. */
template <class Tally>
PBF_FN load_rest load_rest_of(const Tally *t, int solids, int axis, double change) {
  load_rest rest = {change, load_size_over(t, solids, PBF_LOAD_CHANGE + axis),
                    PBF_LOAD_CHANGE + axis};
  if (rest.sum > 0) return rest;
  rest.by = PBF_LOAD_WET;
  rest.sum = load_size_over(t, solids, PBF_LOAD_WET);
  return rest;
}

/* What walls share, and then what is left for all, of which one pressure would do `open` in all and
 * `open_size` in sizes. */
struct load_rests {
  load_rest walls[3], all[3];
  double open[3], open_size[3];
};

/* Along axis k. */
template <class Tally>
PBF_FN void find_load_rests(const Tally *t, int k, load_rests *rests) {
  const int solids = pbf_tally_solids(t);
  const double along = load_sum_over(t, PBF_WALLS, PBF_LOAD_ALONG + k);
  const double known = load_sum_over(t, solids, PBF_LOAD_CHANGE + k) + along;
  const bool are_walls_across = load_size_over(t, PBF_WALLS, PBF_LOAD_CHANGE + k) > 0;
  double rest = pbf_wide_value(t->change[k]) - known;
  if (!are_walls_across) rest += along;
  rests->walls[k] = load_rest_of(t, PBF_WALLS, k, are_walls_across ? along : 0);
  rests->all[k] = load_rest_of(t, solids, k, rest);
  rests->open[k] = load_sum_over(t, solids, PBF_LOAD_OPEN + k);
  rests->open_size[k] = load_size_over(t, solids, PBF_LOAD_OPEN + k);
}

/* The pressure at all depths that what is left tells, by the axes along which it presses on one
 * side more than on the other: wholly where fluid has a surface that it is known to be 0 at, and
 * not at all where it is closed in. One for all axes, so that what is left along one of them
 * presses on solids along their normals. */
PBF_FN double open_pressure_left(const load_rests &rests) {
  double told = 0, open2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double net2 = rests.open[k] * rests.open[k];
    const double all2 = net2 + 0.01 * rests.open_size[k] * rests.open_size[k];
    if (all2 > 0) told += net2 / all2 * rests.all[k].change * rests.open[k];
    open2 += net2;
  }
  return open2 > 0 ? told / open2 : 0;
}

template <class Tally>
PBF_FN load_rests load_rests_of(const Tally *t) {
  load_rests rests;
  for (int k = 0; k < 3; ++k) find_load_rests(t, k, &rests);
  return rests;
}

/* Of a change that solids share. */
PBF_FN double load_share_of(const load_rest &rest, double change, const pbf_load_sums *sums) {
  return rest.sum > 0 ? change * (fabs(pbf_wide_value(sums->of[rest.by])) / rest.sum) : 0;
}

/* A solid's load from its sums. */
PBF_FN void find_load(const pbf_load_sums *sums, const load_rests &rests, bool is_wall,
                      const pbf_load_scales *s, double lever, pbf_collider_load *load) {
  double number[PBF_LOAD_SUMS], units[PBF_LOAD_SUMS], rest[3], place[3];
  pbf_load_units(s->velocity, lever, units);
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) number[k] = pbf_wide_value(sums->of[k]) / units[k];
  const double pressure = open_pressure_left(rests);
  for (int k = 0; k < 3; ++k) {
    const double left = rests.all[k].change - pressure * rests.open[k];
    rest[k] = pressure * pbf_wide_value(sums->of[PBF_LOAD_OPEN + k]);
    rest[k] += load_share_of(rests.all[k], left, sums);
    if (is_wall) rest[k] += load_share_of(rests.walls[k], rests.walls[k].change, sums);
    rest[k] /= s->velocity;
    place[k] = number[PBF_LOAD_WET] > 0 ? number[PBF_LOAD_PLACE + k] / number[PBF_LOAD_WET] : 0;
  }
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    const double turn = number[PBF_LOAD_TURN + k] + place[l] * rest[m] - place[m] * rest[l];
    load->impulse[k] = -s->mass * (number[PBF_LOAD_CHANGE + k] + rest[k]);
    load->angular_impulse[k] = PBF_DIM == 3 || k == 2 ? -s->mass * turn : 0;
  }
  load->contacts = (uint32_t)sums->contacts;
  load->wetted_area = s->mass / s->spacing * number[PBF_LOAD_WET];
  memcpy(&load->penetration, &sums->depth, sizeof load->penetration);
}

/* Adds a step's load so many times to the sums since they were read. */
PBF_FN void add_load(pbf_collider_load *load, double steps, double time_step) {
  for (int k = 0; k < 3; ++k) {
    load->impulse_sum[k] += steps * load->impulse[k];
    load->angular_impulse_sum[k] += steps * load->angular_impulse[k];
  }
  load->time_sum += steps * time_step;
}

PBF_FN bool is_solid_there(int solid, int colliders) {
  return solid < PBF_WALLS ? solid < 2 * PBF_DIM : solid < PBF_WALLS + colliders;
}

/* Once all particles have added theirs: of one solid, from what is left of the whole. */
template <class Tally, class Obstacles>
PBF_FN void end_load(Tally *t, const Obstacles &o, const load_rests &rests,
                     const pbf_load_scales *s, int solid) {
  if (!is_solid_there(solid, pbf_surface_count(o))) return;
  find_load(&t->sums[solid], rests, solid < PBF_WALLS, s, pbf_lever(o, s->periods, solid),
            &t->loads[solid]);
  add_load(&t->loads[solid], 1, s->time_step);
}

template <class Tally, class Obstacles>
PBF_FN void end_loads(Tally *t, const Obstacles &o, const pbf_load_scales *s) {
  const load_rests rests = load_rests_of(t);
  const int solids = PBF_WALLS + pbf_surface_count(o);
  for (int solid = 0; solid < solids; ++solid) end_load(t, o, rests, s, solid);
}

}  // namespace

/* ---- Between steps -------------------------------------------------------------------------- */

/* At the start of a step. */
static inline void pbf_clear_load_sums(pbf_load_tally *t) {
  memset(t->change, 0, sizeof t->change);
  memset(t->sums, 0, (size_t)t->solids * sizeof *t->sums);
}

/* Steps in which all sleep, and which are not made. */
static inline void pbf_repeat_loads(pbf_load_tally *t, uint32_t steps, double time_step) {
  for (int solid = 0; solid < t->solids; ++solid) add_load(&t->loads[solid], steps, time_step);
}

/* Colliders from this number on are other ones. */
static inline void pbf_forget_loads(pbf_load_tally *t, uint32_t collider) {
  for (uint32_t solid = PBF_WALLS + collider; solid < (uint32_t)t->solids; ++solid)
    memset(&t->loads[solid], 0, sizeof t->loads[solid]);
}

/* Once they have been read. */
PBF_FN void pbf_begin_load_sums(pbf_collider_load *load) {
  for (int k = 0; k < 3; ++k) load->impulse_sum[k] = load->angular_impulse_sum[k] = 0;
  load->time_sum = 0;
}

/* Gives loads of solids, and begins their sums anew. */
static inline void pbf_read_loads(pbf_load_tally *t, uint32_t first, uint32_t count,
                                  pbf_collider_load *out) {
  memcpy(out, t->loads + first, count * sizeof *out);
  for (uint32_t k = first; k < first + count; ++k) pbf_begin_load_sums(&t->loads[k]);
}

#endif
