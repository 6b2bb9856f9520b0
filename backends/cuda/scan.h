/* Exclusive prefix sums on the device, in place. */
#ifndef PBF_CUDA_SCAN_H
#define PBF_CUDA_SCAN_H

#include "cuda/plugin.h"

/* Kernels that one scan launches. */
enum { PBF_CUDA_SCAN_LAUNCHES = 2 };

/* Bytes of scratch for scans of up to `count` values. */
pbf_status pbf_cuda_scan_scratch(uint32_t count, size_t *bytes);

pbf_status pbf_cuda_scan(uint32_t *values, uint32_t count, void *scratch, size_t bytes,
                         cudaStream_t stream);

#endif
