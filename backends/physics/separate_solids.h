/* Whether solids are so far apart that none of them can hold water with another one or with the
 * walls, and take so little room that water among them is not much deeper, told from where they are
 * without their poses. Host only. */
#ifndef PBF_PHYSICS_SEPARATE_SOLIDS_H
#define PBF_PHYSICS_SEPARATE_SOLIDS_H

#include "physics/containers.h"

/* The domain is cut along each axis; of what is cut along the first a bit each is in a number. */
enum {
  PBF_APART_BITS = 64,
  PBF_APART_PARTS = 16,
  PBF_APART_ROWS = PBF_DIM == 3 ? PBF_APART_PARTS * PBF_APART_PARTS : PBF_APART_PARTS
};

typedef struct pbf_apart_box {
  int first[PBF_DIM], last[PBF_DIM]; /* parts that it reaches, the outer ones with all beyond */
  int walls;                         /* that it reaches */
  double taken;                      /* of a level, at most, where it stands on the floor */
} pbf_apart_box;

static inline int pbf_apart_part(double place, double lower, double upper, int parts) {
  const double at = parts * ((place - lower) / (upper - lower));
  return (int)fmin(fmax(at, 0), parts - 1);
}

/* Of a ball around a solid, wider by `gap`, in which it and its edge lie in float32, too. */
static inline pbf_apart_box pbf_apart_box_of(const pbf_params *params, const pbf_collider *c,
                                             double gap, int axis) {
  pbf_apart_box box = {{0}, {0}, 0, 0};
  double lower[PBF_DIM], upper[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    const double min = params->domain_min[k], max = params->domain_max[k];
    const double reach = 1.001 * pbf_bound(c) + gap + 1e-6 * fabs(c->position[k]);
    const int parts = k == 0 ? PBF_APART_BITS : PBF_APART_PARTS;
    lower[k] = c->position[k] - reach;
    upper[k] = c->position[k] + reach;
    box.walls += (lower[k] <= min) + (upper[k] >= max);
    box.first[k] = pbf_apart_part(lower[k], min, max, parts);
    box.last[k] = pbf_apart_part(upper[k], min, max, parts);
  }
  box.taken =
      pbf_part_of_floor(params, axis, gap, params->domain_min, params->domain_max, lower, upper);
  return box;
}

/* Takes the box's parts; 0 where one was taken before. */
static inline int pbf_apart_take(uint64_t rows[PBF_APART_ROWS], const pbf_apart_box *box) {
  const int bits = box->last[0] - box->first[0] + 1;
  const uint64_t mask = (~UINT64_C(0) >> (PBF_APART_BITS - bits)) << box->first[0];
  const int deep = PBF_DIM == 3 ? PBF_DIM - 1 : 0; /* 0: there is no third axis, and one layer */
  uint64_t taken = 0;
  for (int z = deep ? box->first[deep] : 0; z <= (deep ? box->last[deep] : 0); ++z)
    for (int y = box->first[1]; y <= box->last[1]; ++y) {
      uint64_t *row = &rows[PBF_APART_PARTS * z + y];
      taken |= *row & mask;
      *row |= mask;
    }
  return !taken;
}

/* 1 where it is sure. A field may hold water by itself, and other walls than the domain's may be
 * anywhere. */
static inline int pbf_solids_are_apart(const pbf_params *params, uint32_t count,
                                       const pbf_collider *colliders, int axis) {
  uint64_t rows[PBF_APART_ROWS] = {0};
  double taken = 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!pbf_is_solid(&colliders[k]) || colliders[k].shape == PBF_COLLIDER_SHAPE) return 0;
    const pbf_apart_box box =
        pbf_apart_box_of(params, &colliders[k], params->smoothing_radius, axis);
    taken += box.taken;
    if (box.walls > 1 || taken >= PBF_SOLIDS_TAKE || !pbf_apart_take(rows, &box)) return 0;
  }
  return 1;
}

#endif
