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

/* Barrier `turn` = 1, 2, … of a launch. What failed before it is read in the same word as the
 * arrivals: all blocks see what any of them wrote before the barrier. */
static __device__ __forceinline__ grid_verdict grid_barrier(grid_control *control, uint32_t turn) {
  __shared__ grid_verdict verdict;
  __syncthreads();
  if (threadIdx.x == 0) {
    unsigned long long low, high;
    arrive(&control->arrived);
    do {
      asm volatile(
          "{ .reg .b128 word; ld.relaxed.gpu.global.b128 word, [%2]; mov.b128 {%0, %1}, word; }"
          : "=l"(low), "=l"(high)
          : "l"(control)
          : "memory");
    } while ((uint32_t)low < turn * gridDim.x);
    __threadfence();
    verdict = {(uint32_t)(low >> 32), (uint32_t)high};
  }
  __syncthreads();
  return verdict;
}

#endif
