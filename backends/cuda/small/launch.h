/* Launches of the kernels of small scenes, which are in a unit of their own of each variant in 32
 * bits, small.cu. There products and sums are apart where no fused multiply-add is written: what
 * the compiler fuses depends on what is around it, and a world has the same bits in a block of its
 * own as alone. */
#ifndef PBF_CUDA_SMALL_LAUNCH_H
#define PBF_CUDA_SMALL_LAUNCH_H

#include "cuda/small/world.h"

/* Of a scene alone. */
template <class Real, int DIM>
pbf_status allow_small_shared(size_t bytes);
template <class Real, int DIM>
pbf_status launch_small(cudaStream_t stream, int features, uint32_t blocks,
                        const small_scene &scene, const small_buffers &buffers,
                        const general_buffers &general);

/* Of worlds, a block each. */
struct world_launch {
  cudaStream_t stream;
  int features, surfaces; /* 1: with colliders */
  const char *records;    /* `worlds` of them, `stride` bytes apart */
  uint32_t worlds, stride, threads;
  world_layout layout;
};
template <class Real, int DIM>
pbf_status launch_worlds(const world_launch &launch);

#endif
