/* States that worlds go back to, shared by the worlds that have the same one. */
#ifndef PBF_LIB_BATCH_STARTS_H
#define PBF_LIB_BATCH_STARTS_H

#include "batch.h"

/* Room for one of so many bytes, held once. */
pbf_status pbf_start_take(const pbf_batch *batch, uint64_t size, pbf_start **start);

/* Takes it from its holder, a world; the last one's frees it. */
void pbf_start_drop(const pbf_batch *batch, pbf_start **start);

#endif
