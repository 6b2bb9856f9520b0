/* Where the colliders of a solver stand now, to find the one that a collider of a new array was
 * before: a caller's list may be in another order each time, or begin with one more. */
#ifndef PBF_LIB_SOLVER_COLLIDER_PLACES_H
#define PBF_LIB_SOLVER_COLLIDER_PLACES_H

#include "collider_way.h"

/* Cells of the width `near`, hashed: chains of those that stand in one. */
typedef struct pbf_collider_places {
  const pbf_collider *list;
  uint32_t count;
  pbf_collider_change change;
  uint32_t *heads, *next; /* `count` of each; null: not built yet */
} pbf_collider_places;

/* `memory` has room for two numbers a collider. */
void pbf_collider_places_build(pbf_collider_places *places, uint32_t *memory);

/* The number of the nearest that stands less than `near` from it, of those the first; `count`:
 * none does. */
uint32_t pbf_collider_places_find(const pbf_collider_places *places, const pbf_collider *next);

#endif
