/* Going through the worlds of a batch. */
#ifndef PBF_LIB_BATCH_WORLDS_H
#define PBF_LIB_BATCH_WORLDS_H

#include "batch.h"

/* What a call does with one world; its failure's sentence is pbf_last_error's of that thread. */
typedef pbf_status (*pbf_world_fn)(pbf_batch *batch, uint32_t world, void *context);

/* In which threads a call goes through worlds. Short work is not worth waking threads. */
typedef enum pbf_worlds_by { PBF_BY_CALLER, PBF_BY_THREADS } pbf_worlds_by;

/* Calls it for the worlds of the mask (null: all), notes each one's status, and returns that of the
 * first that failed, with its sentence. */
pbf_status pbf_batch_for_worlds(pbf_batch *batch, const uint8_t *mask, pbf_worlds_by by,
                                pbf_world_fn function, void *context);

#endif
