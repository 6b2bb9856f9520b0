/* CUDA's errors as status codes. */
#ifndef PBF_CUDA_STATUS_H
#define PBF_CUDA_STATUS_H

#include "cuda/plugin.h"

/* Why calls fail in the child of a process that has begun with CUDA. */
inline constexpr char pbf_cuda_after_fork[] =
    "CUDA works in no process that was forked off after it had begun: start such a process anew "
    "(exec; Python's \"spawn\")";

/* PBF_OK, or the status for `error` with a sentence that names `call`. */
pbf_status pbf_cuda_check(cudaError_t error, const char *call);

/* The same for the launch before this call. */
inline pbf_status pbf_cuda_check_launch(const char *kernel) {
  return pbf_cuda_check(cudaGetLastError(), kernel);
}

#endif
