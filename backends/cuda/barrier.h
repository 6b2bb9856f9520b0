/* Barriers of all blocks of a resident grid, by which they also learn alike whether any of them
 * failed at what came before. */
#ifndef PBF_CUDA_BARRIER_H
#define PBF_CUDA_BARRIER_H

#include "cuda/ptx.h"

/* Of one barrier that recurs: arrivals in the lower half, failures in the upper one. No block may
 * arrive again before all have seen the last outcome: another barrier in between sees to that. */
struct grid_counter {
  unsigned long long arrivals;
};

enum { PBF_FAILURE_SHIFT = 32 };

static __device__ __forceinline__ unsigned long long arrival(bool failed) {
  return 1ull | (unsigned long long)failed << PBF_FAILURE_SHIFT;
}

/* What the block wrote before a __syncthreads, others see after their barrier. */
static __device__ __forceinline__ void arrive(grid_counter *counter, bool failed) {
  add_release(&counter->arrivals, arrival(failed));
}

/* For a barrier that hands over the outcome alone. */
static __device__ __forceinline__ void arrive_relaxed(grid_counter *counter, bool failed) {
  add_relaxed(&counter->arrivals, arrival(failed));
}

/* Waits for arrival `turn` = 1, 2, … of all blocks; returns the failures since the launch. */
static __device__ __forceinline__ uint32_t await_all(const grid_counter *counter, uint32_t turn) {
  unsigned long long seen;
  do {
    seen = load_acquire(&counter->arrivals);
  } while ((uint32_t)seen < turn * gridDim.x);
  return (uint32_t)(seen >> PBF_FAILURE_SHIFT);
}

/* Barrier `turn` of `counter`; returns the failures since the launch, this barrier's included. */
static __device__ __forceinline__ uint32_t grid_barrier(grid_counter *counter, uint32_t turn,
                                                        bool failed = false) {
  __shared__ uint32_t failures;
  bool any = __syncthreads_or(failed);
  if (threadIdx.x == 0) {
    arrive(counter, any);
    failures = await_all(counter, turn);
  }
  __syncthreads();
  return failures;
}

#endif
