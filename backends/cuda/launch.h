/* One thread a particle. */
#ifndef PBF_CUDA_LAUNCH_H
#define PBF_CUDA_LAUNCH_H

#include <stdint.h>

#include "cuda/ptx.h"

enum { PBF_BLOCK = 256 };

static inline uint32_t blocks_for(uint32_t count) { return (count + PBF_BLOCK - 1) / PBF_BLOCK; }

/* The first thing that a kernel asks: it may have been launched early (solver.h). */
static __device__ __forceinline__ uint32_t thread_index() {
  await_launches_before();
  return blockIdx.x * blockDim.x + threadIdx.x;
}

#endif
