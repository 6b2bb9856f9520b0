/* All surfaces that the fluid meets: the domain's and the colliders'; and which of them move. */
#ifndef PBF_PHYSICS_SURFACES_OBSTACLES_H
#define PBF_PHYSICS_SURFACES_OBSTACLES_H

#include "physics/depenetration.h"
#include "physics/surfaces/domain.h"
#include "physics/surfaces/near.h"
#include "physics/surfaces/surface.h"

/* So many colliders have a bit each in one number. */
enum { PBF_FEW_COLLIDERS = 64 };

/* So many are asked one after another. Of more, on a CPU, a grid tells which are near
 * (surfaces/near.h). */
enum { PBF_ASKED_COLLIDERS = 16 };

/* Some of the surfaces of an array, by their numbers, which ascend. */
struct pbf_surface_list {
  const pbf_surface *all;
  const uint16_t *numbers; /* null: all, one after another */

  PBF_IN int number(int k) const { return numbers ? numbers[k] : k; }
  PBF_IN const pbf_surface &operator[](int k) const { return all[number(k)]; }
};

/* Which one the k-th of some is. */
PBF_FN int pbf_surface_number(const pbf_surface_list &list, int k) { return list.number(k); }
PBF_FN int pbf_surface_number(const pbf_surface *, int k) { return k; }

/* Where they are at a time. A backend may hold them elsewhere, in a struct with members of the same
 * names. */
typedef struct pbf_obstacles {
  pbf_domain domain;
  int count;
  pbf_surface_list surfaces;
  pbf_surface_grid *grid; /* of all of them; null: they are few */
  uint16_t *room;         /* a thread's own, for PBF_OBSTACLE_LISTS lists of their numbers */
} pbf_obstacles;

namespace {

/* Calls visit(surface, number) for some of a step's surfaces, the first of which has this number.
 * Not a closure: device code holds it by value where functions are not inlined. */
template <class Surfaces>
struct each_surface {
  Surfaces surfaces;
  int count, first;

  template <class Visit>
  PBF_IN void operator()(Visit visit) const {
    for (int k = 0; k < count; ++k) visit(surfaces[k], first + k);
  }
};

/* … as they stood `before` the step, or after it. */
template <class Surfaces>
struct each_surface_at_time {
  Surfaces surfaces;
  int count, before;

  template <class Visit>
  PBF_IN void operator()(Visit visit) const {
    for (int k = 0; k < count; ++k)
      visit(before ? pbf_surface_before(&surfaces[k]) : surfaces[k], k);
  }
};

}  // namespace

/* What the cells of the grid list together, what is left of that, and of this for one particle. */
enum { PBF_OBSTACLE_LISTS = 3 };

namespace {

/* A build without colliders has no code for them. */
template <class Obstacles>
PBF_FN int pbf_surface_count(const Obstacles &o) {
  return PBF_BUILT & PBF_FEATURE_COLLIDERS ? o.count : 0;
}

template <class Obstacles>
PBF_FN auto all_surfaces_of(const Obstacles &o, int first = 0) {
  return each_surface<decltype(o.surfaces)>{o.surfaces, pbf_surface_count(o), first};
}

}  // namespace

/* How far before a surface with another side particles stay: by so much surfaces that touch
 * overlap, and those that stand on a wall overlap with it. Between two faces in one plane, where
 * what lies on both is in neither, a particle that slid on the one went on through the seam. More
 * than rounding takes from places, and too little to be seen. (Rigid bodies have such
 * skins, too: Box2D's polygon radius, Jolt's convex radius.) */
static inline void pbf_set_margins(const pbf_params *params, const pbf_domain *domain,
                                   pbf_surface *s) {
  double extent = pbf_surface_is_unbounded(s) ? 0 : (double)s->bound;
  for (int k = 0; k < PBF_DIM; ++k) extent += fabs((double)s->center.c[k]);
  const double rounding = (double)domain->rounding + pbf_rounding_within(extent);
  s->rounding = (pbf_real)rounding;
  s->skin = (pbf_real)(pbf_surface_is_unbounded(s)
                           ? 0
                           : fmax(1e-3 * params->smoothing_radius, 16 * rounding));
}

/* What lands in a collider that has been set there, or jumps, or grows at once, would be thrown out
 * of it: depth over time step is a speed without bound. So it leaves at a bounded one. A step
 * without time, a projection, has no speeds; and without collisions in the prediction there is no
 * telling what has just come in. */
static inline void pbf_set_push(const pbf_params *params, pbf_surface *s) {
  const double way = pbf_max_depenetration_speed_of(params, PBF_DIM) * params->time_step;
  s->prediction_push = (pbf_real)(params->time_step > 0 ? way : INFINITY);
  s->iteration_push = params->collide & PBF_COLLIDE_AFTER_PREDICTION ? 0 : (pbf_real)INFINITY;
}

/* A collider at the end of a step between these walls, `elapsed` after it was set. */
static inline __attribute__((noinline)) pbf_surface pbf_obstacle_at(const pbf_params *params,
                                                                    const pbf_domain *domain,
                                                                    const pbf_collider *at_set,
                                                                    double elapsed) {
  pbf_surface s = pbf_surface_at(at_set, elapsed, params->time_step);
  pbf_set_margins(params, domain, &s);
  pbf_set_push(params, &s);
  return s;
}

/* At `time`, of colliders that were set at `set_at`, to `surfaces`. */
static inline void pbf_place_obstacles(const pbf_params *params, uint32_t count,
                                       const pbf_collider *colliders, double set_at, double time,
                                       int close_phases, pbf_surface *surfaces, pbf_obstacles *o) {
  o->domain = pbf_domain_at(params, time, close_phases);
  o->count = (int)count;
  o->surfaces = {surfaces, NULL};
  o->grid = NULL;
  for (int k = 0; k < pbf_surface_count(*o); ++k)
    surfaces[k] = pbf_obstacle_at(params, &o->domain, &colliders[k], time - set_at);
}

/* ---- Which of them are near ----------------------------------------------------------------- */

/* How far places are from what they may ask about by pbf_obstacles_near, at most: as far as solids
 * have a part in pushes. */
static inline double pbf_obstacles_reach(const pbf_params *params) {
  const double h = params->smoothing_radius;
  return 1.002 * fmax(h, 2 * pbf_derive_spacing(params)) + 4e-3 * h;
}

/* Those that may be within `reach` of x. */
static inline pbf_obstacles pbf_obstacles_near(const pbf_obstacles &all, pbf_vec x,
                                               pbf_real reach) {
  pbf_obstacles near = all;
  if (!all.grid || (double)reach > all.grid->reach) return near;
  near.count = (int)pbf_surfaces_at(all.grid, x, &near.surfaces.numbers);
  return near;
}

/* Those that may be within `reach` of something in a box, in the room for them. */
static inline pbf_obstacles pbf_obstacles_around(const pbf_obstacles &all, pbf_vec lower,
                                                 pbf_vec upper, pbf_real reach) {
  pbf_obstacles near = all;
  if (!all.grid) return near;
  near.count = (int)pbf_surfaces_around(all.grid, lower, upper, (double)reach, all.room + all.count,
                                        &near.surfaces.numbers);
  return near;
}

/* ---- Which of them move --------------------------------------------------------------------- */

/* Some of the colliders: of the few first ones a bit each, and of the others, if there are any. */
typedef struct pbf_moving_obstacles {
  uint32_t walls;
  uint32_t others; /* how many of these */
  uint64_t surfaces;
  const uint64_t *more;
} pbf_moving_obstacles;

static inline uint32_t pbf_words_of(uint32_t colliders) {
  return (colliders + PBF_FEW_COLLIDERS - 1) / PBF_FEW_COLLIDERS;
}

/* Whether collider k is in a set, `first` of the few first ones and `more` of the others. */
PBF_FN int pbf_set_has(uint64_t first, const uint64_t *more, int k) {
  return (int)((k < PBF_FEW_COLLIDERS ? first : more[k / PBF_FEW_COLLIDERS - 1]) >>
                   k % PBF_FEW_COLLIDERS &
               1);
}

static inline int pbf_collider_moves(const pbf_collider *collider) {
  int moves =
      collider->radius_rate != 0 || collider->half_length_rate != 0 || collider->scale_rate != 0;
  for (int a = 0; a < 3; ++a)
    moves = moves || collider->velocity[a] != 0 || collider->angular_velocity[a] != 0 ||
            collider->half_extents_rate[a] != 0;
  return moves;
}

namespace {

/* Makes a set of those that has(k) says, `room` being for the others' bits. */
template <class Has>
static inline void find_set(uint32_t count, uint64_t *room, pbf_moving_obstacles *m, Has has) {
  m->surfaces = 0;
  m->others = 0;
  m->more = room;
  for (uint32_t word = 1; word < pbf_words_of(count); ++word) room[word - 1] = 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!has(k)) continue;
    const uint64_t bit = UINT64_C(1) << k % PBF_FEW_COLLIDERS;
    if (k < PBF_FEW_COLLIDERS) {
      m->surfaces |= bit;
    } else {
      room[k / PBF_FEW_COLLIDERS - 1] |= bit;
      ++m->others;
    }
  }
}

}  // namespace

static inline pbf_moving_obstacles pbf_moving_obstacles_of(const pbf_params *params, uint32_t count,
                                                           const pbf_collider *colliders,
                                                           uint64_t *room) {
  pbf_moving_obstacles m = {0, 0, 0, room};
  for (int w = 0; w < 2 * PBF_DIM; ++w)
    if (params->wall_velocity[w] != 0 ||
        (params->wall_amplitude[w] != 0 && params->wall_frequency[w] != 0))
      m.walls |= 1u << w;
  if (!(PBF_BUILT & PBF_FEATURE_COLLIDERS)) return m;
  find_set(count, room, &m, [&](uint32_t k) { return pbf_collider_moves(&colliders[k]) != 0; });
  return m;
}

/* Those of them that still move in a step that begins `elapsed` after they were set. Of the others
 * the bits are in `still`, once pbf_note_still_moving has written them. */
static inline pbf_moving_obstacles pbf_still_moving(pbf_moving_obstacles m, uint32_t count,
                                                    const pbf_collider *colliders, double elapsed,
                                                    const uint64_t *still) {
  for (uint32_t k = 0; k < count && k < PBF_FEW_COLLIDERS; ++k)
    if (pbf_motion_has_ended(&colliders[k], elapsed)) m.surfaces &= ~(UINT64_C(1) << k);
  for (uint32_t k = PBF_FEW_COLLIDERS; k < count && m.others; ++k)
    m.others -= pbf_set_has(0, m.more, (int)k) && pbf_motion_has_ended(&colliders[k], elapsed);
  m.more = still;
  return m;
}

static inline void pbf_note_still_moving(const pbf_moving_obstacles &m, uint32_t count,
                                         const pbf_collider *colliders, double elapsed,
                                         uint64_t *still) {
  pbf_moving_obstacles all;
  if (count > PBF_FEW_COLLIDERS)
    find_set(count, still, &all, [&](uint32_t k) {
      return pbf_set_has(m.surfaces, m.more, (int)k) &&
             !pbf_motion_has_ended(&colliders[k], elapsed);
    });
}

static inline int pbf_any_obstacle_moves(pbf_moving_obstacles m) {
  return m.walls || m.surfaces || m.others;
}

/* Whether one of a list is the same as a collider that has the number k in another one, and is not
 * in `moving`, or null. A caller's list may be in another order each time, as where one has been
 * erased: some around k are looked at, as many on each side. */
static inline bool pbf_is_listed(const pbf_collider *of, uint32_t k, uint32_t count,
                                 const pbf_collider *list, const pbf_moving_obstacles *moving) {
  constexpr uint32_t LOOKED_AT = 16;
  const auto is_it = [&](uint32_t j) {
    return j < count && memcmp(of, &list[j], sizeof *of) == 0 &&
           !(moving && pbf_set_has(moving->surfaces, moving->more, (int)j));
  };
  bool found = is_it(k);
  for (uint32_t away = 1; away <= LOOKED_AT && !found; ++away)
    found = (away <= k && is_it(k - away)) || is_it(k + away);
  return found;
}

/* Of the colliders `now`: those that are in `moving`, or not among `next`, and so may have stood
 * elsewhere. */
static inline pbf_moving_obstacles pbf_leaving_surfaces(uint32_t count, const pbf_collider *now,
                                                        uint32_t next_count,
                                                        const pbf_collider *next,
                                                        const pbf_moving_obstacles &moving,
                                                        uint64_t *room) {
  pbf_moving_obstacles m = {0, 0, 0, room};
  find_set(count, room, &m, [&](uint32_t k) {
    return pbf_set_has(moving.surfaces, moving.more, (int)k) ||
           !pbf_is_listed(&now[k], k, next_count, next, NULL);
  });
  return m;
}

/* Of the colliders `next`: those that have not stood there among `now`. */
static inline pbf_moving_obstacles pbf_coming_surfaces(uint32_t count, const pbf_collider *now,
                                                       uint32_t next_count,
                                                       const pbf_collider *next,
                                                       const pbf_moving_obstacles &moving,
                                                       uint64_t *room) {
  pbf_moving_obstacles m = {0, 0, 0, room};
  find_set(next_count, room, &m,
           [&](uint32_t k) { return !pbf_is_listed(&next[k], k, count, now, &moving); });
  return m;
}

/* Of the colliders `now`: those that stood still, not being in `moving`, and do not stay as they
 * are in `next`. */
static inline pbf_moving_obstacles pbf_departing_surfaces(uint32_t count, const pbf_collider *now,
                                                          uint32_t next_count,
                                                          const pbf_collider *next,
                                                          const pbf_moving_obstacles &moving,
                                                          uint64_t *room) {
  pbf_moving_obstacles m = {0, 0, 0, room};
  find_set(count, room, &m, [&](uint32_t k) {
    return !pbf_set_has(moving.surfaces, moving.more, (int)k) &&
           !pbf_is_listed(&now[k], k, next_count, next, NULL);
  });
  return m;
}

/* Of `count` colliders that have come: those that now stand still. */
static inline pbf_moving_obstacles pbf_arriving_surfaces(uint32_t count,
                                                         const pbf_moving_obstacles &come,
                                                         const pbf_moving_obstacles &moving,
                                                         uint64_t *room) {
  pbf_moving_obstacles m = {0, 0, 0, room};
  find_set(count, room, &m, [&](uint32_t k) {
    return pbf_set_has(come.surfaces, come.more, (int)k) &&
           !pbf_set_has(moving.surfaces, moving.more, (int)k);
  });
  return m;
}

namespace {

/* Whether one of them is within `reach` of x. */
template <class Obstacles>
PBF_FN int pbf_near_moving_obstacle(const pbf_moving_obstacles &m, const Obstacles &o,
                                    pbf_real reach, pbf_vec x) {
  for (int w = 0; w < 2 * PBF_DIM && m.walls; ++w)
    if (m.walls >> w & 1 && pbf_wall_distance(&o.domain, w, x) < reach) return 1;
  for (int k = 0; k < pbf_surface_count(o) && (m.surfaces || m.others); ++k) {
    pbf_vec normal;
    if (!pbf_set_has(m.surfaces, m.more, pbf_surface_number(o.surfaces, k))) continue;
    if (pbf_surface_is_beyond(&o.surfaces[k], x, reach)) continue;
    if (pbf_surface_distance(&o.surfaces[k], x, &normal) < reach) return 1;
  }
  return 0;
}

}  // namespace

#endif
