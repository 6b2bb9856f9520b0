#include "cuda/scan.h"

#include <cub/device/device_scan.cuh>

#include "cuda/status.h"

pbf_status pbf_cuda_scan_scratch(uint32_t count, size_t *bytes) {
  *bytes = 0;
  uint32_t *none = nullptr;
  return pbf_cuda_check(cub::DeviceScan::ExclusiveSum(nullptr, *bytes, none, none, count),
                        "cub::DeviceScan");
}

pbf_status pbf_cuda_scan(uint32_t *values, uint32_t count, void *scratch, size_t bytes,
                         cudaStream_t stream) {
  return pbf_cuda_check(
      cub::DeviceScan::ExclusiveSum(scratch, bytes, values, values, count, stream),
      "cub::DeviceScan");
}
