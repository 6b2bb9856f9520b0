/* What the variants of the `cuda` backend share. */
#ifndef PBF_CUDA_PLUGIN_H
#define PBF_CUDA_PLUGIN_H

#include <cuda_runtime_api.h>

#include <pbf/pbf_backend.h>

extern "C" {
/* The libpbf that has called into this thread: there may be several in a process. */
extern __thread const pbf_backend_host *pbf_cuda_host;
extern const pbf_backend_api cuda_2d_f32, cuda_2d_f64, cuda_3d_f32, cuda_3d_f64;
}

void pbf_cuda_probe(const pbf_workload *workload, pbf_probe_result *result);

#endif
