/* States that worlds go back to, shared by the worlds that have the same one. */
#ifndef PBF_LIB_BATCH_STARTS_H
#define PBF_LIB_BATCH_STARTS_H

#include "batch.h"

/* A state of so many bytes, yet unwritten, with one reference. */
pbf_status pbf_start_take(const pbf_batch *batch, uint64_t size, pbf_start **start);

/* Drops the reference of a world; the last one frees the state. */
void pbf_start_drop(const pbf_batch *batch, pbf_start **start);

#endif
