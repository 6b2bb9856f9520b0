/* Part of solver.h: memory of a solver with more colliders than kernels take by value. Of a step
 * there are its surfaces, the grid that tells which are near a place, what that lists, and what
 * colliders are beside surfaces. */
#ifndef PBF_CUDA_MANY_COLLIDERS_H
#define PBF_CUDA_MANY_COLLIDERS_H

#include "common/collider_table.h"
#include "cuda/listed_obstacles.h"
#include "cuda/memory.h"
#include "physics/friction.h"

/* Steps of which colliders are placed and uploaded at once, if they move. */
enum { MANY_STEPS_AHEAD = 4 };

/* Threads that find an empty list wait for none: cells are smaller than on a CPU. */
enum { MANY_FINER = 8 };

/* Where things are in a step's block: the surfaces at its beginning, what they are asked by behind
 * the last. */
struct many_layout {
  uint64_t starts, entries, friction, adhesion, no_slip, bytes;
};

/* The device's sets: which move, and which have been placed in the fluid. */
enum many_set { MANY_MOVING, MANY_PLACED, MANY_SETS };

struct many_colliders {
  pbf_collider_table table; /* the host's; without room there are few colliders */
  many_layout layout;
  char *staging; /* the host's, of as many steps */
  char *steps;   /* the device's */
  uint64_t *sets;
  pbf_surface *divided;  /* what the pressure grid is divided by */
  pbf_load_tally *loads; /* the device's, if they are wanted */
  int solids;            /* that it has room for */
  bool stand;            /* none moves, nor does a wall; … */
  bool placed;           /* … and the first step's block has them */
};

static inline bool are_many(const many_colliders &m) { return m.table.room > 0; }

static inline uint64_t many_part(uint64_t *bytes, uint64_t more) {
  const uint64_t place = *bytes;
  *bytes += (more + PBF_ALIGNMENT - 1) / PBF_ALIGNMENT * PBF_ALIGNMENT;
  return place;
}

static inline many_layout many_layout_of(uint32_t room) {
  many_layout of = {};
  uint64_t *bytes = &of.bytes;
  many_part(bytes, room * sizeof(pbf_surface) + sizeof(listed_scene));
  of.starts =
      many_part(bytes, (pbf_grid_cell_room(MANY_FINER * (uint64_t)room) + 1) * sizeof(uint32_t));
  of.entries = many_part(bytes, PBF_ENTRIES_A_SURFACE * (uint64_t)room * sizeof(uint16_t));
  of.friction = many_part(bytes, (PBF_WALLS + room) * sizeof(pbf_friction));
  of.adhesion = many_part(bytes, (PBF_WALLS + room) * sizeof(pbf_real));
  of.no_slip = many_part(bytes, room * sizeof(pbf_real));
  return of;
}

static inline uint64_t many_host_bytes(uint32_t room) {
  return pbf_collider_table_bytes(room, 1) + MANY_STEPS_AHEAD * many_layout_of(room).bytes;
}

static inline uint64_t many_set_words(uint32_t room) { return pbf_words_of(room); }

static inline uint64_t many_device_bytes(uint32_t room) {
  uint64_t bytes = MANY_STEPS_AHEAD * many_layout_of(room).bytes;
  many_part(&bytes, MANY_SETS * many_set_words(room) * sizeof(uint64_t));
  many_part(&bytes, room * sizeof(pbf_surface));
  return bytes;
}

/* In these blocks. */
static inline void place_many(many_colliders *m, pbf_basins *basins, char *host, char *device,
                              uint32_t room) {
  uint64_t bytes;
  m->staging = host + pbf_place_collider_table(&m->table, basins, host, room, 1);
  m->layout = many_layout_of(room);
  bytes = MANY_STEPS_AHEAD * m->layout.bytes;
  m->steps = device;
  m->sets = reinterpret_cast<uint64_t *>(
      device + many_part(&bytes, MANY_SETS * many_set_words(room) * sizeof(uint64_t)));
  m->divided =
      reinterpret_cast<pbf_surface *>(device + many_part(&bytes, room * sizeof(pbf_surface)));
  m->placed = false;
}

/* Of the device, words of colliders behind the few first ones. */
static inline uint64_t *many_set_of(const many_colliders &m, many_set which) {
  return m.sets + which * many_set_words(m.table.room);
}

/* The loads of solids on the device, in the tally for many. */
static inline pbf_collider_load *many_loads(const many_colliders &m) {
  return reinterpret_cast<pbf_collider_load *>(reinterpret_cast<char *>(m.loads) +
                                               sizeof(pbf_load_tally) +
                                               (uint64_t)m.solids * sizeof(pbf_load_sums));
}

#endif
