/* Part of pressure_grid_topology.h: the pressure grid's memory on a host. */
#ifndef PBF_COMMON_PRESSURE_GRID_MEMORY_H
#define PBF_COMMON_PRESSURE_GRID_MEMORY_H

#include "common/memory.h"
#include "physics/pressure_grid/grid.h"
#include "physics/pressure_grid/topology.h"

/* Nodes first … last - 1. */
typedef struct pbf_pressure_grid_run {
  uint32_t first, last;
} pbf_pressure_grid_run;

typedef struct pbf_pressure_grid_storage {
  pbf_pressure_grid grid; /* of this step */
  double carried;         /* density, pbf_carried_density's: lambda is of a fluid of density 1 */
  int64_t *sums;          /* of cells: pbf_pressure_grid_entry; the first of all arrays */
  int64_t *places;        /* of cells: pbf_pressure_grid_place_entry */
  int64_t *cell_moves;    /* along each axis: pbf_cell_move_entry; null: no forces like that */
  double *free_volumes;   /* of cells */
  double *depths, *right, *inverse, *lambda, *before; /* of nodes */
  pbf_pressure_grid_run *runs; /* all nodes that are not in the open are in one, in their order … */
  uint32_t count;              /* of so many; unless every node is looked at */
  pbf_pressure_grid_topology topology;
  pbf_obstacles obstacles;      /* that it is of */
  const pbf_obstacles *gaining; /* those of this step; null: each goes on evenly */
} pbf_pressure_grid_storage;

/* What a grid with thin solids in it has beside. */
typedef struct pbf_topology_memory {
  char *bytes;
} pbf_topology_memory;

static inline uint64_t pbf_topology_memory_bytes(uint32_t capacity) {
  return pbf_pressure_grid_topology_bytes(pbf_pressure_grid_max_nodes(capacity));
}

/* What cells have beside where forces differ from particle to particle. */
typedef struct pbf_cell_moves {
  int64_t *sums;
} pbf_cell_moves;

static inline uint64_t pbf_cell_move_words(uint32_t capacity) {
  return PBF_DIM * pbf_pressure_grid_max_nodes(capacity);
}

/* Words of 8 bytes in all arrays. */
static inline uint64_t pbf_pressure_grid_words(uint32_t capacity) {
  enum { ARRAYS = 9 };
  return ARRAYS * pbf_pressure_grid_max_nodes(capacity);
}

/* Takes the memory or releases it; false when there is none. What lies behind the last node is
 * read, and counts for nothing unless it is no number: it begins as 0. */
static inline bool pbf_pressure_grid_keep(pbf_memory *memory, pbf_pressure_grid_storage *storage,
                                          bool wanted, const char *name, uint32_t capacity) {
  bool taken = wanted && !storage->sums;
  if (!pbf_memory_keep(memory, wanted, name, pbf_pressure_grid_words(capacity), 0, &storage->sums))
    return false;
  if (!taken) return true;
  uint64_t limit = pbf_pressure_grid_max_nodes(capacity);
  storage->places = storage->sums + limit;
  double *next = (double *)storage->places;
  double **const arrays[] = {&storage->free_volumes, &storage->depths, &storage->right,
                             &storage->inverse,      &storage->lambda, &storage->before};
  for (unsigned k = 0; k < sizeof arrays / sizeof arrays[0]; ++k) *arrays[k] = next += limit;
  storage->runs = (pbf_pressure_grid_run *)(next + limit);
  return true;
}

#endif
