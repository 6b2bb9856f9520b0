#include "starts.h"

#include "memory.h"

static uint64_t start_bytes(uint64_t size) { return sizeof(pbf_start) + size; }

void pbf_start_drop(const pbf_batch *batch, pbf_start **start) {
  pbf_start *own = *start;
  *start = NULL;
  if (own && atomic_fetch_sub(&own->worlds, 1) == 1)
    pbf_memory_free(&batch->allocator, own, start_bytes(own->size));
}

pbf_status pbf_start_take(const pbf_batch *batch, uint64_t size, pbf_start **start) {
  void *memory;
  pbf_status status =
      pbf_memory_allocate(&batch->allocator, start_bytes(size), "the start of a world", &memory);
  if (status != PBF_OK) return status;
  *start = memory;
  (*start)->size = size;
  atomic_init(&(*start)->worlds, 1);
  return PBF_OK;
}
