/* All surfaces that the fluid meets: the domain's and the colliders'; and which of them move. */
#ifndef PBF_PHYSICS_SURFACES_OBSTACLES_H
#define PBF_PHYSICS_SURFACES_OBSTACLES_H

#include "physics/depenetration.h"
#include "physics/surfaces/domain.h"
#include "physics/surfaces/surface.h"

/* Where they are at a time. A backend may hold them elsewhere, in a struct with members of the same
 * names. */
typedef struct pbf_obstacles {
  pbf_domain domain;
  int count;
  pbf_surface surfaces[PBF_MAX_COLLIDERS];
} pbf_obstacles;

namespace {

/* A build without colliders has no code for them. */
template <class Obstacles>
PBF_FN int pbf_surface_count(const Obstacles &o) {
  return PBF_BUILT & PBF_FEATURE_COLLIDERS ? o.count : 0;
}

}  // namespace

/* How far before a surface with another side particles stay: by so much surfaces that touch
 * overlap, and those that stand on a wall overlap with it. Between two faces in one plane, where
 * what lies on both is in neither, a particle that slid on the one went on through the seam. More
 * than rounding takes from places, and so little that nobody sees it. (Rigid bodies have such
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
static inline pbf_surface pbf_obstacle_at(const pbf_params *params, const pbf_domain *domain,
                                          const pbf_collider *at_set, double elapsed) {
  pbf_surface s = pbf_surface_at(at_set, elapsed, params->time_step);
  pbf_set_margins(params, domain, &s);
  pbf_set_push(params, &s);
  return s;
}

/* At `time`, of colliders that were set at `set_at`. */
static inline void pbf_place_obstacles(const pbf_params *params, uint32_t count,
                                       const pbf_collider *colliders, double set_at, double time,
                                       pbf_obstacles *o) {
  o->domain = pbf_domain_at(params, time);
  o->count = (int)count;
  for (int k = 0; k < pbf_surface_count(*o); ++k)
    o->surfaces[k] = pbf_obstacle_at(params, &o->domain, &colliders[k], time - set_at);
}

/* ---- Which of them move --------------------------------------------------------------------- */

/* A bit each. */
typedef struct pbf_moving_obstacles {
  uint32_t walls;
  uint64_t surfaces;
} pbf_moving_obstacles;

static inline int pbf_collider_moves(const pbf_collider *collider) {
  int moves =
      collider->radius_rate != 0 || collider->half_length_rate != 0 || collider->scale_rate != 0;
  for (int a = 0; a < 3; ++a)
    moves = moves || collider->velocity[a] != 0 || collider->angular_velocity[a] != 0 ||
            collider->half_extents_rate[a] != 0;
  return moves;
}

static inline pbf_moving_obstacles pbf_moving_obstacles_of(const pbf_params *params, uint32_t count,
                                                           const pbf_collider *colliders) {
  pbf_moving_obstacles m = {0, 0};
  for (int w = 0; w < 2 * PBF_DIM; ++w)
    if (params->wall_velocity[w] != 0 ||
        (params->wall_amplitude[w] != 0 && params->wall_frequency[w] != 0))
      m.walls |= 1u << w;
  if (!(PBF_BUILT & PBF_FEATURE_COLLIDERS)) return m;
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_collider_moves(&colliders[k])) m.surfaces |= UINT64_C(1) << k;
  return m;
}

/* Those of them that still move in a step that begins `elapsed` after they were set. */
static inline pbf_moving_obstacles pbf_still_moving(pbf_moving_obstacles m, uint32_t count,
                                                    const pbf_collider *colliders, double elapsed) {
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_motion_has_ended(&colliders[k], elapsed)) m.surfaces &= ~(UINT64_C(1) << k);
  return m;
}

static inline int pbf_any_obstacle_moves(pbf_moving_obstacles m) { return m.walls || m.surfaces; }

/* Of the colliders `now` and `next`: those that are not the same in both, or move, and so may stand
 * elsewhere. */
static inline pbf_moving_obstacles pbf_changed_surfaces(uint32_t count, const pbf_collider *now,
                                                        uint32_t next_count,
                                                        const pbf_collider *next) {
  static const pbf_collider none[1] = {{0}};
  pbf_moving_obstacles m = {0, 0};
  for (uint32_t k = 0; k < count || k < next_count; ++k) {
    const pbf_collider *a = k < count ? &now[k] : none, *b = k < next_count ? &next[k] : none;
    if (memcmp(a, b, sizeof *a) != 0) m.surfaces |= UINT64_C(1) << k;
  }
  return m;
}

namespace {

/* Whether one of them is within `reach` of x. */
template <class Obstacles>
PBF_FN int pbf_near_moving_obstacle(pbf_moving_obstacles m, const Obstacles &o, pbf_real reach,
                                    pbf_vec x) {
  for (int w = 0; w < 2 * PBF_DIM && m.walls; ++w)
    if (m.walls >> w & 1 && pbf_wall_distance(&o.domain, w, x) < reach) return 1;
  for (int k = 0; k < pbf_surface_count(o) && m.surfaces; ++k) {
    pbf_vec normal;
    if (!(m.surfaces >> k & 1) || pbf_surface_is_beyond(&o.surfaces[k], x, reach)) continue;
    if (pbf_surface_distance(&o.surfaces[k], x, &normal) < reach) return 1;
  }
  return 0;
}

}  // namespace

#endif
