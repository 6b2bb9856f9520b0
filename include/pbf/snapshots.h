/* pbf/snapshots.h: the state at the end of a pbf_step for other threads, to draw from while the
 * next steps run. A solver without them has no memory and no time for them.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_SNAPSHOTS_H
#define PBF_SNAPSHOTS_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Snapshots for other threads ------------------------------------------------------------- */

/* The state at the end of a pbf_step, in host memory that does not change while it is held. */
typedef struct pbf_snapshot {
  uint32_t struct_size;
  uint32_t count;
  uint32_t dimension;
  uint32_t element_type; /* PBF_TYPE_… */
  uint64_t step;         /* pbf_info.step and time of then */
  double time;
  const void *positions; /* shape (count, dimension), in the order of adding */
  const void *velocities;
  const uint32_t *ids; /* shape (count), increasing */
  void *owner;         /* the library's; null: nothing is held */
} pbf_snapshot;

/* Snapshots of a solver. */
#define PBF_MAX_SNAPSHOTS 16u

/* Keeps room for so many snapshots of `capacity` particles, and makes one of the present state;
 * from then on each pbf_step that succeeds, or is cancelled, ends with one. It goes where the
 * latest one is not, nor one that is held; where there is no such room, none is made and the latest
 * one stays, so that a step never waits. With n readers that hold one each, n + 2 are enough.
 * `snapshots` is 2 … PBF_MAX_SNAPSHOTS, or 0: gives the memory back. Costs a reading of positions
 * and velocities a call of pbf_step, on a device a wait for it, and no bit. PBF_ERROR_STATE while
 * one is held. */
PBF_API pbf_status pbf_set_snapshots(pbf_solver *solver, uint32_t snapshots);

/* Holds the latest snapshot. From any thread, at any time up to pbf_destroy, also while a call is
 * inside the solver, for which it never waits; other threads may hold the same one.
 * snapshot->struct_size must be set, and owner null. What is held outlives pbf_destroy. */
PBF_API pbf_status pbf_acquire_snapshot(pbf_solver *solver, pbf_snapshot *snapshot);

/* Ends that, from any thread, once for each success of pbf_acquire_snapshot. What `snapshot` points
 * to is then no more to be read, and its members are 0. */
PBF_API pbf_status pbf_release_snapshot(pbf_snapshot *snapshot);

#ifdef __cplusplus
}
#endif

#endif
