/* The phases of a solver, and which of them each particle is of, by row. */
#ifndef PBF_LIB_PARTICLES_PHASES_H
#define PBF_LIB_PARTICLES_PHASES_H

#include <string.h>

#include <pbf/phases.h>

#include "solver/solver.h"

/* Null in a solver without. */
typedef struct pbf_phases {
  uint32_t count;
  uint32_t differ; /* 1: in mass or viscosity, and the backend has them */
  uint32_t used;   /* those that it was told to be used, a bit each; 0: it was told all */
  uint32_t reserved;
  pbf_phase of[PBF_MAX_PHASES];
  uint8_t rows[]; /* capacity */
} pbf_phases;

static inline uint64_t pbf_phases_bytes(const pbf_solver *solver) {
  return sizeof(pbf_phases) + solver->capacity;
}

/* Room for `count` phases; all rows are of phase 0. */
pbf_status pbf_phases_allocate(const pbf_solver *solver, uint32_t count, pbf_phases **phases);
void pbf_phases_free(const pbf_solver *solver, pbf_phases *phases);

/* Each of them, and the heaviest and the lightest together. */
pbf_status pbf_phases_check(pbf_phases *phases, pbf_check_kind kind);

/* Whether what these parameters ask for is to be had where phases differ. */
pbf_status pbf_phases_check_params(const pbf_phases *phases, const pbf_params *params);

/* Whether phases that differ are to be had of the backend: not of each on ranks. */
pbf_status pbf_phases_check_ranks(const pbf_phases *phases, const pbf_solver *solver);

/* Before steps: what phases are that nothing is of must not show. A grid carries what the lightest
 * and the heaviest are by, and so left a pool of water to the iterations where oil was listed. */
pbf_status pbf_phases_tell_used(pbf_solver *solver);

/* How many there are, of which 0 is one, too, where there are none. */
static inline uint32_t pbf_phases_count(const pbf_phases *phases) {
  return phases ? phases->count : 1;
}

/* `list`[index].phase is the number of one. */
pbf_status pbf_phases_check_number(const pbf_phases *phases, const char *list, uint32_t index,
                                   uint32_t phase);

/* The table, and then the rows of particles that it holds: of the solver's own ids where `ids` is
 * null. */
pbf_status pbf_phases_to_backend(pbf_solver *solver, const pbf_phases *phases, uint32_t count,
                                 const uint32_t *ids);

/* The last `count` rows are new. */
static inline void pbf_phases_append(const pbf_solver *solver, uint32_t count, uint32_t phase) {
  if (solver->phases) memset(solver->phases->rows + (solver->count - count), (int)phase, count);
}

/* As part of a saved state: no bytes where there are none. */
uint64_t pbf_phases_saved_size(const pbf_solver *solver);
void pbf_phases_save(const pbf_solver *solver, void *buffer);

/* Of `count` particles, and checked. */
pbf_status pbf_phases_read(const pbf_solver *solver, const void *buffer, uint64_t size,
                           uint32_t count, pbf_phases **phases);

#endif
