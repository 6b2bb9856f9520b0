#include "collider_places.h"

#include <math.h>
#include <string.h>

#include "physics/motion.h"

typedef struct cell {
  double c[3]; /* whole numbers */
} cell;

static cell cell_of(const pbf_collider_places *places, const double position[3]) {
  cell at = {{0, 0, 0}};
  for (uint32_t k = 0; k < places->change.dimension; ++k)
    at.c[k] = floor(position[k] / places->change.near);
  return at;
}

/* Colliders of different kind or geometry are never near each other: they are kept apart. */
static uint32_t bucket_of(const pbf_collider_places *places, const pbf_collider *collider,
                          const cell *at) {
  uint64_t hash = collider->shape;
  if (collider->shape == PBF_COLLIDER_SHAPE) hash ^= (uint64_t)(uintptr_t)collider->geometry;
  for (int k = 0; k < 3; ++k) {
    const double whole = at->c[k] + 0.0; /* no -0 */
    uint64_t bits;
    memcpy(&bits, &whole, sizeof bits);
    hash = (hash ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
    hash ^= hash >> 32;
  }
  return (uint32_t)(hash % places->count);
}

void pbf_collider_places_build(pbf_collider_places *places, uint32_t *memory) {
  places->heads = memory;
  places->next = memory + places->count;
  for (uint32_t i = 0; i < places->count; ++i) places->heads[i] = places->count;
  for (uint32_t i = places->count; i-- > 0;) {
    const pbf_collider *collider = &places->list[i];
    double position[3];
    pbf_motion_position(collider, collider->path, places->change.elapsed, position);
    const cell at = cell_of(places, position);
    uint32_t *head = &places->heads[bucket_of(places, collider, &at)];
    places->next[i] = *head;
    *head = i;
  }
}

/* Without looking at how one of another geometry has grown, which takes long. */
static double distance_from(const pbf_collider_places *places, uint32_t i,
                            const pbf_collider *next) {
  const pbf_collider *before = &places->list[i];
  if (before->shape != next->shape) return INFINITY;
  if (before->shape == PBF_COLLIDER_SHAPE && before->geometry != next->geometry) return INFINITY;
  double way[3];
  const double turn = pbf_collider_find_way(&places->change, before, next, way);
  return turn + sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
}

typedef struct nearest {
  double distance;
  uint32_t number;
} nearest;

static void look_into(const pbf_collider_places *places, const cell *at, const pbf_collider *next,
                      nearest *found) {
  uint32_t i = places->heads[bucket_of(places, next, at)];
  for (; i < places->count; i = places->next[i]) {
    const double distance = distance_from(places, i, next);
    if (distance < found->distance || (distance == found->distance && i < found->number))
      *found = (nearest){distance, i};
  }
}

uint32_t pbf_collider_places_find(const pbf_collider_places *places, const pbf_collider *next) {
  const cell middle = cell_of(places, next->position);
  const int layers = places->change.dimension == 3 ? 1 : 0;
  nearest found = {places->change.near, 0};
  for (int z = -layers; z <= layers; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const cell at = {{middle.c[0] + x, middle.c[1] + y, middle.c[2] + z}};
        look_into(places, &at, next, &found);
      }
    }
  }
  return found.distance < places->change.near ? found.number : places->count;
}
