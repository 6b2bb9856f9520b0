/* What a batch takes of memory, and how that is given back. */
#ifndef PBF_LIB_BATCH_FREE_H
#define PBF_LIB_BATCH_FREE_H

#include "batch.h"

static inline uint64_t pbf_worlds_bytes(uint32_t worlds) {
  return (uint64_t)worlds * sizeof(pbf_world);
}

/* Frees the worlds and everything else. Called by the call that drops the last reference. */
void pbf_batch_free(pbf_batch *batch);

#endif
