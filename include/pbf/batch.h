/* pbf/batch.h: many worlds of one kind in one call.
 *
 * A batch holds `worlds` solvers alike in description and capacity, each with particles, colliders
 * and parameters of its own. A world gives the same bits alone and in a batch, whatever the number
 * of threads and of worlds. The rules of pbf.h hold here, too, and these:
 *   threads   a batch belongs to one thread at a time, and so do its worlds; a second call returns
 *             PBF_ERROR_BUSY. On a CPU each world is stepped by one thread, and several worlds are
 *             at once: by desc.threads threads, the caller's included (0: as many as there are
 *             CPUs), or by desc's task system. They wait in between and end with the batch. A
 *             device is fed by the calling thread alone.
 *   callbacks (the allocator's, the log) are called from all of these threads at once, and may not
 *             be left by an exception or a longjmp, nor end their thread.
 *   mask      `worlds` bytes; a call is for the worlds with a byte that is not 0; null: for all.
 *   failures  a world that fails does not stop the others. The call then returns the status of the
 *             first that has, and its sentence begins with "world k: "; pbf_batch_get_statuses has
 *             each one's.
 *   arrays    row-major, the first index is the world. Of a call with a mask they have all worlds'
 *             rows, and only those of its worlds are looked at, or written.
 */
#ifndef PBF_BATCH_H
#define PBF_BATCH_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Life of a batch ----------------------------------------------------------------------- */

typedef struct pbf_batch pbf_batch;

/* Worlds of a batch. */
#define PBF_MAX_WORLDS 65536u

/* `worlds` (1 … PBF_MAX_WORLDS) empty worlds, each as pbf_create would make it but for desc.threads
 * and the task system, which are the batch's: a world has one thread. All have the backend that the
 * first one gets. `params` may be null: the defaults. */
PBF_API pbf_status pbf_batch_create(const pbf_desc *desc, const pbf_params *params, uint32_t worlds,
                                    pbf_batch **batch);

/* Destroys the worlds, too. Null is a no-op. Tensors live on until their deleter runs. In a
 * callback the call goes on to its end, without a log but those that other threads are in by then;
 * then the batch is freed. */
PBF_API void pbf_batch_destroy(pbf_batch *batch);

/* How many worlds a batch has, and what steps them. */
typedef struct pbf_batch_info {
  uint32_t struct_size;
  uint32_t worlds;
  uint32_t threads;     /* that step worlds, the caller's included; 0 on a device */
  uint32_t device_type; /* PBF_DEVICE_… */
} pbf_batch_info;

/* info->struct_size must be set. */
PBF_API pbf_status pbf_batch_get_info(pbf_batch *batch, pbf_batch_info *info);

/* World `world` as a solver: all of pbf.h's calls take it, between calls of the batch. It is the
 * batch's: pbf_destroy does nothing, and it ends with the batch. */
PBF_API pbf_status pbf_batch_get_world(pbf_batch *batch, uint32_t world, pbf_solver **solver);

/* Shape (worlds): what became of each in the batch's last call that goes through worlds (all below
 * but for those of this section); PBF_OK for those that it was not for. */
PBF_API pbf_status pbf_batch_get_statuses(pbf_batch *batch, pbf_status *statuses);

/* The sentence for that of one world, empty for PBF_OK. Valid until the batch's next call that goes
 * through worlds. */
PBF_API pbf_status pbf_batch_get_sentence(pbf_batch *batch, uint32_t world, const char **sentence);

/* ---- Steps and starts ---------------------------------------------------------------------- */

/* pbf_step of each world. */
PBF_API pbf_status pbf_batch_step(pbf_batch *batch, const uint8_t *mask, uint32_t steps);

/* What pbf_batch_reset goes back to: a state of pbf_save, of which the batch keeps one copy for all
 * these worlds; `state` null (and size 0): the present state of each, kept world by world. Where it
 * fails, starts are what they were: PBF_ERROR_DATA for anything that pbf_save did not write, of
 * another dimension or precision, PBF_ERROR_CAPACITY for more particles than a world holds. */
PBF_API pbf_status pbf_batch_set_start(pbf_batch *batch, const uint8_t *mask, const void *state,
                                       uint64_t size);

/* pbf_load of each world's start: parameters, colliders, time and particles, with the bits that
 * follow. PBF_ERROR_STATE for a world that has none. */
PBF_API pbf_status pbf_batch_reset(pbf_batch *batch, const uint8_t *mask);

/* ---- Actions ------------------------------------------------------------------------------- */

/* pbf_params.gravity of each world, shape (worlds, 3). */
PBF_API pbf_status pbf_batch_set_gravity(pbf_batch *batch, const uint8_t *mask,
                                         const double *gravity);

/* pbf_set_colliders of each world, the same ones for all. */
PBF_API pbf_status pbf_batch_set_colliders(pbf_batch *batch, const uint8_t *mask, uint32_t count,
                                           const pbf_collider *colliders);

/* pbf_move_colliders of each world: its `count` colliders, which must be all that it has, reach
 * positions, shape (worlds, count, 3), and orientations, shape (worlds, count, 4) (null: those that
 * they have), `duration` from now. Sizes stay. */
PBF_API pbf_status pbf_batch_move_colliders(pbf_batch *batch, const uint8_t *mask, uint32_t count,
                                            const double *positions, const double *orientations,
                                            double duration);

/* pbf_add_particles of each world, an emitter's: counts, shape (worlds), of which 0 leaves a world
 * as it is; positions and velocities (null: at rest), shape (sum of counts, dimension), world after
 * world. */
PBF_API pbf_status pbf_batch_add_particles(pbf_batch *batch, const uint32_t *counts,
                                           const void *positions, const void *velocities);

/* ---- Observations -------------------------------------------------------------------------- */

/* Shape (worlds). */
PBF_API pbf_status pbf_batch_get_counts(pbf_batch *batch, uint32_t *counts);

/* pbf_read of each world k, whose rows go to read->data + k * world_stride bytes (0: its rows end
 * where the next one's begin): an array of shape (worlds, read->count, components). A world may
 * have fewer particles than read->first + read->count: rows that it lacks become 0. */
PBF_API pbf_status pbf_batch_read(pbf_batch *batch, const uint8_t *mask, const pbf_read_desc *read,
                                  uint64_t world_stride);

/* The same as a DLPack tensor of shape (worlds, rows, components), in the order of adding; `rows`
 * 0: as many as the world has that has most. `field` is PBF_FIELD_POSITION, _VELOCITY, _ID,
 * _DENSITY or _PRESSURE; of one component are those with one. A copy that is the tensor's:
 * it does not change, and ends with its deleter, after pbf_batch_destroy, too. Of a device
 * positions and velocities stay there, ready for any stream; all else comes in host memory. */
struct DLManagedTensor;
PBF_API pbf_status pbf_batch_export_dlpack(pbf_batch *batch, uint32_t field, uint32_t rows,
                                           struct DLManagedTensor **tensor);

#ifdef __cplusplus
}
#endif

#endif
