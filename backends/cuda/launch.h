/* Launches: one thread a particle, and blocks that wait for each other. */
#ifndef PBF_CUDA_LAUNCH_H
#define PBF_CUDA_LAUNCH_H

#include <stdint.h>

#include "cuda/ptx.h"

enum { PBF_BLOCK = 256 };

/* Threads that a multiprocessor holds, at least; of compute capability 7.5 it holds fewer. */
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ == 750
enum { RESIDENT_THREADS = 1024 };
#else
enum { RESIDENT_THREADS = 1536 };
#endif

/* Blocks that a multiprocessor is to hold at once, as far as it can. */
constexpr int resident_blocks(int wanted, int threads) {
  return wanted * threads <= RESIDENT_THREADS ? wanted : RESIDENT_THREADS / threads;
}

static inline uint32_t blocks_for(uint32_t count) { return (count + PBF_BLOCK - 1) / PBF_BLOCK; }

/* The first thing that a kernel asks: it may have been launched early (solver.h). */
static __device__ __forceinline__ uint32_t thread_index() {
  await_launches_before();
  return blockIdx.x * blockDim.x + threadIdx.x;
}

/* Of blocks that wait for each other. cudaLaunchCooperativeKernel of CUDA 12 takes no function of
 * C++. */
template <class... Parameters, class... Arguments>
static inline cudaError_t launch_cooperative(cudaStream_t stream, void (*kernel)(Parameters...),
                                             uint32_t blocks, uint32_t threads, size_t shared,
                                             const Arguments &...arguments) {
  cudaLaunchAttribute cooperative;
  cooperative.id = cudaLaunchAttributeCooperative;
  cooperative.val.cooperative = 1;
  cudaLaunchConfig_t config = {};
  config.gridDim = dim3(blocks);
  config.blockDim = dim3(threads);
  config.dynamicSmemBytes = shared;
  config.stream = stream;
  config.attrs = &cooperative;
  config.numAttrs = 1;
  return cudaLaunchKernelEx(&config, kernel, Parameters(arguments)...);
}

#endif
