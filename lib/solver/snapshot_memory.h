/* What snapshots (snapshots.h) lie in. */
#ifndef PBF_LIB_SOLVER_SNAPSHOT_MEMORY_H
#define PBF_LIB_SOLVER_SNAPSHOT_MEMORY_H

#include "solver.h"

typedef struct snapshot {
  pbf_solver *solver;
  struct snapshot *next_held; /* in a list of held_snapshots.h */
  uint32_t readers;           /* that hold it */
  uint32_t count;
  uint64_t step;
  double time;
  char *positions, *velocities;
  uint32_t *ids;
} snapshot;

typedef struct pbf_snapshots {
  uint32_t count;
  snapshot *latest;
  char *spare; /* on ranks: where positions and velocities go that there is no room for here */
  snapshot list[PBF_MAX_SNAPSHOTS];
} pbf_snapshots;

/* None is filled. Fails with PBF_ERROR_OUT_OF_MEMORY. */
pbf_status pbf_snapshots_allocate(pbf_solver *solver, uint32_t count, pbf_snapshots **snapshots);

uint64_t pbf_snapshots_bytes(const pbf_solver *solver, const pbf_snapshots *snapshots);

/* Before their memory goes. Null is a no-op. */
void pbf_snapshots_forget(const pbf_snapshots *snapshots);

/* Null is a no-op. None of them is held. */
void pbf_snapshots_free(const pbf_solver *solver, pbf_snapshots *snapshots);

#endif
