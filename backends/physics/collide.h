/* Collision response (Algorithm 1, line 14): a particle with a way through a surface stays
 * on the side it came from, however many surfaces there are, and in whatever order. */
#ifndef PBF_PHYSICS_COLLIDE_H
#define PBF_PHYSICS_COLLIDE_H

#include "physics/contacts.h"
#include "physics/surfaces/obstacles.h"

/* ---- One surface --------------------------------------------------------------------------- */

/* What a surface has to do with a way, in bits: it is in its way; it begins inside. */
enum { PBF_IN_THE_WAY = 1, PBF_BEGINS_INSIDE = 2 };

/* Where the way of length `length` from `from` to x, `distance` before the surface, first meets it,
 * found by stepping on by the distance from it (sphere tracing); *normal is that of the surface
 * there. A way that grazes it for long comes to no end and counts as one that meets it at
 * the nearest point: shapes are convex, so none of it is before that point's tangent plane. Returns
 * 0 where it does not meet it. */
template <class Surface>
PBF_FN int pbf_meet(const Surface *s, pbf_vec from, pbf_vec x, pbf_real length, pbf_real distance,
                    pbf_vec *at, pbf_vec *normal) {
  enum { STEPS = 48 };
  pbf_real way = distance;
  for (int k = 0; k < STEPS && way < length; ++k) {
    *at = pbf_add_scaled(from, way / length, pbf_sub(x, from));
    distance = pbf_surface_distance(s, *at, normal) - s->skin;
    way += distance;
    if (distance < s->rounding) break;
  }
  if (!(way < length) && !(distance < s->rounding)) return 0;
  *at = pbf_add_scaled(*at, -distance, *normal);
  return 1;
}

/* What starts `distance` < 0 before a surface, inside, is to come out of it by as much as `push`,
 * or else to get no deeper. */
PBF_FN pbf_real pbf_way_out(pbf_real distance, pbf_real push) {
  return pbf_real_min(-distance, push);
}

/* A particle on its way from `from`, which the surface carries along, to x: where the way enters
 * it, it slides on along the tangent plane, so that nothing goes through however thin the shape
 * and however fast the particle. What starts inside leaves by the face that is nearest to the
 * start, by no more than `push`. */
template <class Surface>
PBF_FN int pbf_find_contact_on_way(const Surface *s, pbf_real push, pbf_vec from, pbf_vec x,
                                   pbf_contact *contact) {
  const pbf_vec way = pbf_sub(x, from);
  const pbf_real length = pbf_real_sqrt(pbf_dot(way, way));
  if (pbf_surface_is_beyond(s, from, length + s->skin)) return 0;
  pbf_vec at = from, normal;
  const pbf_real distance = pbf_surface_distance(s, from, &normal) - s->skin;
  if (!(distance < length)) return 0;
  if (distance < -s->rounding)
    at = pbf_add_scaled(from, pbf_way_out(distance, push), normal);
  else if (!(distance > s->rounding))
    at = pbf_add_scaled(from, -distance, normal);
  else if (!pbf_meet(s, from, x, length, distance, &at, &normal))
    return 0;
  *contact = pbf_contact_at(at, normal);
  return (pbf_contact_gap(contact, x) < -s->rounding ? PBF_IN_THE_WAY : 0) |
         (distance < -s->rounding ? PBF_BEGINS_INSIDE : 0);
}

/* The same where the surface need not be convex: what touches it, or has met it and is before the
 * tangent plane there, goes on along its way, to its end. None of that may be deeper than where
 * it began, if that was inside. */
PBF_FN_NOINLINE int pbf_find_contact_with_field(const pbf_surface *s, pbf_real push, pbf_vec from,
                                                pbf_vec x, pbf_contact *contact) {
  const pbf_vec way = pbf_sub(x, from);
  const pbf_real length = pbf_real_sqrt(pbf_dot(way, way));
  if (pbf_surface_is_beyond(s, from, length + s->skin)) return 0;
  pbf_vec at = from, normal;
  pbf_real distance = pbf_surface_distance(s, from, &normal) - s->skin;
  if (!(distance < length * s->steepest)) return 0;
  const int begins = distance < -s->rounding ? PBF_BEGINS_INSIDE : 0;
  if (!(distance > s->rounding)) {
    const pbf_real out = begins ? pbf_way_out(distance, push) : -distance;
    *contact = pbf_contact_at(pbf_add_scaled(from, out, normal), normal);
    if (pbf_contact_gap(contact, x) < -s->rounding) return PBF_IN_THE_WAY | begins;
    if (distance < -pbf_field_stride(s, 0)) return begins;
  }
  pbf_real least = pbf_real_min(distance, 0) - s->rounding, gone = 0;
  for (int steps = 0; steps < PBF_FIELD_STEPS; ++steps) {
    if (!(gone < length)) return begins;
    gone += pbf_field_stride(s, distance);
    at = gone < length ? pbf_add_scaled(from, gone / length, way) : x;
    distance = pbf_surface_distance(s, at, &normal) - s->skin;
    if (!(distance < least)) {
      least = pbf_real_max(least, pbf_real_min(distance, 0) - s->rounding);
      continue;
    }
    *contact = pbf_contact_at(pbf_add_scaled(at, -distance, normal), normal);
    if (pbf_contact_gap(contact, x) < -s->rounding) return PBF_IN_THE_WAY | begins;
  }
  for (int k = 0; k < PBF_DIM; ++k) normal.c[k] = -way.c[k] / length;
  *contact = pbf_contact_at(at, normal);
  return PBF_IN_THE_WAY | begins;
}

/* How far behind a surface without another side a particle may be that has started there. */
template <class Surface>
PBF_FN pbf_real pbf_min_distance(const Surface *s, pbf_real push, pbf_vec from) {
  pbf_vec normal;
  const pbf_real distance = pbf_surface_distance(s, from, &normal);
  return distance < -s->rounding ? distance + pbf_way_out(distance, push) : 0;
}

/* What has no other side holds particles as walls do: planes, too, make corners. */
template <class Surface>
PBF_FN int pbf_find_contact_at(const Surface *s, pbf_real push, pbf_vec from, pbf_vec x,
                               pbf_contact *contact) {
  pbf_vec normal;
  const pbf_real distance = pbf_surface_distance(s, x, &normal);
  if (!(distance < -s->rounding)) return 0;
  const pbf_real min_distance = pbf_min_distance(s, push, from);
  *contact = pbf_contact_at(pbf_add_scaled(x, min_distance - distance, normal), normal);
  return distance < min_distance - s->rounding ? PBF_IN_THE_WAY : 0;
}

/* Where a particle's way begins: `with_obstacle_motion` the surface has moved since it was there,
 * in the prediction, and otherwise not. */
PBF_FN pbf_vec pbf_way_start(const pbf_surface *s, int with_obstacle_motion, pbf_vec from) {
  return with_obstacle_motion ? pbf_surface_carries(s, from) : from;
}

PBF_FN pbf_real pbf_push_of(const pbf_surface *s, int with_obstacle_motion) {
  return with_obstacle_motion ? s->prediction_push : s->iteration_push;
}

/* Whether the surface has something against the way of a particle from `from` to x, and the plane
 * that it then stays before; what is found inside it takes out by as much as `push`. */
template <class Surface>
PBF_FN_HOST_NOINLINE int pbf_find_contact(const Surface *s, pbf_real push, int with_obstacle_motion,
                                          pbf_vec from, pbf_vec x, pbf_contact *contact) {
  const pbf_vec start = pbf_way_start(s, with_obstacle_motion, from);
  if (pbf_surface_is_field(s)) return pbf_find_contact_with_field(s, push, start, x, contact);
  return pbf_surface_is_unbounded(s) ? pbf_find_contact_at(s, push, start, x, contact)
                                     : pbf_find_contact_on_way(s, push, start, x, contact);
}

/* The same, where it is asked for seldom and from many places. */
template <class Surface>
PBF_FN_NOINLINE int pbf_find_contact_seldom(const Surface *s, pbf_real push,
                                            int with_obstacle_motion, const pbf_vec &from,
                                            const pbf_vec &x, pbf_contact *contact) {
  return pbf_find_contact(s, push, with_obstacle_motion, from, x, contact);
}

PBF_FN int pbf_find_wall_contact(const pbf_domain *domain, int wall, pbf_vec x,
                                 pbf_contact *contact) {
  const pbf_real distance = pbf_wall_distance(domain, wall, x);
  if (!(distance < -domain->rounding)) return 0;
  pbf_vec normal = {{0}};
  normal.c[wall / 2] = wall % 2 ? (pbf_real)-1 : (pbf_real)1;
  *contact = pbf_contact_at(pbf_add_scaled(x, -distance, normal), normal);
  return 1;
}

/* What has no other side gives back of the depth what walls do, unless the particle has been behind
 * it before. */
template <class Surface>
PBF_FN pbf_vec pbf_keep_out(const pbf_domain *domain, const Surface *s, int with_obstacle_motion,
                            pbf_vec from, pbf_vec x) {
  pbf_vec normal;
  const pbf_real distance = pbf_surface_distance(s, x, &normal);
  if (!(distance < 0)) return x;
  const pbf_real min_distance = pbf_min_distance(s, pbf_push_of(s, with_obstacle_motion),
                                                 pbf_way_start(s, with_obstacle_motion, from));
  const pbf_real bounce = min_distance < 0 ? 0 : pbf_bounce(domain, -distance);
  return distance < min_distance ? pbf_add_scaled(x, min_distance + bounce - distance, normal) : x;
}

/* ---- All of them --------------------------------------------------------------------------- */

namespace {

/* Surfaces in an array or a list. Another set of them has the same function each(visit), which
 * calls visit(surface) for one after another. */
template <class Surfaces>
struct surface_array {
  int count;
  Surfaces of;

  template <class Visit>
  PBF_IN void each(Visit visit) const {
    for (int k = 0; k < count; ++k) visit(of[k]);
  }
};

template <class Surfaces>
PBF_FN surface_array<Surfaces> surface_array_of(int count, Surfaces of) {
  return {count, of};
}

/* The way of a particle from `from` to wherever. */
template <class Surfaces>
struct collision {
  const pbf_domain *domain;
  const Surfaces *surfaces;
  int with_obstacle_motion;
  pbf_vec from;

  /* How far a surface takes what begins at `from`: along with it, and out of it. */
  template <class Surface>
  PBF_IN pbf_real way_by(const Surface &s) const {
    pbf_vec normal;
    const pbf_vec start = pbf_way_start(&s, with_obstacle_motion, from);
    const pbf_vec carried = pbf_sub(start, from);
    const pbf_real depth = s.skin - pbf_surface_distance(&s, start, &normal);
    const pbf_real out = pbf_real_min(depth, pbf_push_of(&s, with_obstacle_motion));
    return pbf_real_sqrt(pbf_dot(carried, carried)) + pbf_real_max(out, 0);
  }

  /* Calls visit(contact, rounding, way) for those that x has with surfaces and walls; these push a
   * particle that they find inside by that `part` of what they may, or with 0 only keep it from
   * getting deeper. `way`: how far they may take it. */
  template <class Visit>
  PBF_IN void each_contact(const pbf_vec &x, pbf_real part, Visit visit) const {
    surfaces->each([&](const auto &s) {
      pbf_contact contact;
      const pbf_real out = part > 0 ? part * pbf_push_of(&s, with_obstacle_motion) : 0;
      if (pbf_find_contact_seldom(&s, out, with_obstacle_motion, from, x, &contact) &
          PBF_IN_THE_WAY)
        visit(contact, s.rounding, part > 0 ? way_by(s) : 0);
    });
    for (int wall = 0; wall < 2 * PBF_DIM; ++wall) {
      pbf_contact contact;
      if (pbf_find_wall_contact(domain, wall, x, &contact))
        visit(contact, domain->rounding,
              pbf_real_max(-pbf_wall_distance(domain, wall, from), (pbf_real)0));
    }
  }

  PBF_IN bool is_free(const pbf_vec &x) const {
    bool free = true;
    each_contact(x, 0, [&](const pbf_contact &, pbf_real, pbf_real) { free = false; });
    return free;
  }

  PBF_IN pbf_real distance_from_start(const pbf_vec &x) const {
    const pbf_vec way = pbf_sub(x, from);
    return pbf_real_sqrt(pbf_dot(way, way));
  }

  /* Where there is no room between obstacles that close on each other: as deep in the one as in the
   * other, in the mean. */
  PBF_IN pbf_vec between(pbf_vec x) const {
    for (int pass = 0; pass < 4; ++pass) {
      pbf_vec sum = x;
      each_contact(x, 0, [&](const pbf_contact &contact, pbf_real, pbf_real) {
        sum = pbf_add_scaled(sum, (pbf_real)-0.5 * pbf_contact_gap(&contact, x), contact.normal);
      });
      x = sum;
    }
    return pbf_keep_in_domain(domain, x);
  }

  /* Where nothing has been found for it: it stays where it was, or goes along with a surface in its
   * way that leaves it room. */
  PBF_IN pbf_vec stay(pbf_vec x) const {
    bool stays = is_free(from);
    pbf_vec place = from;
    if (with_obstacle_motion && !stays)
      surfaces->each([&](const auto &s) {
        pbf_contact contact;
        if (stays || pbf_surface_is_unbounded(&s)) return;
        if (!pbf_find_contact_seldom(&s, 0, with_obstacle_motion, from, x, &contact)) return;
        place = pbf_keep_in_domain(domain, pbf_surface_carries(&s, from));
        stays = is_free(place);
      });
    return stays ? place : between(x);
  }
};

/* Whether a particle is inside one of the surfaces that `may_squeeze` tells, and at another one or
 * a wall: between what has closed on it. Each tells by its own skin, twice as thick, so that those
 * farther away than that need not be asked. */
template <class Surfaces, class MaySqueeze>
PBF_FN bool pbf_is_between(const pbf_domain *domain, const Surfaces &surfaces, const pbf_vec &x,
                           MaySqueeze may_squeeze) {
  int inside = 0, at = 0;
  pbf_real skin = 0;
  surfaces.each([&](const auto &s) {
    if (pbf_surface_is_beyond(&s, x, s.skin)) return;
    pbf_vec normal;
    const pbf_real distance = pbf_surface_distance(&s, x, &normal);
    const pbf_real min_distance = pbf_surface_is_unbounded(&s) ? 0 : s.skin;
    if (!(distance - s.skin < s.skin)) return;
    skin = pbf_real_max(skin, s.skin);
    inside += may_squeeze(s) && distance - min_distance < -4 * s.rounding;
    ++at;
  });
  return inside > 0 && (at > 1 || pbf_domain_distance(domain, x) < skin);
}

template <class Obstacles>
PBF_FN bool pbf_is_squeezed_by(const Obstacles &o, const pbf_vec &x) {
  const auto surfaces = surface_array_of(pbf_surface_count(o), o.surfaces);
  return surfaces.count > 0 &&
         pbf_is_between(&o.domain, surfaces, x, [](const auto &) { return true; });
}

/* Obstacle after obstacle pushes *x off, until none has anything to do: one may push a particle
 * into another. Those that it starts in take it out by that `part` of their push. Returns whether
 * there is such a place, no farther away than `way` and twice what one of them alone may push it
 * by. */
template <class Surfaces>
PBF_FN bool pbf_push_off(const collision<Surfaces> &of, pbf_real part, pbf_real way, pbf_vec *x) {
  enum { PASSES = 8 };
  pbf_contacts held = {0, {{{{0}}, 0}}};
  pbf_real longest = 0; /* of the ways by which one of them has pushed it */
  bool pushed = true, near = true;
  for (int pass = 0; pass < PASSES && pushed && near; ++pass) {
    pushed = false;
    of.each_contact(*x, part, [&](const pbf_contact &contact, pbf_real rounding, pbf_real push) {
      if (!near) return;
      pbf_hold_by_contact(&held, &contact, rounding, x);
      longest = pbf_real_max(longest, push);
      pushed = true;
      near = !(of.distance_from_start(*x) > way + 2 * (longest + rounding));
    });
  }
  return !pushed;
}

/* Two that close on a particle at an acute angle meet far away: none of that is a way that they
 * push it. What starts inside one of them is out of it the later, then, the more acute the angle:
 * by a part of the push that takes it no farther along the other one than elsewhere. Where that
 * does not help it stays between them. */
template <class Surfaces>
PBF_FN_NOINLINE pbf_vec pbf_resolve_contacts(const collision<Surfaces> &of, pbf_vec x) {
  /* The nearest face says nothing of how it has come in: it would slip through what closes on it,
   * unless that has no other side. */
  const auto has_faces = [](const auto &s) { return !pbf_surface_is_unbounded(&s); };
  if (!of.with_obstacle_motion && pbf_is_between(of.domain, *of.surfaces, of.from, has_faces))
    return of.from;
  const pbf_real way = of.distance_from_start(x);
  const pbf_real least =
      of.with_obstacle_motion ? (pbf_real)0.01 : 1; /* else nothing is pushed out */
  for (pbf_real part = 1; !(part < least); part /= 4) {
    pbf_vec place = x;
    if (pbf_push_off(of, part, way, &place)) return place;
  }
  return of.stay(x);
}

/* Where what has no other side, and then the domain, keep a particle that is on its way from `from`
 * to x. */
template <class Surfaces>
PBF_FN pbf_vec pbf_keep_before(const pbf_domain *domain, const Surfaces &surfaces,
                               int with_obstacle_motion, pbf_vec from, pbf_vec x) {
  surfaces.each([&](const auto &s) {
    if (pbf_surface_is_unbounded(&s)) x = pbf_keep_out(domain, &s, with_obstacle_motion, from, x);
  });
  return pbf_keep_in_domain(domain, x);
}

/* Whether any of them has something against its way there. */
template <class Surfaces>
PBF_FN bool pbf_touches_any(const Surfaces &surfaces, int with_obstacle_motion, pbf_vec from,
                            pbf_vec x) {
  bool touched = false;
  surfaces.each([&](const auto &s) {
    pbf_contact contact;
    touched = touched || pbf_find_contact(&s, pbf_push_of(&s, with_obstacle_motion),
                                          with_obstacle_motion, from, x, &contact) != 0;
  });
  return touched;
}

/* The way of a particle from `from` to x. What is found in one of them then, since it has been set
 * there, leaves it bit by bit, in the prediction; iterations ask for what that has reached. */
template <class Surfaces>
PBF_FN pbf_vec pbf_resolve_among(const pbf_domain *domain, const Surfaces &surfaces,
                                 int with_obstacle_motion, pbf_vec from, pbf_vec x) {
  x = pbf_keep_before(domain, surfaces, with_obstacle_motion, from, x);
  if (!pbf_touches_any(surfaces, with_obstacle_motion, from, x)) return x;
  const collision<Surfaces> of = {domain, &surfaces, with_obstacle_motion, from};
  /* Whatever a collider does, the domain holds. */
  return pbf_keep_in_domain(domain, pbf_resolve_contacts(of, x));
}

template <class Obstacles>
PBF_FN pbf_vec pbf_resolve_collisions(const Obstacles &o, int with_obstacle_motion, pbf_vec from,
                                      pbf_vec x) {
  const auto surfaces = surface_array_of(pbf_surface_count(o), o.surfaces);
  return pbf_resolve_among(&o.domain, surfaces, with_obstacle_motion, from, x);
}

/* What is left of a move from x. */
template <class Obstacles>
PBF_FN_NOINLINE pbf_vec pbf_move_past_obstacles(const Obstacles &o, pbf_vec x, pbf_vec move) {
  return pbf_sub(pbf_resolve_collisions(o, 0, x, pbf_add_scaled(x, 1, move)), x);
}

}  // namespace

#endif
