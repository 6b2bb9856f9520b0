#include "cuda/status.h"

#include <stdio.h>

pbf_status pbf_cuda_check(cudaError_t error, const char *call) {
  if (error == cudaSuccess) return PBF_OK;
  cudaGetLastError(); /* so that the next call does not report this failure again */
  char sentence[384];
  if (error == cudaErrorMemoryAllocation) {
    snprintf(sentence, sizeof sentence,
             "%s found no device memory; a smaller capacity or another device would do", call);
    pbf_cuda_host->set_error(sentence);
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  const bool is_of_fork = error == cudaErrorInitializationError;
  snprintf(sentence, sizeof sentence, "%s failed with %s: %s%s%s", call, cudaGetErrorName(error),
           cudaGetErrorString(error), is_of_fork ? "; " : "",
           is_of_fork ? pbf_cuda_after_fork : "");
  pbf_cuda_host->set_error(sentence);
  return PBF_ERROR_DEVICE;
}
