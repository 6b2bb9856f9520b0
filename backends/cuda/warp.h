/* Reductions over lanes of a warp: an instruction from sm_80 on, and a loop over the lanes before.
 * The lanes of the mask call them together, and each gets the result. */
#ifndef PBF_CUDA_WARP_H
#define PBF_CUDA_WARP_H

#include <stdint.h>

#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 800

static __device__ __forceinline__ uint32_t min_of_lanes(uint32_t lanes, uint32_t value) {
  return __reduce_min_sync(lanes, value);
}

static __device__ __forceinline__ uint32_t max_of_lanes(uint32_t lanes, uint32_t value) {
  return __reduce_max_sync(lanes, value);
}

static __device__ __forceinline__ uint32_t or_of_lanes(uint32_t lanes, uint32_t value) {
  return __reduce_or_sync(lanes, value);
}

#else

static __device__ __forceinline__ uint32_t min_of_lanes(uint32_t lanes, uint32_t value) {
  uint32_t least = value;
  for (uint32_t rest = lanes; rest; rest &= rest - 1) {
    const uint32_t other = __shfl_sync(lanes, value, __ffs((int)rest) - 1);
    least = other < least ? other : least;
  }
  return least;
}

static __device__ __forceinline__ uint32_t max_of_lanes(uint32_t lanes, uint32_t value) {
  return ~min_of_lanes(lanes, ~value);
}

static __device__ __forceinline__ uint32_t or_of_lanes(uint32_t lanes, uint32_t value) {
  uint32_t all = 0;
  for (uint32_t rest = lanes; rest; rest &= rest - 1)
    all |= __shfl_sync(lanes, value, __ffs((int)rest) - 1);
  return all;
}

#endif

#endif
