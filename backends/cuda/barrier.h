/* A barrier of all blocks of a resident grid, which also tells every block the same about what has
 * failed so far. */
#ifndef PBF_CUDA_BARRIER_H
#define PBF_CUDA_BARRIER_H

#include <stdint.h>

struct alignas(16) grid_control {
  uint32_t arrived;
  uint32_t cells_failed, lists_failed; /* 1: in this step, they had no room */
  uint32_t unused;
};

struct grid_verdict {
  uint32_t cells_failed, lists_failed;
};

static __device__ __forceinline__ void arrive(uint32_t *arrived) {
  asm volatile("red.release.gpu.global.add.u32 [%0], 1;" ::"l"(arrived) : "memory");
}

static __device__ __forceinline__ uint32_t relaxed(const uint32_t *word) {
  uint32_t value;
  asm volatile("ld.relaxed.gpu.global.u32 %0, [%1];" : "=r"(value) : "l"(word) : "memory");
  return value;
}

/* Barrier `turn` = 1, 2, … of a launch. With `ask`, all blocks learn what any of them found to have
 * failed before it. */
static __device__ __forceinline__ grid_verdict grid_barrier(grid_control *control, uint32_t turn,
                                                            bool ask = false) {
  __shared__ grid_verdict verdict;
  __syncthreads();
  if (threadIdx.x == 0) {
    uint32_t arrived;
    arrive(&control->arrived);
    do {
      asm volatile("ld.acquire.gpu.global.u32 %0, [%1];"
                   : "=r"(arrived)
                   : "l"(&control->arrived)
                   : "memory");
    } while (arrived < turn * gridDim.x);
    if (ask) verdict = {relaxed(&control->cells_failed), relaxed(&control->lists_failed)};
  }
  __syncthreads();
  return verdict;
}

#endif
