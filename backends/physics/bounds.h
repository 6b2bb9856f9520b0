/* How far particles get in a step, and which surfaces that lets them meet. What these tests leave
 * out would leave each particle as it is, to the bit. */
#ifndef PBF_PHYSICS_BOUNDS_H
#define PBF_PHYSICS_BOUNDS_H

#include "physics/collide.h"

/* A ball with all of some particles in it, and a box, with room for what rounding takes from their
 * distances. */
typedef struct group_bounds {
  pbf_vec center, lower, upper;
  pbf_real radius;
  pbf_real way; /* the longest that one of them is on */
} group_bounds;

static const pbf_real bounds_rounding = (pbf_real)1e-5;

PBF_FN group_bounds bounds_between(pbf_vec lower, pbf_vec upper, pbf_real way) {
  group_bounds b = {.way = (1 + bounds_rounding) * way};
  pbf_real diagonal2 = 0, away = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    pbf_real size = upper.c[k] - lower.c[k];
    b.center.c[k] = lower.c[k] + (pbf_real)0.5 * size;
    away += b.center.c[k] < 0 ? -b.center.c[k] : b.center.c[k];
    diagonal2 += size * size;
  }
  b.radius = (pbf_real)0.5 * pbf_real_sqrt(diagonal2);
  const pbf_real rounding = bounds_rounding * (b.radius + away);
  b.radius += rounding;
  for (int k = 0; k < PBF_DIM; ++k) {
    b.lower.c[k] = lower.c[k] - rounding;
    b.upper.c[k] = upper.c[k] + rounding;
  }
  return b;
}

/* A distance changes by no more than `steepest` times the way between two places, whatever the
 * shape. */
PBF_FN_NOINLINE int bounds_are_within(const group_bounds *of, const pbf_surface *s,
                                      pbf_real reach) {
  const pbf_vec arm = pbf_sub(of->center, s->center);
  const pbf_real arm2 = pbf_dot(arm, arm), far = s->bound + of->radius + reach;
  pbf_vec normal;
  if (arm2 > far * far) return 0;
  pbf_real rounding = bounds_rounding * pbf_real_sqrt(arm2);
  return !(pbf_surface_distance(s, of->center, &normal) >
           s->steepest * (of->radius + reach) + rounding);
}

/* How far a surface takes one of them along in a step, at most. */
PBF_FN pbf_real way_of_carried(const group_bounds *of, const pbf_surface *s) {
  if (!(s->turn > 0)) return s->step;
  const pbf_vec arm = pbf_sub(of->center, s->start_center);
  return s->step + s->turn * (pbf_real_sqrt(pbf_dot(arm, arm)) + of->radius);
}

/* How far a surface may push one of them that it finds inside. */
PBF_FN pbf_real way_pushed(const group_bounds *of, const pbf_surface *s, pbf_real push) {
  pbf_vec normal;
  if (!(push > 0)) return 0;
  const pbf_real depth = s->steepest * of->radius - pbf_surface_distance(s, of->center, &normal);
  return depth > 0 ? pbf_real_min(push, depth + s->skin) : 0;
}

/* How far the domain may push one of them that is outside. */
PBF_FN pbf_real way_into_domain(const group_bounds *of, const pbf_domain *domain) {
  pbf_real way2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real below = domain->lower.c[k] - (of->center.c[k] - of->radius);
    const pbf_real above = of->center.c[k] + of->radius - domain->upper.c[k];
    const pbf_real way = pbf_real_max(pbf_real_max(below, above), 0);
    way2 += way * way;
  }
  return pbf_real_sqrt(way2);
}

/* Of a surface that carries them along, `reach` being how far they get by themselves. */
PBF_FN int bounds_may_meet_moving(const group_bounds *of, const pbf_surface *s, pbf_real reach) {
  const pbf_vec arm = pbf_sub(of->center, s->start_center);
  const pbf_real far = s->bound + of->radius + reach + way_of_carried(of, s);
  return !(pbf_dot(arm, arm) > far * far);
}

/* Whether pbf_resolve_collisions may do anything to them by this surface, or ask about it: at twice
 * the skin it asks what particles are between. */
PBF_FN int bounds_may_meet(const group_bounds *of, const pbf_surface *s, int with_obstacle_motion,
                           pbf_real pushed) {
  const pbf_real reach = of->way + 2 * s->skin + pushed;
  if (with_obstacle_motion && !pbf_surface_is_unbounded(s))
    return bounds_may_meet_moving(of, s, reach);
  return bounds_are_within(of, s, reach);
}

PBF_FN group_bounds bounds_of_way(pbf_vec from, pbf_vec x) {
  pbf_vec lower = x, upper = x;
  const pbf_vec way = pbf_sub(x, from);
  for (int k = 0; k < PBF_DIM; ++k) {
    lower.c[k] = pbf_real_min(x.c[k], from.c[k]);
    upper.c[k] = pbf_real_max(x.c[k], from.c[k]);
  }
  return bounds_between(lower, upper, pbf_real_sqrt(pbf_dot(way, way)));
}

/* No shorter than the way, and found without a root. */
PBF_FN pbf_real way_along_axes(pbf_vec from, pbf_vec x) {
  pbf_real way = 0;
  for (int k = 0; k < PBF_DIM; ++k)
    way += x.c[k] < from.c[k] ? from.c[k] - x.c[k] : x.c[k] - from.c[k];
  return way;
}

namespace {

/* How far what has no other side, and the domain, push one of them before others are asked: by its
 * depth, of which they give back half at most. */
template <class Surfaces>
PBF_FN pbf_real way_kept_before(const pbf_domain *domain, const Surfaces &surfaces,
                                const group_bounds *of, int with_obstacle_motion) {
  pbf_real pushed = way_into_domain(of, domain);
  surfaces.each([&](const pbf_surface &s) {
    if (!pbf_surface_is_unbounded(&s)) return;
    pushed += way_pushed(of, &s, INFINITY) + (with_obstacle_motion ? way_of_carried(of, &s) : 0);
  });
  return (pbf_real)1.5 * pushed;
}

/* How far these and the domain push one of them: where it goes first, one after another; and then
 * from each other, by twice the longest of these ways (pbf_resolve_contacts). */
template <class Surfaces>
PBF_FN pbf_real way_pushed_by_all(const pbf_domain *domain, const Surfaces &surfaces,
                                  const group_bounds *of, int with_obstacle_motion) {
  pbf_real pushed = way_into_domain(of, domain), longest = pushed;
  surfaces.each([&](const pbf_surface &s) {
    const pbf_real way = way_pushed(of, &s, pbf_push_of(&s, with_obstacle_motion)) +
                         (with_obstacle_motion ? way_of_carried(of, &s) : 0);
    pushed += way;
    longest = pbf_real_max(longest, way);
  });
  return pushed + 2 * longest;
}

/* Those of some surfaces that a particle on a way no longer than `way` may have something to do
 * with: by the ball around it, as it asks itself but with more room. */
template <class Surfaces>
struct surfaces_on_way {
  Surfaces of;
  int with_obstacle_motion;
  pbf_vec from;
  pbf_real way;

  PBF_IN bool may_meet(const pbf_surface &s) const {
    const pbf_real reach = s.steepest * way + 2 * s.skin;
    if (pbf_surface_is_unbounded(&s)) return true;
    if (!with_obstacle_motion) return !pbf_surface_is_beyond(&s, from, reach);
    const pbf_vec arm = pbf_sub(from, s.start_center);
    const pbf_real far = s.bound + reach + s.step;
    return s.turn > 0 || !(pbf_dot(arm, arm) > far * far);
  }

  template <class Visit>
  PBF_IN void each(Visit visit) const {
    of.each([&](const pbf_surface &s) {
      if (may_meet(s)) visit(s);
    });
  }
};

template <class Surfaces>
PBF_FN surfaces_on_way<Surfaces> surfaces_on_way_of(const Surfaces &of, int with_obstacle_motion,
                                                    pbf_vec from, pbf_real way) {
  return {of, with_obstacle_motion, from, way};
}

}  // namespace

#endif
