/* How deep water can stand between colliders that hold it as a vessel's walls do: between boxes
 * that make a pool, or behind a gate. Host only. */
#ifndef PBF_PHYSICS_BASINS_H
#define PBF_PHYSICS_BASINS_H

#include "physics/separate_solids.h"
#include "physics/groups.h"
#include "physics/region_depth.h"
#include "physics/room.h"

/* Of the particles' spacing: water does not pass what is twice as narrow. */
#define PBF_BASIN_CLEARANCE 0.25

/* Two points of a region next to each other are connected unless a solid is between them, as in
 * pressure_grid/compartments.h. Level by level, those that hang together are a basin, unless water
 * would leave the region from it. */
typedef struct pbf_basin_region {
  double lower[PBF_DIM], spacing[PBF_DIM];
  double clearance;        /* what of a seam between solids may be open on each side */
  int walled[2 * PBF_DIM]; /* whether the domain's walls are at its ends */
  int axis, down;          /* of gravity, and whether it points to lower coordinates */
} pbf_basin_region;

/* What hangs together with a point: its root, and there the number of points, of those in the
 * highest level, the lowest level, and whether water leaves from it. */
typedef struct pbf_basin_points {
  uint8_t free[PBF_BASIN_ALL];
  uint16_t root[PBF_BASIN_ALL], count[PBF_BASIN_ALL], highest[PBF_BASIN_ALL];
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

static inline double pbf_basin_longest_way(const pbf_basin_region *r) {
  double longest = 0;
  for (int k = 0; k < PBF_DIM; ++k) longest = fmax(longest, r->spacing[k]);
  return longest;
}

/* Surfaces that are so near to a point that they may be at it, or on a way from it to the next. */
typedef struct pbf_basin_near {
  const pbf_surface *surfaces;
  const uint16_t *numbers;
  uint32_t count;
} pbf_basin_near;

static inline pbf_basin_near pbf_basin_find_near(const pbf_surface_grid *grid,
                                                 const pbf_surface *surfaces, pbf_vec x) {
  pbf_basin_near near = {surfaces, NULL, 0};
  near.count = pbf_surfaces_at(grid, x, &near.numbers);
  return near;
}

/* Whether a particle finds room: flush solids leave a seam by rounding, and points may lie in it.
 */
static inline int pbf_basin_is_free(const pbf_basin_region *r, const pbf_basin_near *near,
                                    pbf_vec x) {
  for (uint32_t k = 0; k < near->count; ++k) {
    const pbf_surface *s = &near->surfaces[near->numbers[k]];
    pbf_vec normal;
    if (pbf_surface_is_beyond(s, x, (pbf_real)r->clearance)) continue;
    if (!((double)pbf_surface_distance(s, x, &normal) > r->clearance)) return 0;
  }
  return 1;
}

/* From a point one on along an axis. */
static inline int pbf_basin_way_is_open(const pbf_basin_region *r, const pbf_basin_near *near,
                                        const int at[PBF_DIM], int axis, int by) {
  int to[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) to[k] = at[k] + (k == axis ? by : 0);
  const pbf_vec from = pbf_basin_point(r, at), there = pbf_basin_point(r, to);
  const pbf_real way = (pbf_real)(1.0001 * r->spacing[axis]);
  for (uint32_t k = 0; k < near->count; ++k) {
    const pbf_surface *s = &near->surfaces[near->numbers[k]];
    if (!pbf_surface_is_beyond(s, from, way) && pbf_surface_blocks(s, from, there)) return 0;
  }
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
static inline void pbf_basin_connect(const pbf_basin_region *r, const pbf_basin_near *near,
                                     pbf_basin_points *points, int level, int index) {
  int at[PBF_DIM], stride = 1;
  const int p = level * PBF_BASIN_LEVEL + index;
  pbf_basin_place(r, level, index, at);
  for (int k = 0; k < PBF_DIM; ++k) {
    const int upright = k == r->axis;
    for (int side = 0; side < 2; ++side) {
      const int ends = at[k] == (side ? PBF_BASIN_POINTS - 1 : 0), below = side != r->down;
      if (upright && !below) continue;
      if (ends ? r->walled[2 * k + side] : side && !upright) continue;
      const int q = upright ? p - PBF_BASIN_LEVEL : p - stride;
      if (!ends && !points->free[q]) continue;
      if (!pbf_basin_way_is_open(r, near, at, k, 2 * side - 1)) continue;
      if (ends)
        points->open[pbf_basin_root(points, p)] = 1;
      else
        pbf_basin_unite(points, p, q);
    }
    if (!upright) stride *= PBF_BASIN_POINTS;
  }
}

/* Without one that is all of the domain, unless solids take a good part of that: a bottle's body
 * below its neck is as deep as both, and less than a part is told only roughly by few points.
 * `grid` is of the surfaces, within the distance between two points. */
static inline void pbf_region_basins_of(const pbf_basin_region *r, const pbf_surface *surfaces,
                                        const pbf_surface_grid *grid, pbf_region_basins *basins) {
  pbf_basin_points points;
  int all = 0, whole = 1, at[PBF_DIM];
  memset(basins, 0, sizeof *basins);
  basins->height = r->spacing[r->axis];
  basins->volume = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    basins->volume *= r->spacing[k];
    whole = whole && r->walled[2 * k] && r->walled[2 * k + 1];
  }
  for (int level = 0; level < PBF_BASIN_POINTS; ++level) {
    const int first = level * PBF_BASIN_LEVEL, last = first + PBF_BASIN_LEVEL;
    for (int p = first; p < last; ++p) {
      pbf_basin_place(r, level, p - first, at);
      const pbf_vec x = pbf_basin_point(r, at);
      const pbf_basin_near near = pbf_basin_find_near(grid, surfaces, x);
      points.free[p] = (uint8_t)pbf_basin_is_free(r, &near, x);
      points.root[p] = (uint16_t)p;
      points.count[p] = 1;
      points.open[p] = 0;
      points.lowest[p] = (uint8_t)level;
      all += points.free[p];
    }
    for (int p = first; p < last; ++p) {
      if (!points.free[p]) continue;
      pbf_basin_place(r, level, p - first, at);
      const pbf_basin_near near = pbf_basin_find_near(grid, surfaces, pbf_basin_point(r, at));
      pbf_basin_connect(r, &near, &points, level, p - first);
    }
    for (int p = first; p < last; ++p) points.highest[pbf_basin_root(&points, p)] = 0;
    for (int p = first; p < last; ++p) ++points.highest[pbf_basin_root(&points, p)];
    for (int p = first; p < last; ++p) {
      const int root = pbf_basin_root(&points, p);
      if (!points.free[p] || points.open[root]) continue;
      if (whole && points.count[root] == all && all > (1 - PBF_SOLIDS_TAKE) * last) continue;
      const uint32_t count = points.count[root];
      pbf_basin_note(basins, level + 1 - points.lowest[root], count, count - points.highest[root]);
    }
  }
}

/* All of the domain, or of it what solids reach. */
static inline int pbf_basin_region_of(const pbf_params *params, int axis, uint32_t count,
                                      const pbf_surface *surfaces, int of_solids,
                                      pbf_basin_region *r) {
  r->axis = axis;
  r->down = params->gravity[axis] < 0;
  r->clearance = PBF_BASIN_CLEARANCE * pbf_derive_spacing(params);
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

/* All basins that there are, and between what. Where no basin can be deep they are not looked for,
 * which takes a hundred times as long as telling so. */
typedef struct pbf_basins {
  double domain[2 * PBF_DIM], gap, spacing;
  uint32_t count; /* of colliders */
  int axis, down; /* of gravity */
  int solids, planes;
  int known;          /* 0: nothing is; */
  int sought;         /* 1: regions have been looked through */
  int room_sought;    /* and the room that planes leave */
  double deepest;     /* none between solids can be deeper, … */
  double room_height; /* … and what planes hold */
  pbf_region_basins regions[2], room;
  pbf_collider *colliders; /* memory for so many as are asked about, from here on */
  uint64_t *shapes;        /* their geometries' ids: a pointer may be another one's */
  pbf_surface *surfaces;   /* this and what follows hold nothing from one call to another */
  pbf_group *groups;
  uint16_t *numbers;
  pbf_surface_grid *grid;
} pbf_basins;

/* Memory for few colliders. */
typedef struct pbf_few_basins {
  pbf_collider colliders[PBF_FEW_COLLIDERS];
  uint64_t shapes[PBF_FEW_COLLIDERS];
  pbf_surface surfaces[PBF_FEW_COLLIDERS];
  pbf_group groups[PBF_FEW_COLLIDERS];
  uint16_t numbers[PBF_FEW_COLLIDERS];
  pbf_surface_grid grid;
  pbf_surface_box boxes[PBF_FEW_COLLIDERS];
  uint32_t starts[PBF_CELLS_A_SURFACE * PBF_FEW_COLLIDERS + 65];
  uint16_t entries[PBF_ENTRIES_A_SURFACE * PBF_FEW_COLLIDERS];
} pbf_few_basins;

static inline void pbf_place_few_basins(pbf_basins *b, pbf_few_basins *in) {
  b->colliders = in->colliders;
  b->shapes = in->shapes;
  b->surfaces = in->surfaces;
  b->groups = in->groups;
  b->numbers = in->numbers;
  b->grid = &in->grid;
  in->grid.boxes = in->boxes;
  in->grid.starts = in->starts;
  in->grid.entries = in->entries;
  in->grid.room = PBF_FEW_COLLIDERS;
}

static inline uint64_t pbf_shape_id(const pbf_collider *collider) {
  return collider->geometry ? collider->geometry->id : 0;
}

static inline int pbf_shapes_are(const pbf_basins *b, uint32_t count,
                                 const pbf_collider *colliders) {
  for (uint32_t k = 0; k < count; ++k)
    if (b->shapes[k] != pbf_shape_id(&colliders[k])) return 0;
  return 1;
}

/* Notes between what basins are to be; 1 where that has been so before. */
static inline int pbf_basins_are_of(pbf_basins *b, const pbf_params *params, uint32_t count,
                                    const pbf_collider *colliders, int axis) {
  const int down = params->gravity[axis] < 0;
  double domain[2 * PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    domain[2 * k] = params->domain_min[k];
    domain[2 * k + 1] = params->domain_max[k];
  }
  if (b->known && b->count == count && b->axis == axis && b->down == down &&
      b->gap == params->smoothing_radius && b->spacing == pbf_derive_spacing(params) &&
      memcmp(b->domain, domain, sizeof domain) == 0 &&
      (!count || memcmp(b->colliders, colliders, count * sizeof *colliders) == 0) &&
      pbf_shapes_are(b, count, colliders))
    return 1;
  memcpy(b->domain, domain, sizeof domain);
  b->gap = params->smoothing_radius;
  b->spacing = pbf_derive_spacing(params);
  if (count) memcpy(b->colliders, colliders, count * sizeof *colliders);
  for (uint32_t k = 0; k < count; ++k) b->shapes[k] = pbf_shape_id(&colliders[k]);
  b->count = count;
  b->axis = axis;
  b->down = down;
  b->known = 1;
  return 0;
}

static inline void pbf_basins_place_surfaces(pbf_basins *b) {
  for (uint32_t k = 0; k < b->count; ++k) b->surfaces[k] = pbf_surface_as_set(&b->colliders[k]);
}

/* Notes between what basins are to be, and how deep those of solids can be along an axis. */
static inline double pbf_basins_deepest(pbf_basins *b, const pbf_params *params, uint32_t count,
                                        const pbf_collider *colliders, int axis) {
  if (pbf_basins_are_of(b, params, count, colliders, axis)) return b->deepest;
  b->sought = b->room_sought = b->solids = b->planes = 0;
  b->deepest = b->room_height = 0;
  for (uint32_t k = 0; k < count; ++k) {
    b->solids += pbf_is_solid(&colliders[k]);
    b->planes += pbf_is_plane(&colliders[k]);
  }
  if (b->planes) b->room_height = params->domain_max[axis] - params->domain_min[axis];
  if (!b->solids || pbf_solids_are_apart(params, count, colliders, axis)) return 0;
  pbf_basins_place_surfaces(b);
  b->deepest =
      pbf_groups_deepest(params, count, colliders, b->surfaces, axis, b->groups, b->numbers);
  return b->deepest;
}

/* Those of a region that holds all of the domain, or what solids reach of it. */
static inline void pbf_basins_find_in(pbf_basins *b, const pbf_params *params,
                                      const pbf_basin_region *region, pbf_region_basins *found) {
  const pbf_domain domain = pbf_domain_at(params, 0);
  for (uint32_t k = 0; k < b->count; ++k) b->grid->boxes[k] = pbf_surface_box_of(&b->surfaces[k]);
  pbf_grid_build(b->grid, b->count, &domain, 1.0001 * pbf_basin_longest_way(region));
  pbf_region_basins_of(region, b->surfaces, b->grid, found);
}

/* Looks for those that have been noted, once. */
static inline void pbf_basins_find(pbf_basins *b, const pbf_params *params) {
  pbf_basin_region region;
  if (b->sought) return;
  b->sought = 1;
  memset(b->regions, 0, sizeof b->regions);
  if (b->solids) pbf_basins_place_surfaces(b);
  for (int of_solids = 0; of_solids < 2 && b->solids; ++of_solids)
    if (pbf_basin_region_of(params, b->axis, b->count, b->surfaces, of_solids, &region))
      pbf_basins_find_in(b, params, &region, &b->regions[of_solids]);
}

/* Looks for the room that noted planes leave, once. */
static inline void pbf_basins_find_room(pbf_basins *b, const pbf_params *params) {
  if (b->room_sought) return;
  b->room_sought = 1;
  pbf_basins_place_surfaces(b);
  const pbf_group_walls walls = pbf_group_walls_of(params, b->count, b->surfaces, b->numbers);
  pbf_room_find(&walls, b->axis, b->down, &b->room);
}

/* The largest depth of so much fluid at rest in one of them. */
static inline double pbf_basins_depth(const pbf_basins *b, double fluid) {
  return fmax(pbf_region_depth(&b->regions[0], fluid), pbf_region_depth(&b->regions[1], fluid));
}

#endif
