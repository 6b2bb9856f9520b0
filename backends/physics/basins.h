/* How deep water can stand between colliders that hold it as a vessel's walls do: between boxes
 * that make a pool, or behind a gate. Host only. */
#ifndef PBF_PHYSICS_BASINS_H
#define PBF_PHYSICS_BASINS_H

#include "physics/containers.h"

/* Points are spaced evenly in a region, and two next to each other are connected unless a solid is
 * between them, as in pressure_grid/compartments.h. Level by level, those that hang together are a
 * basin, unless water would leave the region from it. */
enum {
  PBF_BASIN_POINTS = 12, /* along an axis */
  PBF_BASIN_LEVEL = PBF_DIM == 3 ? PBF_BASIN_POINTS * PBF_BASIN_POINTS : PBF_BASIN_POINTS,
  PBF_BASIN_ALL = PBF_BASIN_LEVEL * PBF_BASIN_POINTS
};

typedef struct pbf_basin_region {
  double lower[PBF_DIM], spacing[PBF_DIM];
  int walled[2 * PBF_DIM]; /* whether the domain's walls are at its ends */
  int axis, down;          /* of gravity, and whether it points to lower coordinates */
} pbf_basin_region;

/* What hangs together with a point: its root, and there the number of points, the lowest level, and
 * whether water leaves from it. */
typedef struct pbf_basin_points {
  uint8_t free[PBF_BASIN_ALL];
  uint16_t root[PBF_BASIN_ALL], count[PBF_BASIN_ALL];
  uint8_t lowest[PBF_BASIN_ALL], open[PBF_BASIN_ALL];
} pbf_basin_points;

/* Point `index` of the level: levels are counted upwards. */
static inline void pbf_basin_place(const pbf_basin_region *r, int level, int index,
                                   int at[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    if (k == r->axis) {
      at[k] = r->down ? level : PBF_BASIN_POINTS - 1 - level;
      continue;
    }
    at[k] = index % PBF_BASIN_POINTS;
    index /= PBF_BASIN_POINTS;
  }
}

static inline pbf_vec pbf_basin_point(const pbf_basin_region *r, const int at[PBF_DIM]) {
  pbf_vec x;
  for (int k = 0; k < PBF_DIM; ++k)
    x.c[k] = (pbf_real)(r->lower[k] + (at[k] + 0.5) * r->spacing[k]);
  return x;
}

static inline int pbf_basin_is_free(uint32_t count, const pbf_surface *surfaces, pbf_vec x) {
  for (uint32_t k = 0; k < count; ++k) {
    pbf_vec normal;
    if (!(pbf_surface_distance(&surfaces[k], x, &normal) > 0)) return 0;
  }
  return 1;
}

static inline int pbf_basin_way_is_open(uint32_t count, const pbf_surface *surfaces, pbf_vec from,
                                        pbf_vec to) {
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_surface_blocks(&surfaces[k], from, to)) return 0;
  return 1;
}

static inline int pbf_basin_root(pbf_basin_points *points, int p) {
  while (points->root[p] != p) p = points->root[p] = points->root[points->root[p]];
  return p;
}

static inline void pbf_basin_unite(pbf_basin_points *points, int p, int q) {
  p = pbf_basin_root(points, p);
  q = pbf_basin_root(points, q);
  if (p == q) return;
  points->root[q] = (uint16_t)p;
  points->count[p] = (uint16_t)(points->count[p] + points->count[q]);
  points->open[p] |= points->open[q];
  if (points->lowest[q] < points->lowest[p]) points->lowest[p] = points->lowest[q];
}

/* Connects a point with those before it along each axis, and sees whether water leaves the region
 * there. Upwards it does not: it would have to be higher. */
static inline void pbf_basin_connect(const pbf_basin_region *r, uint32_t count,
                                     const pbf_surface *surfaces, pbf_basin_points *points,
                                     int level, int index) {
  int at[PBF_DIM], stride = 1;
  const int p = level * PBF_BASIN_LEVEL + index;
  pbf_basin_place(r, level, index, at);
  const pbf_vec x = pbf_basin_point(r, at);
  for (int k = 0; k < PBF_DIM; ++k) {
    const int upright = k == r->axis;
    for (int side = 0; side < 2; ++side) {
      const int ends = at[k] == (side ? PBF_BASIN_POINTS - 1 : 0), below = side != r->down;
      if (upright && !below) continue;
      if (ends ? r->walled[2 * k + side] : side && !upright) continue;
      const int q = upright ? p - PBF_BASIN_LEVEL : p - stride;
      if (!ends && !points->free[q]) continue;
      int to[PBF_DIM];
      for (int a = 0; a < PBF_DIM; ++a) to[a] = at[a] + (a == k ? 2 * side - 1 : 0);
      if (!pbf_basin_way_is_open(count, surfaces, x, pbf_basin_point(r, to))) continue;
      if (ends)
        points->open[pbf_basin_root(points, p)] = 1;
      else
        pbf_basin_unite(points, p, q);
    }
    if (!upright) stride *= PBF_BASIN_POINTS;
  }
}

/* The largest depth of so much fluid in a basin of the region that is not all of the domain. */
static inline double pbf_region_depth(const pbf_basin_region *r, uint32_t count,
                                      const pbf_surface *surfaces, double fluid) {
  pbf_basin_points points;
  double depth = 0, each = 1;
  int all = 0, whole = 1, at[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    each *= r->spacing[k];
    whole = whole && r->walled[2 * k] && r->walled[2 * k + 1];
  }
  for (int level = 0; level < PBF_BASIN_POINTS; ++level) {
    const int first = level * PBF_BASIN_LEVEL, last = first + PBF_BASIN_LEVEL;
    for (int p = first; p < last; ++p) {
      pbf_basin_place(r, level, p - first, at);
      points.free[p] = (uint8_t)pbf_basin_is_free(count, surfaces, pbf_basin_point(r, at));
      points.root[p] = (uint16_t)p;
      points.count[p] = 1;
      points.open[p] = 0;
      points.lowest[p] = (uint8_t)level;
      all += points.free[p];
    }
    for (int p = first; p < last; ++p)
      if (points.free[p]) pbf_basin_connect(r, count, surfaces, &points, level, p - first);
    for (int p = first; p < last; ++p) {
      const int root = pbf_basin_root(&points, p);
      if (!points.free[p] || points.open[root] || (whole && points.count[root] == all)) continue;
      const double levels = level + 1 - points.lowest[root];
      const double part = fmin(fluid / (points.count[root] * each), 1);
      depth = fmax(depth, levels * part * r->spacing[r->axis]);
    }
  }
  return depth;
}

/* All of the domain, or of it what solids reach. */
static inline int pbf_basin_region_of(const pbf_params *params, int axis, uint32_t count,
                                      const pbf_surface *surfaces, int of_solids,
                                      pbf_basin_region *r) {
  r->axis = axis;
  r->down = params->gravity[axis] < 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    double lower = of_solids ? HUGE_VAL : params->domain_min[k];
    double upper = of_solids ? -HUGE_VAL : params->domain_max[k];
    for (uint32_t s = 0; s < count && of_solids; ++s) {
      if (pbf_surface_is_unbounded(&surfaces[s])) continue;
      const double middle = (double)surfaces[s].center.c[k];
      const double reach = pbf_surface_extent(&surfaces[s], k);
      lower = fmin(lower, middle - reach);
      upper = fmax(upper, middle + reach);
    }
    r->walled[2 * k] = lower <= params->domain_min[k];
    r->walled[2 * k + 1] = upper >= params->domain_max[k];
    lower = fmax(lower, params->domain_min[k]);
    upper = fmin(upper, params->domain_max[k]);
    if (!(lower < upper)) return 0;
    r->lower[k] = lower;
    r->spacing[k] = (upper - lower) / PBF_BASIN_POINTS;
  }
  return 1;
}

/* The largest depth along an axis of so much fluid at rest in a basin. */
static inline double pbf_basins_depth(const pbf_params *params, uint32_t count,
                                      const pbf_collider *colliders, int axis, double fluid) {
  pbf_surface surfaces[PBF_MAX_COLLIDERS];
  pbf_basin_region region;
  double depth = 0;
  int solids = 0;
  for (uint32_t k = 0; k < count; ++k) {
    surfaces[k] = pbf_surface_at(&colliders[k], 0, 0);
    solids += pbf_is_solid(&colliders[k]);
  }
  for (int of_solids = 0; of_solids < 2 && solids; ++of_solids)
    if (pbf_basin_region_of(params, axis, count, surfaces, of_solids, &region))
      depth = fmax(depth, pbf_region_depth(&region, count, surfaces, fluid));
  return depth;
}

#endif
