/* Whether this machine can serve a solver, and if not, why. Creates no context. */
#include <stdio.h>

#include "cuda/architectures.h"
#include "cuda/driver_function.h"
#include "cuda/plugin.h"
#include "cuda/status.h"

namespace {

void say_no_driver(pbf_probe_result *result) {
  int version = 0;
  if (cudaDriverGetVersion(&version) != cudaSuccess || version == 0)
    snprintf(result->reason, sizeof result->reason, "no NVIDIA driver");
  else
    snprintf(result->reason, sizeof result->reason,
             "the NVIDIA driver serves CUDA %d.%d; this build wants %d.%d or newer", version / 1000,
             version % 1000 / 10, CUDART_VERSION / 1000, 0);
}

/* The runtime remembers its devices over a fork, while the driver serves none of them. What asks
 * the driver has to be found before. */
bool is_after_fork() {
  enum { NOT_INITIALIZED = 3 };
  typedef int (*init_fn)(unsigned);
  static const init_fn init = pbf_cuda_driver_function<init_fn>("cuInit");
  return init && init(0) == NOT_INITIALIZED;
}

/* Millions of particle-iterations a second: a step's latency, then the pair loop's rate. Measured
 * on an H200, scaled by the number of multiprocessors. */
int32_t score_of(const pbf_workload *workload, int multiprocessors) {
  double latency_us = 30;
  double rate = (workload->precision == PBF_FLOAT64 ? 1500.0 : 6000.0) * multiprocessors / 132;
  double work = 5.0 * workload->capacity;
  double score = work / (latency_us + work / rate);
  return score < 1 ? 1 : (int32_t)score;
}

}  // namespace

void pbf_cuda_probe(const pbf_workload *workload, pbf_probe_result *result) {
  int count = 0, major = 0, minor = 0, multiprocessors = 0;
  result->score = 0;
  result->device_type = PBF_DEVICE_CUDA;
  cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess) cudaGetLastError();
  if (error == cudaErrorInsufficientDriver) return say_no_driver(result);
  if (error == cudaErrorNoDevice || (error == cudaSuccess && count == 0)) {
    snprintf(result->reason, sizeof result->reason, "no CUDA device");
    return;
  }
  if (error != cudaSuccess) {
    snprintf(result->reason, sizeof result->reason, "cudaGetDeviceCount failed: %s",
             cudaGetErrorString(error));
    return;
  }
  if (is_after_fork()) {
    snprintf(result->reason, sizeof result->reason, "%s", pbf_cuda_after_fork);
    return;
  }
  if (workload->device < 0 || workload->device >= count) {
    snprintf(result->reason, sizeof result->reason, "no CUDA device %d; there are %d",
             workload->device, count);
    return;
  }
  cudaDeviceProp properties;
  error = cudaGetDeviceProperties(&properties, workload->device);
  if (error != cudaSuccess) {
    cudaGetLastError();
    snprintf(result->reason, sizeof result->reason, "cudaGetDeviceProperties failed: %s",
             cudaGetErrorString(error));
    return;
  }
  major = properties.major;
  minor = properties.minor;
  multiprocessors = properties.multiProcessorCount;
  snprintf(result->device_name, sizeof result->device_name, "%.95s", properties.name);
  if (!pbf_cuda_has_code(PBF_CUDA_ARCHITECTURES, 10 * major + minor)) {
    snprintf(result->reason, sizeof result->reason,
             "no code for compute capability %d.%d of device %d; PBF_CUDA_ARCHITECTURES of the "
             "build is %s",
             major, minor, workload->device, PBF_CUDA_ARCHITECTURES);
    return;
  }
  result->score = score_of(workload, multiprocessors);
}
