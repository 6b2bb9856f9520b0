/* Which snapshots are held, so that what never was one, or is no more, is refused without looking
 * into its memory. With the solvers' lock held. */
#ifndef PBF_LIB_SOLVER_HELD_SNAPSHOTS_H
#define PBF_LIB_SOLVER_HELD_SNAPSHOTS_H

#include "snapshot_memory.h"

/* One reader more. */
void pbf_snapshot_hold(snapshot *one);

/* One less; the solver that it is of, or null where `owner` is none that is held. */
pbf_solver *pbf_snapshot_let_go(const void *owner);

/* Before its memory goes: in the child of a fork one may be noted that none holds. */
void pbf_snapshot_forget(const snapshot *one);

#endif
