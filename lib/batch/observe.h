/* Fields of all worlds in one array. */
#ifndef PBF_LIB_BATCH_OBSERVE_H
#define PBF_LIB_BATCH_OBSERVE_H

#include "batch.h"

/* What pbf_batch_read does, in a call that runs. */
pbf_status pbf_batch_observe(pbf_batch *batch, const uint8_t *mask, const pbf_read_desc *read,
                             uint64_t world_stride);

/* The most particles that any world has. */
pbf_status pbf_batch_max_count(pbf_batch *batch, uint32_t *count);

#endif
