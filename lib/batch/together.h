/* Steps of worlds by a backend that does those of all at once (PBF_BACKEND_WORLDS). */
#ifndef PBF_LIB_BATCH_TOGETHER_H
#define PBF_LIB_BATCH_TOGETHER_H

#include "batch.h"

/* Finds out whether the backend of the worlds does, and takes what it needs then. */
pbf_status pbf_batch_find_together(pbf_batch *batch);

/* Needs that. */
pbf_status pbf_batch_step_together(pbf_batch *batch, const uint8_t *mask, uint32_t steps);

void pbf_batch_free_together(pbf_batch *batch);

#endif
