/* Device memory of a solver: every array is in one table, so that the plan and the release can't
 * forget one. */
#ifndef PBF_CUDA_MEMORY_H
#define PBF_CUDA_MEMORY_H

#include <stdint.h>

#include "cuda/plugin.h"
#include "physics/scene_arrays.h"

struct pbf_cuda_array {
  const char *name;
  void *data;
  uint64_t bytes;
};

/* All that a scene may have at once, as PBF_MEMORY_ARRAYS. */
enum { PBF_CUDA_LASTING_ARRAYS = 48, PBF_CUDA_ARRAYS = PBF_CUDA_LASTING_ARRAYS + PBF_SCENE_ARRAYS };

struct pbf_cuda_memory {
  pbf_cuda_array arrays[PBF_CUDA_ARRAYS];
  uint32_t count;
  cudaStream_t stream; /* where arrays are zeroed */
};

/* `name` must outlive the array. The memory is zeroed. */
pbf_status pbf_cuda_take(pbf_cuda_memory *memory, const char *name, uint64_t bytes, void **data);

/* Null is a no-op. */
void pbf_cuda_free(pbf_cuda_memory *memory, void *data);
void pbf_cuda_free_all(pbf_cuda_memory *memory);

/* Adds the arrays to the plan; sums up its bytes. */
void pbf_cuda_memory_plan(const pbf_cuda_memory *memory, uint32_t capacity, pbf_plan *plan);

#endif
