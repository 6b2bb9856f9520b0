/* The colliders of a solver that runs on a CPU, and what is found of them: one block of memory, for
 * as many as there are. */
#ifndef PBF_COMMON_COLLIDER_TABLE_H
#define PBF_COMMON_COLLIDER_TABLE_H

#include "common/memory.h"
#include "physics/basins.h"
#include "physics/surfaces/obstacles.h"

typedef struct pbf_collider_table {
  uint32_t room; /* colliders that there is memory for */
  pbf_collider *list;
  pbf_surface *surfaces; /* at the end of a step, or when they are asked about; */
  pbf_surface *before;   /* at its start; */
  pbf_surface *divided;  /* as the pressure grid is divided by them */
  pbf_surface_grid grid; /* of `surfaces` */
  uint64_t *moving, *still_moving, *changed, *placed; /* sets of all but the few first ones */
  uint16_t *numbers; /* of some of them: PBF_OBSTACLE_LISTS as long for each thread */
} pbf_collider_table;

/* Hands out parts of a block, or, without one, adds up how large it is to be. */
typedef struct pbf_block_parts {
  char *block;
  uint64_t bytes;
} pbf_block_parts;

template <class Element>
static inline void pbf_next_part(pbf_block_parts *parts, uint64_t count, Element **part) {
  *part = parts->block ? (Element *)(parts->block + parts->bytes) : NULL;
  parts->bytes += (count * sizeof(Element) + PBF_ALIGNMENT - 1) / PBF_ALIGNMENT * PBF_ALIGNMENT;
}

/* Places a table of that much room, and what basins need; its size. */
static inline uint64_t pbf_place_collider_table(pbf_collider_table *t, pbf_basins *basins,
                                                char *block, uint32_t room, uint32_t threads) {
  pbf_block_parts parts = {block, 0};
  const uint64_t words = pbf_words_of(room);
  t->room = room;
  pbf_next_part(&parts, room, &t->list);
  pbf_next_part(&parts, room, &t->surfaces);
  pbf_next_part(&parts, room, &t->before);
  pbf_next_part(&parts, room, &t->divided);
  pbf_next_part(&parts, words, &t->moving);
  pbf_next_part(&parts, words, &t->still_moving);
  pbf_next_part(&parts, words, &t->changed);
  pbf_next_part(&parts, words, &t->placed);
  pbf_next_part(&parts, PBF_OBSTACLE_LISTS * (uint64_t)room * threads, &t->numbers);
  pbf_next_part(&parts, room, &t->grid.boxes);
  pbf_next_part(&parts, pbf_grid_cell_room(room) + 1, &t->grid.starts);
  pbf_next_part(&parts, PBF_ENTRIES_A_SURFACE * (uint64_t)room, &t->grid.entries);
  pbf_next_part(&parts, room, &basins->colliders);
  pbf_next_part(&parts, room, &basins->shapes);
  pbf_next_part(&parts, room, &basins->groups);
  t->grid.room = room;
  ++t->grid.built;
  basins->surfaces = t->surfaces;
  basins->numbers = t->numbers;
  basins->grid = &t->grid;
  basins->known = 0;
  return parts.bytes;
}

static inline uint64_t pbf_collider_table_bytes(uint32_t room, uint32_t threads) {
  pbf_collider_table t = {};
  pbf_basins basins = {};
  return pbf_place_collider_table(&t, &basins, NULL, room, threads);
}

/* Room that is taken for so many colliders. */
static inline uint32_t pbf_collider_room(uint32_t count) { return (count + 15) / 16 * 16; }

/* Where colliders stand at a time, for a caller that is alone with the solver. */
static inline void pbf_place_all_obstacles(const pbf_params *params, pbf_collider_table *t,
                                           uint32_t count, double set_at, double time,
                                           int close_phases, pbf_obstacles *o) {
  pbf_place_obstacles(params, count, t->list, set_at, time, close_phases, t->surfaces, o);
  o->room = t->numbers;
  if (count <= PBF_ASKED_COLLIDERS) return;
  for (uint32_t k = 0; k < count; ++k) t->grid.boxes[k] = pbf_surface_box_of(&t->surfaces[k]);
  pbf_grid_build(&t->grid, count, &o->domain, pbf_obstacles_reach(params));
  o->grid = &t->grid;
}

#endif
