/* Live batches, and the calls that run in them. */
#ifndef PBF_LIB_BATCH_HANDLES_H
#define PBF_LIB_BATCH_HANDLES_H

#include "batch.h"

/* Begins a call. Fails for null, for a pointer to no live batch, and with PBF_ERROR_BUSY. After a
 * success the call ends with one pbf_batch_leave, which returns `status`. */
pbf_status pbf_batch_enter(pbf_batch *batch);
pbf_status pbf_batch_leave(pbf_batch *batch, pbf_status status);

/* Makes the handle valid. */
void pbf_batch_publish(pbf_batch *batch);

#endif
