/* The kernels of small scenes: see small/launch.h. */
#include "cuda/features.h"
#include "cuda/small/launch.h"
#include "cuda/status.h"

#if PBF_BITS == 32

static pbf_status allow(const void *kernel, size_t bytes) {
  return pbf_cuda_check(
      cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, (int)bytes),
      "cudaFuncSetAttribute");
}

template <class Kernel>
static const void *address_of(Kernel kernel) {
  return reinterpret_cast<const void *>(kernel);
}

template <class Real, int DIM>
pbf_status allow_small_shared(size_t bytes) {
  pbf_status status = PBF_OK;
  for (int k = 0; k < PBF_FEATURE_COUNT && status == PBF_OK; ++k)
    with_features(k, [&](auto features) {
      constexpr int FEATURES = decltype(features)::value;
      for (auto kernel :
           {small_kernel<FEATURES, false, NO_SURFACES>, small_kernel<FEATURES, true, NO_SURFACES>,
            small_kernel<FEATURES, true, FEW_SURFACES>})
        if (status == PBF_OK) status = allow(address_of(kernel), bytes);
    });
  return status;
}

template <class Real, int DIM>
pbf_status launch_small(cudaStream_t stream, int features, uint32_t blocks,
                        const small_scene &scene, const small_buffers &buffers,
                        const general_buffers &general) {
  pbf_status status = PBF_OK;
  with_features(features, [&](auto constant) {
    constexpr int FEATURES = decltype(constant)::value;
    auto kernel = scene.surface_count ? small_kernel<FEATURES, true, FEW_SURFACES>
                  : scene.accelerated || scene.wall_density
                      ? small_kernel<FEATURES, true, NO_SURFACES>
                      : small_kernel<FEATURES, false, NO_SURFACES>;
    status = pbf_cuda_check(launch_cooperative(stream, kernel, blocks, SMALL_THREADS,
                                               scene.layout.bytes(), scene, buffers, general),
                            "small_kernel");
  });
  return status;
}

template <class Real, int DIM>
pbf_status launch_worlds(const world_launch &l) {
  pbf_status status = PBF_OK;
  with_features(l.features, [&](auto features) {
    constexpr int FEATURES = decltype(features)::value;
    auto kernel =
        l.surfaces ? world_kernel<FEATURES, FEW_SURFACES> : world_kernel<FEATURES, NO_SURFACES>;
    status = allow(address_of(kernel), l.layout.bytes());
    if (status != PBF_OK) return;
    kernel<<<l.worlds, l.threads, l.layout.bytes(), l.stream>>>(l.records, l.stride, l.layout);
    status = pbf_cuda_check_launch("world_kernel");
  });
  return status;
}

template pbf_status allow_small_shared<pbf_real, PBF_DIM>(size_t);
template pbf_status launch_small<pbf_real, PBF_DIM>(cudaStream_t, int, uint32_t,
                                                    const small_scene &, const small_buffers &,
                                                    const general_buffers &);
template pbf_status launch_worlds<pbf_real, PBF_DIM>(const world_launch &);

#endif
