#include "cuda/memory.h"

#include <stdio.h>

#include "cuda/status.h"

pbf_status pbf_cuda_take(pbf_cuda_memory *memory, const char *name, uint64_t bytes, void **data) {
  char call[96];
  void *taken = nullptr;
  snprintf(call, sizeof call, "cudaMalloc of %llu bytes for '%s'", (unsigned long long)bytes, name);
  if (memory->count == PBF_CUDA_ARRAYS) return pbf_cuda_check(cudaErrorMemoryAllocation, call);
  if (pbf_status status = pbf_cuda_check(cudaMalloc(&taken, bytes), call)) return status;
  if (pbf_status status =
          pbf_cuda_check(cudaMemsetAsync(taken, 0, bytes, memory->stream), "cudaMemsetAsync")) {
    cudaFree(taken);
    return status;
  }
  memory->arrays[memory->count++] = {name, taken, bytes};
  *data = taken;
  return PBF_OK;
}

void pbf_cuda_free(pbf_cuda_memory *memory, void *data) {
  for (uint32_t k = 0; data && k < memory->count; ++k)
    if (memory->arrays[k].data == data) {
      /* After a lost device this fails; there is nothing left to free then. */
      if (cudaFree(data) != cudaSuccess) cudaGetLastError();
      memory->arrays[k] = memory->arrays[--memory->count];
      return;
    }
}

void pbf_cuda_free_all(pbf_cuda_memory *memory) {
  while (memory->count) pbf_cuda_free(memory, memory->arrays[memory->count - 1].data);
}

void pbf_cuda_memory_plan(const pbf_cuda_memory *memory, uint32_t capacity, pbf_plan *plan) {
  for (uint32_t k = 0; k < memory->count; ++k) {
    const uint64_t bytes = memory->arrays[k].bytes;
    plan->bytes += bytes;
    plan->bytes_per_particle += (double)bytes / capacity;
    if (plan->array_count == PBF_MAX_ARRAYS) continue;
    pbf_plan_array *entry = &plan->arrays[plan->array_count++];
    snprintf(entry->name, sizeof entry->name, "%s", memory->arrays[k].name);
    entry->bytes = bytes;
    entry->bytes_per_particle = (double)bytes / capacity;
  }
}
