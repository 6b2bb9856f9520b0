/* How deep water can stand in the room that planes leave of the domain: between two that make a
 * slot, or in a trough. Host only. */
#ifndef PBF_PHYSICS_ROOM_H
#define PBF_PHYSICS_ROOM_H

#include "physics/groups.h"
#include "physics/region_depth.h"

typedef struct pbf_room {
  double lower[PBF_DIM], upper[PBF_DIM];
  const pbf_group_walls *walls; /* planes that stand on no axis are among the others */
} pbf_room;

/* The point `p` of so many, and how far a point of its cell is from it at most. */
static inline double pbf_room_point(const pbf_room *r, int p, int at[PBF_DIM], double x[PBF_DIM]) {
  double reach2 = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double cell = (r->upper[k] - r->lower[k]) / PBF_BASIN_POINTS;
    at[k] = p % PBF_BASIN_POINTS;
    p /= PBF_BASIN_POINTS;
    x[k] = r->lower[k] + (at[k] + 0.5) * cell;
    reach2 += cell * cell / 4;
  }
  return sqrt(reach2);
}

/* Whether fluid may be there, or so far from there. */
static inline int pbf_room_may_hold(const pbf_room *r, const double x[PBF_DIM], double within) {
  for (uint32_t i = 0; i < r->walls->count; ++i) {
    const pbf_surface *s = &r->walls->surfaces[r->walls->others[i]];
    double distance = 0;
    for (int k = 0; k < PBF_DIM; ++k)
      distance += (double)s->frame[0].c[k] * (x[k] - (double)s->center.c[k]);
    if (s->shape == PBF_COLLIDER_PLANE && !((double)s->sign * distance > -within)) return 0;
  }
  return 1;
}

/* Leaves out outer cells that hold no fluid; 0 where none does. *smaller: the part that is left. */
static inline int pbf_room_shrink(pbf_room *r, double *smaller) {
  int first[PBF_DIM], last[PBF_DIM], at[PBF_DIM], any = 0;
  for (int k = 0; k < PBF_DIM; ++k) first[k] = PBF_BASIN_POINTS, last[k] = -1;
  for (int p = 0; p < PBF_BASIN_ALL; ++p) {
    double x[PBF_DIM];
    const double reach = pbf_room_point(r, p, at, x);
    if (!pbf_room_may_hold(r, x, reach)) continue;
    any = 1;
    for (int k = 0; k < PBF_DIM; ++k) {
      if (at[k] < first[k]) first[k] = at[k];
      if (at[k] > last[k]) last[k] = at[k];
    }
  }
  *smaller = 1;
  for (int k = 0; k < PBF_DIM && any; ++k) {
    const double from = r->lower[k], cell = (r->upper[k] - from) / PBF_BASIN_POINTS;
    *smaller *= (last[k] + 1.0 - first[k]) / PBF_BASIN_POINTS;
    r->lower[k] = from + cell * first[k];
    r->upper[k] = from + cell * (last[k] + 1);
  }
  return any;
}

/* A room between planes is convex, and so one basin. */
static inline void pbf_room_note_levels(const pbf_room *r, int axis, int down,
                                        pbf_region_basins *found) {
  uint32_t in_level[PBF_BASIN_POINTS] = {0}, below = 0;
  int at[PBF_DIM];
  found->volume = 1;
  for (int k = 0; k < PBF_DIM; ++k) found->volume *= (r->upper[k] - r->lower[k]) / PBF_BASIN_POINTS;
  found->height = (r->upper[axis] - r->lower[axis]) / PBF_BASIN_POINTS;
  for (int p = 0; p < PBF_BASIN_ALL; ++p) {
    double x[PBF_DIM];
    pbf_room_point(r, p, at, x);
    in_level[down ? at[axis] : PBF_BASIN_POINTS - 1 - at[axis]] +=
        (uint32_t)pbf_room_may_hold(r, x, 0);
  }
  int lowest = 0;
  while (lowest < PBF_BASIN_POINTS && !in_level[lowest]) ++lowest;
  for (int level = lowest; level < PBF_BASIN_POINTS; ++level) {
    if (in_level[level]) pbf_basin_note(found, level + 1 - lowest, below + in_level[level], below);
    below += in_level[level];
  }
}

static inline int pbf_is_plane(const pbf_collider *collider) {
  return collider->shape == PBF_COLLIDER_PLANE;
}

/* What water can stand in, between walls that planes are among. Where more than a part of a room is
 * left, there is no reason to look more closely. */
static inline void pbf_room_find(const pbf_group_walls *walls, int axis, int down,
                                 pbf_region_basins *found) {
  enum { ROUNDS = 12 };
  const double shrinks = 0.6;
  pbf_room room = {{0}, {0}, walls};
  double smaller = 0;
  *found = pbf_region_basins{};
  for (int k = 0; k < PBF_DIM; ++k) {
    room.lower[k] = walls->lower[k];
    room.upper[k] = walls->upper[k];
    if (!(room.lower[k] < room.upper[k])) return;
  }
  for (int round = 0; walls->count && round < ROUNDS && smaller < shrinks; ++round)
    if (!pbf_room_shrink(&room, &smaller)) return;
  pbf_room_note_levels(&room, axis, down, found);
}

#endif
