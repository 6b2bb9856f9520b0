/* A set of rows, a bit each, and the removal of those in one. */
#ifndef PBF_LIB_PARTICLES_ROW_SET_H
#define PBF_LIB_PARTICLES_ROW_SET_H

#include "solver/solver.h"

typedef struct pbf_row_set {
  uint64_t *bits;
  uint64_t bytes;
  uint32_t count; /* rows in it */
} pbf_row_set;

/* An empty one, for the rows that there are. */
pbf_status pbf_row_set_allocate(const pbf_solver *solver, pbf_row_set *set);
void pbf_row_set_free(const pbf_solver *solver, pbf_row_set *set);

static inline int pbf_row_set_has(const pbf_row_set *set, uint32_t row) {
  return (int)(set->bits[row / 64] >> row % 64 & 1);
}

static inline void pbf_row_set_add(pbf_row_set *set, uint32_t row) {
  set->count += !pbf_row_set_has(set, row);
  set->bits[row / 64] |= UINT64_C(1) << row % 64;
}

/* Ids of the first `most` rows in it, ascending. */
void pbf_row_set_ids(const pbf_solver *solver, const pbf_row_set *set, uint32_t most,
                     uint32_t *ids);

/* Removes their particles; nothing where it is empty. */
pbf_status pbf_row_set_remove(pbf_solver *solver, const pbf_row_set *set);

#endif
