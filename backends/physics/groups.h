/* Groups of solids that touch each other, and how deep water can stand in what they enclose. Host
 * only. */
#ifndef PBF_PHYSICS_GROUPS_H
#define PBF_PHYSICS_GROUPS_H

#include "physics/containers.h"

/* What one solid that need not be convex encloses, several convex ones may. */
enum { PBF_SOLIDS_OF_FIELD = 2 };

/* A group's bounds, wider on each side by what water does not pass. */
typedef struct pbf_group {
  double lower[PBF_DIM], upper[PBF_DIM];
  uint32_t solids;
} pbf_group;

static inline pbf_group pbf_group_of(const pbf_surface *s, double gap) {
  pbf_group g;
  g.solids = pbf_surface_is_field(s) ? PBF_SOLIDS_OF_FIELD : 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double middle = (double)s->center.c[k], reach = pbf_surface_extent(s, k) + gap;
    g.lower[k] = middle - reach;
    g.upper[k] = middle + reach;
  }
  return g;
}

static inline int pbf_groups_touch(const pbf_group *a, const pbf_group *b) {
  for (int k = 0; k < PBF_DIM; ++k)
    if (a->upper[k] < b->lower[k] || b->upper[k] < a->lower[k]) return 0;
  return 1;
}

static inline void pbf_group_take(pbf_group *a, const pbf_group *b) {
  a->solids += b->solids;
  for (int k = 0; k < PBF_DIM; ++k) {
    a->lower[k] = fmin(a->lower[k], b->lower[k]);
    a->upper[k] = fmax(a->upper[k], b->upper[k]);
  }
}

static inline void pbf_groups_sift(pbf_group *groups, uint32_t root, uint32_t count) {
  for (uint32_t k = root, child; (child = 2 * k + 1) < count; k = child) {
    child += child + 1 < count && groups[child].lower[0] < groups[child + 1].lower[0];
    if (!(groups[k].lower[0] < groups[child].lower[0])) return;
    const pbf_group g = groups[k];
    groups[k] = groups[child];
    groups[child] = g;
  }
}

/* By where they begin along the first axis (Williams's heapsort). */
static inline void pbf_groups_sort(pbf_group *groups, uint32_t count) {
  for (uint32_t k = count / 2; k-- > 0;) pbf_groups_sift(groups, k, count);
  for (uint32_t last = count; last-- > 1;) {
    const pbf_group g = groups[0];
    groups[0] = groups[last];
    groups[last] = g;
    pbf_groups_sift(groups, 0, last);
  }
}

/* Lets those that touch be one, and those that these then touch; their number. Which they are in
 * the end does not depend on the order. */
static inline uint32_t pbf_groups_join(pbf_group *groups, uint32_t count) {
  for (uint32_t before = count + 1; count < before;) {
    before = count;
    pbf_groups_sort(groups, count);
    for (uint32_t k = 0; k < count; ++k)
      for (uint32_t l = k + 1; l < count && groups[k].solids; ++l) {
        if (groups[l].lower[0] > groups[k].upper[0]) break;
        if (!groups[l].solids || !pbf_groups_touch(&groups[k], &groups[l])) continue;
        pbf_group_take(&groups[k], &groups[l]);
        groups[l].solids = 0;
      }
    uint32_t kept = 0;
    for (uint32_t k = 0; k < count; ++k)
      if (groups[k].solids) groups[kept++] = groups[k];
    count = kept;
  }
  return count;
}

/* The walls of all that is convex: those of the domain, farther in where a plane stands upright on
 * an axis, and the numbers of other surfaces that water is inside of. */
typedef struct pbf_group_walls {
  double lower[PBF_DIM], upper[PBF_DIM];
  const pbf_surface *surfaces;
  const uint16_t *others;
  uint32_t count; /* of these */
} pbf_group_walls;

/* 1 where it is another surface than such a plane. */
static inline int pbf_group_walls_take(pbf_group_walls *w, const pbf_surface *s) {
  for (int k = 0; k < PBF_DIM && s->shape == PBF_COLLIDER_PLANE; ++k) {
    const double at = (double)s->center.c[k], normal = (double)(s->sign * s->frame[0].c[k]);
    if (normal == 1) w->lower[k] = fmax(w->lower[k], at);
    if (normal == -1) w->upper[k] = fmin(w->upper[k], at);
    if (fabs(normal) == 1) return 0;
  }
  return 1;
}

/* `others` is room for numbers. */
static inline pbf_group_walls pbf_group_walls_of(const pbf_params *params, uint32_t count,
                                                 const pbf_surface *surfaces, uint16_t *others) {
  pbf_group_walls w;
  w.surfaces = surfaces;
  w.others = others;
  w.count = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    w.lower[k] = params->domain_min[k];
    w.upper[k] = params->domain_max[k];
  }
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_surface_is_unbounded(&surfaces[k]) && pbf_group_walls_take(&w, &surfaces[k]))
      others[w.count++] = (uint16_t)k;
  return w;
}

static inline int pbf_group_is_inside(const pbf_group *g, const pbf_surface *s) {
  for (int corner = 0; corner < 1 << PBF_DIM; ++corner) {
    pbf_vec x, normal;
    for (int k = 0; k < PBF_DIM; ++k)
      x.c[k] = (pbf_real)(corner >> k & 1 ? g->upper[k] : g->lower[k]);
    if (!(pbf_surface_distance(s, x, &normal) > 0)) return 0;
  }
  return 1;
}

/* No water that the group encloses is deeper than that along an axis; infinite where it may part
 * the domain.
 *
 * Where water can be without solids is convex, and so is each solid: one that is at no more than
 * one wall encloses nothing. A field may be a vessel by itself. Several that touch enclose what
 * lies within their bounds, unless they go from wall to wall along all axes but one. */
static inline double pbf_group_deepest(const pbf_group *g, const pbf_group_walls *w, int axis) {
  int walls = 0, both = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int low = g->lower[k] <= w->lower[k], high = g->upper[k] >= w->upper[k];
    walls += low + high;
    both += low && high;
  }
  if (both >= PBF_DIM - 1) return HUGE_VAL;
  for (uint32_t k = 0; k < w->count; ++k)
    if (!pbf_group_is_inside(g, &w->surfaces[w->others[k]])) return HUGE_VAL;
  return g->solids > 1 || walls > 1 ? g->upper[axis] - g->lower[axis] : 0;
}

/* The same of all solids: groups that do not touch enclose no more than each does alone
 * (Janiszewski's theorem). Infinite also where what stands on the floor leaves little room around
 * it. There is room for a group and a number of each. */
static inline double pbf_groups_deepest(const pbf_params *params, uint32_t count,
                                        const pbf_collider *colliders, const pbf_surface *surfaces,
                                        int axis, pbf_group *groups, uint16_t *numbers) {
  const pbf_group_walls walls = pbf_group_walls_of(params, count, surfaces, numbers);
  uint32_t all = 0;
  double deepest = 0, taken = 0;
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_is_solid(&colliders[k]))
      groups[all++] = pbf_group_of(&surfaces[k], params->smoothing_radius);
  all = pbf_groups_join(groups, all);
  for (uint32_t k = 0; k < all; ++k) {
    deepest = fmax(deepest, pbf_group_deepest(&groups[k], &walls, axis));
    taken += pbf_part_of_floor(params, axis, params->smoothing_radius, walls.lower, walls.upper,
                               groups[k].lower, groups[k].upper);
  }
  return taken < PBF_SOLIDS_TAKE ? deepest : HUGE_VAL;
}

#endif
